"""What the pages that scripts write to tests/results/ have in common."""

import os
import pathlib
import platform
import subprocess


def commit():
    """Of the sources that these scripts belong to, short; `-dirty` where files differ from it."""
    return subprocess.run(["git", "describe", "--always", "--dirty", "--exclude=*"], cwd=pathlib.Path(__file__).parent,
                          capture_output=True, text=True).stdout.strip() or "unknown"


def processor(information="/proc/cpuinfo"):
    """Its model; "" where the system does not say."""
    try:
        with open(information) as lines:
            return next((line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")), "")
    except OSError:
        return ""


def machine():
    return f"{processor() or platform.machine()}, {os.cpu_count()} threads"


def table(rows):
    """Lines of Markdown, with an empty one at the end. `rows`: lists of cells, the first one being the head."""
    lines = ["| " + " | ".join(str(cell) for cell in row) + " |" for row in rows]
    return [lines[0], "|---" * len(rows[0]) + "|", *lines[1:], ""]
