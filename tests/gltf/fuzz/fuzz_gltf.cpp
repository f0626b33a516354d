// libFuzzer target: bytes as a scene file (.glb or .gltf: the reader goes by the first bytes, not
// by the name), loaded and built as lacuna-render does. Whatever is neither a sound scene nor a
// proper InputError is a finding. tests/README.md says how to run it.
#include <tbb/global_control.h>

#include <cstdlib>

#include "tests/gltf/everything.h"

using namespace lacuna::test;

namespace {

/// The scene's folder, with files that a scene can name.
TempDir& folder() {
    static TempDir dir;
    static const bool filled = [] {
        dir.write("a.bin", ByteVector(256, 1));
        dir.write("a.png", png(2, 2, ByteVector(16, 99)));
        const std::string sky = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n";
        dir.write("a.hdr", sky + std::string(8, char(128)));
        return true;
    }();
    static_cast<void>(filled);
    return dir;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    // One input at a time and one thread: the order of events does not depend on the machine.
    static const tbb::global_control oneThread(tbb::global_control::max_allowed_parallelism, 1);
    buildsOrIsRefused(folder(), ByteVector(data, data + size));
    if (testing::Test::HasFailure()) std::abort();  // what failed is on stdout
    return 0;
}
