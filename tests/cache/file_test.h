// Fixture for section files of caches: a folder for one file, and the check that a bad file is
// refused.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "libcore/base/error.h"

namespace lacuna::test {

class CacheFileTest : public testing::Test {
  protected:
    void SetUp() override {
        const testing::TestInfo& test = *testing::UnitTest::GetInstance()->current_test_info();
        directory_ = std::filesystem::temp_directory_path() /
                     (std::string("lacuna-") + test.test_suite_name() + "-" + test.name());
        std::filesystem::create_directories(directory_);
    }
    void TearDown() override { std::filesystem::remove_all(directory_); }

    std::string path() const { return (directory_ / "file").string(); }
    std::string content() const {
        std::ostringstream bytes;
        bytes << std::ifstream(path(), std::ios::binary).rdbuf();
        return bytes.str();
    }
    void replace(const std::string& bytes) const {
        std::ofstream(path(), std::ios::binary | std::ios::trunc) << bytes;
    }
    /// Expects `read` to throw for the current file, with the remedy in the message.
    template <class Read>
    static void expectRefusal(const std::string& what, const std::string& remedy,
                              const Read& read) {
        try {
            read();
            ADD_FAILURE() << what << " was accepted";
        } catch (const InputError& e) {
            EXPECT_NE(std::string(e.what()).find(remedy), std::string::npos) << e.what();
            EXPECT_EQ(e.exitCode(), 3);
        }
    }

  private:
    std::filesystem::path directory_;
};

}  // namespace lacuna::test
