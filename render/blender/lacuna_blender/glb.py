"""Writes binary glTF 2.0. Independent of Blender."""

import json
import struct

FLOAT, UNSIGNED = 5126, 5125
_SHAPES = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4"}


class Glb:
    """A document that grows: every method that adds something returns its index."""

    def __init__(self):
        self.document = {"asset": {"version": "2.0", "generator": "Lacuna add-on"}, "scene": 0,
                         "scenes": [{"nodes": []}], "nodes": []}
        self._chunks = []
        self._size = 0
        self._extensions = set()

    def append(self, kind, entry):
        """Appends `entry` to the array `kind` of the document."""
        entries = self.document.setdefault(kind, [])
        entries.append(entry)
        return len(entries) - 1

    def extension(self, owner, name, values):
        """Sets `values` as the extension `name` of `owner`, an object of the document."""
        self._extensions.add(name)
        owner.setdefault("extensions", {})[name] = values

    def accessor(self, array):
        """Adds an accessor for a NumPy array of float32 (n x 2, 3 or 4) or uint32 (n)."""
        width = array.shape[1] if array.ndim == 2 else 1
        entry = {"bufferView": self._view(array.tobytes()), "count": len(array), "type": _SHAPES[width],
                 "componentType": UNSIGNED if array.dtype.kind == "u" else FLOAT}
        if width == 3:
            entry["min"], entry["max"] = array.min(axis=0).tolist(), array.max(axis=0).tolist()
        return self.append("accessors", entry)

    def image(self, data, mime, name):
        return self.append("images", {"bufferView": self._view(data), "mimeType": mime, "name": name})

    def mesh(self, name, primitives):
        """Adds a mesh. `primitives`: (attributes by name, indices, material), with arrays for accessor()."""
        parts = [{"attributes": {key: self.accessor(array) for key, array in attributes.items()},
                  "indices": self.accessor(indices), "material": material}
                 for attributes, indices, material in primitives]
        return self.append("meshes", {"name": name, "primitives": parts})

    def node(self, parent, name, matrix, **members):
        """Adds a node. `matrix`: 16 numbers, column-major. `parent` None: a root of the scene."""
        index = self.append("nodes", {"name": name, "matrix": list(matrix), **members})
        if parent is None:
            self.document["scenes"][0]["nodes"].append(index)
        else:
            self.document["nodes"][parent].setdefault("children", []).append(index)
        return index

    def light(self, parent, name, matrix, light):
        """Adds a light of KHR_lights_punctual in a node of its own."""
        lights = self.document.setdefault("extensions", {}).setdefault("KHR_lights_punctual", {"lights": []})["lights"]
        self._extensions.add("KHR_lights_punctual")
        lights.append({"name": name, **light})
        node = self.node(parent, name, matrix)
        self.extension(self.document["nodes"][node], "KHR_lights_punctual", {"light": len(lights) - 1})
        return node

    def write(self, path):
        document = dict(self.document)
        if self._extensions:
            document["extensionsUsed"] = sorted(self._extensions)
        if self._chunks:
            document["buffers"] = [{"byteLength": self._size}]
        text = json.dumps(document, separators=(",", ":")).encode()
        text += b" " * (-len(text) % 4)
        total = 12 + 8 + len(text) + (8 + self._size if self._chunks else 0)
        with open(path, "wb") as file:
            file.write(struct.pack("<4sII", b"glTF", 2, total))
            file.write(struct.pack("<I4s", len(text), b"JSON") + text)
            if self._chunks:
                file.write(struct.pack("<I4s", self._size, b"BIN\0"))
                file.writelines(self._chunks)

    def _view(self, data):
        at = self._size
        padded = data + b"\0" * (-len(data) % 4)
        self._chunks.append(padded)
        self._size += len(padded)
        return self.append("bufferViews", {"buffer": 0, "byteOffset": at, "byteLength": len(data)})
