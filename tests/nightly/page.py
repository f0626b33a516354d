"""The page that run.py writes: for each part when it ran, what it did and what it found."""

import sys
from pathlib import Path

import parts

sys.path.append(str(Path(__file__).resolve().parents[1]))

import pages  # noqa: E402


def section(name, found):
    lines = [f"## {name}", "", f"{found['date']}, commit {found['commit']}, {found['seconds'] / 60:.0f} minutes: "
             f"{found['summary']}.", ""]
    if len(found["rows"]) > 1:
        lines += pages.table(found["rows"])
    findings = [f"- {finding}" for finding in found["findings"]]
    return lines + (["Findings:", "", *findings, ""] if findings else ["Found nothing.", ""])


def text(results):
    """`results`: what each part of parts.PARTS returned, with its date, commit and seconds."""
    lines = ["# Hostile inputs and surroundings", "",
             f"By `bash tests/nightly.sh`, on {pages.machine()}. An edge is a branch of the program that an input of the fuzzer "
             "took, a feature that and how often; both count what is compiled in, which is more than a parser.", ""]
    for name in parts.PARTS:
        lines += section(name, results[name]) if name in results else [f"## {name}", "", "Has not run.", ""]
    return "\n".join(lines)
