#!/usr/bin/env python3
"""Sanitizers, an old processor, fuzzers, faults, random scenes and command lines, quick studies and a long render, one
after the other, and one page of the results.

    bash tests/nightly.sh                                       all of it: hours
    bash tests/nightly.sh --only fuzz --executions 20000        a part of it
    bash tests/nightly.sh --page tests/results/hostile.md       the page elsewhere than in the folder

A part that fails does not keep the next one from running. The folder keeps what each part found last, so that a page
holds all parts whenever they ran. Exit 1: a part that ran has failed.
"""

import argparse
import datetime
import json
import subprocess
import sys
import time
from pathlib import Path

import page
import parts

ROOT = Path(__file__).resolve().parents[2]
sys.path.append(str(ROOT / "tests"))

import pages  # noqa: E402


def run(name, options):
    """Runs a part and returns what it found; a part that cannot run has failed."""
    begin = time.monotonic()
    print(f"== {name}", file=sys.stderr, flush=True)
    try:
        found = parts.PARTS[name](options)
    except (OSError, subprocess.CalledProcessError, parts.Failed) as failure:
        found = {"summary": "did not come to its end", "rows": [], "findings": [str(failure)]}
    found["seconds"] = time.monotonic() - begin
    found["date"] = str(datetime.date.today())
    found["commit"] = pages.commit()
    for finding in found["findings"]:
        print(f"{name}: {finding}", file=sys.stderr)
    return found


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", metavar="PART", nargs="+", choices=parts.PARTS, default=list(parts.PARTS),
                        help=f"of {', '.join(parts.PARTS)}")
    parser.add_argument("--out", type=Path, default=ROOT / "out" / "nightly", help="folder (out/nightly)")
    parser.add_argument("--page", type=Path, help="the page (hostile.md of the folder)")
    parser.add_argument("--executions", type=int, default=1_000_000, help="of the fuzzer, for each parser")
    parser.add_argument("--seconds-each", type=int, default=0, help="end the fuzzer of a parser after so long")
    parser.add_argument("--parser", nargs="+", help="fuzz these alone")
    parser.add_argument("--scenes", type=int, default=100, help="random ones")
    parser.add_argument("--lines", type=int, default=1000, help="random command lines")
    parser.add_argument("--seed", type=int, default=1000 * datetime.date.today().toordinal(),
                        help="of the first random scene and command line (the day's)")
    parser.add_argument("--minutes", type=int, default=60, help="of the long render (a day: 1440)")
    parser.add_argument("--long-scene", type=Path, default=ROOT / "scenes" / "nave.glb", help="what it shows (nave.glb)")
    parser.add_argument("--quick", action="store_true",
                        help="sanitizers without slow tests, one program on the old processor, a few faults, one study")
    options = parser.parse_args()
    options.out = options.out.resolve()
    options.out.mkdir(parents=True, exist_ok=True)
    kept = options.out / "results.json"
    results = json.loads(kept.read_text()) if kept.exists() else {}
    options.last = results
    for name in options.only:
        results[name] = run(name, options)
        kept.write_text(json.dumps(results, indent=2))
        (options.page or options.out / "hostile.md").write_text(page.text(results))
    failed = [name for name in options.only if results[name]["findings"]]
    print(f"failed: {', '.join(failed)}" if failed else "all passed")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
