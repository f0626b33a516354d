"""Counts what merging and search through glass cost scenes that need neither: writes a page of tests/results.

    python3 tests/calibration/switches.py build/render/lacuna-render DIRECTORY PAGE [SCENE ...]

Instructions of valgrind's callgrind are counted, not seconds: they do not depend on what else the machine does, and show
thousandths. Pictures with and without must have the same bytes. Without names of scenes: those of scenes/ that have no
smooth glass, no glass that is nearly smooth, and no mirror. DIRECTORY keeps caches; valgrind must be installed.
"""

import math
import pathlib
import re
import subprocess
import sys

import scenes

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1]))

import pages  # noqa: E402

POOL = ["candidates=300"]
TRAINED = POOL + ["train.paths=2000", "train.subspaces=20", "train.light_paths=4000"]
MERGING = {"lvcbpt": POOL, "risbpt": POOL, "tsrbpt": POOL, "spcbpt": TRAINED, "sharebpt": TRAINED}
SEARCHING = {"pt": [], "bpt": [], "spcbpt": TRAINED}
SWITCHES = ("chains", "refractions")
SIZE = "64x36"
ITERATIONS = 8
NEEDED_BY = re.compile(r"^simulated +(mirror|smooth_refraction|rough_refraction|smooth_thin_transmission) ", re.MULTILINE)


def needs_neither(program, scene):
    effects = subprocess.run([program, *scene, "--effects"], check=True, capture_output=True, text=True).stdout
    return not NEEDED_BY.search(effects)


def instructions(command):
    """Of the whole process, reading and setup counted."""
    found = subprocess.run(["valgrind", "--tool=callgrind", "--callgrind-out-file=/dev/null", *map(str, command)],
                           check=True, capture_output=True, text=True)
    return int(re.search(r"Collected : (\d+)", found.stderr)[1])


def ratio(program, directory, name, scene, row, settings, without, with_it):
    """Instructions with over those without. Fails if the two pictures differ."""
    picture = directory / "out.pfm"
    command = [program, *scene, "--method", row, *(word for text in settings for word in ("--set", text)),
               "--size", SIZE, "--iterations", ITERATIONS, "--threads", 1, "--quiet", "--cache", directory / name,
               "-o", picture]
    subprocess.run([*map(str, command), "--prepare"], check=True, stderr=subprocess.DEVNULL)  # caches are not counted
    before, old = instructions([*command, *without]), picture.read_bytes()
    after, new = instructions([*command, *with_it]), picture.read_bytes()
    if old != new:
        raise SystemExit(f"{name}, {row}, {' '.join(with_it)}: expected the picture that is made without, found another")
    return after / before


def rows_of(program, directory, name, scene):
    for row, settings in MERGING.items():
        yield f"{row}, merge=on", ratio(program, directory, name, scene, row, settings, ["--set", "merge=off"],
                                        ["--set", "merge=on"])
    off = [word for switch in SWITCHES for word in ("--effect", f"{switch}=off")]
    for row, settings in SEARCHING.items():
        yield f"{row}, {' and '.join(SWITCHES)}", ratio(program, directory, name, scene, row, settings, off, [])


def main():
    program, directory, target, *names = sys.argv[1:]
    load = pages.load()
    directory = pathlib.Path(directory)
    directory.mkdir(parents=True, exist_ok=True)
    ours = sorted(path.stem for path in pathlib.Path(__file__).parents[2].glob("scenes/*.glb"))
    found = {}
    for name, scene in scenes.of(ours, [], names).items():
        if not needs_neither(program, scene):
            continue
        for row, value in rows_of(program, directory, name, scene):
            found.setdefault(row, {})[name] = value
            print(f"{name} | {row} | {value:.5f}", flush=True)
    chosen = list(next(iter(found.values())))
    ratios = [value for by_scene in found.values() for value in by_scene.values()]
    lines = ["# What merging and search through glass cost scenes that need neither", "",
             *pages.origin(f"python3 tests/calibration/switches.py {program} DIRECTORY PAGE", load),
             f"Instructions with, over those without, of whole processes by valgrind's callgrind: {SIZE} pixels, {ITERATIONS} "
             "iterations, one",
             "thread, caches read. Pictures with and without have the same bytes. No scene has smooth glass, glass that is nearly",
             "smooth, or a mirror. No figure of a paper.", "",
             *pages.table([["scene", *found], *([name, *(f"{by[name]:.4f}" for by in found.values())] for name in chosen)]),
             f"Geometric mean {math.exp(sum(map(math.log, ratios)) / len(ratios)):.4f}, largest {max(ratios):.4f}."]
    pathlib.Path(target).write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
