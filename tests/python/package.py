"""Shared parts of the Python package's tests; importing it exits with 77 if the package is not built."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
CORNELL = ROOT / "scenes" / "cornell-box.glb"

try:
    import lacuna
    import lacuna._lacuna  # an empty folder would do for `import lacuna`
    from lacuna.study import find_program
except ModuleNotFoundError as missing:
    if missing.name not in ("lacuna", "lacuna._lacuna", "numpy"):
        raise
    print(f"no module {missing.name}: the Python package is built where pybind11-dev, python3-dev "
          "and python3-numpy are")
    sys.exit(77)


def small(scene, **options):
    """A picture of 8 x 6 pixels, unless options say otherwise."""
    return lacuna.render(scene, **{"width": 8, "height": 6, "method": "bpt", "threads": 2} | options)


def program(*arguments) -> None:
    """Runs lacuna-render."""
    subprocess.run([find_program("lacuna-render"), "--quiet", *map(str, arguments)], check=True,
                   stdout=subprocess.DEVNULL)


class InFolder(unittest.TestCase):
    """A test with a folder of its own, which also holds the user's caches."""

    def setUp(self):
        self.folder = Path(tempfile.mkdtemp(prefix="lacuna-python-"))
        self.addCleanup(shutil.rmtree, self.folder)
        before = os.environ.get("XDG_CACHE_HOME")
        os.environ["XDG_CACHE_HOME"] = str(self.folder)
        self.addCleanup(lambda: os.environ.pop("XDG_CACHE_HOME") if before is None
                        else os.environ.update(XDG_CACHE_HOME=before))
