#!/usr/bin/env python3
"""Whether `lacuna-render --until` keeps what it promises; Python's standard library only.

  python3 tests/calibration/until.py -o out/until --summary PAGE

Renders small pictures of twelve scenes by every row without bias until an error is reached, and compares each with a
reference: bidirectional path tracing of another seed. The constants of libcore/bidir/error_estimate.cpp were chosen on the
scenes TUNED; the others judge them. Iterations count, not seconds, so a busy machine changes nothing. References and
finished renders are kept in the folder: stopped (Ctrl-C), the study writes the page of what there is, and goes on when
it is started again. Remove `runs/` after a new build.
"""

from __future__ import annotations

import argparse
import contextlib
import datetime
import itertools
import json
import subprocess
import sys
from pathlib import Path
from statistics import median

ROOT = Path(__file__).resolve().parents[2]
sys.path.append(str(ROOT / "tests"))

import pages  # noqa: E402

WIDTH = 64
MOST_ITERATIONS = 512
REFERENCE = ["--method", "bpt", "--iterations", "4096", "--seed", "99"]
TARGETS = [("mape", 0.3), ("mape", 0.15), ("relmse", 0.1)]
FEWEST_PATHS = 2**17  # of libcore/bidir/error_estimate.cpp: before, nothing is promised
PROMISE, OF_RUNS = 1.1, 0.95
KNOWN = 1 / 3  # a reference is known for runs whose error is at least three times its own
FORECAST, OF_FORECASTS = 1.3, 0.9

TUNED = {
    "cornell-box": [],
    "door": [],
    "ring-caustic": [],
    "nave": ["--crop", "8,56,4,32"],
    "kitchen-glass": [],
    "light-mesh-instanced": ["--env", "scenes/sky.hdr", "--env-scale", "0.2"],
}
JUDGES = {
    "court": [],
    "bedroom-curtain": [],
    "glossy-room": [],
    "drapery-hall": [],
    "classroom-windows": ["--env-rotate", "40", "--env", "scenes/sky.hdr"],
    "blender-still-life": ["--aperture", "0.02", "--focus", "1.0"],
}
SCENES = TUNED | JUDGES
# Light tracing lacks what is seen in mirrors and through glass, so no reference shows what it converges to.
LT_SEES_ALL = {"cornell-box", "nave", "light-mesh-instanced", "drapery-hall"}
# Point lights behind smooth glass: see "Why is my picture black?" of render/README.md.
PT_SEES_ALL = set(SCENES) - {"blender-still-life"}


def rows(program: Path) -> list[str]:
    text = subprocess.run([program, "--list-methods"], check=True, capture_output=True, text=True).stdout
    return [line.split()[0] for line in text.splitlines() if "biased" not in line]


class NotThere(Exception):
    """A render that --page-only does not make."""


def render(program: Path | None, folder: Path, name: str, arguments: list[str]) -> dict:
    """The measurements of a render, read from the folder if they are there."""
    result = folder / f"{name}.json"
    if not result.exists():
        if program is None:
            raise NotThere
        command = [str(program), *arguments, "-o", str(folder / f"{name}.exr"), "--json", str(result), "--quiet"]
        done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
        if done.returncode:
            sys.exit(f"{' '.join(command)}: {done.stderr}")
    return json.loads(result.read_text())


def applies(scene: str, row: str) -> bool:
    return scene in {"lt": LT_SEES_ALL, "pt": PT_SEES_ALL}.get(row, SCENES)


