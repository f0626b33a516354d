// What is done with files that may be damaged, by the tests as by the fuzzer.
#pragma once

#include "tests/gltf/gltf_builder.h"

namespace lacuna::test {

/// A scene that uses everything the reader knows.
GltfBuilder everything();

/// Loads `bytes`, as if they were `scene.glb` in `dir`; true if they were accepted. Fails the test unless they
/// were refused properly or gave a valid description.
bool loadsOrIsRefused(const TempDir& dir, const ByteVector& bytes);

/// The same, and then builds the scene that rays are traced in, as lacuna-render does.
bool buildsOrIsRefused(const TempDir& dir, const ByteVector& bytes);

}  // namespace lacuna::test
