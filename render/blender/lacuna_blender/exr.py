"""Reads the OpenEXR files that lacuna-render writes, and writes environment maps. Blender's own reader drops layers
whose names are not its own. Supports scan lines of floats, uncompressed or ZIP; nothing else occurs."""

import struct
import zlib

import numpy

_MAGIC = b"\x76\x2f\x31\x01"
_LINES = {0: 1, 2: 1, 3: 16}  # scanlines per chunk, by compression: none, ZIPS, ZIP


class Picture:
    """`channels`: name -> height x width float32, row 0 at the top; `header`: text and integer attributes by name."""

    def __init__(self, width, height, channels, header):
        self.width, self.height, self.channels, self.header = width, height, channels, header

    def stack(self, *names):
        """The named channels stacked (height x width x n), or None if one is missing."""
        if any(name not in self.channels for name in names):
            return None
        return numpy.stack([self.channels[name] for name in names], axis=-1)


def read(path):
    """Reads a Picture. Raises ValueError if the file is of another kind or incomplete."""
    with open(path, "rb") as file:
        data = file.read()
    try:
        return _decode(data)
    except (struct.error, IndexError, KeyError, zlib.error) as error:
        raise ValueError(f"{path}: expected an .exr of lacuna-render, found something else ({error})") from error


def _text(data, at):
    end = data.index(b"\0", at)
    return data[at:end].decode(), end + 1


def _attributes(data):
    at, found = 8, {}
    while data[at]:
        name, at = _text(data, at)
        kind, at = _text(data, at)
        size, = struct.unpack_from("<i", data, at)
        found[name] = (kind, data[at + 4:at + 4 + size])
        at += 4 + size
    return found, at + 1


def _channel_names(data):
    at, names = 0, []
    while data[at]:
        name, at = _text(data, at)
        if struct.unpack_from("<i", data, at)[0] != 2:
            raise ValueError(f"channel {name}: expected 32-bit floats")
        names.append(name)
        at += 16
    return names


def _unpacked(chunk, size):
    """The bytes of a ZIP chunk, which holds differences with even and odd bytes separated. Incompressible chunks are
    stored as they are."""
    if len(chunk) == size:
        return chunk
    steps = numpy.frombuffer(zlib.decompress(chunk), numpy.uint8).astype(numpy.int64)
    steps[1:] -= 128
    values = (numpy.cumsum(steps) & 255).astype(numpy.uint8)
    whole = numpy.empty(size, numpy.uint8)
    half = (size + 1) // 2
    whole[0::2], whole[1::2] = values[:half], values[half:]
    return whole.tobytes()


def _decode(data):
    if data[:4] != _MAGIC or data[5] & 2:
        raise ValueError("expected an OpenEXR file of scanlines")
    attributes, at = _attributes(data)
    names = _channel_names(attributes["channels"][1])
    x0, y0, x1, y1 = struct.unpack("<4i", attributes["dataWindow"][1])
    width, height, compression = x1 - x0 + 1, y1 - y0 + 1, attributes["compression"][1][0]
    lines = _LINES[compression]
    pixels = numpy.zeros((height, len(names), width), numpy.float32)
    chunks = (height + lines - 1) // lines
    for place in struct.unpack_from(f"<{chunks}Q", data, at):
        y, size = struct.unpack_from("<ii", data, place)
        rows = min(lines, y1 + 1 - y)
        raw = _unpacked(data[place + 8:place + 8 + size], rows * len(names) * width * 4)
        pixels[y - y0:y - y0 + rows] = numpy.frombuffer(raw, "<f4").reshape(rows, len(names), width)
    header = {name: value.decode(errors="replace") if kind == "string" else struct.unpack("<i", value)[0]
              for name, (kind, value) in attributes.items() if kind in ("string", "int")}
    return Picture(width, height, {name: pixels[:, i] for i, name in enumerate(names)}, header)


def write(path, rgb):
    """Writes an uncompressed .exr. `rgb`: height x width x 3 float32, row 0 at the top."""
    height, width, _ = rgb.shape

    def attribute(name, kind, value):
        return name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<i", len(value)) + value

    channels = b"".join(name + b"\0" + struct.pack("<iB3xii", 2, 0, 1, 1) for name in (b"B", b"G", b"R")) + b"\0"
    window = struct.pack("<4i", 0, 0, width - 1, height - 1)
    header = _MAGIC + struct.pack("<i", 2) + attribute("channels", "chlist", channels) + \
        attribute("compression", "compression", b"\0") + attribute("dataWindow", "box2i", window) + \
        attribute("displayWindow", "box2i", window) + attribute("lineOrder", "lineOrder", b"\0") + \
        attribute("pixelAspectRatio", "float", struct.pack("<f", 1)) + \
        attribute("screenWindowCenter", "v2f", struct.pack("<2f", 0, 0)) + \
        attribute("screenWindowWidth", "float", struct.pack("<f", 1)) + b"\0"
    first, size = len(header) + 8 * height, 12 * width
    planes = numpy.ascontiguousarray(rgb[:, :, ::-1].transpose(0, 2, 1), "<f4")  # B, G, R, each a row
    with open(path, "wb") as file:
        file.write(header + struct.pack(f"<{height}Q", *(first + y * (8 + size) for y in range(height))))
        for y in range(height):
            file.write(struct.pack("<ii", y, size) + planes[y].tobytes())
