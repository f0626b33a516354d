// Compresses the content of a builder with the libraries' own encoders.
#pragma once

#include <array>
#include <vector>

#include "tests/gltf/gltf_builder.h"

namespace lacuna::test {

/// A lossless WebP of `width` x `height` RGBA texels.
ByteVector webp(int width, int height, const ByteVector& rgba);

struct DracoCoding {
    bool edgebreaker = true;  ///< reorders triangles and vertices; else sequential
    int positionBits = 0;     ///< 0: unquantised floats
    bool metadata = false;
    bool smallest = false;  ///< with texture coordinates of 12 bits, predicted from positions
};

/// Compresses the triangles and all attributes of a mesh's first primitive to a Draco stream. Its accessors, which must
/// be tightly packed, lose their plain bytes. Returns the stream's buffer view.
int packByDraco(GltfBuilder& builder, int mesh = 0, DracoCoding coding = {});

/// The stream alone.
ByteVector dracoStream(const GltfBuilder& builder, int mesh = 0, DracoCoding coding = {});

/// Adds a buffer view of `count` elements of `stride` bytes, compressed in a mode of
/// EXT_meshopt_compression. `plain`: the codec's input. Call declareFallback() at the end.
int meshoptView(GltfBuilder& builder, const ByteVector& plain, std::size_t count,
                std::size_t stride, const char* mode, const char* filter = "NONE");

/// Compresses the buffer view of a tightly packed accessor: indices as triangles if their number is a multiple of
/// three, all else as attributes with a stride that is a multiple of 4.
void packByMeshopt(GltfBuilder& builder, int accessor);

/// Declares the builder's own buffer and the fallback buffer of meshopt, which need not exist.
void declareFallback(GltfBuilder& builder);

/// A mesh of a bent grid with all attributes that a mesh can have. Positions are floats; the others are integers, or
/// all are floats.
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