def run_all(program: Path, out: Path, sampler: str, targets: list[tuple[str, float]], results: list[dict], page_only: bool) -> None:
    """Appends to `results`, which keep what they have at an interrupt. `page_only`: only with results of the folder."""
    maker = None if page_only else program
    runs, references = out / "runs", out / "references"
    runs.mkdir(parents=True, exist_ok=True)
    references.mkdir(exist_ok=True)
    for (scene, options), (measure, bound) in itertools.product(SCENES.items(), targets):
        view = [f"scenes/{scene}.glb", "--width", str(WIDTH), *options]
        with contextlib.suppress(NotThere):
            truth = render(maker, references, scene, [*view, *REFERENCE])["estimated_error"][measure]
        bar = bound * (KNOWN**2 if measure == "relmse" else KNOWN)
        for number, row in enumerate(rows(program)):
            if not applies(scene, row):
                continue
            arguments = [*view, "--method", row, "--seed", str(number + 1), "--prepare", "--cache", str(out / "cache"),
                         "--until", f"{measure}={bound}", "--iterations", str(MOST_ITERATIONS), "--sampler", sampler,
                         "--reference", str(references / f"{scene}.exr")]
            try:
                j = render(maker, runs, f"{scene}.{row}.{sampler}.{measure}-{bound}", arguments)
            except NotThere:
                continue
            results.append({"scene": scene, "row": row, "measure": measure, "bound": bound,
                            "iterations": j["iterations"], "stopped": j["stopped"], "said": j["estimated_error"][measure],
                            "ratio": j["error"][measure] / bound, "doubt": j["estimate_doubts"].get(measure, ""), "known": truth <= bar,
                            "easy": j["iterations"] * 3 / 4 * j["width"] * j["height"] <= FEWEST_PATHS})
            print(*results[-1].values(), sep="\t", file=sys.stderr)


def quantile(values: list[float], q: float) -> float:
    return sorted(values)[min(len(values) - 1, int(q * len(values)))]


def line(name: str, results: list[dict]) -> str:
    ended = [r for r in results if r["stopped"] == "error"]
    stopped = [r for r in ended if not r["easy"]]
    if not stopped:
        return f"| {name} | {len(results)} | {len(ended)} | 0 | | | | |"
    ratios = [r["ratio"] for r in stopped]
    kept = sum(r <= PROMISE for r in ratios)
    return (f"| {name} | {len(results)} | {len(ended)} | {len(stopped)} | {100 * kept / len(stopped):.1f} % | {median(ratios):.2f} | "
            f"{quantile(ratios, OF_RUNS):.2f} | {max(ratios):.2f} |")


HEAD = (f"| | runs | stopped by the error | later than at the first look | of these at most {PROMISE} of what was asked | median | 95 % below | largest |\n"
        "|---|---|---|---|---|---|---|---|")


def forecasts(results: list[dict]) -> list[float]:
    """Iterations to the next error, as forecast at the end of a run, over the iterations that it took."""
    at = {(r["scene"], r["row"], r["bound"]): r for r in results if r["measure"] == "mape" and r["stopped"] == "error"}
    bounds = sorted({bound for _, _, bound in at}, reverse=True)
    ratios = []
    for (scene, row, bound), first in at.items():
        later = [at.get((scene, row, b)) for b in bounds if b < bound]
        second = later[0] if later else None
        if second and second["iterations"] > first["iterations"]:
            ratios.append(first["iterations"] * (first["said"] / second["bound"]) ** 2 / second["iterations"])
    return ratios


