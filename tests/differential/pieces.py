#!/usr/bin/env python3
"""Renders random command lines on random scenes. The picture must be the same, bit for bit, on one thread and on three,
after interrupts, and merged from parts; a find is where it differs.

    pieces.py PROGRAMS [--lines N] [--first SEED] [--seconds T]
    pieces.py PROGRAMS --seed SEED     one command line alone

PROGRAMS is the folder of lacuna-render and lacuna-merge. Exit 1: there are finds.
"""

import argparse
import random
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

sys.dont_write_bytecode = True  # leave nothing behind in the source tree

import exr_pixels  # noqa: E402
import rows as rows_  # noqa: E402
from random_scene import RandomScene  # noqa: E402

SECONDS = 300  # for one render
INTERRUPTS = 8
USAGE, INPUT, INTERRUPTED = 2, 3, 130  # exit codes
WHOLE = ("--half", "--multi-part")  # options of the picture, not of its parts


class Failed(Exception):
    """What is wrong with a command line."""


def _picture_options(r, width, height):
    """Random options for the picture, each by a chance of its own."""
    def sometimes(chance, *words):
        return [str(word) for word in words] if r.random() < chance else []

    def part(size):
        return sorted(r.sample(range(size + 1), 2))

    (x0, x1), (y0, y1) = part(width), part(height)
    return [*sometimes(0.25, "--crop", f"{x0},{x1},{y0},{y1}"),
            *sometimes(0.2, "--aperture", r.choice((0, 0.01, 0.1, 0.5)), "--focus", r.choice((0.5, 1, 3))),
            *sometimes(0.3, "--max-depth", r.choice((1, 2, 3, 5, 30))),
            *sometimes(0.2, "--rr-depth", r.choice((1, 2, 5))),
            *sometimes(0.15, "--env-colour", r.choice((".1,.2,.3", "0,0,0", "5,5,5"))),
            *sometimes(0.1, "--env-rotate", r.choice((-400, 33.3, 180))),
            *sometimes(0.1, "--env-scale", r.choice((0, 0.5, 3))),
            *sometimes(0.1, "--units", "photometric"),
            *sometimes(0.1, "--tolerance", r.choice((0.001, 0.05, 0.1))),
            *sometimes(0.1, "--shift", r.choice((".1,-.3", "1,0", "0,-2"))),
            *(sometimes(0.2, "--light-groups") or sometimes(0.1, "--light-noise")),
            *sometimes(0.2, "--layer", r.choice(("all=C.*[LOB]", "all=C.*L"))),
            *sometimes(0.15, "--layer", "wide=C<RD>L", "--layer", "narrow=C.*<TS>.*L"),
            *sometimes(0.2, "--transparent-background"),
            *sometimes(0.2, "--cryptomatte", r.choice(("object", "material", "object,material"))),
            *sometimes(0.15, "--half"), *sometimes(0.15, "--multi-part"), *sometimes(0.15, "--techniques"),
            *sometimes(0.5, "--sampler", r.choice(("sobol", "independent")))]


def _without(options, names):
    """`options` less those of `names`, each with its value."""
    kept, words = [], iter(options)
    for word in words:
        if word in names:
            next(words)
        else:
            kept.append(word)
    return kept


