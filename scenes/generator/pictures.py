"""Small pictures: palette PNGs (textures) and a Radiance HDR sky. Nothing here depends on the zlib version."""

from __future__ import annotations

import math
import struct
import zlib
from typing import Callable, Sequence

Rgb = tuple[float, float, float]
Rgba = tuple[float, float, float, float]


def _srgb8(linear: float) -> int:
    s = 12.92 * linear if linear <= 0.0031308 else 1.055 * linear ** (1 / 2.4) - 0.055
    return max(0, min(255, int(255 * s + 0.5)))


def _stored_zlib(data: bytes) -> bytes:
    """A zlib stream without compression: zlib.compress gives other bytes in other versions of zlib."""
    out = b"\x78\x01"
    for start in range(0, len(data), 65535):
        block = data[start:start + 65535]
        last = start + 65535 >= len(data)
        out += struct.pack("<BHH", last, len(block), len(block) ^ 0xFFFF) + block
    return out + struct.pack(">I", zlib.adler32(data))


def _chunk(kind: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def png(size: int, index: Callable[[float, float], int], palette: Sequence[Rgba]) -> bytes:
    """Square palette PNG; `index` maps texel centres in (0, 1)^2, origin top left, to a linear RGBA of `palette`."""
    rows = b"".join(
        b"\0" + bytes(index((x + 0.5) / size, (y + 0.5) / size) for x in range(size)) for y in range(size))
    colours = b"".join(bytes(_srgb8(c) for c in entry[:3]) for entry in palette)
    alphas = bytes(int(255 * entry[3] + 0.5) for entry in palette)
    return (b"\x89PNG\r\n\x1a\n" + _chunk(b"IHDR", struct.pack(">IIBBBBB", size, size, 8, 3, 0, 0, 0))
            + _chunk(b"PLTE", colours) + (_chunk(b"tRNS", alphas) if min(alphas) < 255 else b"")
            + _chunk(b"IDAT", _stored_zlib(rows)) + _chunk(b"IEND", b""))


def checker(a: Rgb, b: Rgb) -> bytes:
    """Two by two squares; many texels each, because look-ups are bilinear."""
    return png(64, lambda u, v: (u < 0.5) ^ (v < 0.5), [(*a, 1.0), (*b, 1.0)])


def perforated(colour: Rgb) -> bytes:
    """Sheet with one round hole per repeat; holes take a third of it."""
    return png(64, lambda u, v: (u - 0.5) ** 2 + (v - 0.5) ** 2 < 0.33 ** 2, [(*colour, 1.0), (*colour, 0.0)])


def leaves(light: Rgb, dark: Rgb) -> bytes:
    """Lens-shaped leaves of two greens on nothing."""
    places = [(0.25, 0.22, 30), (0.70, 0.30, -50), (0.30, 0.68, -20), (0.75, 0.75, 65)]

    def index(u: float, v: float) -> int:
        for k, (cx, cy, degrees) in enumerate(places):
            c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
            x, y = (u - cx) * c + (v - cy) * s, (v - cy) * c - (u - cx) * s
            if abs(y) < 0.11 * (1 - (x / 0.23) ** 2):
                return 1 + k % 2
        return 0

    return png(64, index, [(*dark, 0.0), (*light, 1.0), (*dark, 1.0)])


def _rgbe(c: Rgb) -> tuple[int, int, int, int]:
    top = max(c)
    if top < 1e-32:
        return (0, 0, 0, 0)
    fraction, exponent = math.frexp(top)
    s = fraction * 256 / top
    return (int(c[0] * s), int(c[1] * s), int(c[2] * s), exponent + 128)


def _run_lengths(values: Sequence[int]) -> bytes:
    """Radiance's run lengths: a byte above 128 repeats the next one, a smaller one announces plain bytes."""
    out, plain, i = b"", bytearray(), 0

    def flush() -> bytes:
        return b"".join(bytes([len(plain[k:k + 128])]) + bytes(plain[k:k + 128]) for k in range(0, len(plain), 128))

    while i < len(values):
        run = 1
        while i + run < len(values) and run < 127 and values[i + run] == values[i]:
            run += 1
        if run >= 4:
            out += flush() + bytes([128 + run, values[i]])
            plain.clear()
        else:
            plain += bytes(values[i:i + run])
        i += run
    return out + flush()


def direction_of(x: int, y: int, width: int, height: int) -> Rgb:
    """The direction of a pixel's centre in a latitude-longitude picture: centre -Z, right half +X, top row +Y."""
    polar = math.pi * (y + 0.5) / height
    turn = 2 * math.pi * ((x + 0.5) / width - 0.5)
    return math.sin(polar) * math.sin(turn), math.cos(polar), -math.sin(polar) * math.cos(turn)


def hdr(width: int, height: int, radiance: Callable[[Rgb], Rgb]) -> bytes:
    """Latitude-longitude picture of radiance(direction_of(..))."""
    out = f"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {width}\n".encode()
    for y in range(height):
        row = [_rgbe(radiance(direction_of(x, y, width, height))) for x in range(width)]
        out += bytes([2, 2, width >> 8, width & 255]) + b"".join(_run_lengths([p[k] for p in row]) for k in range(4))
    return out


def sky(sun: Rgb, sun_radiance: Rgb, sun_width_degrees: float) -> Callable[[Rgb], Rgb]:
    """Blue towards the zenith, white at the horizon, dark ground, and a round sun with a soft rim and a halo."""

    def radiance(d: Rgb) -> Rgb:
        if d[1] < 0:
            return (0.08, 0.07, 0.06)
        haze = (1 - d[1]) ** 3
        base = (0.25 + 0.75 * haze, 0.45 + 0.55 * haze, 0.9 + 0.2 * haze)
        cosine = max(-1.0, min(1.0, d[0] * sun[0] + d[1] * sun[1] + d[2] * sun[2]))
        angle = math.degrees(math.acos(cosine))
        disc = math.exp(-((angle / sun_width_degrees) ** 4))
        halo = 0.001 * math.exp(-angle / 14)
        return tuple(b + s * (disc + halo) for b, s in zip(base, sun_radiance))

    return radiance
