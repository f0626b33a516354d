#!/usr/bin/env python3
"""Time and memory that large scenes take to load; Python's standard library only.

  python3 tests/benchmarks/large_scenes.py [LACUNA-RENDER]      default: build/render/lacuna-render

Makes each scene in a temporary directory, has one small picture of it rendered, and prints what lacuna-render measured:
seconds for parsing (JSON, hierarchy, materials), decoding (textures), meshes (accessors to triangles) and building
(world space, lights, hierarchy of boxes), and the peak of its memory. `file` is the file's size, which has to be read
at least.
"""

from __future__ import annotations

import json
import math
import random
import struct
import subprocess
import sys
import tempfile
import zlib
from array import array
from collections.abc import Iterable
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.append(str(ROOT / "tests"))

import pages  # noqa: E402

PHASES = ("parse", "decode", "meshes", "build")


def write_glb(path: Path, root: dict, parts: list[array]) -> None:
    """Each of `parts` becomes a buffer view, in this order."""
    sizes = [len(p) * p.itemsize for p in parts]
    root["bufferViews"] = [{"buffer": 0, "byteOffset": sum(sizes[:i]), "byteLength": s} for i, s in enumerate(sizes)]
    root["buffers"] = [{"byteLength": sum(sizes)}]
    text = json.dumps(root).encode()
    text += b" " * (-len(text) % 4)
    with path.open("wb") as file:
        file.write(struct.pack("<4sIIII", b"glTF", 2, 28 + len(text) + sum(sizes), len(text), 0x4E4F534A))
        file.write(text)
        file.write(struct.pack("<II", sum(sizes), 0x004E4942))
        for part in parts:
            part.tofile(file)


def png(side: int, rows: Iterable[bytes]) -> bytes:
    """`rows`: `side` rows, each of `side` texels of R, G, B."""
    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    packer = zlib.compressobj(9)
    packed = b"".join([packer.compress(b"\0" + row) for row in rows]) + packer.flush()
    header = struct.pack(">IIBBBBB", side, side, 8, 2, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", packed) + chunk(b"IEND", b"")


def terrain(side: int) -> tuple[array, array, array]:
    """Positions, normals and indices of a hilly square of 2 side^2 triangles, 20 units wide, about the origin."""
    wave = [math.sin(0.02 * i) for i in range(side + 1)]
    slope = [0.02 * math.cos(0.02 * i) * side / 20 for i in range(side + 1)]
    at = [20 * (i / side - 0.5) for i in range(side + 1)]
    positions, normals, indices = array("f"), array("f"), array("I")
    for y in range(side + 1):
        for x in range(side + 1):
            positions.extend((at[x], 0.1 * (wave[x] + wave[y]), at[y]))
            normals.extend((-0.1 * slope[x], 1.0, -0.1 * slope[y]))
    row = [i for x in range(side) for i in (x, x + side + 1, x + 1, x + 1, x + side + 1, x + side + 2)]
    for y in range(side):
        first = y * (side + 1)
        indices.extend([first + i for i in row])
    return positions, normals, indices


def scene(side: int, nodes: list[dict]) -> tuple[dict, list[array]]:
    """The terrain under these nodes, in sunlight, seen from above its near edge."""
    positions, normals, indices = terrain(side)
    count = (side + 1) ** 2
    nodes = nodes + [{"camera": 0, "translation": [0, 6, 16], "rotation": [-0.2, 0, 0, 0.98]},
                     {"extensions": {"KHR_lights_punctual": {"light": 0}}, "rotation": [-0.6, 0, 0, 0.8]}]
    root = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": list(range(len(nodes)))}], "nodes": nodes,
            "cameras": [{"type": "perspective", "perspective": {"yfov": 0.8, "znear": 0.1}}],
            "extensionsUsed": ["KHR_lights_punctual"],
            "extensions": {"KHR_lights_punctual": {"lights": [{"type": "directional", "intensity": 3}]}},
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "NORMAL": 1}, "indices": 2}]}],
            "accessors": [{"bufferView": 0, "componentType": 5126, "count": count, "type": "VEC3"},
                          {"bufferView": 1, "componentType": 5126, "count": count, "type": "VEC3"},
                          {"bufferView": 2, "componentType": 5125, "count": len(indices), "type": "SCALAR"}]}
    return root, [positions, normals, indices]


def many(count: int) -> list[dict]:
    """`count` small copies on a square, turned and stretched."""
    side = math.isqrt(count - 1) + 1
    return [{"mesh": 0, "translation": [20 * (i % side / side - 0.5), 0, 20 * (i // side / side - 0.5)],
             "rotation": [0, math.sin(i), 0, math.cos(i)], "scale": [0.002, 0.002 + 1e-7 * (i % 1000), 0.002]}
            for i in range(count)]


def pictured(side: int, *, flat: bool = False) -> tuple[dict, list[array]]:
    """Two triangles with a picture of side x side texels. `flat`: of one colour."""
    root, parts = scene(1, [{"mesh": 0}])
    root["meshes"][0]["primitives"][0]["material"] = 0
    root |= {"materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}], "textures": [{"source": 0}],
             "images": [{"bufferView": len(parts)}]}
    texels = bytes(3 * (side + 100)) if flat else random.Random(1).randbytes(3 * (side + 100))
    picture = png(side, (texels[y % 100 * 3:][:3 * side] for y in range(side)))
    return root, [*parts, array("B", picture + bytes(-len(picture) % 4))]


SCENES = {
    "10 million triangles, one mesh": lambda: scene(2237, [{"mesh": 0}]),
    "100,000 instances of 200 triangles": lambda: scene(10, many(100_000)),
    "a million instances of 2 triangles": lambda: scene(1, many(1_000_000)),
    "a PNG of 16384 x 16384 texels": lambda: pictured(16384),
}


def table(tool: Path, names: Iterable[str] = SCENES) -> list[list[str]]:
    """What lacuna-render measured of each scene, below a row of heads."""
    rows = [["scene", "file", *PHASES, "peak memory"]]
    with tempfile.TemporaryDirectory() as folder:
        glb, report = Path(folder) / "scene.glb", Path(folder) / "report.json"
        for name in names:
            write_glb(glb, *SCENES[name]())
            subprocess.run([tool, glb, "-o", Path(folder) / "picture.pfm", "--method", "pt", "--width", "64", "--height", "36",
                            "--iterations", "1", "--quiet", "--json", report], check=True, stdout=subprocess.DEVNULL)
            result = json.loads(report.read_text())
            rows.append([name, f"{glb.stat().st_size / 1e6:.0f} MB", *(f"{result['phases'][phase]:.2f} s" for phase in PHASES),
                         f"{result['peak_bytes'] / 1e6:.0f} MB"])
    return rows


def main() -> None:
    tool = Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "build/render/lacuna-render"
    print("\n".join(pages.table(table(tool))))


if __name__ == "__main__":
    main()
