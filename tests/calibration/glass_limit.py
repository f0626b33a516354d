"""Compares a point light behind glass, seen through glass, with lamps that shrink to it: writes a page of tests/results.

    python3 tests/calibration/glass_limit.py build/render/lacuna-render DIRECTORY PAGE

A room of three metres, half of it behind a pane of solid glass. There are a lamp, a ball of glass below it, and a block. The
camera is in front of the pane, so that no edge of light through the ball can be joined. `pt` and `bpt` render the lamp as a
point, `bpt` also as a ball of the same power, with and without next event through glass. The noise is the variance of a
pixel times the seconds of rendering, for all pixels and without the noisiest hundredth. DIRECTORY keeps scenes and pictures.
Needs NumPy.
"""

import datetime
import json
import math
import pathlib
import statistics
import subprocess
import sys

import numpy

import pictures

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "scenes"), str(ROOT / "tests")]

import pages  # noqa: E402
from generator import materials as m  # noqa: E402
from generator.glb import SceneFile  # noqa: E402
from generator.mesh import box, sphere  # noqa: E402
from generator.vector import about_y  # noqa: E402

INTENSITY = 3.0  # W/sr
ROOM = 3.0  # m
LAMP = (0.55, 2.6, -0.7)  # out of sight, as the ball of glass below it is: no lens sees a point
RADII = {"a hundredth": ROOM / 100, "a thirtieth": ROOM / 30}  # of the ball, as a share of the room
SEEDS = (1, 2, 3, 4)
ITERATIONS = 48
# The rows that render the point lamp, and those that render balls:
OF_POINTS = {"pt": ["--method", "pt"], "bpt": ["--method", "bpt"]}
OF_BALLS = {"bpt": ["--method", "bpt"], "bpt, refractions=off": ["--method", "bpt", "--effect", "refractions=off"]}


def area(mesh):
    corner = numpy.array(mesh.positions)
    a, b, c = (corner[[t[k] for t in mesh.triangles]] for k in range(3))
    return numpy.linalg.norm(numpy.cross(b - a, c - a), axis=1).sum() / 2


def scene(radius):
    """The scene; its lamp is a point if `radius` is 0."""
    s = SceneFile("glass-limit", "Lamp, ball of glass and block behind a pane of solid glass", 160, 90, 8)
    wall = s.material(m.lambert("wall", (0.6, 0.6, 0.55)))
    blue = s.material(m.lambert("blue", (0.2, 0.3, 0.6)))
    glass = s.material(m.glass("glass"))
    half = ROOM / 2
    s.add("room", box((-half, 0, -half), (half, ROOM, half), inward=True), wall)
    s.add("pane", box((-half - 0.1, -0.1, 0.2), (half + 0.1, ROOM + 0.1, 0.25)), glass)
    s.add("ball", sphere(0.3, 24, 48), glass, at=(0.3, 2.0, -0.7))
    s.add("block", box((-0.25, 0, -0.25), (0.25, 0.7, 0.25)), blue, at=(-0.6, -0.002, -0.5), turned=about_y(25))
    if radius:
        ball = sphere(radius, 8, 16)
        side = 4 * INTENSITY / area(ball)
        s.add("lamp", ball, s.material(m.emitter("lamp", (side, side, side))), at=LAMP)
    else:
        s.light("lamp", "point", INTENSITY, (1, 1, 1), at=LAMP)
    s.camera((0.0, 1.3, 1.45), (0.0, 0.6, -0.7), 40.0)
    return s.glb()


def render(program, file, options, seed, target):
    subprocess.run([str(part) for part in [program, file, *options, "--iterations", ITERATIONS, "--seed", seed, "-o", target,
                                           "--json", target.with_suffix(".json"), "--quiet"]],
                   check=True, stdout=subprocess.DEVNULL)
    told = json.loads(target.with_suffix(".json").read_text())
    return pictures.pixels(target), told["seconds"] - told["setup_seconds"]


def relative_variance(found, mean):
    """The variance of each pixel over the square of the picture's mean. (A pixel's own mean is too noisy.)"""
    return (numpy.var(found, axis=0, ddof=1) / mean.mean() ** 2).mean(axis=-1)


def measure(program, file, options, target):
    found, seconds = zip(*(render(program, file, options, seed, target) for seed in SEEDS))
    means = [picture.mean() for picture in found]
    noise = numpy.sort(relative_variance(found, numpy.mean(found, axis=0)).ravel())
    spent = statistics.median(seconds)
    return {"mean": statistics.mean(means), "error": statistics.stdev(means) / math.sqrt(len(SEEDS)), "seconds": spent,
            "noise": noise.mean() * spent, "most": noise[:-len(noise) // 100].mean() * spent}


def line(lamp, row, found, limit):
    times = [found[part] / limit[part] for part in ("noise", "most")]
    return (f"| {lamp} | {row} | {found['mean']:.5f} | {found['error']:.5f} | {found['seconds']:.1f} | {found['noise']:.3g} "
            f"| {times[0]:.3g} | {times[1]:.3g} |")


def main():
    program, directory, page = sys.argv[1:]
    directory = pathlib.Path(directory)
    directory.mkdir(parents=True, exist_ok=True)
    lamps = [("a point", 0, OF_POINTS)] + [(name, radius, OF_BALLS) for name, radius in RADII.items()]
    lines, limit = [], None
    for lamp, radius, rows in lamps:
        file = directory / f"{lamp.replace(' ', '-')}.glb"
        file.write_bytes(scene(radius))
        for row, options in rows.items():
            found = measure(program, file, options, directory / "picture.pfm")
            limit = limit or found
            lines.append(line(lamp, row, found, limit))
            print(lines[-1], flush=True)
    pathlib.Path(page).write_text("\n".join([
        "# A point light behind glass, seen through glass", "",
        f"By `python3 tests/calibration/glass_limit.py`, {datetime.date.today()}, commit {pages.commit()}, on {pages.machine()}: {ITERATIONS} iterations,",
        f"160 x 90 pixels, {len(SEEDS)} seeds. The lamp is a point, or a ball of the same power with a radius of so much of the room. Mean: of all",
        "pixels, with its standard error. Noise: the variance of a pixel over the squared mean, times the seconds; then over that of",
        "the first line, and the same without the hundredth of the pixels that has the most. No figure of a paper.", "",
        "| lamp | row | mean | error | seconds | noise | times | without the worst |", "|---" * 8 + "|", *lines, ""]))


if __name__ == "__main__":
    main()
