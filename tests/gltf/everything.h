// Checks of files that may be damaged, for the tests and the fuzzer.
#pragma once

#include "tests/gltf/gltf_builder.h"

namespace lacuna::test {

/// A scene that uses every feature of the reader.
GltfBuilder everything();

/// Loads `bytes` as `scene.glb` in `dir`; true if they are accepted. Fails the test unless they are refused properly or
/// give a valid description.
bool loadsOrIsRefused(const TempDir& dir, const ByteVector& bytes);

/// The same, and then builds the scene for ray tracing, like lacuna-render.
bool buildsOrIsRefused(const TempDir& dir, const ByteVector& bytes);

}  // namespace lacuna::test
