#include "libcore/gltf/accessor.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <type_traits>

#include "libcore/gltf/component_type.h"

namespace lacuna::gltf {
namespace {

std::string placeOf(int index) {
    return "accessors[" + std::to_string(index) + "]";
}

template <class T>
T loadAs(const std::uint8_t* bytes) {
    T value;  // files do not guarantee alignment
    std::memcpy(&value, bytes, sizeof value);
    return value;
}

/// glTF 2.0, 3.6.2.3 (normalised integers).
template <class T>
float toFloat(T value, bool normalized) {
    if constexpr (std::is_floating_point_v<T>) {
        return value;
    } else {
        if (!normalized) return float(value);
        constexpr double kScale = 1.0 / double(std::numeric_limits<T>::max());
        return float(std::max(double(value) * kScale, -1.0));
    }
}

template <class T>
void convert(const std::uint8_t* from, int components, bool normalized, float* to) {
    for (int c = 0; c < components; ++c) {
        to[c] = toFloat(loadAs<T>(from + std::size_t(c) * sizeof(T)), normalized);
    }
}

/// Throws unless `count` elements of `elementSize` bytes, `stride` apart, fit `available` bytes
/// from `offset` on. No product is computed before it is known not to overflow.
void checkRange(const Document& document, const std::string& place, std::size_t offset,
                std::size_t count, std::size_t stride, std::size_t elementSize,
                std::size_t available) {
    const bool fits = offset <= available && elementSize <= available - offset &&
                      count - 1 <= (available - offset - elementSize) / stride;
    if (!fits) {
        refuse(document.file, place,
               "elements within the " + std::to_string(available) + " bytes of the buffer view",
               std::to_string(count) + " elements of " + std::to_string(elementSize) + " bytes, " +
                   std::to_string(stride) + " apart, at " + std::to_string(offset));
    }
}

void viewSparse(const Document& document, const tinygltf::Accessor& accessor, int index,
                std::size_t elementSize, AccessorView& view) {
    const auto& sparse = accessor.sparse;
    const std::string place = placeOf(index) + ".sparse";
    if (sparse.count < 1 || std::size_t(sparse.count) > accessor.count) {
        refuse(document.file, place + ".count", "1 to " + std::to_string(accessor.count),
               std::to_string(sparse.count));
    }
    const std::size_t count = std::size_t(sparse.count);
    const int type = sparse.indices.componentType;
    if (!isIndexType(type)) {
        refuse(document.file, place + ".indices.componentType", "5121, 5123 or 5125",
               std::to_string(type));
    }
    const auto indices = document.view(sparse.indices.bufferView);
    const auto values = document.view(sparse.values.bufferView);
    const std::size_t indexOffset = std::size_t(sparse.indices.byteOffset);
    const std::size_t valueOffset = std::size_t(sparse.values.byteOffset);
    const std::size_t indexSize = componentSize(type);
    checkRange(document, place + ".indices", indexOffset, count, indexSize, indexSize,
               indices.size());
    checkRange(document, place + ".values", valueOffset, count, elementSize, elementSize,
               values.size());

    view.sparse.values = values.data() + valueOffset;
    view.sparse.indices.resize(count);
    withComponentType(type, [&](auto zero) {
        using T = decltype(zero);
        for (std::size_t i = 0; i < count; ++i) {
            view.sparse.indices[i] =
                std::uint32_t(loadAs<T>(indices.data() + indexOffset + i * sizeof(T)));
        }
    });
    for (const std::uint32_t i : view.sparse.indices) {
        if (i >= accessor.count) {
            refuse(document.file, place + ".indices",
                   "indices below " + std::to_string(accessor.count), std::to_string(i));
        }
    }
}

}  // namespace

AccessorView viewAccessor(const Document& document, int index, int components) {
    const tinygltf::Accessor& accessor = document.model.accessors[std::size_t(index)];
    const std::string place = placeOf(index);
    AccessorView view;
    view.count = accessor.count;
    view.componentType = accessor.componentType;
    view.normalized = accessor.normalized;
    view.components = tinygltf::GetNumComponentsInType(std::uint32_t(accessor.type));
    const bool isMatrix =
        accessor.type >= TINYGLTF_TYPE_MAT2 && accessor.type <= TINYGLTF_TYPE_MAT4;
    constexpr int kMatrix = 16;  // 4 x 4: smaller matrices have gaps between columns
    if (view.components != components || isMatrix != (components == kMatrix)) {
        const std::string type = components == 1         ? "SCALAR"
                                 : components == kMatrix ? "MAT4"
                                                         : "VEC" + std::to_string(components);
        refuse(document.file, place + ".type", type, "another one");
    }
    const std::size_t size = componentSize(accessor.componentType);
    if (size == 0) {
        refuse(document.file, place + ".componentType", "5120 to 5123, 5125 or 5126",
               std::to_string(accessor.componentType));
    }
    if (accessor.count < 1 || accessor.count > std::numeric_limits<std::uint32_t>::max()) {
        refuse(document.file, place + ".count", "1 to 4294967295", std::to_string(accessor.count));
    }
    const std::size_t elementSize = size * std::size_t(components);
    if (accessor.bufferView >= 0) {
        const auto bytes = document.view(accessor.bufferView);
        view.stride = document.model.bufferViews[std::size_t(accessor.bufferView)].byteStride;
        if (view.stride == 0) view.stride = elementSize;
        if (view.stride < elementSize) {
            refuse(document.file, place, "a stride of at least " + std::to_string(elementSize),
                   std::to_string(view.stride));
        }
        checkRange(document, place, accessor.byteOffset, accessor.count, view.stride, elementSize,
                   bytes.size());
        view.base = bytes.data() + accessor.byteOffset;
    }
    if (accessor.sparse.isSparse) viewSparse(document, accessor, index, elementSize, view);
    return view;
}

std::vector<float> readFloats(const AccessorView& view) {
    const std::size_t n = std::size_t(view.components);
    std::vector<float> result(view.count * n);
    withComponentType(view.componentType, [&](auto zero) {
        using T = decltype(zero);
        if (view.base) {
            for (std::size_t i = 0; i < view.count; ++i) {
                convert<T>(view.base + i * view.stride, view.components, view.normalized,
                           &result[i * n]);
            }
        }
        for (std::size_t i = 0; i < view.sparse.indices.size(); ++i) {
            convert<T>(view.sparse.values + i * n * sizeof(T), view.components, view.normalized,
                       &result[view.sparse.indices[i] * n]);
        }
    });
    return result;
}

std::vector<float> readFloats(const AccessorView& view, std::span<const std::uint32_t> which) {
    const std::size_t n = std::size_t(view.components);
    std::vector<float> result(which.size() * n);
    withComponentType(view.componentType, [&](auto zero) {
        using T = decltype(zero);
        if (view.base) {
            for (std::size_t i = 0; i < which.size(); ++i) {
                convert<T>(view.base + which[i] * view.stride, view.components, view.normalized,
                           &result[i * n]);
            }
        }
        for (std::size_t i = 0; i < view.sparse.indices.size(); ++i) {
            const std::uint32_t element = view.sparse.indices[i];
            const auto at = std::lower_bound(which.begin(), which.end(), element);
            if (at == which.end() || *at != element) continue;
            convert<T>(view.sparse.values + i * n * sizeof(T), view.components, view.normalized,
                       &result[std::size_t(at - which.begin()) * n]);
        }
    });
    return result;
}

std::vector<std::uint32_t> readIndices(const Document& document, int index) {
    const AccessorView view = viewAccessor(document, index, 1);
    if (!isIndexType(view.componentType) || view.normalized) {
        refuse(document.file, placeOf(index), "plain unsigned integers as vertex indices",
               "component type " + std::to_string(view.componentType) +
                   (view.normalized ? ", normalised" : ""));
    }
    std::vector<std::uint32_t> result(view.count);
    withComponentType(view.componentType, [&](auto zero) {
        using T = decltype(zero);
        if (view.base) {
            for (std::size_t i = 0; i < view.count; ++i) {
                result[i] = std::uint32_t(loadAs<T>(view.base + i * view.stride));
            }
        }
        for (std::size_t i = 0; i < view.sparse.indices.size(); ++i) {
            result[view.sparse.indices[i]] =
                std::uint32_t(loadAs<T>(view.sparse.values + i * sizeof(T)));
        }
    });
    return result;
}

}  // namespace lacuna::gltf
