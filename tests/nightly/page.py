"""The page that run.py writes: for each part when it ran, what it did and what it found."""

import os
import platform

import parts


def processor(information="/proc/cpuinfo"):
    try:
        with open(information) as lines:
            return next((line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")), "")
    except OSError:
        return ""


def machine():
    return f"{processor() or platform.machine()}, {os.cpu_count()} threads"


def table(rows):
    lines = ["| " + " | ".join(str(cell) for cell in row) + " |" for row in rows]
    return [lines[0], "|---" * len(rows[0]) + "|", *lines[1:], ""]


def section(name, found):
    lines = [f"## {name}", "", f"{found['date']}, commit {found['commit']}, {found['seconds'] / 60:.0f} minutes: "
             f"{found['summary']}.", ""]
    if len(found["rows"]) > 1:
        lines += table(found["rows"])
    findings = [f"- {finding}" for finding in found["findings"]]
    return lines + (["Findings:", "", *findings, ""] if findings else ["Found nothing.", ""])


def text(results):
    """`results`: what each part of parts.PARTS returned, with its date, commit and seconds."""
    lines = ["# Hostile inputs and surroundings", "",
             f"By `bash tests/nightly.sh`, on {machine()}. An edge is a branch of the program that an input of the fuzzer "
             "took, a feature that and how often; both count what is compiled in, which is more than a parser.", ""]
    for name in parts.PARTS:
        lines += section(name, results[name]) if name in results else [f"## {name}", "", "Has not run.", ""]
    return "\n".join(lines)
