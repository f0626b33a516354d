#include "tests/fuzz/parsers.h"

#include <stdexcept>
#include <string>

namespace lacuna::test {

std::span<const Parser> parsers() {
    static constexpr Parser kParsers[] = {
        {"scene", acceptsScene},       {"exr", acceptsExr},
        {"hdr", acceptsHdr},           {"pfm", acceptsPfm},
        {"png", acceptsPng},           {"subspaces", acceptsSubspaces},
        {"emission", acceptsEmission}, {"walks", acceptsWalks},
        {"guarded", acceptsGuarded},   {"skeleton", acceptsSkeleton},
        {"voxels", acceptsVoxels},     {"part", acceptsPart},
        {"study", acceptsStudy},       {"curve", acceptsCurve},
        {"arguments", acceptsArguments},
    };
    return kParsers;
}

const Parser& parserOf(std::string_view name) {
    for (const Parser& parser : parsers()) {
        if (parser.name == name) return parser;
    }
    throw std::out_of_range("no parser '" + std::string(name) + "'");
}

}  // namespace lacuna::test
