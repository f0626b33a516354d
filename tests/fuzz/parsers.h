// One function for each parser of foreign bytes, for the fuzzer and for the files of corpus/.
#pragma once

#include <cstdint>
#include <ostream>
#include <span>
#include <string_view>

namespace lacuna::test {

using Bytes = std::span<const std::uint8_t>;

/// Reads `bytes` like the tools and returns whether they were accepted. A refusal is a proper
/// InputError or UsageError (attempt.h). Any other exception, crash or hang is a finding.
struct Parser {
    std::string_view name;
    bool (*accepts)(Bytes bytes);

    friend std::ostream& operator<<(std::ostream& out, const Parser& parser) {
        return out << parser.name;
    }
};

/// All parsers. Checksums are corrected before content is read: they detect accidents, not malice,
/// and would keep the fuzzer out.
std::span<const Parser> parsers();

bool acceptsScene(Bytes bytes);  ///< .glb or .gltf, and the scene built from it
bool acceptsDraco(Bytes bytes);  ///< a mesh's stream
bool acceptsMeshopt(
    Bytes bytes);  ///< mode and filter, half the stride, a third of the count; then the stream
bool acceptsWebp(Bytes bytes);       ///< a texture
bool acceptsJpeg(Bytes bytes);       ///< a texture
bool acceptsExr(Bytes bytes);        ///< a reference, and a part or checkpoint
bool acceptsHdr(Bytes bytes);        ///< an environment
bool acceptsPfm(Bytes bytes);        ///< a reference
bool acceptsPng(Bytes bytes);        ///< a texture, and a picture to compare
bool acceptsSubspaces(Bytes bytes);  ///< the sections of KEY.subspaces
bool acceptsEmission(Bytes bytes);   ///< the sections of KEY.emission
bool acceptsWalks(Bytes bytes);      ///< the sections of KEY.walks
bool acceptsGuarded(Bytes bytes);    ///< a .vdb and its sidecar, which must reject foreign bytes
bool acceptsSkeleton(Bytes bytes);   ///< the metadata of KEY.skeleton.vdb; OpenVDB's own are valid
bool acceptsVoxels(Bytes bytes);     ///< the metadata of KEY.voxels.vdb
bool acceptsPart(Bytes bytes);       ///< the attributes of a part; its hash is correct
bool acceptsStudy(Bytes bytes);      ///< a study's .json
bool acceptsCurve(Bytes bytes);      ///< a file of --log
bool acceptsArguments(Bytes bytes);  ///< lacuna-render's, one per line, and the method's settings
bool acceptsExpressions(Bytes bytes);  ///< light path expressions, one per line, and their automata

}  // namespace lacuna::test
