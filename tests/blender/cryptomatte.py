"""A reader of Cryptomatte that knows the published specification (1.2.0) and nothing of Lacuna: it finds names, ids and
mattes in a file's channels and attributes. As a program it checks what lacuna-render writes: python3 cryptomatte.py
LACUNA_RENDER. Exits with 77 without NumPy."""

import json
import os
import struct
import subprocess
import sys
import tempfile

try:
    import numpy
except ImportError:
    print("skipped: expected NumPy, found none (Debian: python3-numpy)")
    sys.exit(77)

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(HERE, "..", "..", "render", "blender"))
from lacuna_blender import exr  # noqa: E402


def murmur_hash(text):
    """MurmurHash3_32 of the text's UTF-8 with seed 0."""
    data, value = text.encode(), 0

    def turned(x, by):
        return ((x << by) | (x >> (32 - by))) & 0xffffffff

    def mixed(block):
        return turned(block * 0xcc9e2d51 & 0xffffffff, 15) * 0x1b873593 & 0xffffffff

    whole = len(data) // 4 * 4
    for block, in struct.iter_unpack("<I", data[:whole]):
        value = (turned(value ^ mixed(block), 13) * 5 + 0xe6546b64) & 0xffffffff
    if data[whole:]:
        value ^= mixed(int.from_bytes(data[whole:], "little"))
    value ^= len(data)
    value = (value ^ value >> 16) * 0x85ebca6b & 0xffffffff
    value = (value ^ value >> 13) * 0xc2b2ae35 & 0xffffffff
    return value ^ value >> 16


def id_bits(name):
    """The bits of a name's id as a float, which is no zero, denormal, infinity or NaN."""
    value = murmur_hash(name)
    return value ^ 1 << 23 if value >> 23 & 255 in (0, 255) else value


class Cryptomatte:
    """One type of a file: `names` maps names to the bits of ids; `ids` and `shares` are by rank (ranks x height x
    width)."""

    def __init__(self, channels, header, type_name):
        key = "cryptomatte/%s/" % ("%08x" % murmur_hash(type_name))[:7]
        meta = {name: header[key + name] for name in ("name", "hash", "conversion", "manifest")}
        if (meta["name"], meta["hash"], meta["conversion"]) != (type_name, "MurmurHash3_32", "uint32_to_float32"):
            raise ValueError("another Cryptomatte: %s" % meta)
        self.names = {name: int(digits, 16) for name, digits in json.loads(meta["manifest"]).items()}
        self.ids, self.shares = [], []
        for layer in range(3):
            for of_id, of_share in ("RG", "BA"):
                start = "%s%02d." % (type_name, layer)
                self.ids.append(numpy.ascontiguousarray(channels[start + of_id]).view(numpy.uint32))
                self.shares.append(channels[start + of_share])
        self.ids, self.shares = numpy.stack(self.ids), numpy.stack(self.shares)

    def matte(self, name):
        return numpy.where(self.ids == self.names[name], self.shares, 0).sum(axis=0)

    def check(self):
        """Raises AssertionError if something is not as the specification says."""
        for name, bits in self.names.items():
            assert bits == id_bits(name), (name, bits)
        known = set(self.names.values()) | {0}
        assert set(numpy.unique(self.ids).tolist()) <= known, "an id that no name has"
        assert ((self.ids == 0) == (self.shares == 0)).all(), "coverage of nothing"
        assert (self.shares >= 0).all() and (self.shares.sum(axis=0) < 1 + 1e-5).all(), "more than all of a pixel"
        assert (numpy.diff(self.shares, axis=0) <= 0).all(), "ranks that are not in order"


def _renamed(path, names):
    """The bytes of a .glb with renamed nodes."""
    data = open(path, "rb").read()
    size, = struct.unpack_from("<I", data, 12)
    document = json.loads(data[20:20 + size])
    for node in document["nodes"]:
        name = names.get(node.get("name"), node.get("name"))
        node.pop("name", None)
        if name:
            node["name"] = name
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    rest = data[20 + size:]
    return struct.pack("<4sIII4s", b"glTF", 2, 20 + len(text) + len(rest), len(text), b"JSON") + text + rest


def _test(program):
    """Checks what lacuna-render writes for names that are long, foreign, shared by several nodes, or missing."""
    scene = os.path.join(HERE, "..", "..", "scenes", "blender-still-life.glb")
    long = "Stra\u00dfe \u6771\u4eac \"quoted\" \\ " + 300 * "x"
    names = {"enamel ring": long, "wall": "", "skittle 2": "skittle", "skittle 3": "skittle"}
    with tempfile.TemporaryDirectory() as folder:
        glb, picture = os.path.join(folder, "a.glb"), os.path.join(folder, "a.exr")
        with open(glb, "wb") as file:
            file.write(_renamed(scene, names))
        subprocess.run([program, glb, "-o", picture, "--quiet", "--method", "pt", "--iterations", "1", "--width", "160",
                        "--cryptomatte", "object,material"], check=True, stdout=subprocess.DEVNULL)
        read = exr.read(picture)
    objects = Cryptomatte(read.channels, read.header, "CryptoObject")
    materials = Cryptomatte(read.channels, read.header, "CryptoMaterial")
    for matte in (objects, materials):
        matte.check()
        assert numpy.allclose(matte.shares.sum(axis=0), 1), "a room without a gap"
    assert {long, "unnamed", "skittle"} <= set(objects.names) and "skittle 2" not in objects.names, objects.names
    assert objects.matte(long).max() == 1 and objects.matte("unnamed").mean() > 0.2
    # The skittles are the only objects of their material, whatever their names.
    skittles = sum(objects.matte(name) for name in objects.names if name.startswith("skittle"))
    assert any(numpy.allclose(skittles, materials.matte(name)) for name in materials.names), list(materials.names)
    print("Cryptomatte: %d objects, %d materials" % (len(objects.names), len(materials.names)))


if __name__ == "__main__":
    assert [murmur_hash(text) for text in ("", "test", "Hello, world!", "bunny")] == \
        [0, 0xba6bd213, 0xc0363e43, 0x13851a76]
    _test(sys.argv[1])
