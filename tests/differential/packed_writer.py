"""Packed meshes and pictures: the simplest streams that a decoder takes, hardly smaller than plain data."""

import math
import struct

DRACO_TYPES = {5120: 1, 5121: 2, 5122: 3, 5123: 4, 5125: 6, 5126: 9}
DRACO_KINDS = {"POSITION": 0, "NORMAL": 1, "COLOR_0": 2, "TEXCOORD_0": 3, "TEXCOORD_1": 3}


def _varint(value):
    data = b""
    while value >= 128:
        data += bytes([value & 127 | 128])
        value >>= 7
    return data + bytes([value])


def _zigzag(value):
    return value << 1 if value >= 0 else (-value << 1) - 1


def draco(triangles, attributes):
    """`attributes`: (name, component type, components, normalised, bytes of each vertex); their ids count from 0."""
    points = len(attributes[0][4])
    data = b"DRACO" + bytes([2, 2, 1, 0]) + struct.pack("<H", 0) + _varint(len(triangles)) + _varint(points) + bytes([1])
    for triangle in triangles:
        data += struct.pack("<3B" if points < 256 else "<3H", *triangle)
    data += bytes([1]) + _varint(len(attributes))
    for i, (name, component, size, normalized, _) in enumerate(attributes):
        data += bytes([DRACO_KINDS.get(name, 4), DRACO_TYPES[component], size, normalized]) + _varint(i)
    return data + bytes(len(attributes)) + b"".join(row for *_, rows in attributes for row in rows)


def meshopt_vertices(data, stride):
    """Mode ATTRIBUTES of whole vertices of `stride` bytes."""
    vertices = [data[i:i + stride] for i in range(0, len(data), stride)]
    out, last = bytes([0xA0]), vertices[0]
    size = min(8192 // stride & ~15, 256)
    for first in range(0, len(vertices), size):
        block = vertices[first:first + size]
        groups = -(-len(block) // 16)
        for k in range(stride):
            column = [v[k] for v in (last, *block)]
            steps = [(b - a) & 255 for a, b in zip(column, column[1:])]
            coded = bytes((-(d >> 7) ^ d << 1) & 255 for d in steps)
            # Two bits for each group of 16 say that it follows unpacked.
            heads = b"".join(bytes([sum(3 << 2 * i for i in range(min(4, groups - g)))]) for g in range(0, groups, 4))
            out += heads + coded + bytes(16 * groups - len(coded))
        last = block[-1]
    return out + bytes(max(32 - stride, 0)) + vertices[0]


def meshopt_triangles(indices):
    """Mode TRIANGLES."""
    data, last = b"", 0
    for i, index in enumerate(indices):
        data += (b"" if i % 3 else b"\xff") + _varint(_zigzag(index - last))
        last = index
    return b"\xe1" + b"\xff" * (len(indices) // 3) + data + bytes(16)


def meshopt_indices(indices):
    """Mode INDICES."""
    steps = [b - a for a, b in zip([0, *indices], indices)]
    return b"\xd1" + b"".join(_varint(_zigzag(step) << 1) for step in steps) + bytes(4)


def exponential(numbers):
    """Floats as the filter EXPONENTIAL wants them: a mantissa of 24 bits. The smallest become 0."""
    data = b""
    for x in numbers:
        mantissa, exponent = math.frexp(x)
        whole = round(mantissa * (1 << 23))
        if abs(whole) == 1 << 23:
            whole, exponent = whole // 2, exponent + 1
        exponent -= 23
        if exponent < -100:
            whole = exponent = 0
        data += struct.pack("<I", (exponent & 255) << 24 | whole & 0xFFFFFF)
    return data


def octahedral(normal):
    """A unit vector in four bytes, as the filter OCTAHEDRAL wants it."""
    x, y, z = (c / sum(map(abs, normal)) for c in normal)
    if z < 0:
        x, y = (1 - abs(y)) * math.copysign(1, x), (1 - abs(x)) * math.copysign(1, y)
    return struct.pack("<4b", round(127 * x), round(127 * y), 127, 0)


def quaternion(q):
    """A unit quaternion in eight bytes, as the filter QUATERNION wants it."""
    largest = max(range(4), key=lambda i: abs(q[i]))
    scale = 32767 * math.sqrt(2) * math.copysign(1, q[largest])
    others = [max(-32767, min(32767, round(q[(largest + i) % 4] * scale))) for i in (1, 2, 3)]
    return struct.pack("<4h", *others, 32767 & ~3 | largest)


def webp(width, height, colours, texels):
    """A WebP without loss. `colours`: two values for each of red, green, blue and alpha; `texels`: which of
    the two, for each channel of each texel."""
    bits = []

    def put(value, count):
        bits.extend(value >> i & 1 for i in range(count))

    put(0x2F, 8)
    put(width - 1, 14)
    put(height - 1, 14)
    put(1, 1)  # there is alpha
    put(0, 3 + 3)  # version; no transforms, cache, or further codes
    order = (1, 0, 2, 3)
    for channel in order:
        first, second = colours[channel]
        put(1, 1)
        put(first != second, 1)
        put(1, 1)
        put(first, 8)
        if first != second:
            put(second, 8)
    put(1, 4)  # no distances: one symbol, of one bit, 0
    for texel in texels:
        for channel in order:
            first, second = colours[channel]
            if first != second:
                put(texel[channel] if first < second else 1 - texel[channel], 1)
    bits += [0] * (-len(bits) % 16)
    data = bytes(sum(bits[i + k] << k for k in range(8)) for i in range(0, len(bits), 8))
    return b"RIFF" + struct.pack("<I", 12 + len(data)) + b"WEBPVP8L" + struct.pack("<I", len(data)) + data
