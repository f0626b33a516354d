// What tells builds of the renderer apart.
#include "render/code_file.h"

#include <gtest/gtest.h>

#include <filesystem>

namespace lacuna::test {
namespace {

// Programs stay the same when the code that renders changes: runs of an older library are not kept.
TEST(CodeFile, isTheLibrary) {
    const std::filesystem::path file = codeFile();
    EXPECT_EQ(file.filename().string().substr(0, 12), "liblacuna.so") << file;
    EXPECT_TRUE(std::filesystem::exists(file)) << file;
}

}  // namespace
}  // namespace lacuna::test
