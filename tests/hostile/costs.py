#!/usr/bin/env python3
"""What a scene of a stranger costs until it is refused: processor time and memory for each of its bytes; Python's standard library only.

  python3 tests/hostile/costs.py build                                a page of tests/results, with the day in its name
  python3 tests/hostile/costs.py build /tmp/page.md --megabytes 1

The files are refused as late as their kind allows. Exits 1 if one took more memory than a gigabyte and 8 kB for each of its bytes.
"""

from __future__ import annotations

import argparse
import datetime
import json
import math
import multiprocessing
import os
import random
import shlex
import struct
import subprocess
import sys
import tempfile
import zlib
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.append(str(ROOT / "tests"))

import pages  # noqa: E402

FREE, PER_BYTE = 1 << 30, 1 << 13  # bytes of memory that a file may take, and for each of its own
HEAD = b'{"asset":{"version":"2.0"},'
CYCLE = b'"nodes":[{"children":[0]}]}'  # found once all is parsed


def glb(root: dict, binary: bytes) -> bytes:
    text = json.dumps(root | {"asset": {"version": "2.0"}, "buffers": [{"byteLength": len(binary)}]}).encode()
    text += b" " * (-len(text) % 4)
    binary += bytes(-len(binary) % 4)
    return (struct.pack("<4sIIII", b"glTF", 2, 28 + len(text) + len(binary), len(text), 0x4E4F534A) + text +
            struct.pack("<II", len(binary), 0x004E4942) + binary)


def flat_png(side: int) -> bytes:
    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = struct.pack(">IIBBBBB", side, side, 8, 2, 0, 0, 0)
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(bytes(side * (3 * side + 1)), 9)) +
            chunk(b"IEND", b""))


def triangles(number: int, picture: bytes = b"") -> bytes:
    """A mesh whose last index is wrong, which is found behind the pictures."""
    indices = bytes(12 * number - 4) + b"\xff\xff\xff\0"
    sizes = [36, len(indices), len(picture)]
    root = {
        "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, **({"material": 0} if picture else {})}]}],
        "bufferViews": [{"buffer": 0, "byteOffset": sum(sizes[:i]), "byteLength": size} for i, size in enumerate(sizes)],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"},
                      {"bufferView": 1, "componentType": 5125, "count": 3 * number, "type": "SCALAR"}],
    }
    if picture:
        root |= {"images": [{"bufferView": 2}], "textures": [{"source": 0}],
                 "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}]}
    return glb(root, bytes(36) + indices + picture)


@dataclass(frozen=True)
class Kind:
    name: str
    largest: float  # megabytes; a larger file would take gigabytes, or be refused for its size
    make: Callable[[int], bytes]  # a file of about that many bytes


KINDS = [
    Kind("no scene: random bytes", 100, lambda size: random.Random(1).randbytes(size)),
    Kind("triangles, the last one wrong", 100, lambda size: triangles(size // 12)),
    Kind("a PNG of one colour, a triangle wrong", 0.1, lambda size: triangles(1, flat_png(math.isqrt(size * 1000 // 3)))),
    Kind("JSON of numbers, cut off", 100, lambda size: HEAD + b'"extras":[' + b"0," * (size // 2)),
    Kind("JSON of empty objects, cut off", 100, lambda size: HEAD + b'"extras":[' + b"{}," * (size // 3)),
    Kind("empty nodes, and two parents of one", 10,
         lambda size: HEAD + b'"nodes":[' + b"{}," * (size // 3) + b'{"children":[0]},{"children":[0]}]}'),
    Kind("empty meshes, nodes in a cycle", 10, lambda size: HEAD + b'"meshes":[' + b"{}," * (size // 3) + b"{}]," + CYCLE),
    Kind("empty materials, nodes in a cycle", 1, lambda size: HEAD + b'"materials":[' + b"{}," * (size // 3) + b"{}]," + CYCLE),
]


@dataclass(frozen=True)
class Cost:
    kind: str
    size: int
    exit: int
    seconds: float
    memory: int

    @property
    def wrong(self) -> list[str]:
        found = [] if self.exit == 3 else [f"exit code {self.exit}, expected 3"]
        if self.memory > FREE + PER_BYTE * self.size:
            found.append(f"took {self.memory} bytes of memory")
        return [f"{self.size} bytes, {self.kind}: {w}" for w in found]


def cost(tool: Path, kind: Kind, size: int) -> Cost:
    with tempfile.TemporaryDirectory() as folder:
        scene = Path(folder) / "scene.glb"
        # Not in this process: the memory of a program begins with that of the process which starts it.
        maker = multiprocessing.Process(target=lambda: scene.write_bytes(kind.make(size)))
        maker.start()
        maker.join()
        process = subprocess.Popen([tool, scene, "-o", Path(folder) / "picture.pfm", "--method", "pt", "--quiet"],
                                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        size = scene.stat().st_size
    return Cost(kind.name, size, process.returncode, usage.ru_utime + usage.ru_stime, usage.ru_maxrss * 1024)


def costs(tool: Path, megabytes: list[float]) -> list[Cost]:
    return [cost(tool, kind, int(size * 1e6)) for kind in KINDS for size in sorted({min(m, kind.largest) for m in megabytes})]


def run(attack) -> tuple[dict[str, int], list[str]]:
    """As the other attacks of run.py."""
    found = costs(Path(attack.program("lacuna-render")), [1])
    return {"costs of refusals": len(found)}, [wrong for c in found for wrong in c.wrong]


def table(start: Cost, found: list[Cost]) -> list[list[str]]:
    """`start`: of an empty file."""
    return [["file", "size, MB", "seconds", "memory, MB", "ns for each byte", "bytes for each byte"],
            *([c.kind, f"{c.size / 1e6:.3g}", f"{c.seconds:.2f}", f"{c.memory / 1e6:.0f}",
               f"{(c.seconds - start.seconds) / c.size * 1e9:.3g}", f"{(c.memory - start.memory) / c.size:.3g}"] for c in found)]


def text(start: Cost, found: list[Cost], command: str) -> str:
    return "\n".join([
        "# Costs of refusals", "",
        *pages.table([["", ""], ["date", datetime.date.today()], ["commit", pages.commit()], ["machine", pages.machine()],
                      ["load after", Path("/proc/loadavg").read_text().split()[0]], ["command", f"`{command}`"]]),
        f"What `lacuna-render` takes until it refuses a scene, by `tests/hostile/costs.py`: processor time and memory at the peak. An empty "
        f"file takes {start.seconds:.2f} s and {start.memory / 1e6:.0f} MB, which are not counted for each byte.", "",
        *pages.table(table(start, found))])


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=Path)
    parser.add_argument("page", type=Path, nargs="?", help="file to write (in tests/results, with the day in its name)",
                        default=ROOT / f"tests/results/refusals-{datetime.date.today()}.md")
    parser.add_argument("--megabytes", type=float, nargs="+", default=[1, 10, 100])
    options = parser.parse_args()
    tool = options.build / "render/lacuna-render"
    start, found = cost(tool, Kind("nothing", 0, lambda size: b"{"), 0), costs(tool, options.megabytes)
    command = shlex.join(["python3", "tests/hostile/costs.py", *sys.argv[1:]])
    options.page.write_text(text(start, found, command))
    wrong = [w for c in found for w in c.wrong]
    print(*wrong, sep="\n", end="\n" if wrong else "")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
