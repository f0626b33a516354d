#!/usr/bin/env python3
"""Runs the command of render/README.md, "Scenes of strangers", and tries what it should not allow.

    sandbox.py RENDER

RENDER is lacuna-render of the build folder, which is put into the sandbox as well. Exit 77 where there is no bwrap, or where the
system lets nobody have namespaces.
"""

import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
GUIDE = (ROOT / "render" / "README.md").read_text()
INSIDE = "/usr/bin/python3"


def command(render, scenes, output):
    """The guide's, as words; the last ones are the program and its arguments."""
    text = re.search(r"^    (timeout .+?)\n\n", GUIDE, re.M | re.S)[1].replace("\\\n", " ")
    words = shlex.split(text.replace("SCENES", str(scenes)).replace("OUTPUT", str(output)).replace("60s", "1s"))
    at = words.index("lacuna-render")
    # Where it was built, which is not below /usr, with the library beside it.
    build = render.parents[1]
    words[at:at + 1] = ["--ro-bind", str(build), str(build), str(render)]
    return words


class Sandbox(unittest.TestCase):
    render = Path()

    def setUp(self):
        self.folder = Path(tempfile.mkdtemp(prefix="sandbox-"))
        self.addCleanup(shutil.rmtree, self.folder)
        self.scenes, self.output = self.folder / "scenes", self.folder / "output"
        self.scenes.mkdir()
        self.output.mkdir()
        shutil.copy(ROOT / "scenes" / "cornell-box.glb", self.scenes / "scene.glb")
        self.words = command(self.render, self.scenes, self.output)

    def run_inside(self, program):
        """The output of a line of Python in place of the renderer."""
        words = self.words[:self.words.index(str(self.render))]
        done = subprocess.run([*words, INSIDE, "-c", program], capture_output=True, text=True)
        return done.stdout + done.stderr

    def test_the_renderer_does_its_work(self):
        done = subprocess.run([*self.words, "--width", "24", "--method", "bpt"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertTrue((self.output / "picture.exr").exists())
        self.assertEqual([p.name for p in self.scenes.iterdir()], ["scene.glb"])

    def test_only_the_output_can_be_written(self):
        self.assertEqual(self.run_inside("open('/output/a', 'w')"), "")
        self.assertTrue((self.output / "a").exists())
        for place in ("/scenes/a", "/usr/a", str(self.render)):
            self.assertIn("Read-only file system", self.run_inside(f"open('{place}', 'w')"))

    def test_nothing_else_is_seen(self):
        for place in ("/etc/passwd", "/home", "/root", str(self.folder)):
            self.assertIn("FileNotFoundError", self.run_inside(f"import os; os.stat('{place}')"))

    def test_there_is_no_network(self):
        self.assertIn("['lo']", self.run_inside("import socket; print([name for _, name in socket.if_nameindex()])"))


def main():
    if shutil.which("bwrap") is None or subprocess.run(
            ["bwrap", "--unshare-all", "--ro-bind", "/", "/", "true"], capture_output=True).returncode != 0:
        print("skipped: no bwrap that may make namespaces")
        return 77
    Sandbox.render = Path(sys.argv[1]).resolve()
    result = unittest.TextTestRunner().run(unittest.defaultTestLoader.loadTestsFromTestCase(Sandbox))
    return 0 if result.wasSuccessful() else 1


if __name__ == "__main__":
    sys.exit(main())
