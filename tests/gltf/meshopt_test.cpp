// EXT_meshopt_compression: packed by meshoptimizer's own encoders, held against what was packed.
#include <meshoptimizer.h>

#include "tests/gltf/everything.h"
#include "tests/gltf/packed.h"

namespace lacuna::test {
namespace {

/// A grid whose buffer views are all packed.
GridBuilder packedGrid(int side, bool allFloats = false) {
    GridBuilder b(side, allFloats);
    const std::size_t count = b.root["accessors"].size();
    for (std::size_t i = 0; i < count; ++i) packByMeshopt(b, int(i));
    declareFallback(b);
    return b;
}

json& extensionOf(GltfBuilder& b, int accessor) {
    const json& view = b.root["accessors"][std::size_t(accessor)]["bufferView"];
    return b.root["bufferViews"][view.get<std::size_t>()]["extensions"]["EXT_meshopt_compression"];
}

std::uint8_t& firstByte(GltfBuilder& b, int accessor) {
    return b.binary[extensionOf(b, accessor)["byteOffset"].get<std::size_t>()];
}

TEST(Meshopt, PackedViewsAreTheSame) {
    for (const bool allFloats : {false, true}) {
        const SceneDescription packed = packedGrid(20, allFloats).load();
        expectValid(packed);
        EXPECT_TRUE(packed.warnings.empty()) << packed.warnings.front();
        const SceneDescription plain = GridBuilder(20, allFloats).load();
        expectSameTriangles(plain, packed, 0.0f);
    }
}

TEST(Meshopt, IndexSequencesAreTheSame) {
    GridBuilder b(3);
    const SceneDescription plain = b.load();
    std::vector<std::uint32_t> corners;
    for (const auto& t : plain.meshes[0].triangles)
        corners.insert(corners.end(), t.begin(), t.end());
    for (const std::size_t size : {2, 4}) {
        ByteVector bytes;
        for (const std::uint32_t c : corners) {
            const auto* at = reinterpret_cast<const std::uint8_t*>(&c);
            bytes.insert(bytes.end(), at, at + size);
        }
        GridBuilder packed(3);
        json& accessor = packed.root["accessors"][std::size_t(packed.indices())];
        accessor["bufferView"] = meshoptView(packed, bytes, corners.size(), size, "INDICES");
        accessor["componentType"] = size == 2 ? 5123 : 5125;
        declareFallback(packed);
        expectSameTriangles(plain, packed.load(), 0.0f);
    }
}

TEST(Meshopt, FiltersAreUndone) {
    GridBuilder b(8, true);
    const SceneDescription plain = b.load();
    std::vector<float> normals, positions;
    for (const Vec3 n : plain.meshes[0].normals) normals.insert(normals.end(), {n.x, n.y, n.z, 0});
    for (const Vec3 p : plain.meshes[0].positions)
        positions.insert(positions.end(), {p.x, p.y, p.z});
    const std::size_t count = plain.meshes[0].normals.size();
    const struct {
        std::size_t stride;
        int bits, componentType;
        float tolerance;
    } forms[] = {{4, 8, 5120, 0.02f}, {8, 12, 5122, 0.002f}};
    for (const auto& form : forms) {
        GridBuilder packed = b;
        ByteVector bytes(count * form.stride);
        meshopt_encodeFilterOct(bytes.data(), count, form.stride, form.bits, normals.data());
        json& accessor = packed.root["accessors"][std::size_t(packed.accessorOf("NORMAL"))];
        accessor["bufferView"] =
            meshoptView(packed, bytes, count, form.stride, "ATTRIBUTES", "OCTAHEDRAL");
        accessor["componentType"] = form.componentType;
        accessor["normalized"] = true;
        bytes.resize(count * 12);
        meshopt_encodeFilterExp(bytes.data(), count, 12, 15, positions.data());
        packed.root["accessors"][std::size_t(packed.accessorOf("POSITION"))]["bufferView"] =
            meshoptView(packed, bytes, count, 12, "ATTRIBUTES", "EXPONENTIAL");
        declareFallback(packed);
        expectSameTriangles(plain, packed.load(), form.tolerance);
    }
}

TEST(Meshopt, QuaternionsOfCopiesAreUndone) {
    GridBuilder b(1);
    const std::vector<float> turns = {0, 0, 0, 1, 0.6f, 0, 0, 0.8f, -0.5f, 0.5f, 0.5f, 0.5f};
    ByteVector bytes(3 * 8);
    meshopt_encodeFilterQuat(bytes.data(), 3, 8, 16, turns.data());
    const auto attributes = [&](int accessor) {
        return json({{"EXT_mesh_gpu_instancing", {{"attributes", {{"ROTATION", accessor}}}}}});
    };
    b.root["nodes"][0]["extensions"] = attributes(b.accessor(turns, "VEC4"));
    const SceneDescription plain = b.load();
    const int view = meshoptView(b, bytes, 3, 8, "ATTRIBUTES", "QUATERNION");
    b.root["nodes"][0]["extensions"] = attributes(b.add("accessors", {{"bufferView", view},
                                                                      {"componentType", 5122},
                                                                      {"normalized", true},
                                                                      {"count", 3},
                                                                      {"type", "VEC4"}}));
    declareFallback(b);
    const SceneDescription packed = b.load();
    ASSERT_EQ(packed.instances.size(), 3u);
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t k = 0; k < 3; ++k) {
            EXPECT_NEAR(length(plain.instances[i].toWorld.m[k] - packed.instances[i].toWorld.m[k]),
                        0.0, 1e-3);
        }
    }
}

