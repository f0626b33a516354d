"""Writes the list of a GoogleTest program's suites as tests for ctest.

    suites.py PROGRAM LIST FILTER

One process per suite: started for every test of a suite, two thousand of them take longer to start than to
test. A suite in which all tests skip is skipped; of one that skips a part, ctest -V says what and why.
"""
import re
import subprocess
import sys
from pathlib import Path

# The last lines where nothing ran, and so nothing failed.
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
        # Where no run has been timed, those with most tests begin first: else the last one may be long.
        lines.append(f"set_tests_properties([==[{suite}]==] PROPERTIES COST {count} "
                     f"SKIP_REGULAR_EXPRESSION [==[{SKIPPED}]==])\n")
    Path(path).write_text("".join(lines))


if __name__ == "__main__":
    main()
