#!/usr/bin/env python3
"""Puts faults into the program, one at a time, and tells which tests notice.

    python3 tests/mutants/run.py --list
    python3 tests/mutants/run.py film-variance-by-squares light-without-pmf
    python3 tests/mutants/run.py --all            all of them: hours
    python3 tests/mutants/run.py --quick NAME     by all quick tests, not only those that should notice
    python3 tests/mutants/run.py --write NAME     and put what notices into the table of tests/README.md
    python3 tests/mutants/run.py --seconds 60 NAME  tests that then still run are stopped: they noticed
    python3 tests/mutants/run.py --check          whether faults.py and the table in tests/README.md are
                                                  up to date with the sources; nothing is built

The faults are put into a copy of the sources, build-mutants/, which is kept for the next time. With
--build DIR they are put into these sources, whose build DIR is, and taken out again.

Exit 0: every fault was noticed (or only costs quality, as faults.py says).
"""

import argparse
import os
import re
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

from faults import FAULTS

ROOT = Path(__file__).resolve().parents[2]
README = ROOT / "tests" / "README.md"
HEAD = "| name | fault | noticed by |\n|---|---|---|\n"


def fail(text):
    sys.exit(f"run.py: {text}")


def tests_in(folder):
    """Suite.name of every test in a folder of tests/, as its sources have it."""
    names = set()
    for source in (ROOT / "tests" / folder).rglob("*.cpp"):
        for suite, name in re.findall(r"^TEST(?:_F|_P|)\((\w+),\s*(\w+)\)", source.read_text(), re.M):
            names.add(f"{suite}.{name}")
    return names


def exists(pattern, tests):
    """Whether a part of a gtest filter names a test, or a suite if it has a *."""
    suite = pattern.partition(".")[0].strip("*")
    return any(t == pattern or ("*" in pattern and t.startswith(suite)) for t in tests)


def gtest_filter(patterns):
    """The tests of these names, those with a parameter too: All/Suite.name/value."""
    return ":".join(f"{p}:*/{p}" if "*" in p else f"{p}:*/{p}/*" for p in patterns.split(":"))


def check():
    wrong = []
    names = [f.name for f in FAULTS]
    for f in FAULTS:
        source = ROOT / f.file
        times = source.read_text().count(f.old) if source.exists() else 0
        if times != 1:
            wrong.append(f"{f.name}: expected its old text once in {f.file}, found it {times} times")
        if f.new == f.old:
            wrong.append(f"{f.name}: expected a change, found none")
        if names.count(f.name) > 1:
            wrong.append(f"{f.name}: expected a name of its own")
        for folder, patterns in f.tests.items():
            known = tests_in(folder)
            for pattern in patterns.split(":"):
                if not exists(pattern, known):
                    wrong.append(f"{f.name}: expected a test {pattern} in tests/{folder}, found none")
    everywhere = tests_in("")
    for name, noticed in table_rows()[1].items():
        for test in re.findall(r"\w+\.\w+", noticed):
            if test not in everywhere:
                wrong.append(f"{name}: expected tests/README.md to name tests that there are, found {test}")
    missing = [n for n in names if n not in table_rows()[1]]
    if missing or README.read_text() != readme_with({}):
        wrong.append("tests/README.md: expected a table of all faults, in order, and of no others; missing: "
                     f"{', '.join(missing) or 'none'}; use --write")
    if wrong:
        print("\n".join(wrong))
        sys.exit(1)
    print(f"{len(FAULTS)} faults can be put in")


def table_rows():
    """The table of tests/README.md: what stands before it, what notices each fault, what stands behind it."""
    before, _, rest = README.read_text().partition(HEAD)
    rows = re.match(r"(?:\|.*\n)*", rest)[0]
    return before, dict(re.findall(r"^\| `(.+?)` \| .+ \| (.+?) \|$", rows, re.M)), rest[len(rows):]


def readme_with(results):
    """tests/README.md with these results in its table."""
    before, noticed, behind = table_rows()
    for name, found in results.items():
        more = f" and {len(found) - 2} more" if len(found) > 2 else ""
        noticed[name] = ", ".join(found[:2]) + more or "nobody"
    rows = [f"| `{f.name}` | {f.breaks} | {noticed[f.name]} |\n" for f in FAULTS if f.name in noticed]
    return before + HEAD + "".join(rows) + behind


def copy_sources(to):
    """Copies the files that git knows or would add. Unchanged files keep their times, so that little is built again."""
    listed = subprocess.run(["git", "ls-files", "-co", "--exclude-standard"], cwd=ROOT, check=True,
                            capture_output=True, text=True).stdout.splitlines()
    names = {name for name in listed if (ROOT / name).is_file()}
    for old in [p for p in to.rglob("*") if p.is_file() and (to / "build") not in p.parents]:
        if str(old.relative_to(to)) not in names:
            old.unlink()
    for name in names:
        source, target = ROOT / name, to / name
        if target.exists() and target.read_bytes() == source.read_bytes():
            continue
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(source, target)


