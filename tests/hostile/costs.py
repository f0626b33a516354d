#!/usr/bin/env python3
"""What a scene of a stranger costs until it is refused: processor time and memory for each of its bytes; Python's standard library only.

  python3 tests/hostile/costs.py build                                a page of tests/results, with the day in its name
  python3 tests/hostile/costs.py build /tmp/page.md --megabytes 1

The files are refused as late as their kind allows. Exits 1 if one took more memory than a gigabyte and 8 kB for each of its bytes.
"""

from __future__ import annotations

import argparse
import datetime
import math
import multiprocessing
import os
import random
import shlex
import subprocess
import sys
import tempfile
from array import array
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path += [str(ROOT / "tests"), str(ROOT / "tests/benchmarks")]

import large_scenes  # noqa: E402
import pages  # noqa: E402

FREE, PER_BYTE = 1 << 30, 1 << 13  # bytes of memory that a file may take, and for each of its own
CYCLE = b'"nodes":[{"children":[0]}]}'  # found once all is parsed


def triangles(path: Path, number: int, side: int = 0) -> None:
    """A mesh whose last index is wrong, which is found behind the picture of side x side texels."""
    root, parts = large_scenes.pictured(side, flat=True) if side else large_scenes.scene(1, [{"mesh": 0}])
    root["accessors"][2]["count"] = 3 * number
    parts[2] = array("I", bytes(12 * number))
    parts[2][-1] = 4
    large_scenes.write_glb(path, root, parts)


def text_file(begin: bytes, repeated: bytes, end: bytes = b"") -> Callable[[Path, int], None]:
    def write(path: Path, size: int) -> None:
        path.write_bytes(b'{"asset":{"version":"2.0"},' + begin + repeated * (size // len(repeated)) + end)

    return write


@dataclass(frozen=True)
class Kind:
    name: str
    largest: float  # megabytes; a larger file would take gigabytes, or be refused for its size
    write: Callable[[Path, int], None]  # a file of about that many bytes


KINDS = [
    Kind("no scene: random bytes", 100, lambda path, size: path.write_bytes(random.Random(1).randbytes(size))),
    Kind("triangles, the last one wrong", 100, lambda path, size: triangles(path, size // 12)),
    Kind("a PNG of one colour, a triangle wrong", 0.1, lambda path, size: triangles(path, 1, math.isqrt(size * 1000 // 3))),
    Kind("JSON of numbers, cut off", 100, text_file(b'"extras":[', b"0,")),
    Kind("JSON of empty objects, cut off", 100, text_file(b'"extras":[', b"{},")),
    Kind("empty nodes, and two parents of one", 10, text_file(b'"nodes":[', b"{},", b'{"children":[0]},{"children":[0]}]}')),
    Kind("empty meshes, nodes in a cycle", 10, text_file(b'"meshes":[', b"{},", b"{}]," + CYCLE)),
    Kind("empty materials, nodes in a cycle", 1, text_file(b'"materials":[', b"{},", b"{}]," + CYCLE)),
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
        maker = multiprocessing.Process(target=kind.write, args=(scene, size))
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
    """Like the other attacks of run.py."""
    found = costs(Path(attack.program("lacuna-render")), [1])
    return {"costs of refusals": len(found)}, [wrong for c in found for wrong in c.wrong]


def table(start: Cost, found: list[Cost]) -> list[list[str]]:
    """`start`: the cost of a file of one byte."""
    return [["file", "size, MB", "seconds", "memory, MB", "ns for each byte", "bytes for each byte"],
            *([c.kind, f"{c.size / 1e6:.3g}", f"{c.seconds:.2f}", f"{c.memory / 1e6:.0f}",
               f"{(c.seconds - start.seconds) / c.size * 1e9:.3g}", f"{(c.memory - start.memory) / c.size:.3g}"] for c in found)]


def text(start: Cost, found: list[Cost], load: str, command: str) -> str:
    return "\n".join([
        "# Costs of refusals", "",
        *pages.origin(command, load),
        f"What `lacuna-render` takes until it refuses a scene, by `tests/hostile/costs.py`: processor time and memory at the peak. A file of "
        f"one byte takes {start.seconds:.2f} s and {start.memory / 1e6:.0f} MB, which are not counted for each byte.", "",
        *pages.table(table(start, found))])


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=Path)
    parser.add_argument("page", type=Path, nargs="?", help="file to write (in tests/results, with the day in its name)",
                        default=ROOT / f"tests/results/refusals-{datetime.date.today()}.md")
    parser.add_argument("--megabytes", type=float, nargs="+", default=[1, 10, 100])
    options = parser.parse_args()
    tool = options.build / "render/lacuna-render"
    load = pages.load()
    start, found = cost(tool, Kind("nothing", 0, lambda path, size: path.write_bytes(b"{")), 0), costs(tool, options.megabytes)
    command = shlex.join(["python3", "tests/hostile/costs.py", *sys.argv[1:]])
    options.page.write_text(text(start, found, load, command))
    wrong = [w for c in found for w in c.wrong]
    print(*wrong, sep="\n", end="\n" if wrong else "")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