class CommandLine:
    """One seed's scene and command, made in `folder`."""

    def __init__(self, programs, every_row, folder, seed):
        self.r, self.programs, self.folder = random.Random(seed), programs, folder
        scene = RandomScene(self.r.randrange(10 ** 7))
        path = scene.gltf.write(folder)
        row = self.r.choice([*every_row, None])
        settings = rows_.settings(row, self.r, scene.unit, []) if row else []
        width, height = self.r.randrange(1, 50), self.r.randrange(1, 40)
        picture = _picture_options(self.r, width, height)
        ours = {word for word in picture if word.startswith("--")} | {"--width", "--height", "--sampler"}
        self.iterations = self.r.choice((1, 2, 3, 5, 8, 13, 20, 40))
        self.block = self.r.choice((1, 3, 4, 8, 16))
        self.arguments = [path.name, *_without(scene.options, ours), *_without(settings, {"--sampler"}), "--width", str(width),
                          "--height", str(height), *picture, "--method", row.name if row else "auto", "--iterations",
                          str(self.iterations), "--block-iterations", str(self.block), "--seed",
                          str(self.r.randrange(2 ** 40)), "--prepare", "--cache", "cache", "--quiet"]

    def run(self, program, *arguments, interrupt=None):
        """Exit code and the last line on stderr."""
        process = subprocess.Popen([self.programs / program, *arguments], cwd=self.folder, stdout=subprocess.DEVNULL,
                                   stderr=subprocess.PIPE, text=True)
        for seconds, then in [*([(interrupt, signal.SIGINT)] if interrupt else []), (SECONDS, signal.SIGKILL)]:
            try:
                error = process.communicate(timeout=seconds)[1]
                return process.returncode, (error.strip().splitlines() or [""])[-1]
            except subprocess.TimeoutExpired:
                process.send_signal(then)
        process.communicate()
        return process.returncode, f"not done in {SECONDS} s"

    def render(self, out, *more, threads=2):
        code, error = self.run("lacuna-render", *self.arguments, "--threads", str(threads), "-o", out, *more)
        if code != 0:
            raise Failed(f"{' '.join(more)}: exit code {code}: {error}")
        return self.shown(out)

    def shown(self, out):
        return exr_pixels.of(self.folder / out)

    def check(self):
        """False if the command is refused. Raises Failed if anything is wrong."""
        code, error = self.run("lacuna-render", *self.arguments, "--threads", "1", "-o", "one.exr")
        if code in (USAGE, INPUT) and error:
            return False
        if code != 0:
            raise Failed(f"exit code {code}: {error}")
        one = self.shown("one.exr")
        if self.render("three.exr", threads=3) != one:
            raise Failed("three threads make another picture")
        if self.interrupted() != one:
            raise Failed("after interrupts it is another picture")
        if self.of_parts() != one:
            raise Failed("parts make another picture")
        return True

    def interrupted(self):
        """What is shown after some interrupts at random times. They may come before the program handles signals."""
        options = ("--checkpoint", "checkpoint")
        for _ in range(self.r.randrange(INTERRUPTS)):
            threads = str(self.r.choice((1, 2)))
            code, error = self.run("lacuna-render", *self.arguments, "--threads", threads, "-o", "whole.exr", *options,
                                   interrupt=self.r.uniform(0.01, 0.4))
            if code not in (0, INTERRUPTED, -signal.SIGINT):
                raise Failed(f"interrupted: exit code {code}: {error}")
        return self.render("whole.exr", *options)

    def of_parts(self):
        blocks = -(-self.iterations // self.block)
        cuts = sorted({0, blocks, *(self.r.randint(0, blocks) for _ in range(2))})
        arguments, self.arguments = self.arguments, [word for word in self.arguments if word not in WHOLE]
        parts = [f"part-{begin}.exr" for begin in cuts[:-1]]
        for part, begin, end in zip(parts, cuts, cuts[1:]):
            self.render(part, "--blocks", f"{begin},{end}")
        self.arguments = arguments
        self.r.shuffle(parts)
        code, error = self.run("lacuna-merge", *parts, "-o", "merged.exr", "--quiet",
                               *(word for word in arguments if word in WHOLE))
        if code != 0:
            raise Failed(f"lacuna-merge: exit code {code}: {error}")
        return self.shown("merged.exr")


def one(programs, every_row, seed):
    """'refused', 'same', or what is wrong."""
    with tempfile.TemporaryDirectory() as folder:
        line = CommandLine(programs, every_row, Path(folder), seed)
        try:
            return "same" if line.check() else "refused"
        except Failed as failure:
            return f"{failure}: lacuna-render {' '.join(line.arguments)}"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("programs", type=Path)
    parser.add_argument("--lines", type=int, default=200)
    parser.add_argument("--first", type=int, default=1)
    parser.add_argument("--seconds", type=float, default=float("inf"))
    parser.add_argument("--seed", type=int)
    options = parser.parse_args()
    programs = options.programs.resolve()
    every_row = rows_.rows(programs / "lacuna-render")
    seeds = [options.seed] if options.seed is not None else range(options.first, options.first + options.lines)
    end, lines, refused, finds = time.monotonic() + options.seconds, 0, 0, 0
    for seed in seeds:
        if time.monotonic() > end:
            break
        found = one(programs, every_row, seed)
        lines += 1
        refused += found == "refused"
        if found not in ("same", "refused"):
            finds += 1
            print(f"line {seed}: {found}", flush=True)
    print(f"{lines} command lines, {refused} of them refused")
    return 1 if finds else 0


if __name__ == "__main__":
    sys.exit(main())
