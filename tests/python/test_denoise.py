#!/usr/bin/env python3
"""python3 -m lacuna.denoise, with a stand-in for oidnDenoise, which is not in Debian 12.

  PYTHONPATH=build/python python3 tests/python/test_denoise.py
"""

from __future__ import annotations

import subprocess
import sys
import unittest

from package import CORNELL, InFolder, program

import lacuna
import numpy as np

# Checks that its inputs are as Open Image Denoise wants them, and halves the picture.
DOUBLE = """#!{python}
import sys
import lacuna
import numpy as np
arguments = dict(zip(sys.argv[1::2], sys.argv[2::2]))
assert set(arguments) == {{"--hdr", "--alb", "--nrm", "-o"}}, arguments
hdr, albedo, normal = (lacuna.Image.load(arguments[name]).rgb for name in ("--hdr", "--alb", "--nrm"))
assert hdr.shape == albedo.shape == normal.shape
assert np.isfinite(hdr).all() and (hdr >= 0).all()
assert (albedo >= 0).all() and (albedo <= 1).all() and albedo.max() > 0.1
assert (np.abs(normal) <= 1).all() and normal.min() < -0.5
lacuna.Image(hdr / 2).save(arguments["-o"])
"""


class Denoise(InFolder):
    def setUp(self):
        super().setUp()
        self.double = self.folder / "double"
        self.double.write_text(DOUBLE.format(python=sys.executable))
        self.double.chmod(0o755)
        self.picture = self.folder / "a.exr"
        program(CORNELL, "--method", "pt", "--iterations", 2, "--width", 24, "-o", self.picture, "--half",
                "--multi-part")

    def run_module(self, *arguments):
        return subprocess.run([sys.executable, "-m", "lacuna.denoise", *map(str, arguments)], capture_output=True,
                              text=True, check=False)

    def test_gives_picture_albedo_and_normal(self):
        out = self.folder / "b.exr"
        done = self.run_module(self.picture, out, "--program", self.double)
        self.assertEqual(done.returncode, 0, done.stderr)
        expected = lacuna.Image.load(self.picture).rgb / 2
        np.testing.assert_array_equal(lacuna.Image.load(out).rgb, expected)
        self.assertGreater(expected.max(), 0)

    def test_says_what_is_missing(self):
        out = self.folder / "b.exr"
        for arguments, code, text in (((self.picture, out, "--program", "no-such-denoiser"), 2, "Open Image Denoise"),
                                      ((self.folder / "none.exr", out, "--program", self.double), 3, "none.exr"),
                                      ((self.picture, out, "--program", "false"), 1, "expected a result")):
            done = self.run_module(*arguments)
            self.assertEqual(done.returncode, code, done.stderr)
            self.assertIn(text, done.stderr)
            self.assertEqual(done.stderr.count("\n"), 1)
        self.assertFalse(out.exists())
        plain = self.folder / "plain.pfm"
        lacuna.Image(np.ones((2, 2, 3), np.float32)).save(plain)
        done = self.run_module(plain, out, "--program", self.double)
        self.assertEqual((done.returncode, "a layer albedo" in done.stderr), (3, True), done.stderr)


if __name__ == "__main__":
    unittest.main()
