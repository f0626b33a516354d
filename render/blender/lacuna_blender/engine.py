"""The render engine: F12."""

import os
import shutil
import tempfile
import time

import bpy

from . import camera, command, export, exr, passes, process
from .notes import Notes

_LOOK = 0.2  # seconds between checks for Esc and for a new picture
_LIVE = "2s"  # between pictures during the render
last_notes = []  # what the last render left out, for the panel


class _Stopped(Exception):
    """The user pressed Esc before there was a render."""


class LacunaEngine(bpy.types.RenderEngine):
    bl_idname = "LACUNA"
    bl_label = "Lacuna"
    bl_use_eevee_viewport = True
    bl_use_preview = False
    bl_use_postprocess = True

    def render(self, depsgraph):
        folder = tempfile.mkdtemp(prefix="lacuna-")
        try:
            self._render(depsgraph, folder)
        except _Stopped:
            pass
        except (camera.CannotRender, process.NotFound, ValueError, OSError) as error:
            self._fail(str(error))
        finally:
            shutil.rmtree(folder, ignore_errors=True)

    def update_render_passes(self, scene=None, renderlayer=None):
        self.register_pass(scene, renderlayer, "Combined", 4, "RGBA", "COLOR")
        if renderlayer.use_pass_z:
            self.register_pass(scene, renderlayer, "Depth", 1, "Z", "VALUE")
        if renderlayer.use_pass_normal:
            self.register_pass(scene, renderlayer, "Normal", 3, "XYZ", "VECTOR")
        if renderlayer.use_pass_position:
            self.register_pass(scene, renderlayer, "Position", 3, "XYZ", "VECTOR")
        for name, width, channels, kind, wanted, _ in passes.OWN:
            if getattr(renderlayer.lacuna, wanted):
                self.register_pass(scene, renderlayer, name, width, channels, kind)

    def _render(self, depsgraph, folder):
        scene = depsgraph.scene
        self.update_stats("", "Lacuna: exporting the scene")
        program = process.find(bpy.path.abspath(_preferred_program()))
        notes = Notes()
        arguments = export.write(depsgraph, self.camera_override or scene.camera, folder, notes, self._asking)
        self._say(notes)
        image = os.path.join(folder, "picture.exr")
        threads = scene.render.threads if scene.render.threads_mode == "FIXED" else 0
        options = command.options(scene.lacuna, scene.frame_current, threads, scene.render.film_transparent)
        line = [program, *arguments, "-o", image, *options,
                "--cache", _cache_folder(folder)]
        if not bpy.app.background:
            line += ["--write-every", _LIVE]
        if self._follow(process.Child(line), scene, depsgraph.view_layer.name, image):
            self._show(exr.read(image), scene, depsgraph.view_layer.name)

    def _follow(self, child, scene, layer, image):
        """Shows pictures until the child ends. Returns whether it completed a picture."""
        begun, seen, iterations, said = None, None, 0, 0
        while (code := child.wait(_LOOK)) is None:
            if self._stopped():
                self.update_stats("", "Lacuna: stopping")
                child.stop()
                return False
            newest = _age(image)
            if newest != seen:
                seen = newest
                begun = begun or time.monotonic()  # the time limit does not include preparation
                picture = exr.read(image)  # the file is replaced atomically
                iterations = picture.header.get("iterations", iterations)
                self._show(picture, scene, layer)
            self.update_progress(command.share_done(scene.lacuna, time.monotonic() - begun if begun else 0, iterations))
            if len(child.lines) != said:
                said = len(child.lines)
                self.update_stats("", "Lacuna: " + child.lines[-1])
        if code != 0:
            self._fail(child.error())
            return False
        for warning in child.warnings():
            self.report({"WARNING"}, warning)
        return True

    def _asking(self, name):
        """Called during the export for each question to Cycles."""
        if self._stopped():
            raise _Stopped
        self.update_stats("", f"Lacuna: asking Cycles about {name}")

    def _stopped(self):
        """Whether the user pressed Esc."""
        return self.test_break()

    def _show(self, picture, scene, layer):
        result = self.begin_result(0, 0, picture.width, picture.height, layer=layer)
        try:
            for made in result.layers[0].passes:
                values = passes.pixels(made.name, picture)
                if values is not None and len(values) == len(made.rect):
                    made.rect = values
        finally:  # Blender crashes if a result is left open
            self.end_result(result)

    def _say(self, notes):
        last_notes[:] = notes.lines()
        for line in last_notes:
            print("Lacuna:", line)
        if last_notes:
            self.report({"WARNING"}, "Not rendered as in Blender: " + "; ".join(last_notes))

    def _fail(self, message):
        self.report({"ERROR"}, message)
        self.error_set(message)


def _age(path):
    try:
        return os.stat(path).st_mtime_ns
    except FileNotFoundError:
        return None


def _preferred_program():
    add_on = bpy.context.preferences.addons.get(__package__)
    return add_on.preferences.program if add_on else ""


def _cache_folder(folder):
    """The folder for caches, beside the .blend, so that the next render of the same scene starts at once."""
    if not bpy.data.filepath:
        return folder
    beside = os.path.splitext(bpy.data.filepath)[0] + ".cache"
    return beside if os.access(os.path.dirname(beside), os.W_OK) else folder


def register():
    bpy.utils.register_class(LacunaEngine)


def unregister():
    bpy.utils.unregister_class(LacunaEngine)
