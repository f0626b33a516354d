#!/usr/bin/env python3
"""Renders random small scenes by all rows, and compares them with bpt: a find is where a row differs.

    run.py RENDER [DIRECTORY] [--scenes N] [--first SEED] [--rows N] [--seconds T] [--page FILE]
    run.py RENDER --seed SEED     one scene alone, and what each row said
    run.py --features             how many of the first 500 scenes have what the loader reads; renders nothing

RENDER is lacuna-render. DIRECTORY keeps a line for each scene (scenes.jsonl) and, of scenes with a find, their files:
run again, it goes on. Without it nothing is kept. Exit 1: there are finds, or the loader reads what no scene has.
"""

import argparse
import json
import random
import shlex
import shutil
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

sys.dont_write_bytecode = True  # leave nothing behind in the source tree

import features  # noqa: E402
import page  # noqa: E402
import rows  # noqa: E402
from judge import Judge  # noqa: E402
from random_scene import RandomScene  # noqa: E402

SCENES = 500


EXAMPLE = Path(__file__).resolve().parents[2] / "scenes" / "cornell-box.glb"  # every scene has the same list of effects


def one(render, every_row, directory, seed, known):
    """What was found in a scene; its folder is kept if there are finds."""
    folder = directory / str(seed)
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    scene = RandomScene(seed)
    begin = time.monotonic()
    judge = Judge(render, rows.effects(render, EXAMPLE), scene, folder, seed)
    found = {"seed": seed, **judge.judge(every_row), "finds": judge.finds,
             "features": sorted(features.of_scene(scene.gltf.root, known)), "seconds": time.monotonic() - begin}
    if not judge.finds:
        shutil.rmtree(folder)
    return found


def kept(log):
    return [json.loads(line) for line in log.read_text().splitlines()] if log.exists() else []


def run(options, render, directory, known):
    every_row = rows.rows(render)
    log = directory / "scenes.jsonl"
    done = {found["seed"] for found in kept(log)}
    end = time.monotonic() + options.seconds
    for seed in range(options.first, options.first + options.scenes):
        if seed in done:
            continue
        if time.monotonic() > end:
            break
        some = random.Random(seed).sample(every_row, min(options.rows, len(every_row)))
        found = one(render, some, directory, seed, known)
        with log.open("a") as out:
            out.write(json.dumps(found) + "\n")
        for find in found["finds"]:
            print(f"scene {seed}, {find['method']}: {find['kind']}: {find['what']}", flush=True)
    return kept(log)


def show(found):
    for name, row in found["rows"].items():
        off = "black" if row["relative"] is None else "%+.4f +- %.4f" % tuple(row["relative"])
        print(f"{name:8} {row['kind']:8} {row['z']:+6.2f} errors, {off}, {row['wall']:.2f} s, {' '.join(row['options'])}")
    for find in found["finds"]:
        print(f"{find['method']}: {find['kind']}: {find['what']}")
    print(f"{found['seconds']:.1f} s")


def missing(counts, known):
    return [f"{feature}: the loader reads it and no scene has it" for feature in known if not counts[feature]]


def count_features(known, seeds):
    counts = Counter()
    for seed in seeds:
        counts.update(features.of_scene(RandomScene(seed).gltf.root, known))
    return counts


def render_all(options, known):
    """Complaints about what was rendered."""
    render = str(Path(options.render).resolve())
    with tempfile.TemporaryDirectory() as temporary:
        directory = (options.directory or Path(temporary)).resolve()
        directory.mkdir(parents=True, exist_ok=True)
        if options.seed is not None:
            show(one(render, rows.rows(render), directory, options.seed, known))
            return []
        found = run(options, render, directory, known)
    counts = Counter(f for scene in found for f in scene["features"])
    print(f"{len(found)} scenes, {sum(len(s['rows']) for s in found)} comparisons")
    if options.page:
        command = f"python3 tests/differential/run.py {shlex.join(sys.argv[1:])}"
        options.page.write_text(page.text(found, counts, known, command))
    return [f"scene {s['seed']}: {len(s['finds'])} finds" for s in found if s["finds"]]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("render", nargs="?")
    parser.add_argument("directory", nargs="?", type=Path)
    parser.add_argument("--scenes", type=int, default=SCENES)
    parser.add_argument("--first", type=int, default=1)
    parser.add_argument("--rows", type=int, default=100, help="of each scene, drawn at random")
    parser.add_argument("--seconds", type=float, default=float("inf"))
    parser.add_argument("--seed", type=int)
    parser.add_argument("--page", type=Path)
    parser.add_argument("--features", action="store_true")
    options = parser.parse_args()
    known = features.of_loader()
    if options.features:
        counts = count_features(known, range(1, SCENES + 1))
        for feature in known:
            print(f"{counts[feature]:5} {feature}")
        complaints = missing(counts, known)
    elif options.render:
        complaints = render_all(options, known)
    else:
        parser.error("expected RENDER or --features")
    for complaint in complaints:
        print(complaint, file=sys.stderr)
    return 1 if complaints else 0


if __name__ == "__main__":
    sys.exit(main())
