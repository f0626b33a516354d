// A file of learned emission comes back as it was written, and is refused when anything about it is
// wrong.
#include "libcore/cache/emission_file.h"

#include <gtest/gtest.h>

#include "tests/cache/example_guide.h"
#include "tests/cache/example_subspaces.h"
#include "tests/cache/file_test.h"

namespace lacuna::test {
namespace {

class EmissionFiles : public CacheFileTest {
  protected:
    void write(std::shared_ptr<const EmissionGuide> guide) const {
        writeEmissionFile(path(), {guide, kStamp, guide ? guide->contentHash() : "plain"});
    }
    void expectRefused(const std::string& what, const CacheStamp& expected = kStamp) const {
        expectRefusal(what, "learn again",
                      [&] { readEmissionFile(path(), expected, "learn again"); });
    }
};

TEST_F(EmissionFiles, comeBack) {
    const auto guide = exampleGuide();
    write(guide);
    const EmissionFile read = readEmissionFile(path(), kStamp, "learn again");
    ASSERT_TRUE(read.guide);
    EXPECT_EQ(read.guide->contentHash(), guide->contentHash());
    EXPECT_EQ(read.contentHash, guide->contentHash());
    EXPECT_EQ(read.stamp, kStamp);
    write(nullptr);
    EXPECT_FALSE(readEmissionFile(path(), kStamp, "learn again").guide);
}

TEST_F(EmissionFiles, areRefusedWhereAByteIsWrongOrMissing) {
    expectRefused("nothing");
    write(exampleGuide());
    const std::string good = content();
    for (std::size_t i = 0; i < good.size(); ++i) {
        std::string bad = good;
        bad[i] = char(bad[i] ^ 0x10);
        replace(bad);
        expectRefused("byte " + std::to_string(i));
    }
    for (std::size_t size = 0; size < good.size(); size += 7) {
        replace(good.substr(0, size));
        expectRefused("a length of " + std::to_string(size));
    }
    replace(good);
    CacheStamp other = kStamp;
    other.inputs["scene"] = "another";
    expectRefused("another scene", other);
}

/// The checksums are right: a program with a fault may have written such files.
TEST_F(EmissionFiles, areRefusedWhereTheirPartsDoNotFit) {
    const auto refused = [&](const char* what, const auto& spoil) {
        auto guide = exampleGuide();
        spoil(*guide);
        write(guide);
        expectRefused(what);
    };
    refused("no such tree", [](EmissionGuide& g) { g.pointTree[0] = 2; });
    refused("no such rays", [](EmissionGuide& g) { g.rayTree[0] = 2; });
    refused("too few leaves", [](EmissionGuide& g) { g.rayTree.pop_back(); });
    refused("a sum of two", [](EmissionGuide& g) { g.pmf[1] = 1.0; });
    refused("a light too many", [](EmissionGuide& g) { g.pmf.push_back(0.0); });
}

}  // namespace
}  // namespace lacuna::test
