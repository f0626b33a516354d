// Reader of accessors: every component type, normalised or not, any stride, sparse with and without
// a base. Every result of arithmetic on the file's numbers is checked before it is used.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "libcore/base/vec.h"
#include "libcore/gltf/document.h"

namespace lacuna::gltf {

/// An accessor whose ranges have been checked: element i < count is `components` values of
/// `componentType` at base + i * stride (zeros where base is null), then overwritten by `sparse`.
struct AccessorView {
    std::size_t count = 0;
    int components = 0;
    int componentType = 0;
    bool normalized = false;
    const std::uint8_t* base = nullptr;
    std::size_t stride = 0;

    struct Sparse {
        std::vector<std::uint32_t> indices;  ///< each below `count`
        const std::uint8_t* values = nullptr;
    } sparse;
};

/// Checks accessor `index` (which must be in range) and locates its elements; 16 components are a matrix. Throws
/// InputError if it does not have `components` components, is empty, or any of its bytes lies outside its view. An
/// accessor without a view has no bytes: the caller must bound its size.
AccessorView viewAccessor(const Document& document, int index, int components);

/// The elements as floats, `components` per element. Normalised integers are mapped to [0, 1] or
/// [-1, 1], others keep their value. Returns all elements, or only those in `which` (ascending,
/// unique, below count).
std::vector<float> readFloats(const AccessorView& view);
std::vector<float> readFloats(const AccessorView& view, std::span<const std::uint32_t> which);

/// Accessor `index` as vertex indices: SCALAR of unsigned integers, not normalised. Throws
/// InputError.
std::vector<std::uint32_t> readIndices(const Document& document, int index);

}  // namespace lacuna::gltf
