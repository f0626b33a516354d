"""Asks Cycles what shader nodes come to, in a Blender of its own: within a render it cannot be asked."""

import json
import os
import subprocess
import threading

import bpy

from . import exr, process

_PATIENCE = 120.0  # seconds for one answer
_SKY, _LARGEST = 2048, 4096  # texels along the longer side


class Cycles:
    """A context; the other Blender begins with the first question. Answers are height x width x 3 floats, row 0 at the
    top, or None where there is none."""

    def __init__(self, folder, frame):
        self._folder, self._frame, self._child, self._asked, self._known = folder, frame, None, 0, {}

    def __enter__(self):
        return self

    def __exit__(self, *_):
        if self._child:
            self._child.kill()
            self._child.communicate()

    def panorama(self, world, width):
        """A world as a latitude-longitude picture, the middle of it +X; `width`: of the images that it has, in texels."""
        width = min(max(width, _SKY), _LARGEST)
        return self._ask("panorama", "worlds", world, (width, width // 2))

    def output(self, owner, found, size):
        """`found`: the output of a node (sockets.Source) of a material or a lamp; `size`: width and height, in texels.
        Images lie as they are, the coordinates of the picture are theirs."""
        place = (owner.name_full, tuple(g.name for g in found.groups), found.node.name, found.output.identifier)
        if place not in self._known:
            share = min(_LARGEST / max(size), 1)
            self._known[place] = self._ask(*("lamp", "lights") if isinstance(owner, bpy.types.Light) else ("flat", "materials"), owner,
                                           [max(int(s * share), 1) for s in size], groups=place[1], node=place[2], output=place[3])
        return self._known[place]

    def _ask(self, what, kind, owner, size, **more):
        self._asked += 1
        file, out = (os.path.join(self._folder, f"nodes{self._asked}.{end}") for end in ("blend", "exr"))
        owner = owner.original
        try:
            bpy.data.libraries.write(file, {owner}, path_remap="ABSOLUTE", fake_user=True)
            said = self._answer({"what": what, "kind": kind, "name": owner.name, "file": file, "out": out,
                                 "frame": self._frame, "width": size[0], "height": size[1], **more})
            if said == "done":
                return exr.read(out).stack("R", "G", "B")
            print(f"Lacuna: {owner.name}: Cycles cannot say what its nodes come to: {said}")
        except (OSError, RuntimeError, ValueError) as error:
            print(f"Lacuna: {owner.name}: Cycles was not asked about its nodes: {error}")
        return None

    def _answer(self, request):
        if self._child is None or self._child.poll() is not None:
            self._child = self._start()
        watch = threading.Timer(_PATIENCE, self._child.kill)
        watch.start()
        try:
            self._child.stdin.write(json.dumps(request) + "\n")
            self._child.stdin.flush()
            for line in self._child.stdout:
                if line.startswith("LACUNA "):
                    return line[len("LACUNA "):].strip()
        finally:
            watch.cancel()
        return "it ended, or took too long"

    @staticmethod
    def _start():
        script = os.path.join(os.path.dirname(os.path.abspath(__file__)), "cycles_child.py")
        return subprocess.Popen(process.mortal([bpy.app.binary_path, "-b", "--factory-startup", "-P", script]), text=True,
                                stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, start_new_session=True)
