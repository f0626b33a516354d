// Every file of corpus/: what the fuzzer found, and odd files on purpose.
#include <algorithm>

#include "tests/gltf/everything.h"

namespace lacuna::test {
namespace {

namespace fs = std::filesystem;

TEST(Corpus, EveryFileBuildsOrIsRefused) {
    const TempDir dir;
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(LACUNA_GLTF_CORPUS)) {
        files.push_back(entry.path());
    }
    std::sort(files.begin(), files.end());
    ASSERT_FALSE(files.empty());
    for (const fs::path& file : files) {
        SCOPED_TRACE(file.filename());
        std::ifstream stream(file, std::ios::binary);
        const ByteVector bytes{std::istreambuf_iterator<char>(stream), {}};
        const bool accepted = buildsOrIsRefused(dir, bytes);
        // `odd-` files have to load; the others may do either, but properly.
        EXPECT_TRUE(accepted || !file.filename().string().starts_with("odd-"));
    }
}

}  // namespace
}  // namespace lacuna::test
