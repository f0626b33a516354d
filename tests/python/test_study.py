#!/usr/bin/env python3
"""lacuna.study: the results of lacuna-study as dicts and arrays; its errors and interrupts.

  PYTHONPATH=build/python python3 tests/python/test_study.py
"""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
import unittest
from pathlib import Path

from package import CORNELL, InFolder, lacuna

import numpy as np

SETTING = {"width": 8, "height": 6}


def tiny(scene) -> dict:
    return {
        "title": "tiny",
        "iterations": 2,
        "seeds": [1, 2],
        "scenes": [{"name": "box", "file": scene, "options": SETTING,
                    "reference": {"method": "bpt", "iterations": 4, "parts": 1}}],
        "methods": [{"method": "pt"}, {"name": "mine", "method": "bpt"}],
        "quick": {"seeds": [np.int64(1)]},
    }


STUDY_FROM_A_CHILD = """
import json, sys, lacuna
try:
    lacuna.study(json.load(open(sys.argv[1])), sys.argv[2], on_message=lambda m: print(m, flush=True))
except KeyboardInterrupt:
    print("interrupted", flush=True)
"""


class Study(InFolder):
    def test_gives_curves_runs_and_tables(self):
        os.symlink(CORNELL, self.folder / "box.glb")
        before = Path.cwd()
        os.chdir(self.folder)
        self.addCleanup(os.chdir, before)
        results = lacuna.study(tiny(Path("box.glb")), "out", threads=2)  # paths are relative to here
        self.assertEqual(sorted((r["scene"], r["name"], r["method"], r["seed"])
                                for r in results["runs"]),
                         [("box", "mine", "bpt", 1), ("box", "mine", "bpt", 2),
                          ("box", "pt", "pt", 1), ("box", "pt", "pt", 2)])
        run = results["runs"][1]
        image = lacuna.Image.load(run["image"])
        here = lacuna.render("box.glb", method="bpt", iterations=2, **SETTING)
        np.testing.assert_array_equal(image.rgb, here.rgb)
        curve = run["curve"]
        self.assertEqual(curve["iteration"][-1], 2)
        self.assertEqual(curve["mape"][-1], run["error"]["mape"])
        self.assertEqual(curve["phases"]["eye paths"].shape, curve["seconds"].shape)
        x, median, low, high = results["bands"]["box"]["mine"]["mape"]["iterations"].T
        self.assertEqual(x[-1], 2)
        self.assertTrue((low <= median).all() and (median <= high).all() and (low > 0).all())
        self.assertGreater(results["costs"]["box"]["pt"]["rays"]["eye"], 0)
        self.assertTrue(all(len(row) == len(table["columns"])
                            for table in results["tables"] for row in table["rows"]))
        # The same study again is read, not rendered; --quick has one of its seeds.
        changed = os.stat(run["image"]).st_mtime_ns
        quick = lacuna.study(self.folder / "out" / "study.json", "out", quick=True, threads=2)
        self.assertEqual([r["seed"] for r in quick["runs"]], [1, 1])
        self.assertEqual(os.stat(run["image"]).st_mtime_ns, changed)

    def test_errors_are_of_the_kind_of_its_exit_code(self):
        study = tiny(str(CORNELL))
        with self.assertRaisesRegex(lacuna.InputError, "colour"):
            lacuna.study(study | {"colour": "red"}, self.folder / "out")
        with self.assertRaises(lacuna.InputError):
            lacuna.study(self.folder / "none.json", self.folder / "out")
        with self.assertRaises(lacuna.UsageError):
            lacuna.study(study, self.folder / "out", threads=-1)
        (self.folder / "file").write_text("")
        with self.assertRaises(lacuna.RunError):
            lacuna.study(study, self.folder / "file")

    def test_ctrl_c_ends_it_in_order(self):
        file = self.folder / "study.json"
        study = tiny(str(CORNELL)) | {"iterations": 1000000000, "quick": {"seeds": [1]}}
        file.write_text(json.dumps(study))
        child = subprocess.Popen([sys.executable, "-c", STUDY_FROM_A_CHILD, file, self.folder / "out"],
                                 stdout=subprocess.PIPE, text=True)
        with child:
            try:
                deadline = time.monotonic() + 60
                while not list(self.folder.glob("out/runs/*/curve.csv")):
                    self.assertLess(time.monotonic(), deadline, "no run began")
                    time.sleep(0.05)
                child.send_signal(signal.SIGINT)
                said, _ = child.communicate(timeout=60)
            finally:
                child.kill()
        self.assertEqual(child.returncode, 0)
        self.assertIn("interrupted", said.splitlines())
        mine = str(self.folder).encode()
        left = [p for p in Path("/proc").glob("[0-9]*/cmdline") if mine in read(p)]
        self.assertEqual(left, [])


def read(file: Path) -> bytes:
    try:
        return file.read_bytes()
    except OSError:  # it has ended
        return b""


if __name__ == "__main__":
    unittest.main()
