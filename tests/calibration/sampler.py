"""Measures the gain of --sampler sobol over --sampler independent: writes a page of tests/results.

    python3 tests/calibration/sampler.py build/render/lacuna-render DIRECTORY PAGE [SCENE ...]

Errors are taken after equal numbers of iterations, which do not depend on what else the machine
does: medians of ratios over seeds, each against a long render of another seed. Costs are processor
seconds of the process, measured in turn. DIRECTORY keeps the results, and a repeated call continues
from them. Without names of scenes: those of scenes/ and of $LACUNA_SHARED_SCENES, if that is set.
"""

import datetime
import json
import math
import pathlib
import resource
import statistics
import subprocess
import sys

import scenes

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1]))

import pages  # noqa: E402

OURS = ("blender-still-life", "court", "cornell-box", "light-environment", "classroom-windows",
        "glossy-room", "kitchen-glass", "nave", "drapery-hall", "bedroom-curtain", "door",
        "ring-caustic")
SHARED = ("veach-mis", "veach-bidir", "staircase", "classroom", "door-pg2015")
OPEN = {"blender-still-life", "court", "light-environment", "cornell-box", "veach-mis"}
SAMPLERS = ("independent", "sobol")
SIZE = ["--width", "64", "--height", "36"]
POOL = ["--set", "candidates=1000"]
TRAINED = ["--prepare", "--set", "train.paths=50000", "--set", "train.subspaces=100", "--set",
           "train.light_paths=100000"]
ROWS = {"pt": [], "bpt": [], "risbpt": POOL + ["--set", "cache_density=0.01"],
        "spcbpt": POOL + TRAINED}
ITERATIONS = (4, 16, 64)
SEEDS = (1, 2, 3)
REFERENCE = ["--method", "spcbpt", *ROWS["spcbpt"], "--iterations", "2048", "--seed", "1000001",
             "--sampler", "independent"]
COST_SCENES = ("blender-still-life", "court", "door")
COST_ITERATIONS = 16
COST_ROUNDS = 3


