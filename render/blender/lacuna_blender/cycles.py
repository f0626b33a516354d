"""Evaluates shader nodes with Cycles in a second Blender process, because Cycles cannot be used within a render."""

import json
import os
import subprocess
import threading

import bpy
import numpy

from . import exr, process

_PATIENCE = 120.0  # seconds for one answer
_LARGEST = 4096  # most texels along the longer side


class Cycles:
    """A context manager; the first question starts the other Blender. Answers are height x width x 3 floats, row 0 at
    the top, or None if there is none. `side`: texels along a side of baked pictures; 0: nothing is baked. `asking` is
    called with the name of the object of each question, and may raise an exception to end the export."""

    def __init__(self, folder, frame, side, asking):
        self.side = side
        self._folder, self._frame, self._asking, self._child, self._asked, self._known = folder, frame, asking, None, 0, {}

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self._end()

    def panorama(self, world, width):
        """A world as a latitude-longitude picture whose centre is +X; `width`: in texels."""
        return self._ask("panorama", "worlds", world, (width, width // 2))

    def flat(self, owner, found, size):
        """The output of a node (sockets.Source) of a material or a lamp as a picture; `size`: width and height in
        texels. Images in the nodes are not transformed: the picture has their coordinates."""
        share = min(_LARGEST / max(size), 1)
        what = ("lamp", "lights") if isinstance(owner, bpy.types.Light) else ("flat", "materials")
        return self._ask(*what, owner, [max(int(s * share), 1) for s in size], **_place(found))

    def unwrapped(self, name, body):
        """Unwrapped texture coordinates for the arrays of a body.Body, or None."""
        return self._ask_for(name, "unwrapped", "npy", body=self._written(body))

    def baked(self, owner, found, body, side):
        """The output of a material's node on a body with unwrapped coordinates; a square of `side` x `side` texels."""
        return self._ask("baked", "materials", owner, (side, side), "npy", body=self._written(body), **_place(found))

    def _ask(self, what, kind, owner, size, end="exr", **more):
        """Asks about a data-block of one of bpy.data's lists; equal questions are asked once."""
        key = (what, owner.name_full, *size, repr(more))
        if key not in self._known:
            owner = owner.original
            file = self._saved(owner)
            self._known[key] = file and self._ask_for(owner.name, what, end, kind=kind, name=owner.name, file=file, frame=self._frame,
                                                      width=size[0], height=size[1], **more)
        return self._known[key]

    def _saved(self, owner):
        """The path of a .blend with a data-block and its dependencies; None if it cannot be written."""
        key = ("saved", owner.name_full)
        if key not in self._known:
            self._known[key] = self._path("blend")
            try:
                bpy.data.libraries.write(self._known[key], {owner}, path_remap="ABSOLUTE", fake_user=True)
            except (OSError, RuntimeError) as error:
                print(f"Lacuna: {owner.name}: Cycles was not asked about its nodes: {error}")
                self._known[key] = None
        return self._known[key]

    def _ask_for(self, about, what, end, **request):
        self._asking(about)
        out = self._path(end)
        try:
            said = self._answer({"what": what, "out": out, **request})
            if said == "done":
                return numpy.load(out) if end == "npy" else exr.read(out).stack("R", "G", "B")
        except (OSError, ValueError) as error:
            said = error
        print(f"Lacuna: {about}: Cycles cannot say what its nodes come to: {said}")
        return None

    def _written(self, body):
        key = (body, len(body.arrays))  # written again once it has coordinates
        if key not in self._known:
            self._known[key] = self._path("npz")
            numpy.savez(self._known[key], **body.arrays)
        return self._known[key]

    def _path(self, end):
        self._asked += 1
        return os.path.join(self._folder, f"asked{self._asked}.{end}")

    def _answer(self, request):
        if self._child is None or self._child.poll() is not None:
            self._end()
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

    def _end(self):
        if self._child:
            self._child.kill()
            self._child.communicate()

    @staticmethod
    def _start():
        script = os.path.join(os.path.dirname(os.path.abspath(__file__)), "cycles_child.py")
        return subprocess.Popen(process.mortal([bpy.app.binary_path, "-b", "--factory-startup", "-P", script]), text=True,
                                stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, start_new_session=True)


def _place(found):
    """The location of an output, for the other Blender."""
    return {"groups": [g.name for g in found.groups], "node": found.node.name, "output": found.output.identifier}
