// Reads a glTF 2.0 file (.glb, or .gltf with external files and data URIs) into a SceneDescription.
//
// No byte of the file is trusted: sizes, indices, offsets, types and numbers are checked before
// they are used. Anything that cannot be used causes an InputError that says what was expected.
// tinygltf turns the structural JSON into structs; it sees neither payload bytes nor URIs
// (document.h).
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "libcore/scene/description.h"

namespace lacuna {

/// The default scene (the file's `scene`, else 0) of the glTF file `path`.
///
/// Features of the file that are not rendered are left out with one warning per kind (`warnings`:
/// plain sentences without the file's name). `cameras` may be empty: see requireCamera.
/// `phaseSeconds` has "parse", "decode" and "meshes". Meshes and images are read with
/// tbb::parallel_for, in the caller's arena; the result does not depend on the number of threads.
///
/// `units`: the units of the file's punctual lights.
///
/// Throws InputError: `path: expected ..., found ...; what to do`, one line.
SceneDescription loadGltf(const std::string& path, LampUnits units = LampUnits::Radiometric);
/// The same for a .glb in memory, which messages call `name`.
SceneDescription loadGltf(const std::string& name, std::span<const std::uint8_t> glb,
                          LampUnits units = LampUnits::Radiometric);

/// Throws InputError if the scene has no perspective camera to render from.
void requireCamera(const SceneDescription& scene);

}  // namespace lacuna
