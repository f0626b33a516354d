#!/usr/bin/env python3
"""Writes Lacuna's own scenes (.glb) and their sky (.hdr) beside this file; Python's standard library only.

The one scene that Blender exports is made by make_blender_scene.py; it is only checked here.

  python3 scenes/make_scenes.py            writes all files, after checking each
  python3 scenes/make_scenes.py --check    compares with the files that are there; exit 1 where they differ
  python3 scenes/make_scenes.py --table    prints the table of sizes for README.md

The same bytes come out on every machine: numbers are rounded to micrometres, nothing is compressed, nothing is random.
"""

from __future__ import annotations

import argparse
import math
import sys
from pathlib import Path

sys.dont_write_bytecode = True  # leave nothing behind in the source tree

from generator import pictures, scenes_interior, scenes_large, scenes_small, validate  # noqa: E402

HERE = Path(__file__).resolve().parent
TOTAL_LIMIT = 2_200_000  # bytes; the files are kept in the repository
EXPORTED = ("blender-still-life.glb",)  # by make_blender_scene.py: checked as they are, not made here


def make_sky() -> bytes:
    """Sun in front of the left side, 38 degrees high: it shines into windows in left walls."""
    elevation, azimuth = math.radians(38), math.radians(-62)  # azimuth from -Z towards +X
    sun = (math.cos(elevation) * math.sin(azimuth), math.sin(elevation), -math.cos(elevation) * math.cos(azimuth))
    return pictures.hdr(128, 64, pictures.sky(sun, (1700.0, 1540.0, 1250.0), 3.5))


def make_files() -> dict[str, bytes]:
    files = {"sky.hdr": make_sky()}
    for module in (scenes_small, scenes_interior, scenes_large):
        for build in module.SCENES:
            scene = build()
            files[f"{scene.name}.glb"] = scene.glb()
    for name in EXPORTED:
        files[name] = (HERE / name).read_bytes()
    return files


def problems(files: dict[str, bytes]) -> list[str]:
    found = [f"{name}: {problem}" for name, data in files.items() if name.endswith(".glb")
             for problem in validate.problems(data, set(files))]
    total = sum(len(data) for data in files.values())
    return found + ([f"all files: {total} bytes, the limit is {TOTAL_LIMIT}"] if total > TOTAL_LIMIT else [])


def differences(files: dict[str, bytes]) -> list[str]:
    there = {p.name for pattern in ("*.glb", "*.hdr") for p in HERE.glob(pattern)}
    found = [f"{name}: nothing makes it" for name in sorted(there - set(files))]
    for name, data in files.items():
        if name not in there:
            found.append(f"{name}: is missing; run scenes/make_scenes.py")
        elif (HERE / name).read_bytes() != data:
            found.append(f"{name}: differs from what scenes/make_scenes.py makes; run it")
    return found


def print_table(files: dict[str, bytes]) -> None:
    for name, data in files.items():
        if name.endswith(".glb"):
            glb = validate.Glb(data)
            extras = glb.json["scenes"][0]["extras"]
            size = extras["lacuna"]
            print(f"| {name} | {extras['description']} | {size['width']}x{size['height']}, {size['max_depth']} | "
                  f"{glb.triangles():,} ({glb.emissive_triangles():,}) | {len(data) / 1000:.0f} kB |")


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    mode = parser.add_mutually_exclusive_group()
    mode.add_argument("--check", action="store_true", help="compare with the files beside this script, write nothing")
    mode.add_argument("--table", action="store_true", help="print the rows of README.md's table, write nothing")
    options = parser.parse_args()

    files = make_files()
    complaints = problems(files) + (differences(files) if options.check else [])
    for complaint in complaints:
        print(complaint, file=sys.stderr)
    if complaints:
        return 1
    if options.table:
        print_table(files)
    elif not options.check:
        for name, data in files.items():
            (HERE / name).write_bytes(data)
        print(f"{len(files)} files, {sum(map(len, files.values())):,} bytes")
    return 0


if __name__ == "__main__":
    sys.exit(main())
