#include "tests/fuzz/parsers.h"

namespace lacuna::test {

std::span<const Parser> parsers() {
    static constexpr Parser kParsers[] = {
        {"scene", acceptsScene},
        {"exr", acceptsExr},
        {"hdr", acceptsHdr},
        {"pfm", acceptsPfm},
        {"png", acceptsPng},
        {"subspaces", acceptsSubspaces},
        {"emission", acceptsEmission},
        {"walks", acceptsWalks},
        {"guarded", acceptsGuarded},
        {"skeleton", acceptsSkeleton},
        {"voxels", acceptsVoxels},
        {"part", acceptsPart},
        {"draco", acceptsDraco},
        {"meshopt", acceptsMeshopt},
        {"webp", acceptsWebp},
        {"jpeg", acceptsJpeg},
        {"study", acceptsStudy},
        {"curve", acceptsCurve},
        {"arguments", acceptsArguments},
        {"expressions", acceptsExpressions},
    };
    return kParsers;
}

}  // namespace lacuna::test
