// glTF's component types as C++ types.
#pragma once

#include <tiny_gltf.h>

#include <cstddef>
#include <cstdint>

namespace lacuna::gltf {

/// Calls body(T{}) with the C++ type of a glTF component type. Returns false for a type that glTF
/// does not have (tinygltf lets INT and DOUBLE pass).
template <class Body>
bool withComponentType(int componentType, Body&& body) {
    switch (componentType) {
        case TINYGLTF_COMPONENT_TYPE_BYTE:
            return body(std::int8_t{}), true;
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
            return body(std::uint8_t{}), true;
        case TINYGLTF_COMPONENT_TYPE_SHORT:
            return body(std::int16_t{}), true;
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
            return body(std::uint16_t{}), true;
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
            return body(std::uint32_t{}), true;
        case TINYGLTF_COMPONENT_TYPE_FLOAT:
            return body(float{}), true;
        default:
            return false;
    }
}

/// Bytes of one number; 0 for a type that glTF does not have.
inline std::size_t componentSize(int componentType) {
    std::size_t size = 0;
    withComponentType(componentType, [&](auto zero) { size = sizeof zero; });
    return size;
}

/// Whether vertex indices may have that type.
inline bool isIndexType(int componentType) {
    return componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE ||
           componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ||
           componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
}

}  // namespace lacuna::gltf
