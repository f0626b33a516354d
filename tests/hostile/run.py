#!/usr/bin/env python3
"""Attacks every tool as tests/README.md, "Hostile surroundings", says; Python's standard library only.

  python3 tests/hostile/run.py BUILD SHIM [--quick]

SHIM is faults.c, compiled. Prints how often each thing was done, and what was wrong; exits 1 if anything was.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import costs
import moments
import refusals
import surroundings
from commands import Attack


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=Path)
    parser.add_argument("shim", type=Path)
    parser.add_argument("--quick", action="store_true", help="a few calls of two commands")
    arguments = parser.parse_args()
    attack = Attack(arguments.build, arguments.shim)
    wrong: list[str] = []
    try:
        attacks = [lambda: refusals.run(attack, quick=arguments.quick)]
        if not arguments.quick:
            attacks += [lambda: moments.run(attack, moments=10, races=3), lambda: surroundings.run(attack),
                        lambda: costs.run(attack)]
        for run in attacks:
            counts, found = run()
            for name, count in counts.items():
                print(f"{count:6}  {name}", flush=True)
            print(*found, sep="\n", end="\n" if found else "", flush=True)
            wrong += found
    finally:
        attack.close()
    print(f"{len(wrong)} wrong")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
