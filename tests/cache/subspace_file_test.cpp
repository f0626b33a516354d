// A file of subspaces comes back as it was written, and is refused when anything about it is wrong.
#include "libcore/cache/subspace_file.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <set>

#include "libcore/base/error.h"
#include "libcore/base/rng.h"
#include "tests/cache/example_subspaces.h"
#include "tests/cache/file_test.h"

namespace lacuna::test {
namespace {

class SubspaceFiles : public CacheFileTest {
  protected:
    void expectRefused(const std::string& what, const CacheStamp& expected = kStamp) const {
        expectRefusal(what, "train again",
                      [&] { readSubspaceFile(path(), expected, "train again"); });
    }
};

TEST_F(SubspaceFiles, comeBack) {
    const SubspaceFile written = example(5, 3);
    writeSubspaceFile(path(), written);
    const SubspaceFile read = readSubspaceFile(path(), kStamp, "train again");
    EXPECT_EQ(read.subspaces.contentHash(), written.subspaces.contentHash());
    EXPECT_EQ(read.contentHash, written.contentHash);
    EXPECT_EQ(read.stamp, written.stamp);
    EXPECT_EQ(read.subspaces.q, written.subspaces.q);
    EXPECT_EQ(read.subspaces.population, written.subspaces.population);
    EXPECT_EQ(read.subspaces.cells.count(), 3u);
    EXPECT_NE(example(5, 4).contentHash, written.contentHash);
}

TEST_F(SubspaceFiles, damagedOnesAreRefused) {
    writeSubspaceFile(path(), example(5, 3));
    const std::string good = content();
    Rng rng(5, 0, StreamKind::User, 0);
    for (int n = 0; n < 200; ++n) {
        std::string bad = good;
        // Every byte of the header, and others.
        const std::uint32_t at = n < 64 ? std::uint32_t(n) : rng.below(std::uint32_t(bad.size()));
        bad[at] = char(bad[at] ^ (1 << rng.below(8)));
        replace(bad);
        expectRefused("a flipped bit");
        replace(good.substr(0, rng.below(std::uint32_t(good.size()))));
        expectRefused("a truncated file");
    }
    replace(good + std::string(8, '\0'));
    expectRefused("a longer file");
    replace(good);
    readSubspaceFile(path(), kStamp, "train again");
    std::filesystem::remove(path());
    expectRefused("no file");
}

/// The message says what differs.
TEST_F(SubspaceFiles, foreignOnesAreRefused) {
    writeSubspaceFile(path(), example(5, 3));
    CacheStamp other = kStamp;
    other.inputs["scene"] = "456def";
    expectRefused("another scene's", other);
    other = kStamp;
    other.inputs["camera"] = "2 Hall";
    try {
        readSubspaceFile(path(), other, "train again");
        ADD_FAILURE();
    } catch (const InputError& e) {
        EXPECT_NE(std::string(e.what()).find("camera (there '1 Cam', here '2 Hall')"),
                  std::string::npos)
            << e.what();
        EXPECT_EQ(std::string(e.what()).find("paths"), std::string::npos) << e.what();
    }
    // A tool that is given a file may leave inputs open.
    EXPECT_EQ(readSubspaceFile(path(), {{{"scene", "0123abc"}}}, "").stamp, kStamp);
}

/// A good checksum over numbers that do not fit together.
TEST_F(SubspaceFiles, wrongOnesAreRefused) {
    const auto refused = [&](const std::string& what, const auto& spoil) {
        SubspaceFile file = example(5, 3);
        spoil(file.subspaces);
        writeSubspaceFile(path(), file);
        expectRefused(what);
    };
    refused("a column that does not sum to one", [](Subspaces& s) { s.gamma[2] = 0.9f; });
    refused("a negative Gamma", [](Subspaces& s) { s.gamma[0] = -0.2f, s.gamma[1] = 0.6f; });
    refused("a Gamma of another size", [](Subspaces& s) { s.gamma.pop_back(); });
    refused("Q that is not a number", [](Subspaces& s) { s.q[1] = std::nan(""); });
    refused("no Q", [](Subspaces& s) { s.q.clear(), s.population.clear(); });
    refused("too few populations", [](Subspaces& s) { s.population.pop_back(); });
    refused("labels out of range", [](Subspaces& s) {
        s.eyeTree = DecisionTree({{0.0f, 9u << 4 | DecisionTree::kLeaf}}, 10);
    });
    refused("cells out of range", [](Subspaces& s) { s.cells = LightCells({{7, 1, 1}}); });
}

}  // namespace
}  // namespace lacuna::test
