"""Shared parts of the pages that scripts write to tests/results/."""

import datetime
import os
import pathlib
import platform
import subprocess


def commit():
    """The commit of the sources that these scripts belong to, short; `-dirty` if files differ from it."""
    return subprocess.run(["git", "describe", "--always", "--dirty", "--exclude=*"], cwd=pathlib.Path(__file__).parent,
                          capture_output=True, text=True).stdout.strip() or "unknown"


def processor(information="/proc/cpuinfo"):
    """The processor's model; "" if the system does not say."""
    try:
        with open(information) as lines:
            return next((line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")), "")
    except OSError:
        return ""


def machine():
    return f"{processor() or platform.machine()}, {os.cpu_count()} threads"


def origin(command, load):
    """Lines of a table: date, commit, machine, the load before the program began, and its command."""
    return table([["", ""], ["date", datetime.date.today()], ["commit", commit()], ["machine", machine()], ["load before", load],
                  ["command", f"`{command}`"]])


def load():
    """The load of the system, averaged over the last minute."""
    return pathlib.Path("/proc/loadavg").read_text().split()[0]


def table(rows):
    """Lines of Markdown, with an empty one at the end. `rows`: lists of cells, the first one being the head."""
    lines = ["| " + " | ".join(str(cell) for cell in row) + " |" for row in rows]
    return [lines[0], "|---" * len(rows[0]) + "|", *lines[1:], ""]