def page(everything: list[dict], total: int, sampler: str, targets: list[tuple[str, float]], commit: str, command: str) -> str:
    results = [r for r in everything if r["known"]]
    unknown = sorted({f"{r['scene']} ({r['measure']} {r['bound']})" for r in everything if not r["known"]})
    text = [
        "# Does --until keep its promise?", "",
        f"Pictures of {WIDTH} pixels' width, of twelve scenes by every row without bias, until the error that the renderer estimates is",
        "below what was asked, against references. The promise: where it stops, the achieved error is at most "
        f"{PROMISE} of what was asked in {100 * OF_RUNS:.0f} % of the runs.",
        "The constants of the estimate were chosen on the scenes called tuned; the other six judge them. A run that stops at the first",
        "look at which anything is promised was asked for less than it had: it shows nothing and is not judged.", "",
        *([f"**Stopped after {len(everything)} of {total} runs.**", ""] if len(everything) < total else []),
        "| | |", "|---|---|",
        f"| date | {datetime.date.today()} |", f"| commit | {commit} |",
        f"| machine | {pages.machine()} |", f"| command | `{command}` |",
        f"| each run | `--until MEASURE=E --iterations {MOST_ITERATIONS} --sampler {sampler}`, E: {', '.join(f'{m} {b}' for m, b in targets)} |",
        f"| references | `{' '.join(REFERENCE)}`; their own errors are part of those of the runs |", "", "## Achieved over asked", "", HEAD]
    text += [line("all", results),
             line("tuned", [r for r in results if r["scene"] in TUNED]),
             line("judges", [r for r in results if r["scene"] in JUDGES])]
    text += [line(f"{m} {b}", [r for r in results if (r["measure"], r["bound"]) == (m, b)]) for m, b in targets]
    text += ["", "By row and by scene:", "", HEAD]
    text += [line(row, [r for r in results if r["row"] == row]) for row in dict.fromkeys(r["row"] for r in results)]
    text += [line(scene, [r for r in results if r["scene"] == scene]) for scene in SCENES]
    doubted = [r for r in results if r["stopped"] != "error" and r["doubt"]]
    if unknown:
        text += ["", f"Left out, because the reference's own estimated error is more than a third of what was asked: {', '.join(unknown)}."]
    text += ["", f"Of the runs that did not stop, {len(doubted)} could not be promised at their end; the others were above the error asked."]
    broken = sorted((r for r in results if r["stopped"] == "error" and r["ratio"] > PROMISE), key=lambda r: -r["ratio"])
    if broken:
        text += ["", "Not kept:", "", "| scene | row | asked | iterations | said | achieved over asked |", "|---|---|---|---|---|---|"]
        text += [f"| {r['scene']} | {r['row']} | {r['measure']} {r['bound']} | {r['iterations']} | {r['said']:.3g} | {r['ratio']:.2f} |"
                 for r in broken]
    ratios = forecasts(results)
    if ratios:
        good = sum(1 / FORECAST <= r <= FORECAST for r in ratios)
        text += ["", "## Foretold over real", "",
                 "What `--estimate` says where one error is reached of the effort to the next, in iterations, over what it took "
                 "(wanted: within "
                 f"{FORECAST} in {100 * OF_FORECASTS:.0f} %).", "",
                 "| runs | within 1.3 | median | 5 % below | 95 % below |", "|---|---|---|---|---|",
                 f"| {len(ratios)} | {100 * good / len(ratios):.1f} % | {median(ratios):.2f} | {quantile(ratios, 0.05):.2f} | "
                 f"{quantile(ratios, 0.95):.2f} |"]
    return "\n".join(text) + "\n"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-o", "--output", type=Path, required=True, help="folder of references and runs")
    parser.add_argument("--program", type=Path, default=ROOT / "build/render/lacuna-render")
    parser.add_argument("--measure", choices=["mape", "relmse"], help="runs to errors of this one alone")
    parser.add_argument("--commit", help="of the program, if not that of the work tree")
    parser.add_argument("--sampler", choices=["sobol", "independent"], default="sobol", help="random numbers (sobol, which auto draws)")
    parser.add_argument("--summary", type=Path, help="page to write")
    parser.add_argument("--page-only", action="store_true", help="render nothing: the page of what the folder has")
    arguments = parser.parse_args()
    program = arguments.program.resolve()
    targets = [t for t in TARGETS if arguments.measure in (None, t[0])]
    results: list[dict] = []
    with contextlib.suppress(KeyboardInterrupt):
        run_all(program, arguments.output.resolve(), arguments.sampler, targets, results, arguments.page_only)
    total = len(targets) * sum(applies(scene, row) for scene in SCENES for row in rows(program))
    commit = arguments.commit or pages.commit()
    text = page(results, total, arguments.sampler, targets, commit, "python3 " + " ".join(sys.argv))
    print(text)
    if arguments.summary:
        arguments.summary.write_text(text)


if __name__ == "__main__":
    main()
