// EXT_meshopt_compression: buffer views whose bytes are packed, as gltfpack -c writes them.
#pragma once

#include "libcore/gltf/document.h"

namespace lacuna::gltf {

/// Decodes every packed buffer view of `document.json` into a buffer of its own, and makes the view a
/// plain one of that. Wants the buffers loaded. Throws InputError for streams that are damaged or of a
/// version that we lack, for counts and strides that the codec does not have, and for ranges outside
/// their buffer.
void unpackMeshopt(Document& document);

}  // namespace lacuna::gltf
