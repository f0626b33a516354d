// The file that tells builds of the renderer apart.
#include "render/code_file.h"

#include <gtest/gtest.h>

#include <filesystem>

namespace lacuna::test {
namespace {

// Programs may stay the same when the library changes. Runs of an older library must not be kept.
TEST(CodeFile, isTheLibrary) {
    const std::filesystem::path file = codeFile();
    EXPECT_EQ(file.filename().string().substr(0, 12), "liblacuna.so") << file;
    EXPECT_TRUE(std::filesystem::exists(file)) << file;
}

}  // namespace
}  // namespace lacuna::test
