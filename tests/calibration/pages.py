"""What the pages of calibrations have in common."""

import pathlib
import subprocess


def commit():
    """Of the sources that these scripts belong to, short."""
    return subprocess.run(["git", "rev-parse", "--short", "HEAD"], cwd=pathlib.Path(__file__).parent, capture_output=True,
                          text=True, check=True).stdout.strip()