def run(command, cwd, seconds=None):
    """The output, and the exit code, which is None if the command did not end in time. Tests start renders, which
    hold the pipe as well: so the session of them all is stopped."""
    process = subprocess.Popen([str(c) for c in command], cwd=cwd, stdout=subprocess.PIPE,
                               stderr=subprocess.STDOUT, text=True, errors="replace", start_new_session=True)
    try:
        output, _ = process.communicate(timeout=seconds)
        return output, process.returncode
    except BaseException as e:
        os.killpg(process.pid, signal.SIGKILL)
        output, _ = process.communicate()
        if isinstance(e, subprocess.TimeoutExpired):
            return output, None
        raise


def failed_tests(output, code, program):
    """Names of the tests that failed or did not end; what else went wrong in brackets."""
    names = sorted(set(re.findall(r"\[  FAILED  \] ([\w/]+\.\w[\w/]*)", output)))
    if code is None:
        begun = re.findall(r"\[ RUN      \] (\S+)", output)
        return names + [f"{begun[-1]} (does not end)" if begun else f"[{program} did not end]"]
    if code != 0 and not names:
        return [f"[{program} ended with {code}]"]
    return names


class Build:
    def __init__(self, directory, jobs, seconds):
        self.jobs, self.seconds = jobs, seconds
        if directory:
            self.sources, self.directory = ROOT, Path(directory).resolve()
            return
        self.sources = ROOT / "build-mutants"
        self.directory = self.sources / "build"
        copy_sources(self.sources)
        output, code = run(["cmake", "--preset", "release", "-DLACUNA_TESTS=ON", "-DLACUNA_BENCHMARKS=OFF"],
                           self.sources)
        if code != 0:
            fail("the copy cannot be configured:\n" + output)

    def make(self, targets):
        return run(["cmake", "--build", self.directory, "--parallel", self.jobs,
                    *(["--target", *targets] if targets else [])], self.sources)

    def noticed(self, fault, quick):
        """What notices the fault; None where it does not build."""
        targets = [] if quick else [f"test_{folder}" for folder in fault.tests]
        output, code = self.make(targets)
        if code != 0:
            print("\n".join(output.split("\n")[-30:]))
            return None
        if quick:
            output, _ = run(["ctest", "--test-dir", self.directory, "-LE", "slow|night", "--timeout", self.seconds],
                            self.sources)
            return re.findall(r"^\s+\d+ - (\S+) \(", output, re.M)
        found, end = [], time.monotonic() + self.seconds
        for folder, patterns in fault.tests.items():
            program = self.directory / "tests" / f"test_{folder}"
            output, code = run([program, f"--gtest_filter={gtest_filter(patterns)}"], self.directory,
                               max(1, end - time.monotonic()))
            if re.search(r"^\[=+\] 0 tests", output, re.M):
                fail(f"{fault.name}: no test of {program.name} is called {patterns}")
            found += failed_tests(output, code, program.name)
        return found

    def try_fault(self, fault, quick):
        source = self.sources / fault.file
        original = source.read_text()
        try:
            source.write_text(original.replace(fault.old, fault.new))
            return self.noticed(fault, quick)
        finally:
            source.write_text(original)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", metavar="NAME")
    parser.add_argument("--all", action="store_true")
    parser.add_argument("--list", action="store_true")
    parser.add_argument("--check", action="store_true")
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--write", action="store_true")
    parser.add_argument("--build", metavar="DIR")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--seconds", type=int, default=600, metavar="N")  # for one fault's tests
    options = parser.parse_args()
    if options.list:
        width = max(len(f.name) for f in FAULTS)
        for f in FAULTS:
            print(f"{f.name:{width}}  {f.breaks}")
        return
    if options.check:
        check()
        return
    by_name = {f.name: f for f in FAULTS}
    unknown = [n for n in options.names if n not in by_name]
    if unknown:
        fail(f"expected a name that --list shows, found {unknown[0]}")
    chosen = FAULTS if options.all else [by_name[n] for n in options.names]
    if not chosen:
        parser.error("expected --all, --list, --check or names")

    # SIGTERM takes the fault out again, as an interrupt does.
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))
    build = Build(options.build, options.jobs, options.seconds)
    unnoticed = 0
    for fault in chosen:
        found = build.try_fault(fault, options.quick)
        unnoticed += found is None or (not found and bool(fault.tests))
        said = "does not build" if found is None else ", ".join(found) or "nobody"
        print(f"{fault.name}: {said}", flush=True)
        if options.write and found is not None:
            README.write_text(readme_with({fault.name: found}))
    if unnoticed:
        fail(f"{unnoticed} of {len(chosen)} faults were not noticed")


if __name__ == "__main__":
    main()
