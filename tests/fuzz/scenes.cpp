#include "tests/fuzz/parsers.h"
#include "tests/gltf/everything.h"

namespace lacuna::test {

bool acceptsScene(Bytes bytes) {
    // The scene's folder, with files that a scene can name.
    static const TempDir folder;
    [[maybe_unused]] static const bool filled = [] {
        folder.write("a.bin", ByteVector(256, 1));
        folder.write("a.png", png(2, 2, ByteVector(16, 99)));
        const std::string sky = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n";
        folder.write("a.hdr", sky + std::string(8, char(128)));
        return true;
    }();
    return buildsOrIsRefused(folder, ByteVector(bytes.begin(), bytes.end()));
}

}  // namespace lacuna::test
