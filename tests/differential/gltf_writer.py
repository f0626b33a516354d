"""Writes glTF files and their pictures, in every form that the loader reads."""

import base64
import json
import math
import struct
import zlib

BYTE, UNSIGNED_BYTE, SHORT, UNSIGNED_SHORT, UNSIGNED_INT, FLOAT = 5120, 5121, 5122, 5123, 5125, 5126
_CODES = {BYTE: "b", UNSIGNED_BYTE: "B", SHORT: "h", UNSIGNED_SHORT: "H", UNSIGNED_INT: "I", FLOAT: "f"}
_LARGEST = {BYTE: 127, UNSIGNED_BYTE: 255, SHORT: 32767, UNSIGNED_SHORT: 65535}
_TYPES = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4", 16: "MAT4"}


class Gltf:
    """A file in the making: `root` is its JSON, `view` and `accessor` fill the buffer."""

    def __init__(self):
        self.root = {"asset": {"version": "2.0"}}
        self.blob = bytearray()
        self.files = {}  # beside the scene, by name
        self.more_buffers = []

    def add(self, kind, entry):
        entries = self.root.setdefault(kind, [])
        entries.append(entry)
        return len(entries) - 1

    def view(self, data, stride=None):
        self.blob += bytes(-len(self.blob) % 4)
        view = {"buffer": 0, "byteOffset": len(self.blob), "byteLength": len(data)}
        if stride:
            view["byteStride"] = stride
        self.blob += data
        return self.add("bufferViews", view)

    def accessor(self, rows, component=FLOAT, normalized=False, gap=0, sparse=False):
        """`rows`: tuples of numbers, from -1 to 1 for normalised integers. `gap`: bytes before the first and
        between any two, as in a shared vertex buffer. `sparse`: the last row comes from a list of its own."""
        if normalized:
            rows = [[round(x * _LARGEST[component]) for x in row] for row in rows]
        code = "<" + _CODES[component] * len(rows[0])
        size = struct.calcsize(code)
        step = size + gap
        if gap or size % 4:
            step += -step % 4
        scalar = len(rows[0]) == 1
        if scalar:
            step, gap = size, 0
        plain = rows[:-1] + [rows[0]] if sparse else rows
        data = bytes(gap) + b"".join(struct.pack(code, *row) + bytes(step - size) for row in plain)
        entry = {"bufferView": self.view(data, None if scalar or step == size else step), "componentType": component,
                 "count": len(rows), "type": _TYPES[len(rows[0])]}
        if gap:
            entry["byteOffset"] = gap
        if normalized:
            entry["normalized"] = True
        if sparse:
            entry["sparse"] = {
                "count": 1,
                "indices": {"bufferView": self.view(bytes(4) + struct.pack("<H", len(rows) - 1)), "byteOffset": 4,
                            "componentType": UNSIGNED_SHORT},
                "values": {"bufferView": self.view(bytes(4) + struct.pack(code, *rows[-1])), "byteOffset": 4}}
        return self.add("accessors", entry)

    def image(self, data, form, number):
        """`form`: where the bytes of a PNG, JPEG or WebP lie."""
        kind = {b"\x89PNG": "png", b"RIFF": "webp"}.get(data[:4], "jpeg")
        if form == "view":
            return self.add("images", {"bufferView": self.view(data), "mimeType": f"image/{kind}"})
        if form == "data":
            text = base64.b64encode(data).decode()
            return self.add("images", {"uri": f"data:image/{kind};base64,{text}"})
        name = f"picture {number}.{kind}"
        self.files[name] = data
        return self.add("images", {"uri": name.replace(" ", "%20")})

    def close(self, form):
        """Nothing is added from now on. `form`: a .glb, or a .gltf with its buffer in a file or as data within."""
        buffer = {"byteLength": len(self.blob)}
        self.root["buffers"] = [buffer, *self.more_buffers]
        if form == "data":
            buffer["uri"] = "data:application/octet-stream;base64," + base64.b64encode(self.blob).decode()
        elif form == "file":
            buffer["uri"] = "scene.bin"
            self.files["scene.bin"] = bytes(self.blob)

    def write(self, folder):
        """Writes `scene.glb` or `scene.gltf` and what lies beside it; returns the path."""
        for name, data in self.files.items():
            (folder / name).write_bytes(data)
        if "uri" not in self.root["buffers"][0]:
            text = json.dumps(self.root).encode()
            text += b" " * (-len(text) % 4)
            blob = bytes(self.blob) + bytes(-len(self.blob) % 4)
            chunks = (struct.pack("<II", len(text), 0x4E4F534A) + text + struct.pack("<II", len(blob), 0x004E4942) + blob)
            path = folder / "scene.glb"
            path.write_bytes(struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks)
            return path
        path = folder / "scene.gltf"
        path.write_text(json.dumps(self.root))
        return path


