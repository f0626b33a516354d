// Every parser reads the files that the fuzzer starts from, the same with damage at random, and what the fuzzer found
// (corpus/). The fuzzer itself runs by hand or at night.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <vector>

#include "libcore/base/rng.h"
#include "tests/fuzz/parsers.h"
#include "tests/fuzz/seeds.h"
#include "tests/gltf/gltf_builder.h"

namespace lacuna::test {
namespace {

namespace fs = std::filesystem;

struct File {
    std::string name;
    std::vector<std::uint8_t> bytes;
};

/// In the order of their names; none where there is no such folder.
std::vector<File> filesIn(const fs::path& folder) {
    std::vector<File> files;
    std::error_code none;
    for (const auto& entry : fs::directory_iterator(folder, none)) {
        std::ifstream stream(entry.path(), std::ios::binary);
        const std::vector<char> content{std::istreambuf_iterator<char>(stream), {}};
        files.push_back({entry.path().filename(), {content.begin(), content.end()}});
    }
    std::ranges::sort(files, {}, &File::name);
    return files;
}

struct Seeds {
    Seeds() { writeSeeds(folder / ""); }
    TempDir folder;
};

class Fuzz : public testing::TestWithParam<Parser> {
  protected:
    static std::vector<File> seeds() {
        static const Seeds written;
        return filesIn(written.folder / std::string(GetParam().name));
    }
    static bool accepts(const File& file) {
        SCOPED_TRACE(file.name);
        bool accepted = false;
        EXPECT_NO_THROW(accepted = GetParam().accepts(file.bytes));
        return accepted;
    }
};

TEST_P(Fuzz, SeedsAreAccepted) {
    const std::vector<File> files = seeds();
    EXPECT_FALSE(files.empty());
    for (const File& file : files) EXPECT_TRUE(accepts(file)) << file.name;
}

TEST_P(Fuzz, CorpusIsReadOrRefused) {
    for (const File& file : filesIn(fs::path(LACUNA_CORPUS) / GetParam().name)) {
        // `odd-` files have to be accepted; the others may go either way, but properly.
        EXPECT_TRUE(accepts(file) || !file.name.starts_with("odd-")) << file.name;
    }
}

TEST_P(Fuzz, DamageIsReadOrRefused) {
    Rng rng(33, 0, StreamKind::User, 0);
    for (const File& seed : seeds()) {
        for (int i = 0; i < 200 && !HasFailure(); ++i) {
            File damaged = seed;
            damaged.name += ", damage " + std::to_string(i);
            for (std::uint32_t n = 1 + rng.below(4); n > 0 && !damaged.bytes.empty(); --n) {
                const auto at = rng.below(std::uint32_t(damaged.bytes.size()));
                switch (rng.below(3)) {
                    case 0:
                        damaged.bytes[at] ^= std::uint8_t(1u << rng.below(8));
                        break;
                    case 1:
                        damaged.bytes[at] = std::uint8_t(rng.below(256));
                        break;
                    default:
                        damaged.bytes.resize(at);
                }
            }
            accepts(damaged);
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Of, Fuzz, testing::ValuesIn(parsers().begin(), parsers().end()),
                         [](const auto& parser) { return std::string(parser.param.name); });

}  // namespace
}  // namespace lacuna::test
