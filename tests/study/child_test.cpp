#include "render/study/child.h"

#include <gtest/gtest.h>
#include <signal.h>

#include <cstdio>

namespace lacuna {
namespace {

/// Handles SIGTERM as a tool with an InterruptGuard does.
class Handled {
  public:
    Handled() : before_(::signal(SIGTERM, [](int) {})) {}
    ~Handled() { ::signal(SIGTERM, before_); }

  private:
    void (*before_)(int);
};

// An interrupt may come while the child is still a copy of this process, with its handlers.
TEST(Child, hearsAnInterruptThatComesBeforeItBegins) {
    const Handled handled;
    const std::atomic<bool> cancel = true;
    const std::string log = ::testing::TempDir() + "lacuna-child.log";
    for (int i = 0; i < 3; ++i) {
        EXPECT_EQ(runChild({"/bin/sleep", "20"}, log, cancel), 128 + SIGTERM);
    }
    std::remove(log.c_str());
}

TEST(Child, givesItsExitCode) {
    const std::atomic<bool> cancel = false;
    EXPECT_EQ(runChild({"/bin/sh", "-c", "exit 3"}, "/dev/null", cancel), 3);
    EXPECT_EQ(runChild({"/bin/sh", "-c", "kill -9 $$"}, "/dev/null", cancel), 128 + SIGKILL);
}

}  // namespace
}  // namespace lacuna