def png(width, height, texels):
    """`texels`: rows of four numbers from 0 to 255."""
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    lines = b"".join(b"\0" + bytes(c for texel in texels[y * width:(y + 1) * width] for c in texel)
                     for y in range(height))
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 6, 0, 0, 0)) +
            chunk(b"IDAT", zlib.compress(lines)) + chunk(b"IEND", b""))


def jpeg(columns, rows, greys):
    """A grey JPEG of columns x rows blocks of 8 x 8 texels, each of one brightness (0 to 255)."""
    def segment(mark, data):
        return struct.pack(">BBH", 0xFF, mark, len(data) + 2) + data
    # Twelve codes of four bits for the differences' lengths, and one code, "nothing", for all that varies within a
    # block.
    tables = bytes([0x00, 0, 0, 0, 12] + [0] * 12 + list(range(12))) + bytes([0x10, 1] + [0] * 15 + [0])
    bits, last = "", 0
    for grey in greys:
        step, last = grey - 128 - last, grey - 128
        length = abs(step).bit_length()
        bits += f"{length:04b}"
        if length:
            bits += f"{step if step > 0 else step + (1 << length) - 1:0{length}b}"
        bits += "0"
    bits += "1" * (-len(bits) % 8)
    coded = bytes(int(bits[i:i + 8], 2) for i in range(0, len(bits), 8)).replace(b"\xff", b"\xff\0")
    return (b"\xff\xd8" + segment(0xDB, bytes([0]) + bytes([8] * 64)) +
            segment(0xC0, struct.pack(">BHHB", 8, 8 * rows, 8 * columns, 1) + bytes([1, 0x11, 0])) +
            segment(0xC4, tables) + segment(0xDA, bytes([1, 1, 0, 0, 63, 0])) + coded + b"\xff\xd9")


def hdr(width, height, texels):
    """Radiance's format, rows that are not compressed. `texels`: rows of three numbers of at least 0."""
    data = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y %d +X %d\n" % (height, width)
    for texel in texels:
        exponent = max(math.frexp(c)[1] for c in texel)
        data += bytes([min(255, int(c * 2.0 ** (8 - exponent))) for c in texel] + [exponent + 128 if max(texel) else 0])
    return data


def exr(width, height, texels):
    """OpenEXR, 32-bit floats, not compressed."""
    def attribute(name, kind, data):
        return name + b"\0" + kind + b"\0" + struct.pack("<I", len(data)) + data
    channels = b"".join(c + b"\0" + struct.pack("<IBxxxII", 2, 0, 1, 1) for c in (b"B", b"G", b"R")) + b"\0"
    window = struct.pack("<4i", 0, 0, width - 1, height - 1)
    head = (struct.pack("<II", 20000630, 2) + attribute(b"channels", b"chlist", channels) +
            attribute(b"compression", b"compression", b"\0") + attribute(b"dataWindow", b"box2i", window) +
            attribute(b"displayWindow", b"box2i", window) + attribute(b"lineOrder", b"lineOrder", b"\0") +
            attribute(b"pixelAspectRatio", b"float", struct.pack("<f", 1)) +
            attribute(b"screenWindowCenter", b"v2f", struct.pack("<ff", 0, 0)) +
            attribute(b"screenWindowWidth", b"float", struct.pack("<f", 1)) + b"\0")
    line = 8 + 12 * width
    table = b"".join(struct.pack("<Q", len(head) + 8 * height + y * line) for y in range(height))
    lines = b""
    for y in range(height):
        row = texels[y * width:(y + 1) * width]
        lines += struct.pack("<ii", y, 12 * width)
        lines += b"".join(struct.pack("<f", texel[c]) for c in (2, 1, 0) for texel in row)
    return head + table + lines
