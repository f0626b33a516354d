"""The page that run.py writes: what was compared, how sharply, and what was found."""

import datetime
import math
import shlex
import statistics
import sys
from pathlib import Path

import judge

sys.path.append(str(Path(__file__).resolve().parents[1]))

import pages  # noqa: E402

FLOOR = 0.01  # so that no scene alone decides about the pooled deviation


def pooled(deviations):
    """The mean of relative deviations, each weighted by its error, and the error of that mean."""
    weights = [1 / (error ** 2 + FLOOR ** 2) for _, error in deviations]
    mean = sum(w * d for w, (d, _) in zip(weights, deviations)) / sum(weights)
    error = math.sqrt(sum((w * e) ** 2 for w, (_, e) in zip(weights, deviations))) / sum(weights)
    return mean, error


def of_row(name, scenes):
    found = [s["rows"][name] for s in scenes if name in s["rows"]]
    both = [f["relative"] for f in found if f["kind"] == "same" and f["relative"] and math.isfinite(f["relative"][1])]
    seen = sorted(judge.SIEVE * error for _, error in both)
    off = "%+.2f %% +- %.2f %%" % tuple(100 * x for x in pooled(both)) if both else ""
    sharp = f"{100 * statistics.median(seen):.1f} %, {100 * seen[len(seen) * 9 // 10]:.0f} %" if seen else ""
    return (f"| `{name}` | {len(found)} | {sum(f['kind'] != 'same' for f in found)} | {off} | {sharp} | "
            f"{sum(f['rounds'] > 0 for f in found)} | {sum(f['rounds'] > 1 for f in found)} | "
            f"{sum('undecided' in f for f in found)} | {max(float(f['verify']) for f in found):.1e} |")


def text(scenes, counts, known, command):
    comparisons = sum(len(s["rows"]) for s in scenes)
    names = list(dict.fromkeys(name for s in scenes for name in s["rows"]))
    black = sum(not any(s.get("mean", [0])) for s in scenes)
    lines = [
        f"# {len(scenes)} random scenes by all rows", "",
        f"Date {datetime.date.today()}, commit {pages.commit()}, {pages.machine()}. `{command}`.", "",
        f"Scenes of `tests/differential/random_scene.py` by seeds from {scenes[0]['seed']} to {scenes[-1]['seed']}, "
        f"{sum(s['seconds'] for s in scenes) / 60:.0f} minutes. A row has {judge.ITERATIONS} iterations of about 200 pixels in each "
        f"scene, with settings drawn at random in half of all cases, and {judge.ITERATIONS * judge.REFERENCE} iterations of `bpt` are what "
        "it is held against, by the mean of each channel. Who differs by "
        f"{judge.SIEVE:g} errors is rendered anew, {judge.MORE[0]} times as long, then {judge.MORE[1]} times (less, where that were more than "
        f"{judge.MOST_RAYS:.0e} rays), `bpt` as well, both with other random numbers, and is a find if it differs by {judge.CONFIRM} errors "
        f"both times, and by the spread of {judge.SEEDS} more seeds. Were errors normal, the chance of one false alarm among all "
        f"{comparisons} comparisons would be "
        f"{comparisons * judge.false_alarm():.1g}. No sample may be invalid, every weight is within {judge.VERIFY:g} of `--verify`'s, and one "
        "row of each scene makes the same picture by two threads.", "",
        f"{black} scenes are black (lamps out of sight, or paths too short): two rows each.", "",
        "## By row", "",
        "*One-sided*: scenes in which a row lacks or adds light by rule (`rows.py`) and is judged from the other side, or not at all "
        "(`ppm`). *Off*: how far a row is from `bpt` in all others together, each by its error. *Seen*: the relative bias of a "
        "picture's mean that makes a suspect, in the median of the scenes and in nine of ten. *Anew*: suspects that were rendered again, "
        "*again*: twice. *Left*: those that took too long or were nothing but noise.", "",
        "| row | scenes | one-sided | off | seen | anew | again | left | weights differ by |", "|---" * 9 + "|",
        *(of_row(name, scenes) for name in names), "", "## Finds", ""]
    finds = [(s["seed"], find) for s in scenes for find in s["finds"]]
    lines += [f"- scene {seed}, `{f['method']}`: {f['kind']}: {f['what']} (`{shlex.join(f['arguments'])}`)"
              for seed, f in finds]
    lines += [f"- scene {s['seed']}, `{name}`: left undecided: {row['undecided']}"
              for s in scenes for name, row in s["rows"].items() if "undecided" in row]
    lines += ["None."] if lines[-1] == "" else []
    least = sorted(known, key=lambda f: counts[f])[:8]
    lines += ["", "## What the scenes have", "",
              f"Of {len(known)} features that the loader's sources name {sum(counts[f] > 0 for f in known)} are in a scene. "
              "Seldom: " + ", ".join(f"{f} ({counts[f]})" for f in least) + ".", ""]
    effects = sorted({e for s in scenes for e in s["effects"]})
    lines += ["Effects that were simulated: " +
              ", ".join(f"{e} {sum(e in s['effects'] for s in scenes)}" for e in effects) + "."]
    return "\n".join(lines) + "\n"
