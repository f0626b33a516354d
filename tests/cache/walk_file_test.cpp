// A file of guided walks comes back as it was written, and is refused when anything about it is wrong.
#include "libcore/cache/walk_file.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "libcore/base/error.h"
#include "tests/cache/example_subspaces.h"
#include "tests/fixtures/random_walk_guide.h"

namespace lacuna::test {
namespace {

class WalkFiles : public testing::Test {
  protected:
    void SetUp() override {
        directory_ = std::filesystem::temp_directory_path() /
                     (std::string("lacuna-walks-test-") +
                      testing::UnitTest::GetInstance()->current_test_info()->name());
        std::filesystem::create_directories(directory_);
    }
    void TearDown() override { std::filesystem::remove_all(directory_); }

    std::string path() const { return (directory_ / "w.walks").string(); }
    std::string content() const {
        std::ostringstream bytes;
        bytes << std::ifstream(path(), std::ios::binary).rdbuf();
        return bytes.str();
    }
    void replace(const std::string& bytes) const {
        std::ofstream(path(), std::ios::binary | std::ios::trunc) << bytes;
    }
    void write(std::shared_ptr<const WalkGuide> guide) const {
        writeWalkFile(path(), {guide, kStamp, guide ? guide->contentHash() : "plain"});
    }
    void expectRefused(const std::string& what, const CacheStamp& expected = kStamp) const {
        try {
            readWalkFile(path(), expected, "learn again");
            ADD_FAILURE() << what << " was accepted";
        } catch (const InputError& e) {
            EXPECT_NE(std::string(e.what()).find("learn again"), std::string::npos) << e.what();
        }
    }

  private:
    std::filesystem::path directory_;
};

TEST_F(WalkFiles, comeBack) {
    const auto guide = randomWalkGuide(1);
    write(guide);
    const WalkFile read = readWalkFile(path(), kStamp, "learn again");
    ASSERT_TRUE(read.guide);
    EXPECT_EQ(read.guide->contentHash(), guide->contentHash());
    EXPECT_EQ(read.contentHash, guide->contentHash());
    EXPECT_EQ(read.stamp, kStamp);
    write(nullptr);
    EXPECT_FALSE(readWalkFile(path(), kStamp, "learn again").guide);
}

TEST_F(WalkFiles, areRefusedWhereAByteIsWrongOrMissing) {
    expectRefused("nothing");
    write(randomWalkGuide(2));
    const std::string good = content();
    for (std::size_t i = 0; i < good.size(); i += 3) {
        std::string bad = good;
        bad[i] = char(bad[i] ^ 0x10);
        replace(bad);
        expectRefused("byte " + std::to_string(i));
    }
    for (std::size_t size = 0; size < good.size(); size += 17) {
        replace(good.substr(0, size));
        expectRefused("a length of " + std::to_string(size));
    }
    replace(good);
    CacheStamp other = kStamp;
    other.inputs["scene"] = "another";
    expectRefused("another scene", other);
}

}  // namespace
}  // namespace lacuna::test
