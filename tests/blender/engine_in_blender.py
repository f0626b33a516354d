"""The engine inside Blender: passes, border, cameras, Esc, and what is listed.

  blender -b --factory-startup --python-exit-code 1 -P tests/blender/engine_in_blender.py -- lacuna-render
"""

import os
import sys
import tempfile
import unittest
from pathlib import Path

import bpy
import numpy

sys.dont_write_bytecode = True
sys.path[:0] = [str(Path(__file__).parent), str(Path(__file__).parents[2] / "render" / "blender")]
import lacuna_blender  # noqa: E402
import scenes  # noqa: E402
from lacuna_blender import exr  # noqa: E402


class Engine(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        program = Path(sys.argv[sys.argv.index("--") + 1]).resolve()
        os.environ["PATH"] = f"{program.parent}{os.pathsep}{os.environ['PATH']}"
        lacuna_blender.register()

    @classmethod
    def tearDownClass(cls):
        lacuna_blender.unregister()

    def setUp(self):
        bpy.ops.wm.read_factory_settings(use_empty=True)
        self.scene = scene = bpy.context.scene
        scene.render.engine = "LACUNA"
        scene.lacuna.method, scene.lacuna.samples, scene.lacuna.seconds = "pt", 8, 0
        scene.render.resolution_x, scene.render.resolution_y = 60, 40
        scene.render.image_settings.file_format = "OPEN_EXR_MULTILAYER"
        scene.render.image_settings.color_depth, scene.render.image_settings.exr_codec = "32", "ZIP"
        scenes.stage()
        scenes.lamp("SUN", (0, 0, 5), (1, 2, 0), 3)

    def render(self):
        with tempfile.TemporaryDirectory() as folder:
            self.scene.render.filepath = os.path.join(folder, "a.exr")
            bpy.ops.render.render(write_still=True)
            return exr.read(self.scene.render.filepath)

    def test_passes(self):
        scenes.camera((0, -6, 2), (0, 0, 2))
        layer = bpy.context.view_layer
        layer.use_pass_z = layer.use_pass_normal = layer.use_pass_position = layer.lacuna.use_albedo = layer.lacuna.use_variance = True
        picture = self.render()
        found = {name.split(".", 1)[1]: plane[5, 30] for name, plane in picture.channels.items()}
        self.assertAlmostEqual(found["Depth.Z"], 9, delta=0.01)  # the wall, 3 behind the middle
        numpy.testing.assert_allclose([found["Normal." + c] for c in "XYZ"], (0, -1, 0), atol=1e-3)
        numpy.testing.assert_allclose([found["Albedo." + c] for c in "RGB"], (0.5, 0.6, 0.7), atol=1e-3)
        self.assertGreater(found["Combined.G"], 0.1)
        self.assertEqual(found["Combined.A"], 1)
        self.assertAlmostEqual(found["Position.Y"], 3, delta=0.01)
        self.assertGreater(found["Position.Z"], 2)
        self.assertIn("Variance.R", found)

    def test_a_transparent_film_leaves_out_the_world(self):
        scenes.camera((0, -6, 40), (0, 0, 80))  # at nothing
        self.scene.world = bpy.data.worlds.new("sky")
        self.scene.world.color = (0.5, 0.6, 0.7)
        alpha = {}
        for transparent in (False, True):
            self.scene.render.film_transparent = transparent
            found = {name.rsplit(".", 1)[1]: plane.mean() for name, plane in self.render().channels.items()
                     if "Combined" in name}
            alpha[transparent] = found["A"]
            self.assertEqual(found["G"] == 0, transparent)
        self.assertEqual(alpha, {False: 1, True: 0})

    def test_border_is_that_part_of_the_picture(self):
        scenes.camera()
        whole = self.render()
        render = self.scene.render
        render.use_border = render.use_crop_to_border = True
        render.border_min_x, render.border_max_x, render.border_min_y, render.border_max_y = 0.5, 1.0, 0.25, 1.0
        part = self.render()
        self.assertEqual((part.width, part.height), (30, 30))
        name = next(n for n in part.channels if n.endswith("Combined.G"))
        self.assertAlmostEqual(part.channels[name].mean() / whole.channels[name][:30, 30:].mean(), 1, delta=0.02)

    def test_the_scenes_camera_of_several(self):
        scenes.camera((0, -6, -2), (0, -6, -9))
        scenes.camera((0, -6, 2), (0, 0, 2))
        bpy.context.view_layer.use_pass_z = True
        picture = self.render()
        self.assertAlmostEqual(next(p for n, p in picture.channels.items() if n.endswith("Z"))[5, 30], 9, delta=0.01)

    def test_esc_saves_nothing(self):
        self.stop()

    def test_esc_ends_the_export_too(self):
        self.add_marble()
        self.stop()

    def add_marble(self):
        """Adds a cube with a texture that only Cycles can evaluate."""
        made, tree, node = scenes.material("marble", "ShaderNodeBsdfDiffuse")
        tree.links.new(tree.nodes.new("ShaderNodeTexNoise").outputs["Color"], node.inputs["Color"])
        return scenes.cube(made)

    def stop(self):
        from lacuna_blender import engine
        scenes.camera()
        self.scene.lacuna.samples, self.scene.lacuna.seconds = 0, 600
        shown = []
        stopped, engine.LacunaEngine._stopped = engine.LacunaEngine._stopped, lambda self: True
        show = engine.LacunaEngine._show
        engine.LacunaEngine._show = lambda *given: shown.append(given)
        try:
            bpy.ops.render.render()
        finally:
            engine.LacunaEngine._stopped = stopped
            engine.LacunaEngine._show = show
        self.assertEqual(shown, [])

    def test_what_is_not_carried_over_is_listed(self):
        from lacuna_blender import engine
        scenes.camera()
        self.add_marble()
        scenes.lamp("AREA", (0, -2, 4), (0, 0, 0), 10, spread=0.5).name = "softbox"
        scenes.cube(scenes.principled("skin", (0.5, 0.5, 0.5), Subsurface=0.3))
        self.scene.render.use_motion_blur = True
        self.scene.lacuna.baked = 0
        self.render()
        text = "\n".join(engine.last_notes)
        for what in ("marble: the node Noise Texture", "softbox: the Spread", "skin: Subsurface", "Scene: motion blur"):
            self.assertIn(what, text)
        self.scene.lacuna.baked = 64
        self.render()
        self.assertNotIn("Noise Texture", "\n".join(engine.last_notes))

    def test_a_material_in_two_slots_is_baked_for_both(self):
        scenes.camera()
        cube = self.add_marble()
        cube.data.materials.append(cube.data.materials[0])
        for i, face in enumerate(cube.data.polygons):
            face.material_index = i % 2
        self.scene.lacuna.baked = 64
        self.assertGreater(next(p for n, p in self.render().channels.items() if n.endswith("Combined.G")).mean(), 0)

    def test_without_an_answer_of_cycles_the_render_goes_on(self):
        from lacuna_blender import cycles, engine
        scenes.camera()
        self.add_marble()
        tree = scenes.world().node_tree
        tree.links.new(tree.nodes.new("ShaderNodeTexSky").outputs[0], tree.nodes["Background"].inputs["Color"])
        start, cycles.Cycles._start = cycles.Cycles._start, staticmethod(lambda: cycles.subprocess.Popen(
            ["true"], text=True, stdin=cycles.subprocess.PIPE, stdout=cycles.subprocess.PIPE))
        try:
            self.assertGreater(next(p for n, p in self.render().channels.items() if n.endswith("Combined.G")).mean(), 0)
        finally:
            cycles.Cycles._start = start
        text = "\n".join(engine.last_notes)
        self.assertIn("marble: the node Noise Texture", text)
        self.assertIn("World: the world's nodes cannot be followed", text)

    def test_no_camera_is_said(self):
        with self.assertRaisesRegex(RuntimeError, "camera"):
            bpy.ops.render.render()


unittest.main(argv=["engine"], verbosity=2)
