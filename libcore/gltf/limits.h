// Upper bounds on the memory that a file may make the reader allocate. A small file can ask for a
// lot (accessors without data, pictures of one colour, one mesh under many nodes), so that sums are
// bounded, not only single sizes. All bounds are far beyond what scenes need.
#pragma once

#include <cstddef>
#include <cstdint>

namespace lacuna::gltf {

struct Limits {
    /// Lengths in a GLB have 32 bits, and tinygltf takes the text's length as unsigned.
    static constexpr std::uint64_t kFileBytes = 0xFFFFFFFFu;
    static constexpr std::uint64_t kJsonBytes = 1ull << 30;
    static constexpr std::uint64_t kTotalBytes = 1ull << 34;  ///< scene file and all external files
    static constexpr int kJsonDepth = 64;                     ///< glTF itself needs about 8
    static constexpr std::size_t kZeroElements = 1u << 24;    ///< total without a buffer view
    static constexpr std::size_t kTriangles = 1u << 28;       ///< before instancing
    static constexpr std::size_t kInstances = 1u << 25;
    static constexpr int kImageSide = 1 << 16;
    static constexpr std::uint64_t kImageTexels = 1ull << 28;
    static constexpr std::uint64_t kTotalTexels = 1ull << 30;
    static constexpr std::size_t kJpegScans = 64;        ///< encoders make about 10
    static constexpr std::size_t kDracoAttributes = 16;  ///< of one stream
};

}  // namespace lacuna::gltf
