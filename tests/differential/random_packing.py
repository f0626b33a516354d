"""Packs some of what a finished scene has, as other programs do when they export."""

import math
import random
import struct

import packed_writer
from gltf_writer import BYTE, FLOAT, SHORT, UNSIGNED_INT, UNSIGNED_SHORT

_SIZES = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}
_CODES = {BYTE: "b", 5121: "B", SHORT: "h", UNSIGNED_SHORT: "H", UNSIGNED_INT: "I", FLOAT: "f"}
MESHOPT = "EXT_meshopt_compression"
DRACO = "KHR_draco_mesh_compression"


# Known to the loader, which does not read them.
UNREAD = ("EXT_lights_image_based", "EXT_texture_avif", "KHR_animation_pointer", "KHR_materials_dispersion",
          "KHR_materials_iridescence", "KHR_materials_pbrSpecularGlossiness", "KHR_materials_unlit", "KHR_materials_variants",
          "KHR_meshopt_compression", "KHR_xmp_json_ld", "MSFT_texture_dds")


class Packing:
    """Draws from a generator of its own: a scene is otherwise the same as without."""

    def __init__(self, gltf, seed):
        self.gltf, self.r = gltf, random.Random(f"packing {seed}")
        self.used = set()

    def chance(self, p):
        return self.r.random() < p

    def all(self):
        """Packs, and returns the extensions that a reader must have from now on."""
        for i, node in enumerate(self.gltf.root["nodes"]):
            if "skin" in node and "extensions" not in node:
                self.bend(i, node)
        for mesh in self.gltf.root.get("meshes", []):
            if any("targets" in primitive for primitive in mesh["primitives"]) and self.chance(0.7):
                mesh["weights"] = [self.r.random()]
            for primitive in mesh["primitives"]:
                if primitive.get("mode", 4) < 4:  # shares its attributes
                    continue
                if self.chance(0.1):
                    self.by_draco(primitive)
                elif self.chance(0.15):
                    self.by_meshopt(primitive)
        for node in self.gltf.root["nodes"]:
            copies = node.get("extensions", {}).get("EXT_mesh_gpu_instancing", {}).get("attributes", {})
            if "ROTATION" in copies and self.chance(0.3):
                self.turns(copies)
        for texture in self.gltf.root["textures"]:
            if self.chance(0.15):
                self.picture(texture)
            elif self.chance(0.05):  # not read, since the plain one is there
                texture["extensions"] = {"KHR_texture_basisu": {"source": texture["source"]}}
        if MESHOPT in self.used:
            self.gltf.more_buffers = [{"byteLength": 1 << 20, "extensions": {MESHOPT: {"fallback": True}}}]
        return self.used

    def others(self):
        """Extensions that a file may name although nothing of them is in it."""
        return self.r.sample(UNREAD, 2) if self.chance(0.3) else []

    def bend(self, index, node):
        """Gives the node's skin two joints: the node itself, and mostly the same a little beside it."""
        gltf, r = self.gltf, self.r
        skin = gltf.root["skins"][node["skin"]]
        skin["joints"] = [index, index]
        if self.chance(0.7):
            moves = [(0.0, 0.0, 0.0), tuple(r.uniform(-0.2, 0.2) for _ in range(3))]
            skin["inverseBindMatrices"] = gltf.accessor([(1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0,
                                                         *move, 1.0) for move in moves])
        for primitive in gltf.root["meshes"][node["mesh"]]["primitives"]:
            count = self.accessor(primitive["attributes"]["POSITION"])["count"]
            joints = [tuple(r.randrange(2) for _ in range(4)) for _ in range(count)]
            weights = [tuple(r.random() for _ in range(4)) for _ in range(count)]
            primitive["attributes"]["JOINTS_0"] = gltf.accessor(joints, r.choice((5121, UNSIGNED_SHORT)))
            primitive["attributes"]["WEIGHTS_0"] = gltf.accessor(weights)
            if self.chance(0.2):
                primitive["attributes"]["JOINTS_1"] = gltf.accessor([(0, 0, 0, 0)] * count, UNSIGNED_SHORT)
                primitive["attributes"]["WEIGHTS_1"] = gltf.accessor([(0.0, 0.0, 0.0, 0.0)] * count)

    def accessor(self, index):
        return self.gltf.root["accessors"][index]

    def rows(self, index):
        """The bytes of each element; nothing for a sparse accessor."""
        accessor = self.accessor(index)
        if "sparse" in accessor:
            return None
        view = self.gltf.root["bufferViews"][accessor["bufferView"]]
        size = struct.calcsize("<" + _CODES[accessor["componentType"]]) * _SIZES[accessor["type"]]
        first = view["byteOffset"] + accessor.get("byteOffset", 0)
        step = view.get("byteStride", size)
        return [bytes(self.gltf.blob[first + i * step:first + i * step + size]) for i in range(accessor["count"])]

    def numbers(self, index):
        accessor = self.accessor(index)
        code = f"<{_SIZES[accessor['type']]}{_CODES[accessor['componentType']]}"
        return [struct.unpack(code, row) for row in self.rows(index)]

    def copy(self, index, **members):
        """A new accessor like that one, for bytes that lie elsewhere."""
        like = {k: v for k, v in self.accessor(index).items() if k not in ("bufferView", "byteOffset")}
        return self.gltf.add("accessors", {**like, **members})

    def by_draco(self, primitive):
        attributes = primitive["attributes"]
        indices = primitive.get("indices")
        if primitive.get("mode", 4) != 4 or indices is None or any(self.rows(i) is None for i in attributes.values()):
            return
        corners = [i for (i,) in self.numbers(indices)]
        if 3 * (len(corners) // 3) < self.accessor(attributes["POSITION"])["count"]:
            return
        entries = [(name, self.accessor(i)["componentType"], _SIZES[self.accessor(i)["type"]],
                    self.accessor(i).get("normalized", False), self.rows(i)) for name, i in attributes.items()]
        stream = packed_writer.draco([corners[i:i + 3] for i in range(0, len(corners), 3)], entries)
        primitive["attributes"] = {name: self.copy(i) for name, i in attributes.items()}
        primitive["indices"] = self.copy(indices)
        primitive["extensions"] = {DRACO: {"bufferView": self.gltf.view(stream),
                                           "attributes": {name: i for i, name in enumerate(attributes)}}}
        self.used.add(DRACO)

    def meshopt(self, stream, mode, count, stride, name="NONE"):
        """A view of `count` elements of `stride` bytes. `name`: of a filter."""
        view = self.gltf.root["bufferViews"][self.gltf.view(stream)]
        packed = {**view, "mode": mode, "count": count, "byteStride": stride}
        if name != "NONE" or self.chance(0.5):
            packed["filter"] = name
        plain = {"buffer": 1, "byteLength": count * stride, "extensions": {MESHOPT: packed}}
        if mode == "ATTRIBUTES":
            plain["byteStride"] = stride
        self.used.add(MESHOPT)
        return self.gltf.add("bufferViews", plain)

    def vertices(self, rows, name="NONE"):
        stride = -(-len(rows[0]) // 4) * 4
        data = b"".join(row + bytes(stride - len(row)) for row in rows)
        return self.meshopt(packed_writer.meshopt_vertices(data, stride), "ATTRIBUTES", len(rows), stride, name)

    def by_meshopt(self, primitive):
        primitive["attributes"] = dict(primitive["attributes"])
        for name, index in primitive["attributes"].items():
            rows, form = self.rows(index), self.accessor(index)
            if rows is None or self.chance(0.2):
                continue
            if form["componentType"] == FLOAT and self.chance(0.3):
                packed = self.vertices([packed_writer.exponential(row) for row in self.numbers(index)], "EXPONENTIAL")
            elif name == "NORMAL" and form["componentType"] == BYTE and all(any(n) for n in self.numbers(index)):
                packed = self.vertices([packed_writer.octahedral(n) for n in self.numbers(index)], "OCTAHEDRAL")
            else:
                packed = self.vertices(rows)
            primitive["attributes"][name] = self.copy(index, bufferView=packed)
        indices = primitive.get("indices")
        if indices is None or self.accessor(indices)["componentType"] not in (UNSIGNED_SHORT, UNSIGNED_INT):
            return
        corners = [i for (i,) in self.numbers(indices)]
        stride = 2 if self.accessor(indices)["componentType"] == UNSIGNED_SHORT else 4
        if len(corners) % 3 == 0 and self.chance(0.7):
            packed = self.meshopt(packed_writer.meshopt_triangles(corners), "TRIANGLES", len(corners), stride)
        else:
            packed = self.meshopt(packed_writer.meshopt_indices(corners), "INDICES", len(corners), stride)
        primitive["indices"] = self.copy(indices, bufferView=packed)

    def turns(self, copies):
        quaternions = [[x / math.hypot(*q) for x in q] for q in self.numbers(copies["ROTATION"])]
        packed = self.vertices([packed_writer.quaternion(q) for q in quaternions], "QUATERNION")
        copies["ROTATION"] = self.copy(copies["ROTATION"], bufferView=packed, componentType=SHORT, normalized=True)

    def picture(self, texture):
        r = self.r
        width, height = r.choice((1, 2, 3, 5)), r.choice((1, 2, 4))
        colours = [(r.randrange(256), r.randrange(256)) for _ in range(3)] + [r.choice(((255, 255), (0, 255), (40, 200)))]
        texels = [[r.randrange(2) for _ in range(4)] for _ in range(width * height)]
        data = packed_writer.webp(width, height, colours, texels)
        number = len(self.gltf.root["images"])
        image = self.gltf.image(data, r.choice(("view", "data", "file")), number)
        texture["extensions"] = {"EXT_texture_webp": {"source": image}}
        if self.chance(0.5):
            del texture["source"]
        self.used.add("EXT_texture_webp")
