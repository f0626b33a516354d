// Packed parts of a scene that is otherwise sound, so that the fuzzer need not find the way to them.
#include "tests/fuzz/parsers.h"
#include "tests/gltf/everything.h"
#include "tests/gltf/packed.h"

namespace lacuna::test {
namespace {

bool accepts(const GltfBuilder& builder) {
    static const TempDir folder;
    return loadsOrIsRefused(folder, builder.glb());
}

bool acceptsTexture(Bytes bytes) {
    TriangleBuilder b;
    const int texture = b.texture({bytes.begin(), bytes.end()});
    b.add("materials", {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", texture}}}}}});
    b.primitive()["material"] = 0;
    return accepts(b);
}

}  // namespace

bool acceptsDraco(Bytes bytes) {
    static const GridBuilder packed = [] {
        GridBuilder grid(2);
        packByDraco(grid);
        for (json& accessor : grid.root["accessors"]) accessor["count"] = 999;
        return grid;
    }();
    GridBuilder grid = packed;
    const int view = grid.view({bytes.begin(), bytes.end()});
    grid.primitive()["extensions"]["KHR_draco_mesh_compression"]["bufferView"] = view;
    return accepts(grid);
}

bool acceptsMeshopt(Bytes bytes) {
    constexpr const char* kModes[] = {"ATTRIBUTES", "TRIANGLES", "INDICES"};
    constexpr const char* kFilters[] = {"NONE", "OCTAHEDRAL", "QUATERNION", "EXPONENTIAL"};
    if (bytes.size() < 3) return false;
    TriangleBuilder b;
    const int view = b.view({bytes.begin() + 3, bytes.end()});
    json& element = b.root["bufferViews"][std::size_t(view)];
    json extension = element;
    extension["mode"] = kModes[bytes[0] % 3];
    extension["filter"] = kFilters[bytes[0] / 3 % 4];
    extension["byteStride"] = 2 * bytes[1];
    extension["count"] = 3 * bytes[2];
    element["extensions"]["EXT_meshopt_compression"] = extension;
    return accepts(b);
}

bool acceptsWebp(Bytes bytes) {
    return acceptsTexture(bytes);
}

bool acceptsJpeg(Bytes bytes) {
    return acceptsTexture(bytes);
}

}  // namespace lacuna::test
