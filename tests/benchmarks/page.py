#!/usr/bin/env python3
"""Runs bench_render and large_scenes.py and writes a page of tests/results; Python's standard library only.

  python3 tests/benchmarks/page.py build            a page there, with the day in its name
  python3 tests/benchmarks/page.py build /tmp/page.md --scenes cornell-box --repetitions 1 --min-time 0.01

It wants a machine that does nothing else. $LACUNA_SHARED_SCENES adds its scenes.
"""

from __future__ import annotations

import argparse
import datetime
import json
import re
import shlex
import statistics
import subprocess
import sys
import tempfile
from collections import defaultdict
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.append(str(ROOT / "tests"))

import large_scenes  # noqa: E402
import pages  # noqa: E402

ROWS = ("pt", "bpt")
COLUMNS = {  # head of the column: benchmark, its counter
    "rate": ("render", "of_bare_embree"),
    "samples": ("render", "Msamples/s"),
    "forced": ("effects", "all_over_needed"),
    "coated": ("tolerance", "all_over_within"),
}

Measured = dict[tuple[str, ...], dict[str, float]]  # by the parts of a benchmark's name: its counters


def medians(benchmarks: list[dict]) -> Measured:
    """The median of every counter, over the repetitions in Google Benchmark's JSON."""
    runs = defaultdict(list)
    for run in benchmarks:
        if run["run_type"] == "iteration":
            runs[tuple(run["run_name"].split("/"))[:3]].append(run)
    return {name: {key: statistics.median(run[key] for run in of) for key, value in of[0].items() if isinstance(value, float)}
            for name, of in runs.items()}


def bench(program: Path, pattern: str, options: list[str]) -> Measured:
    with tempfile.NamedTemporaryFile(suffix=".json") as report:
        subprocess.run([program, f"--benchmark_filter={pattern}", f"--benchmark_out={report.name}", "--benchmark_out_format=json",
                        *options], check=True, stdout=sys.stderr)
        text = Path(report.name).read_text()
    return medians(json.loads(text)["benchmarks"]) if text else {}


def speeds(found: Measured) -> list[list[str]]:
    """A row per scene, of COLUMNS by ROWS."""
    def cell(scene: str, kind: str, row: str, counter: str) -> str:
        measured = found.get((kind, scene, row))
        return f"{measured[counter]:.2f}" if measured else ""

    scenes = dict.fromkeys(name[1] for name in found)
    return [["scene", *(f"{head}, `{row}`" for head in COLUMNS for row in ROWS)],
            *([scene, *(cell(scene, kind, row, counter) for kind, counter in COLUMNS.values() for row in ROWS)] for scene in scenes)]


def pools(found: Measured) -> list[list[str]]:
    return [["scene", "light vertices, millions", "bytes each", "MB"],
            *([name[1], f"{of['vertices'] / 1e6:.2f}", f"{of['bytes/vertex']:.0f}", f"{of['MB']:.0f}"] for name, of in found.items())]


def text(of_speed: Measured, of_pools: Measured, large: list[list[str]], repetitions: int, load: str, command: str) -> str:
    return "\n".join([
        "# Benchmarks", "",
        *pages.origin(command, load),
        f"256 x 256 pixels, paths of up to 16 edges, all threads, medians of {repetitions}. *Rate*: rays per second over those of bare "
        "Embree with the same rays in the same order. *Samples*: millions per second. *Forced*: time with textures, emissive textures, "
        "normal maps, masks, vertex colours and attenuation forced on, over the time with what the scene calls for. *Coated*: time with a "
        "clearcoat of weight 1e-4 on every material, over the time with it left out by `--tolerance 0.001`. They are taken without the "
        "first look, by which `lacuna-render` uses techniques over mirrors less often where they do not pay.", "",
        *pages.table(speeds(of_speed)),
        "## Pools", "", "A million light subpaths of `lvcbpt`; bytes of a vertex and of its entry in the list of what can be connected.", "",
        *pages.table(pools(of_pools)),
        "## Large scenes", "", "By `tests/benchmarks/large_scenes.py`: seconds to load by phase, memory at the peak.", "",
        *pages.table(large)])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=Path)
    parser.add_argument("page", type=Path, nargs="?", help="file to write (in tests/results, with the day in its name)",
                        default=ROOT / f"tests/results/benchmarks-{datetime.date.today()}.md")
    parser.add_argument("--scenes", default=".*", help="regular expression that the whole name of a scene has to match (all)")
    parser.add_argument("--repetitions", type=int, default=3, help="of each benchmark (3)")
    parser.add_argument("--min-time", type=float, default=0.5, help="seconds of each repetition (0.5)")
    options = parser.parse_args()
    load = pages.load()
    program = options.build / "tests/bench_render"
    names = f"({options.scenes})"
    of_speed = bench(program, f"^(render|effects|tolerance)/{names}/({'|'.join(ROWS)})/",
                     [f"--benchmark_repetitions={options.repetitions}", f"--benchmark_min_time={options.min_time:g}"])
    of_pools = bench(program, f"^pool/{names}/", [])
    chosen = [name for name in large_scenes.SCENES if re.fullmatch(options.scenes, name)]
    large = large_scenes.table(options.build / "render/lacuna-render", chosen)
    command = shlex.join(["python3", "tests/benchmarks/page.py", *sys.argv[1:]])
    options.page.write_text(text(of_speed, of_pools, large, options.repetitions, load, command))


if __name__ == "__main__":
    main()
