// Everything that reads bytes which others may have made, one function each: for the fuzzer and for the
// files of corpus/.
#pragma once

#include <cstdint>
#include <ostream>
#include <span>
#include <string_view>

namespace lacuna::test {

using Bytes = std::span<const std::uint8_t>;

/// Reads `bytes` as the tools would, and returns whether they were accepted. Refused is what
/// throws a proper InputError or UsageError (attempt.h); whatever else is thrown, and any crash or
/// hang, is a finding.
struct Parser {
    std::string_view name;
    bool (*accepts)(Bytes bytes);

    friend std::ostream& operator<<(std::ostream& out, const Parser& parser) {
        return out << parser.name;
    }
};

/// All of them. Checksums are made right before checksummed content is read: a checksum finds
/// accidents, not malice, and would keep the fuzzer out.
std::span<const Parser> parsers();

bool acceptsScene(Bytes bytes);  ///< .glb or .gltf, and the scene that is built of it
bool acceptsDraco(Bytes bytes);  ///< a mesh's stream
bool acceptsMeshopt(
    Bytes bytes);  ///< mode and filter, half the stride, a third of the count; the stream
bool acceptsWebp(Bytes bytes);       ///< a texture
bool acceptsExr(Bytes bytes);        ///< a reference, and a part or checkpoint
bool acceptsHdr(Bytes bytes);        ///< an environment
bool acceptsPfm(Bytes bytes);        ///< a reference
bool acceptsPng(Bytes bytes);        ///< a texture, and a picture to compare
bool acceptsSubspaces(Bytes bytes);  ///< the sections of KEY.subspaces
bool acceptsEmission(Bytes bytes);   ///< the sections of KEY.emission
bool acceptsWalks(Bytes bytes);      ///< the sections of KEY.walks
bool acceptsGuarded(Bytes bytes);    ///< a .vdb and its sidecar: nothing foreign may come through
bool acceptsSkeleton(Bytes bytes);  ///< the metadata of KEY.skeleton.vdb, OpenVDB's own being sound
bool acceptsVoxels(Bytes bytes);    ///< the metadata of KEY.voxels.vdb
bool acceptsPart(Bytes bytes);      ///< the attributes of a part; its hash is right
bool acceptsStudy(Bytes bytes);     ///< a study's .json
bool acceptsCurve(Bytes bytes);     ///< what --log wrote
bool acceptsArguments(Bytes bytes);    ///< lacuna-render's, one per line, and the method's settings
bool acceptsExpressions(Bytes bytes);  ///< of light paths, one per line, and the automata of them

}  // namespace lacuna::test
