#!/usr/bin/env python3
"""Makes STABILITY.md beside this file: every hard case, what must hold, what was measured, by which test.

  python3 tests/stability_table.py --check             compares list, tests and table without running anything
  python3 tests/stability_table.py --write             runs all tests that cover a case, minutes, and writes the table
  python3 tests/stability_table.py --write CASE ...    runs the tests of these cases and keeps the other rows' figures
  python3 tests/stability_table.py --list              prints the names of the cases and their tests

stability_cases.py lists the cases. A test covers one by a line `stabilityCase("NAME", measured, "unit")` (stability.h).
Tests are run from build/tests; `--build DIR` names another build directory.
"""

from __future__ import annotations

import argparse
import json
import re
import subprocess
import sys
import tempfile
from pathlib import Path

sys.dont_write_bytecode = True  # leave nothing behind in the source tree

from stability_cases import GROUPS  # noqa: E402

HERE = Path(__file__).resolve().parent
TABLE = HERE / "STABILITY.md"
INTRODUCTION = """\
# Hard cases

`python3 tests/stability_table.py --write` makes this page by running the tests named here; `--check` compares it with the list
of cases and with the tests. No sample may be invalid in any case. A deviation is the largest over pixels, blocks of pixels and
the mean, as a share of what the test allows: Student's t over iterations, with one false alarm in 10^6 comparisons of pictures.
If a test runs several times, usually once for every method, the figure is the worst.
"""
MARK = re.compile(r'\bTEST(_F|_P)?\(\s*(\w+)\s*,\s*(\w+)\s*\)|\bstabilityCase\(\s*"([^"]*)"')


class Test:
    """A test as the sources state it."""

    def __init__(self, area: str, name: str, parametrised: bool):
        self.area, self.name, self.parametrised = area, name, parametrised

    @property
    def filter(self) -> str:
        return f"*/{self.name}/*" if self.parametrised else self.name


def stated() -> dict[str, list[Test]]:
    """The tests that cover each case, in the order of files and lines."""
    found: dict[str, list[Test]] = {}
    for source in sorted(HERE.glob("*/*.cpp")):
        test = None
        for kind, suite, name, case in (m.groups() for m in MARK.finditer(source.read_text(encoding="utf-8"))):
            if suite:
                test = Test(source.parent.name, f"{suite}.{name}", kind == "_P")
            elif test is None:
                raise SystemExit(f"{source}: expected stabilityCase inside a test, found it before the first one")
            else:
                found.setdefault(case, []).append(test)
    return found


def all_cases() -> list[str]:
    return [case.name for _, cases in GROUPS for case in cases]


def complaints_of_list(tests: dict[str, list[Test]]) -> list[str]:
    names = all_cases()
    found = [f"stability_cases.py: {name} is listed twice" for name in sorted({n for n in names if names.count(n) > 1})]
    found += [f"stability_cases.py: no test covers {name}" for name in names if name not in tests]
    found += [f"{tests[name][0].name}: covers {name}, which stability_cases.py does not list"
              for name in tests if name not in names]
    return found


def figure(value: float) -> str:
    return f"{value:.0f}" if value >= 100 else f"{value:.2g}"


def run(wanted: list[Test], build: Path) -> dict[tuple[str, str], str]:
    """What each (case, test) measured: the largest over the test's parameters."""
    measured: dict[tuple[str, str], tuple[float, str, int]] = {}
    for area in sorted({test.area for test in wanted}):
        filters = sorted({test.filter for test in wanted if test.area == area})
        program = build / "tests" / f"test_{area}"
        print(f"{program}: {len(filters)} tests", file=sys.stderr)
        with tempfile.TemporaryDirectory() as directory:
            report = Path(directory) / "report.json"
            subprocess.run([program, "--gtest_filter=" + ":".join(filters), f"--gtest_output=json:{report}",
                            "--gtest_brief=1"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=False)
            suites = json.loads(report.read_text(encoding="utf-8"))["testsuites"]
        for suite in suites:
            for test in suite["testsuite"]:
                # All/Suite.name/parameter
                name = f"{suite['name'].split('/')[-1]}.{test['name'].split('/')[0]}"
                if test.get("failures"):
                    raise SystemExit(f"{name}: expected to pass, failed; nothing was written")
                for key, text in test.items():
                    if not key.startswith("case-"):
                        continue
                    number, unit = text.split(" ", 1)
                    key = (key.removeprefix("case-"), name)
                    value, _, count = measured.get(key, (-1.0, "", 0))
                    measured[key] = (max(value, float(number)), unit, count + 1)
    return {key: f"{figure(value)} {unit}" + (f" (worst of {count})" if count > 1 else "")
            for key, (value, unit, count) in measured.items()}


def table(tests: dict[str, list[Test]], measured: dict[tuple[str, str], str]) -> str:
    lines = [INTRODUCTION]
    for group, cases in GROUPS:
        lines += [f"## {group}", "", "| case | | what must hold | measured | test |", "|---|---|---|---|---|"]
        for case in cases:
            said = f"{case.what} | {case.holds}"
            for test in tests[case.name]:
                lines.append(f"| {case.name} | {said} | {measured.get((case.name, test.name), '')} | `{test.name}` |")
                said = " | "  # once for all tests of a case
        lines.append("")
    return "\n".join(lines)


def kept() -> dict[tuple[str, str], str]:
    """The figures of the existing table."""
    rows = re.findall(r"^\| ([\w-]+) \| .* \| (.*) \| `(\S+)` \|$",
                      TABLE.read_text(encoding="utf-8") if TABLE.exists() else "", re.MULTILINE)
    return {(case, test): text for case, text, test in rows}


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    mode = parser.add_mutually_exclusive_group(required=True)
    mode.add_argument("--check", action="store_true", help="run nothing; exit 1 where list, tests and table differ")
    mode.add_argument("--write", nargs="*", metavar="CASE", help="run the tests (of these cases) and write the table")
    mode.add_argument("--list", action="store_true", help="print cases and tests")
    parser.add_argument("--build", type=Path, default=HERE.parent / "build", help="the build directory")
    options = parser.parse_args()

    tests = stated()
    complaints = complaints_of_list(tests)
    measured = kept()
    if options.check and not complaints:
        if not TABLE.exists() or TABLE.read_text(encoding="utf-8") != table(tests, measured):
            complaints.append("STABILITY.md: differs from list and tests; run tests/stability_table.py --write")
        complaints += [f"STABILITY.md: {case} by {test} has no figure; run tests/stability_table.py --write {case}"
                       for (case, test), text in measured.items() if not text]
    for unknown in set(options.write or []) - set(all_cases()):
        complaints.append(f"--write: no case {unknown}; --list names them")
    for complaint in complaints:
        print(complaint, file=sys.stderr)
    if complaints:
        return 1

    if options.list:
        for name in all_cases():
            print(name, *(test.name for test in tests[name]))
    if options.check:
        print(f"{len(all_cases())} hard cases, each with a test")
    if options.write is not None:
        wanted = options.write or all_cases()
        measured.update(run([test for name in wanted for test in tests[name]], options.build))
        TABLE.write_text(table(tests, measured), encoding="utf-8")
        print(f"{TABLE}: {len(wanted)} cases measured")
    return 0


if __name__ == "__main__":
    sys.exit(main())
