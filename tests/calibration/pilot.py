"""Measures what a pilot with few pixels says about a picture with many: writes a page of tests/results.

    python3 tests/calibration/pilot.py build/render/lacuna-render DIRECTORY PAGE [SCENE ...]

Renders each scene in three sizes by bpt, whose pixels are independent, and by sharebpt, whose pixels share what they find,
with equal numbers of iterations. The noise is the mean relative distance of pictures of different seeds. The sizes give
`alike` of render/choose/choose.cpp: the power of the number of pixels by which sharebpt's variance falls faster than bpt's.
Iterations count, not seconds, so a busy machine changes nothing. DIRECTORY keeps the training. Needs NumPy. Without names
of scenes: some of scenes/, and those of $LACUNA_SHARED_SCENES, if that is set.
"""

import datetime
import itertools
import pathlib
import statistics
import subprocess
import sys

import numpy

import pictures
import scenes

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1]))

import pages  # noqa: E402

OURS = ("classroom-windows", "court", "door", "drapery-hall", "glossy-room", "kitchen-glass", "nave", "bedroom-curtain")
SHARED = ("classroom", "staircase", "kitchen-su22", "sponza-crytek", "veach-bidir", "veach-mis")
SIZES = ((40, 22), (160, 90), (640, 360))
ITERATIONS = 4
SEEDS = (1, 2, 3, 4)
SMOOTHED = 5     # pixels, square
EPSILON = 0.01   # of the mean, as of mape
TRAINED = ["--prepare", "--set", "candidates=10000", "--set", "train.paths=16000", "--set", "train.subspaces=90",
           "--set", "train.light_paths=68000", "--set", "train.epochs=5"]
ROWS = {"bpt": [], "sharebpt": TRAINED}


def smoothed(picture):
    reach = SMOOTHED // 2
    padded = numpy.pad(picture, ((reach, reach), (reach, reach), (0, 0)), mode="edge")
    windows = numpy.lib.stride_tricks.sliding_window_view(padded, (SMOOTHED, SMOOTHED), axis=(0, 1))
    return windows.mean(axis=(-1, -2))


def rendered(program, directory, scene, size, row):
    target = directory / "picture.pfm"
    for seed in SEEDS:
        subprocess.run([str(part) for part in [
            program, *scene, "--method", row, *ROWS[row], "--cache", directory / "caches" / scene[0].stem, "--width", size[0],
            "--height", size[1], "--iterations", ITERATIONS, "--sampler", "sobol", "--seed", seed, "-o", target, "--quiet"]],
            check=True, stdout=subprocess.DEVNULL)
        yield pictures.pixels(target)


def noises(program, directory, scene, size):
    """The noise of each row, relative to the mean of all pictures."""
    by_row = {row: list(rendered(program, directory, scene, size, row)) for row in ROWS}
    mean = numpy.mean([p for of in by_row.values() for p in of], axis=0)
    over = smoothed(mean) + EPSILON * mean.mean()
    return {row: statistics.mean((abs(a - b) / over).mean() for a, b in itertools.combinations(of, 2)) / 2 ** 0.5
            for row, of in by_row.items()}


def measure(program, directory, scene):
    """Noises by size, sharebpt's gains, and the power from the smallest size to the largest."""
    by_size = [noises(program, directory, scene, size) for size in SIZES]
    gains = [(n["bpt"] / n["sharebpt"]) ** 2 for n in by_size]
    ratio = SIZES[-1][0] * SIZES[-1][1] / (SIZES[0][0] * SIZES[0][1])
    return by_size, gains, numpy.log(gains[-1] / gains[0]) / numpy.log(ratio)


def main():
    program, directory, page, *names = sys.argv[1:]
    directory = pathlib.Path(directory)
    directory.mkdir(parents=True, exist_ok=True)
    lines, powers = [], []
    for name, scene in scenes.of(OURS, SHARED, names).items():
        by_size, gains, power = measure(program, directory, scene)
        powers.append(power)
        noise = " | ".join(f"{n['bpt']:.3f} | {n['sharebpt']:.3f}" for n in by_size)
        lines.append(f"| {name} | {noise} | {' | '.join(f'{g:.2f}' for g in gains)} | {power:.3f} |")
        print(lines[-1], flush=True)
    sizes = [f"{w} x {h}" for w, h in SIZES]
    head = [f"{row}, {size}" for size in sizes for row in ROWS] + [f"gain, {size}" for size in sizes]
    pathlib.Path(page).write_text("\n".join([
        "# What a pilot in few pixels tells of a picture in many", "",
        f"By `python3 tests/calibration/pilot.py`, {datetime.date.today()}, commit {pages.commit()}, on {pages.machine()}. After",
        f"{ITERATIONS} iterations with even numbers: the mean relative distance of pictures of {len(SEEDS)} seeds, over the square root",
        "of 2; the gain is the ratio of bpt's variance to sharebpt's; the power is that of the number of pixels by which the gain",
        "grows from the smallest size to the largest. No figure of a paper.", "",
        f"The median of the powers is {statistics.median(powers):.3f}, the least {min(powers):.3f}, the largest {max(powers):.3f}.", "",
        f"| scene | {' | '.join(head)} | power |", "|---" * (len(head) + 2) + "|", *lines, ""]))


if __name__ == "__main__":
    main()
