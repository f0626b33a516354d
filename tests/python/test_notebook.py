#!/usr/bin/env python3
"""render/python/door.ipynb runs from its first cell to its last, with small settings.

  PYTHONPATH=build/python python3 tests/python/test_notebook.py [FOLDER]

Its cells are run here, without Jupyter. With a folder its figures are kept there, by number.
"""

from __future__ import annotations

import json
import os
import sys
import tempfile
import unittest
from pathlib import Path

from package import ROOT

try:
    import matplotlib
except ModuleNotFoundError:
    print("no matplotlib: python3-matplotlib is not installed")
    sys.exit(77)

matplotlib.use("Agg")
FOLDER = Path(sys.argv.pop(1)) if len(sys.argv) > 1 else None
NOTEBOOK = ROOT / "render" / "python" / "door.ipynb"
SMALL = {
    "width": 32, "height": 18, "seconds": 0.3, "reference_seconds": 1, "technique_iterations": 1,
    "methods": {
        "pt": {}, "bpt": {},
        "spcbpt": {"candidates": 100, "train.paths": 2000, "train.light_paths": 2000},
    },
}


class Notebook(unittest.TestCase):
    def setUp(self):
        self.cells = json.loads(NOTEBOOK.read_text(encoding="utf-8"))["cells"]

    def test_runs(self):
        before = Path.cwd()
        os.chdir(NOTEBOOK.parent)
        self.addCleanup(os.chdir, before)
        with tempfile.TemporaryDirectory() as temporary:
            tempfile.tempdir = temporary
            self.addCleanup(setattr, tempfile, "tempdir", None)
            shared: dict = {}
            for number, cell in enumerate(c for c in self.cells if c["cell_type"] == "code"):
                exec(compile("".join(cell["source"]), f"{NOTEBOOK.name}, code cell {number}", "exec"),
                     shared)
                if number == 0 and FOLDER is None:
                    self.assertLessEqual(SMALL.keys(), shared.keys())
                    shared.update(SMALL)
        self.assertEqual(list(shared["images"]), list(shared["curves"]))
        figures = [matplotlib.pyplot.figure(n) for n in matplotlib.pyplot.get_fignums()]
        self.assertEqual(len(figures), 3)
        lines = figures[1].axes[0].get_lines()
        self.assertEqual([line.get_label() for line in lines], ["pt", "bpt", "spcbpt"])
        for line in lines:
            self.assertTrue((line.get_ydata() > 0).all())
        shown = [ax.get_title() for ax in figures[2].axes if ax.images]
        self.assertIn("s = 2, t = 3", shown)
        if FOLDER is not None:
            for number, figure in enumerate(figures):
                figure.savefig(FOLDER / f"door-{number}.png", dpi=100)

    def test_has_no_outputs_in_git(self):
        for cell in self.cells:
            self.assertFalse(cell.get("outputs"))
            self.assertIsNone(cell.get("execution_count"))


if __name__ == "__main__":
    unittest.main()
