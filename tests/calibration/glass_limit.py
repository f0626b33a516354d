"""What only specular chains make of lights without a size, beside what other techniques make: writes a page of tests/results.

    python3 tests/calibration/glass_limit.py build/render/lacuna-render DIRECTORY PAGE

First a room of three metres, half of it behind a pane of solid glass. There are a lamp, a ball of glass below it, and a block.
The camera is in front of the pane, so that no edge of light through the ball can be joined. `pt` and `bpt` render the lamp as
a point, `bpt` also as a ball of the same power, with and without next event through glass.

Then a torus in a block of glass under a sun, which fills the picture. `pt` and `bpt` find the sun by chains. `ppm` makes the
same picture with photons within ever smaller radii. `pt` without chains makes it by eye subpaths that run into a sky with a
bright disk of the same irradiance.

The noise is the variance of a pixel times the seconds of rendering, for all pixels and without the noisiest hundredth.
DIRECTORY keeps scenes and pictures. Needs NumPy.
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
from generator import materials as m, pictures as painted  # noqa: E402
from generator.glb import SceneFile  # noqa: E402
from generator.mesh import box, quad, sphere, torus  # noqa: E402
from generator.vector import about_x, about_y, towards  # noqa: E402

SEEDS = (1, 2, 3, 4)
WITHOUT_CHAINS = ["--effect", "chains=off", "--effect", "refractions=off"]

INTENSITY = 3.0  # W/sr
ROOM = 3.0  # m
LAMP = (0.55, 2.6, -0.7)  # out of sight, as the ball of glass below it is: no lens sees a point
RADII = {"a hundredth": ROOM / 100, "a thirtieth": ROOM / 30}  # of the ball, as a share of the room
# The rows that render the point lamp, and those that render balls, with how many iterations:
OF_POINTS = {"pt": (48, ["--method", "pt"]), "bpt": (48, ["--method", "bpt"])}
OF_BALLS = {"bpt": (192, ["--method", "bpt"]), "bpt, refractions=off": (192, ["--method", "bpt", "--effect", "refractions=off"])}

IRRADIANCE = 3.0  # W/m^2, of the sun on what faces it
SUN = (-0.55, -1.0, -0.45)  # the way of its light
ANGLES = {"four degrees": 4.0, "two degrees": 2.0}  # how wide the disk in its place is
WIDTH, HEIGHT = 1440, 720  # pixels of the sky, a quarter of a degree each


def of_photons(radius):
    return 48, ["--method", "ppm", *WITHOUT_CHAINS, "--set", f"radius={radius}", "--set", "photons=400000"]


OF_SUN = {"pt": (96, ["--method", "pt"]), "bpt": (96, ["--method", "bpt"]), "ppm, 8 mm": of_photons(0.008),
          "ppm, 4 mm": of_photons(0.004), "ppm, 2 mm": of_photons(0.002)}
OF_WIDE_SUNS = {"pt, refractions=off, chains=off": (1024, ["--method", "pt", *WITHOUT_CHAINS])}


def area(mesh):
    corner = numpy.array(mesh.positions)
    a, b, c = (corner[[t[k] for t in mesh.triangles]] for k in range(3))
    return numpy.linalg.norm(numpy.cross(b - a, c - a), axis=1).sum() / 2


def room(radius):
    """The room; the lamp is a point where `radius` is 0."""
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


def cosine_to_sun(direction):
    return -sum(a * b for a, b in zip(SUN, direction)) / math.hypot(*SUN)


def rim(degrees):
    """cosine_to_sun at the rim of a disk that is so wide."""
    return math.cos(math.radians(degrees / 2))


def sky_of(degrees):
    return f"disk-{degrees}.hdr"


def paint_sky(degrees):
    """The disk has radiance 1, the rest is black."""
    return painted.hdr(WIDTH, HEIGHT, lambda direction: [float(cosine_to_sun(direction) > rim(degrees))] * 3)


def irradiance_of(degrees):
    """On a surface that faces the disk, summed up over the sky's pixels."""
    pixel = (math.pi / HEIGHT) * (2 * math.pi / WIDTH)  # sr, on the horizon
    directions = (painted.direction_of(x, y, WIDTH, HEIGHT) for y in range(HEIGHT) for x in range(WIDTH))
    return sum(pixel * math.hypot(d[0], d[2]) * cosine_to_sun(d) for d in directions if cosine_to_sun(d) > rim(degrees))