def render(program, arguments):
    subprocess.run([program, *map(str, arguments), "--quiet"], check=True,
                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def reference(program, directory, name, scene):
    target = directory / "references" / f"{name}.exr"
    if not target.exists():
        target.parent.mkdir(parents=True, exist_ok=True)
        render(program, [*scene, "-o", target, *SIZE, *REFERENCE, "--cache", directory / "caches" / name])
        print(f"{name}: reference", file=sys.stderr, flush=True)
    return target


def errors(program, directory, name, scene, row, sampler, iterations, seed):
    """mape and relmse of one render."""
    report = directory / "runs" / f"{name}-{row}-{sampler}-{iterations}-{seed}.json"
    if not report.exists():
        report.parent.mkdir(parents=True, exist_ok=True)
        partial = report.with_suffix(".part")
        render(program, [*scene, "-o", directory / "out.exr", *SIZE, "--method", row, *ROWS[row],
                         "--cache", directory / "caches" / name, "--sampler", sampler, "--iterations", iterations,
                         "--seed", seed, "--reference", reference(program, directory, name, scene),
                         "--json", partial])
        partial.rename(report)
    found = json.loads(report.read_text())["error"]
    return found["mape"], found["relmse"]


def mean(values):
    values = list(values)
    return math.exp(sum(map(math.log, values)) / len(values))


def measure(program, directory, chosen):
    """The errors of all seeds, by scene, row and iterations, then by sampler."""
    found = {}
    for name, scene in chosen.items():
        for row in ROWS:
            for n in ITERATIONS:
                for seed in SEEDS:
                    for sampler in SAMPLERS:
                        found.setdefault((name, row, n), {}).setdefault(sampler, []).append(
                            errors(program, directory, name, scene, row, sampler, n, seed))
        print(f"{name}: measured", file=sys.stderr, flush=True)
    return found


def gain(of, measure_, power):
    """How much longer independent numbers take, as time is error^-power: median over seeds, lowest, highest."""
    a, b = ([e[measure_] for e in of[s]] for s in SAMPLERS)
    ratios = [(x / y) ** power for x, y in zip(a, b)]
    return statistics.median(ratios), min(ratios), max(ratios)


def seconds(program, arguments):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    render(program, [*arguments, "--threads", "1"])
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime - before.ru_utime


def costs(program, directory, chosen):
    """Ratios of processor seconds per iteration, sobol over independent, by scene and row."""
    kept = directory / "costs.json"
    found = json.loads(kept.read_text()) if kept.exists() else {}
    for name in (n for n in COST_SCENES if n in chosen):
        for row in ROWS:
            ratios = found.setdefault(f"{name} {row}", [])
            while len(ratios) < COST_ROUNDS:
                spent = {}
                for sampler in SAMPLERS if len(ratios) % 2 else reversed(SAMPLERS):
                    common = [*chosen[name], "-o", directory / "out.exr", "--width", 128, "--height", 72,
                              "--method", row, *ROWS[row], "--cache", directory / "caches" / name,
                              "--sampler", sampler, "--iterations"]
                    spent[sampler] = (seconds(program, [*common, COST_ITERATIONS + 1]) -
                                      seconds(program, [*common, 1]))
                ratios.append(spent["sobol"] / spent["independent"])
                kept.write_text(json.dumps(found))
        print(f"{name}: costs", file=sys.stderr, flush=True)
    return found


def slope(found, name, row, sampler):
    """The slope of log error over log iterations, from the first to the last."""
    first, last = (statistics.median(e[0] for e in found[name, row, n][sampler])
                   for n in (ITERATIONS[0], ITERATIONS[2]))
    return math.log(last / first) / math.log(ITERATIONS[2] / ITERATIONS[0])


def page(found, spent, chosen, command):
    lines = [
        "# Even numbers: what --sampler sobol is worth", "",
        f"Date {datetime.date.today()}, commit {pages.commit()}, {pages.machine()}. `{command}`.", "",
        f"{' x '.join(SIZE[1::2])} pixels, seeds {', '.join(map(str, SEEDS))}, each against 2048 iterations of "
        "`spcbpt` with independent numbers and another seed. A figure says how much longer "
        "independent numbers take to the error of even ones, iterations for iterations (mape^-2): "
        "the median over seeds, its lowest and highest. After one iteration there is no "
        "difference: an iteration alone has the same distribution. Pools have 1000 light "
        "subpaths, risbpt few cache points, spcbpt 100 subspaces, so that all this takes minutes.", ""]
    for n in ITERATIONS:
        lines += [f"## After {n} iterations, mape", "",
                  "| scene | " + " | ".join(ROWS) + " |", "|---" * (len(ROWS) + 1) + "|"]
        for name in chosen:
            cells = ["%.2f (%.2f to %.2f)" % gain(found[name, row, n], 0, 2) for row in ROWS]
            lines.append(f"| {name} | " + " | ".join(cells) + " |")
        overall = [mean(gain(found[name, row, n], 0, 2)[0] for name in chosen) for row in ROWS]
        lines.append("| geometric mean | " + " | ".join("%.3f" % g for g in overall) + " |")
        opens = [name for name in chosen if name.removesuffix(" (shared)") in OPEN]
        if opens:
            of = [mean(gain(found[name, row, n], 0, 2)[0] for name in opens) for row in ROWS]
            lines.append("| of scenes with lamps or sky in plain sight | " +
                         " | ".join("%.3f" % g for g in of) + " |")
        worst = min((gain(found[name, row, n], 0, 2)[0], name, row) for name in chosen for row in ROWS)
        lines += ["", "Of all %.3f; the least %.2f (%s, %s)." % (mean(overall), *worst), ""]
    lines += ["## relmse, geometric means over the scenes", "",
              "Rare bright paths carry much of it; a mean over scenes says more than a scene.", "",
              "| iterations | " + " | ".join(ROWS) + " |", "|---" * (len(ROWS) + 1) + "|"]
    for n in ITERATIONS:
        of = [mean(gain(found[name, row, n], 1, 1)[0] for name in chosen) for row in ROWS]
        lines.append(f"| {n} | " + " | ".join("%.3f" % g for g in of) + " |")
    lines += ["", "## How fast errors fall", "",
              f"Exponent of mape against iterations, from {ITERATIONS[0]} to {ITERATIONS[2]}: "
              "independent, sobol.", "",
              "| scene | " + " | ".join(ROWS) + " |", "|---" * (len(ROWS) + 1) + "|"]
    for name in chosen:
        cells = [", ".join("%.2f" % slope(found, name, row, s) for s in SAMPLERS) for row in ROWS]
        lines.append(f"| {name} | " + " | ".join(cells) + " |")
    lines += ["", "## What they cost", "",
              "Processor seconds per iteration, sobol over independent, one thread, 128 x 72; median of "
              f"{COST_ROUNDS} rounds in turn, lowest and highest.", "",
              "| scene and row | |", "|---|---|"]
    for key, ratios in spent.items():
        lines.append("| %s | %.3f (%.3f to %.3f) |" % (key, statistics.median(ratios), min(ratios),
                                                       max(ratios)))
    if spent:
        lines += ["", "Geometric mean %.3f." % mean(statistics.median(r) for r in spent.values())]
    return "\n".join(lines) + "\n"


def main():
    program, directory, target, *names = sys.argv[1:]
    directory = pathlib.Path(directory)
    directory.mkdir(parents=True, exist_ok=True)
    chosen = scenes.of(OURS, SHARED, names)
    found = measure(program, directory, chosen)
    spent = costs(program, directory, chosen)
    command = " ".join(["python3 tests/calibration/sampler.py", program, "DIRECTORY PAGE", *names])
    pathlib.Path(target).write_text(page(found, spent, chosen, command))


if __name__ == "__main__":
    main()
