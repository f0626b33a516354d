"""Writes the list of a GoogleTest program's suites as tests for ctest.

    suites.py PROGRAM LIST FILTER

One process per suite, because two thousand processes, one per test, would take longer to start than to test. A suite in
which all tests skip is skipped; if a suite skips some tests, ctest -V says which and why.
"""
import re
import subprocess
import sys
from pathlib import Path

# The last lines of the output if no test ran, and so none failed.
SKIPPED = r"PASSED  . 0 tests.\n(.  SKIPPED . [^\n]*\n)+\n*$"


def suites_of(program, tests):
    """The suites by name, and how many tests each has."""
    listed = subprocess.run([program, "--gtest_list_tests", f"--gtest_filter={tests}"], check=True,
                            capture_output=True, text=True).stdout
    suites = {}
    for line in listed.splitlines():
        suite = re.match(r"(\S+)\.(\s+#.*)?$", line)
        if suite:
            name = suite[1]
        elif line.startswith("  "):
            suites[name] = suites.get(name, 0) + 1
    return suites


def main():
    program, path, tests = sys.argv[1:]
    lines = []
    for suite, count in suites_of(program, tests).items():
        lines.append(f"add_test([==[{suite}]==] [==[{program}]==] [==[--gtest_filter={suite}.*]==])\n")
        # Without times of earlier runs, suites with most tests begin first, so that the last one is not a long one.
        lines.append(f"set_tests_properties([==[{suite}]==] PROPERTIES COST {count} "
                     f"SKIP_REGULAR_EXPRESSION [==[{SKIPPED}]==])\n")
    Path(path).write_text("".join(lines))


if __name__ == "__main__":
    main()
