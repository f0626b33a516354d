// Packs what a builder has made, by the libraries' own encoders.
#pragma once

#include <array>
#include <vector>

#include "tests/gltf/gltf_builder.h"

namespace lacuna::test {

/// WebP of `width` x `height` RGBA texels, without loss.
ByteVector webp(int width, int height, const ByteVector& rgba);

struct DracoCoding {
    bool edgebreaker = true;  ///< which reorders triangles and vertices; else sequential
    int positionBits = 0;     ///< 0: floats as they are
    bool metadata = false;
    bool smallest = false;  ///< with texture coordinates of 12 bits, predicted from positions
};

/// Puts the triangles and all attributes of a mesh's first primitive into a Draco stream, and takes the
/// plain bytes from its accessors, which must be packed tightly. Returns the stream's buffer view.
int packByDraco(GltfBuilder& builder, int mesh = 0, DracoCoding coding = {});

/// The stream alone.
ByteVector dracoStream(const GltfBuilder& builder, int mesh = 0, DracoCoding coding = {});

/// A buffer view of `count` elements of `stride` bytes, packed in a mode of EXT_meshopt_compression;
/// `plain` is what the codec gets. Call declareFallback() when all is added.
int meshoptView(GltfBuilder& builder, const ByteVector& plain, std::size_t count,
                std::size_t stride, const char* mode, const char* filter = "NONE");

/// Packs the buffer view of an accessor that is packed tightly: indices as triangles where they are a
/// multiple of three, all else as attributes at a stride that 4 divides.
void packByMeshopt(GltfBuilder& builder, int accessor);

/// Declares the builder's buffers: its own, and one that need not exist for what meshopt unpacks.
void declareFallback(GltfBuilder& builder);

/// A mesh of a bent grid with all attributes that a mesh can have: positions as floats, the others as
/// integers, or all of them as floats.
struct GridBuilder : GltfBuilder {
    explicit GridBuilder(int side, bool allFloats = false);
    json& primitive() { return root["meshes"][0]["primitives"][0]; }
    int accessorOf(const char* attribute) { return primitive()["attributes"][attribute]; }
    int indices() { return primitive()["indices"]; }
};

/// Expects the two scenes to have the same triangles with the same attributes, within `tolerance`, in
/// any order.
void expectSameTriangles(const SceneDescription& a, const SceneDescription& b, float tolerance);

}  // namespace lacuna::test
