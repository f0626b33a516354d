// KHR_draco_mesh_compression: primitives whose triangles and vertices lie in a Draco stream.
#pragma once

#include "libcore/gltf/document.h"

namespace lacuna::gltf {

/// Decodes every packed primitive of `document.json` into a buffer of its own, and makes it a plain one
/// of triangles with accessors in that. Wants the buffers loaded and the buffer views plain. Warns of
/// streams that hold less than their accessors say, as encoders leave them that drop flat triangles.
/// Throws InputError for streams that are damaged or of another version than 2.2, lack an attribute, or
/// hold more than their accessors say.
void unpackDraco(Document& document, Warnings& warnings);

}  // namespace lacuna::gltf
