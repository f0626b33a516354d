// A file of guided walks comes back as it was written, and is refused when anything about it is wrong.
#include "libcore/cache/walk_file.h"

#include <gtest/gtest.h>

#include "tests/cache/example_subspaces.h"
#include "tests/cache/file_test.h"
#include "tests/fixtures/random_walk_guide.h"

namespace lacuna::test {
namespace {

class WalkFiles : public CacheFileTest {
  protected:
    void write(std::shared_ptr<const WalkGuide> guide) const {
        writeWalkFile(path(), {guide, kStamp, guide ? guide->contentHash() : "plain"});
    }
    void expectRefused(const std::string& what, const CacheStamp& expected = kStamp) const {
        expectRefusal(what, "learn again", [&] { readWalkFile(path(), expected, "learn again"); });
    }
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