TEST(Meshopt, DracoInAPackedViewIsUnpackedToo) {
    GridBuilder b(2);
    const SceneDescription plain = b.load();
    const ByteVector stream = dracoStream(b);
    const int view = packByDraco(b);
    ByteVector padded = stream;
    padded.resize((stream.size() + 3) / 4 * 4);
    const int packed = meshoptView(b, padded, padded.size() / 4, 4, "ATTRIBUTES");
    b.root["bufferViews"][std::size_t(view)] = b.root["bufferViews"][std::size_t(packed)];
    declareFallback(b);
    expectSameTriangles(plain, b.load(), 0.0f);
}

TEST(Meshopt, FallbackBuffersAreNeitherReadNorFollowed) {
    GridBuilder b = packedGrid(2);
    b.root["buffers"][1]["uri"] = "there-is-none.bin";
    EXPECT_NO_THROW(b.load());
    b.root["bufferViews"].push_back({{"buffer", 1}, {"byteLength", 4}});
    expectRefused(b, {"a range within the 0 bytes", "4 bytes at 0"});
    b.root["bufferViews"].erase(b.root["bufferViews"].size() - 1);
    b.root["buffers"][1].erase("extensions");
    expectRefused(b, {"there-is-none.bin"});
}

TEST(Meshopt, OtherVersionsAreRefused) {
    GridBuilder b = packedGrid(2);
    const int positions = b.accessorOf("POSITION"), indices = b.indices();
    EXPECT_EQ(firstByte(b, positions), 0xA0);
    firstByte(b, positions) = 0xA1;
    expectRefused(b, {"bufferViews", "version 0 or older", "version 1"});
    firstByte(b, positions) = 0xB0;
    expectRefused(b, {"bufferViews", "meshopt stream", "damaged"});
    firstByte(b, positions) = 0xA0;
    firstByte(b, indices) = 0xE2;
    expectRefused(b, {"bufferViews", "version 1 or older", "version 2"});
}

TEST(Meshopt, ModesFiltersAndShapesAreChecked) {
    GridBuilder b = packedGrid(2);
    const json intact = b.root;
    const int positions = b.accessorOf("POSITION"), normals = b.accessorOf("NORMAL");
    const int indices = b.indices();
    const auto refuses = [&](int accessor, const char* member, const json& value,
                             const std::vector<std::string>& parts) {
        b.root = intact;
        extensionOf(b, accessor)[member] = value;
        SCOPED_TRACE(std::string(member) + value.dump());
        expectRefused(b, parts);
    };
    refuses(positions, "mode", "VERTICES", {".mode", "ATTRIBUTES, TRIANGLES, INDICES", "VERTICES"});
    refuses(positions, "mode", 3, {".mode", "a string"});
    refuses(positions, "filter", "COLOR", {".filter", "EXPONENTIAL", "COLOR"});
    refuses(positions, "filter", "OCTAHEDRAL", {"4 or 8", "12 bytes"});
    refuses(normals, "filter", "QUATERNION", {"byteStride of 8", "4 bytes"});
    for (const int stride : {0, 10, 260}) {
        refuses(positions, "byteStride", stride, {"a byteStride of 4 to 256"});
    }
    refuses(indices, "byteStride", 1, {"a byteStride of 2 or 4"});
    refuses(indices, "count", 23, {"a count that 3 divides"});
    refuses(positions, "count", 0, {"0 elements"});
    refuses(positions, "count", 1000, {"stream of 1000 elements", "damaged"});
    refuses(positions, "count", 8, {"accessors[0]", "9 elements"});
    refuses(positions, "count", 1ull << 50, {"4096 times the file's bytes"});
    refuses(positions, "byteOffset", 1 << 20, {"a range within"});
    refuses(positions, "byteLength", 1 << 20, {"a range within"});
    refuses(positions, "byteLength", 0, {"damaged"});
    refuses(positions, "buffer", 2, {"an index below 2"});
    for (const char* member : {"buffer", "byteLength", "byteStride", "count", "mode"}) {
        b.root = intact;
        extensionOf(b, positions).erase(member);
        expectRefused(b, {member});
    }
}

TEST(Meshopt, DamagedStreamsAreReadOrRefused) {
    const TempDir dir;
    GridBuilder b = packedGrid(2);
    for (std::size_t i = 0; i < b.binary.size(); ++i) {
        for (const std::uint8_t change : {0x01, 0x80, 0xFF}) {
            GridBuilder damaged = b;
            damaged.binary[i] ^= change;
            loadsOrIsRefused(dir, damaged.glb());
        }
    }
    for (int accessor = 0; accessor < int(b.root["accessors"].size()); ++accessor) {
        json& length = extensionOf(b, accessor)["byteLength"];
        const std::size_t whole = length;
        for (std::size_t i = 0; i < whole; ++i) {
            length = i;
            EXPECT_FALSE(loadsOrIsRefused(dir, b.glb()))
                << accessor << ": " << i << " of " << whole;
        }
        length = whole;
    }
}

TEST(Meshopt, ItsSuccessorIsRefusedWithAConverter) {
    TriangleBuilder b;
    b.root["extensionsUsed"] = b.root["extensionsRequired"] = {"KHR_meshopt_compression"};
    expectRefused(b, {"extensionsRequired", "KHR_meshopt_compression", "gltfpack -c -ce ext"});
    b.root.erase("extensionsRequired");
    EXPECT_EQ(warningsWith(b.load(), "KHR_meshopt_compression is not rendered"), 1);
}

}  // namespace
}  // namespace lacuna::test
