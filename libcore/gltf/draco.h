// KHR_draco_mesh_compression: primitives whose triangles and vertices are in a Draco stream.
#pragma once

#include "libcore/gltf/document.h"

namespace lacuna::gltf {

/// Decodes every packed primitive of `document.json` into a buffer of its own and replaces it by a plain one of
/// triangles. The buffers must be loaded and the buffer views plain. Warns of streams that hold less than their
/// accessors say; encoders that drop flat triangles write such streams. Throws InputError for streams that are damaged
/// or of another version than 2.2, lack an attribute, or hold more than their accessors say.
void unpackDraco(Document& document, Warnings& warnings);

}  // namespace lacuna::gltf
