// EXT_meshopt_compression: compressed buffer views, as gltfpack -c writes them.
#pragma once

#include "libcore/gltf/document.h"

namespace lacuna::gltf {

/// Decodes every packed buffer view of `document.json` into a buffer of its own and makes it a plain view of that
/// buffer. The buffers must be loaded. Throws InputError for streams that are damaged or of an unsupported version, for
/// counts and strides that the codec does not allow, and for ranges outside their buffer.
void unpackMeshopt(Document& document);

}  // namespace lacuna::gltf