def block(degrees):
    """Torus in a block; the sun is so many degrees wide."""
    s = SceneFile("torus-limit", "Torus in a block of solid glass under a sun", 160, 90, 8)
    floor = s.material(m.lambert("floor", (0.62, 0.60, 0.56)))
    red = s.material(m.lambert("red", (0.75, 0.28, 0.16)))
    s.add("floor", quad((-3, 0, 3), (6, 0, 0), (0, 0, -6)), floor)
    s.add("block", box((-0.45, -0.3, -0.45), (0.45, 0.3, 0.45)), s.material(m.glass("glass")), at=(0, 0.3005, 0), turned=about_y(24))
    s.add("torus", torus(0.2, 0.075, 24, 12), red, at=(0, 0.31, 0), turned=about_x(62))
    if degrees:
        s.environment(sky_of(degrees), IRRADIANCE / irradiance_of(degrees))
    else:
        s.light("sun", "directional", IRRADIANCE, (1, 1, 1), turned=towards(SUN))
    s.camera((0.5, 1.25, 2.3), (0.0, 0.3, 0.0), 8.0)
    return s.glb()


def render(program, file, options, iterations, seed, target):
    subprocess.run([str(part) for part in [program, file, *options, "--iterations", iterations, "--seed", seed, "-o", target,
                                           "--json", target.with_suffix(".json"), "--quiet"]],
                   check=True, stdout=subprocess.DEVNULL)
    told = json.loads(target.with_suffix(".json").read_text())
    return pictures.pixels(target), told["seconds"] - told["setup_seconds"]


def relative_variance(found, mean):
    """Of each pixel, over the square of the picture's mean: what a pixel shows itself is as noisy."""
    return (numpy.var(found, axis=0, ddof=1) / mean.mean() ** 2).mean(axis=-1)


def measure(program, file, row, target):
    iterations, options = row
    found, seconds = zip(*(render(program, file, options, iterations, seed, target) for seed in SEEDS))
    means = [picture.mean() for picture in found]
    noise = numpy.sort(relative_variance(found, numpy.mean(found, axis=0)).ravel())
    spent = statistics.median(seconds)
    return {"mean": statistics.mean(means), "error": statistics.stdev(means) / math.sqrt(len(SEEDS)), "seconds": spent,
            "noise": noise.mean() * spent, "most": noise[:-len(noise) // 100].mean() * spent}


def line(lamp, name, iterations, found, first):
    off = (found["mean"] - first["mean"]) / first["mean"]
    times = [found[part] / first[part] for part in ("noise", "most")]
    return [lamp, name, iterations, f"{found['mean']:.5f}", f"{100 * found['error'] / found['mean']:.2g} %", f"{100 * off:+.2f} %",
            f"{found['seconds']:.1f}", f"{times[0]:.3g}", f"{times[1]:.3g}"]


def rows(program, directory, make, lamps):
    """Of a table: what each row makes of each lamp; `lamps`: by name, what `make` takes, and the rows."""
    lines, first = [], None
    for lamp, (size, of_lamp) in lamps.items():
        file = directory / f"{make.__name__}-{size}.glb"
        file.write_bytes(make(size))
        for name, row in of_lamp.items():
            found = measure(program, file, row, directory / "picture.pfm")
            first = first or found
            lines.append(line(lamp, name, row[0], found, first))
            print(*lines[-1], sep=" | ", flush=True)
    return lines


def main():
    program, directory, page = sys.argv[1:]
    directory = pathlib.Path(directory)
    directory.mkdir(parents=True, exist_ok=True)
    load = pages.load()
    for degrees in ANGLES.values():
        (directory / sky_of(degrees)).write_bytes(paint_sky(degrees))
    lamps = {"a point": (0, OF_POINTS)} | {name: (radius, OF_BALLS) for name, radius in RADII.items()}
    suns = {"a sun": (0, OF_SUN)} | {name: (angle, OF_WIDE_SUNS) for name, angle in ANGLES.items()}
    head = ["lamp", "row", "iterations", "mean", "standard error", "against the first line", "seconds", "noise, times", "without the worst"]
    pathlib.Path(page).write_text("\n".join([
        "# Lights without a size behind glass, seen through glass", "",
        *pages.origin("python3 tests/calibration/glass_limit.py build/render/lacuna-render DIRECTORY PAGE", load),
        f"160 x 90 pixels, {len(SEEDS)} seeds. Mean: of all pixels. Noise: the variance of a pixel over the squared mean, times the seconds,",
        "over that of the first line; then the same without the hundredth of the pixels that has the most. No figure of a paper.", "",
        "## A point light and a ball of glass behind a pane", "",
        "The lamp is a point, or a ball of the same power with a radius of so much of the room.", "",
        *pages.table([head, *rows(program, directory, room, lamps)]),
        "## A torus in a block of glass", "",
        "The sun is a direction, or a disk in the sky that is so wide and has the same irradiance. The radii of `ppm` are those of the first",
        "iteration: what it blurs changes the mean, and the less the smaller they are.", "",
        *pages.table([head, *rows(program, directory, block, suns)])]))


if __name__ == "__main__":
    main()
