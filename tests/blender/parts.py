#!/usr/bin/env python3
"""The parts of the add-on that need no Blender: python3 tests/blender/parts.py. Exits with 77 without NumPy."""

import json
import math
import os
import struct
import sys
import tempfile
import time
import types
import unittest
from pathlib import Path

try:
    import numpy
except ImportError:
    print("skipped: expected NumPy, found none (Debian: python3-numpy)")
    sys.exit(77)

sys.path.insert(0, str(Path(__file__).parents[2] / "render" / "blender"))
from lacuna_blender import blend, brushing, camera, command, exr, passes, process, shapes, sockets, textures  # noqa: E402
from lacuna_blender.glb import Glb  # noqa: E402
from lacuna_blender.notes import Notes  # noqa: E402
from lacuna_blender.sockets import Value  # noqa: E402


def object_with(**members):
    return types.SimpleNamespace(**members)


class Shapes(unittest.TestCase):
    def test_areas_and_sides(self):
        for shape, expected in ((shapes.rectangle(2, 3), 6), (shapes.ellipse(2, 3), 1.5 * math.pi)):
            self.assertAlmostEqual(shapes.area(*shape), expected, delta=0.01 * expected)
            corners, triangles = shape
            a, b, c = (corners[triangles[i::3]] for i in range(3))
            self.assertTrue((numpy.cross(b - a, c - a)[:, 2] < 0).all(), "faces -z")
        corners, triangles = shapes.sphere(2, 3)
        self.assertAlmostEqual(shapes.area(corners, triangles), 16 * math.pi, delta=2)
        a, b, c = (corners[triangles[i::3]] for i in range(3))
        self.assertTrue((numpy.einsum("ij,ij->i", numpy.cross(b - a, c - a), a) > 0).all(), "faces outwards")

    def test_samples_fill_the_disk(self):
        at = shapes.disk_samples(64)
        radius = numpy.hypot(*at.T)
        self.assertLess(radius.max(), 1)
        self.assertAlmostEqual((radius ** 2).mean(), 0.5, delta=0.01)
        self.assertLess(numpy.abs(at.mean(axis=0)).max(), 0.05)


class Files(unittest.TestCase):
    def test_what_is_written_is_read(self):
        rgb = numpy.random.default_rng(1).random((5, 7, 3), numpy.float32)
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "a.exr")
            exr.write(path, rgb)
            numpy.testing.assert_array_equal(exr.read(path).stack("R", "G", "B"), rgb)
            Path(path).write_bytes(Path(path).read_bytes()[:-40])
            with self.assertRaises(ValueError):
                exr.read(path)

    def test_glb(self):
        glb = Glb()
        root = glb.node(None, "root", range(16))
        mesh = glb.mesh("m", [({"POSITION": numpy.zeros((3, 3), numpy.float32)}, numpy.arange(3, dtype=numpy.uint32), 0)])
        glb.node(root, "child", range(16), mesh=mesh)
        glb.light(root, "lamp", range(16), {"type": "point"})
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "a.glb")
            glb.write(path)
            data = Path(path).read_bytes()
        self.assertEqual(struct.unpack_from("<4sII", data), (b"glTF", 2, len(data)))
        size = struct.unpack_from("<I", data, 12)[0]
        document = json.loads(data[20:20 + size])
        self.assertEqual(document["nodes"][0]["children"], [1, 2])
        self.assertEqual(document["extensionsUsed"], ["KHR_lights_punctual"])
        self.assertEqual(document["buffers"][0]["byteLength"], len(data) - 28 - size)

    def test_coding_there_and_back(self):
        values = numpy.linspace(0, 1, 50)
        numpy.testing.assert_allclose(textures.to_linear(textures.to_srgb(values)), values, atol=1e-6)


class Camera(unittest.TestCase):
    def view(self, width, height, **members):
        return camera.view(object_with(**{"lens": 50, "sensor_width": 36, "sensor_height": 24, "sensor_fit": "AUTO",
                                          "shift_x": 0.1, "shift_y": 0.2, **members}), width, height)

    def test_the_sensor_fits_the_larger_side(self):
        yfov, shift = self.view(200, 100)
        self.assertAlmostEqual(math.tan(yfov / 2), 0.36 / 2)
        self.assertEqual(shift, (0.1, 0.2))
        self.assertAlmostEqual(math.tan(self.view(100, 200)[0] / 2), 0.36)

    def test_or_the_side_that_is_chosen(self):
        yfov, shift = self.view(100, 200, sensor_fit="HORIZONTAL")
        self.assertAlmostEqual(math.tan(yfov / 2), 0.72)
        self.assertEqual(shift, (0.05, 0.1))
        self.assertAlmostEqual(math.tan(self.view(200, 100, sensor_fit="VERTICAL")[0] / 2), 0.24)

    def test_a_border_is_a_crop_from_above(self):
        render = object_with(resolution_x=200, resolution_y=100, resolution_percentage=50, use_border=True,
                             border_min_x=0.25, border_max_x=0.5, border_min_y=0.0, border_max_y=0.2)
        self.assertEqual(camera.film(render), (100, 50, (25, 50, 40, 50)))


class Brushing(unittest.TestCase):
    def test_widths_are_blenders(self):
        for along, across in (brushing.principled_widths(0.8), brushing.anisotropic_widths(0.4), brushing.anisotropic_widths(-0.4)):
            roughness, brushed = brushing.brushed(Value(0.5), along, across, 0.1, None)
            fine = roughness.factor ** 2
            coarse = fine + (1 - fine) * brushed.strength ** 2  # KHR_materials_anisotropy
            turned = abs(brushed.rotation - 0.2 * math.pi) > 1
            self.assertEqual(turned, across > along)
            numpy.testing.assert_allclose((coarse, fine)[::-1 if turned else 1], (0.25 * along, 0.25 * across), rtol=1e-6)

    def test_what_is_not_brushed(self):
        self.assertEqual(brushing.principled_widths(0), (1, 1))
        self.assertEqual(brushing.brushed(Value(0.0), 3, 0.3, 0, None)[1].strength, 0)

    def test_tangents_go_around_the_axis(self):
        directions = numpy.random.default_rng(1).normal(size=(50, 3))
        normals = directions / numpy.linalg.norm(directions, axis=1, keepdims=True)
        points = numpy.concatenate((normals, -normals))  # of a ball about the origin
        tangents = brushing.around(2, points, points)
        numpy.testing.assert_allclose(numpy.linalg.norm(tangents[:, :3], axis=1), 1, atol=1e-5)
        numpy.testing.assert_allclose((tangents[:, :3] * points).sum(axis=1), 0, atol=1e-5)
        self.assertTrue((numpy.cross(points, tangents[:, :3])[:, 2] > 0).all(), "counterclockwise")
        numpy.testing.assert_array_equal(tangents[:, 3], 1)
        self.assertTrue(numpy.isfinite(brushing.around(2, points, numpy.tile([0, 0, 1.0], (100, 1)))).all())


def node(kind, *inputs, output="Color", **members):
    """A shader node with one output; its inputs are numbers or other nodes."""
    made = object_with(type=kind, name=f"{kind} {id(inputs)}", mute=False, internal_links=[], bl_label=kind, **members)
    made.outputs = [object_with(name=output, identifier=output, node=made)]
    made.inputs = Inputs(socket_of(value) for value in inputs)
    return made


class Inputs(list):
    """Inputs of which the first is found by any name."""

    def __getitem__(self, key):
        return super().__getitem__(0 if isinstance(key, str) else key)


def socket_of(value):
    if isinstance(value, float):
        return object_with(is_linked=False, links=[], enabled=True, name="Value", default_value=value)
    link = object_with(from_node=value, from_socket=value.outputs[0], is_muted=False)
    return object_with(is_linked=True, links=[link], enabled=True, name="Value", default_value=0.25)


class Nodes(unittest.TestCase):
    def test_links_lead_through_reroutes_and_muted_nodes(self):
        constant = node("RGB")
        muted = node("INVERT", constant)
        muted.mute, muted.internal_links = True, [object_with(from_socket=muted.inputs[0], to_socket=muted.outputs[0])]
        self.assertIs(sockets.source_of(socket_of(node("REROUTE", muted))).node, constant)
        muted.internal_links = []
        self.assertIsNone(sockets.source_of(socket_of(muted)))
        self.assertIsNone(sockets.source_of(socket_of(0.5)))

    def test_what_an_output_is_made_of(self):
        def kinds(image):
            return {source.node.type for source in sockets.made_of(sockets.source_of(socket_of(node("VALTORGB", image))))}

        self.assertEqual(kinds(node("TEX_IMAGE", node("TEX_COORD", output="UV"), projection="FLAT")), {"VALTORGB", "TEX_IMAGE"})
        for lies, projection in (("Object", "FLAT"), ("UV", "BOX")):
            self.assertEqual(kinds(node("TEX_IMAGE", node("TEX_COORD", output=lies), projection=projection)),
                             {"VALTORGB", "TEX_IMAGE", "TEX_COORD"})


def use_of(values, **placed):
    """A use of a picture with these values: rows from the top, numbers or colours."""
    texels = numpy.array(values, numpy.float32)
    rgb = texels if texels.ndim == 3 else numpy.dstack([texels] * 3)
    return textures.Use(textures.Picture("made", rgb), **placed)


class Blend(unittest.TestCase):
    def test_texels_are_mixed_by_the_mask(self):
        mask, grey = use_of([[0, 0.25], [0.5, 1]]), use_of([[0.2, 0.4], [0.6, 0.8]])
        factor, made = blend.mixed("m", (0.5, None), (2.0, grey), (1.0, mask))
        expected = [[0.5, 0.75 * 0.5 + 0.25 * 0.8], [0.25 + 0.6, 1.6]]
        numpy.testing.assert_allclose(factor * textures.scalar(made), expected, rtol=1e-5)
        self.assertLessEqual(textures.scalar(made).max(), 1)
        factor, made = blend.mixed("m", ((1.0, 0.0, 0.0), None), ((0.0, 0.0, 1.0), None), (0.5, mask))
        numpy.testing.assert_allclose(factor * textures.linear(made.image)[1, 1, :3], (0.5, 0, 0.5), rtol=1e-5)

    def test_constants_stay_constants(self):
        self.assertEqual(blend.mixed("m", (1.0, None), (3.0, None), (0.25, None)), (1.5, None))
        factor, made = blend.mixed("m", ((0.0, 1.0, 2.0), None), ((4.0, 1.0, 0.0), None), (0.5, None))
        self.assertEqual((factor, made), ((2.0, 1.0, 1.0), None))

    def test_masks_end_at_one(self):
        factor, made = blend.mixed("m", (0.0, None), (1.0, None), (4.0, use_of([[0.1, 0.9]])))
        numpy.testing.assert_allclose(factor * textures.scalar(made), [[0.4, 1]], rtol=1e-5)

    def normals(self, heights, *given, **placed):
        made = blend.normals_of_heights("n", use_of(heights, **placed), *given)
        return 2 * textures.stored(made.image)[..., :3] - 1

    def test_a_slope_is_its_normal(self):
        x = numpy.arange(16) / 16
        for heights, expected in ((numpy.tile(x, (16, 1)), (-0.5, 0, 1)), (numpy.tile(x[::-1, None], (1, 16)), (0, -0.5, 1))):
            normal = self.normals(heights, 1.0, 1.0, 2.0, wrap="EXTEND")[8, 8]  # one metre over two
            numpy.testing.assert_allclose(normal, numpy.array(expected) / numpy.linalg.norm(expected), atol=1e-6)
        numpy.testing.assert_allclose(self.normals(heights, 1.0, 0.0, 2.0)[8, 8], (0, 0, 1), atol=1e-6)

    def test_a_placed_slope_turns_with_its_image(self):
        heights = numpy.tile(numpy.arange(16) / 16, (16, 1))
        normal = self.normals(heights, 1.0, 1.0, 1.0, wrap="EXTEND", place=((0, 0), math.pi / 2, (1, 2)))[8, 8]
        # Turned by a right angle, the image's u runs along the surface's -v and is twice as dense.
        numpy.testing.assert_allclose(normal[:2] / normal[2], (0, 2), atol=1e-6)

    def test_repeated_heights_have_no_rim(self):
        heights = numpy.tile(numpy.sin(numpy.arange(32) * 2 * math.pi / 32), (32, 1))
        normal = self.normals(heights, 0.1, 1.0, 1.0)
        self.assertAlmostEqual(normal[3, 0, 0] / normal[3, 0, 2], -0.2 * math.pi, delta=0.02)

    def test_what_lies_alike(self):
        self.assertTrue(textures.placed_alike([]))
        self.assertTrue(textures.placed_alike([use_of([[1]]), use_of([[0]], channel="R")]))
        for placed in ({"uv_map": "b"}, {"wrap": "EXTEND"}, {"nearest": True}, {"place": ((0, 0), 1, (1, 1))}):
            self.assertFalse(textures.placed_alike([use_of([[1]]), use_of([[0]], **placed)]))


class Passes(unittest.TestCase):
    def test_of_blenders_kind(self):
        plane = numpy.array([[0.0, 1], [2, 3]], numpy.float32)
        names = ["R", "G", "B", "Z", "normal.X", "normal.Y", "normal.Z"]
        picture = exr.Picture(2, 2, {name: plane + 10 * i for i, name in enumerate(names)}, {})
        picture.channels["Z"] = plane
        self.assertEqual(passes.pixels("Combined", picture)[0].tolist(), [2, 12, 22, 1])  # the lower left
        self.assertEqual(passes.pixels("Depth", picture)[:, 0].tolist(), [2, 3, numpy.float32(1e10), 1])
        self.assertEqual(passes.pixels("Normal", picture)[2].tolist(), [40, -60, 50])
        self.assertIsNone(passes.pixels("Albedo", picture))
        picture.channels["A"] = plane / 4
        self.assertEqual(passes.pixels("Combined", picture)[:, 3].tolist(), [0.5, 0.75, 0, 0.25])


class Commands(unittest.TestCase):
    def test_limits_and_progress(self):
        settings = object_with(method="spcbpt", samples=10, seconds=4, error=5, depth=3, seed=2, animate_seed=True)
        text = " ".join(command.options(settings, 7, 2))
        self.assertEqual(text, "--method spcbpt --iterations 10 --time 4s --until mape=0.05 --max-depth 3 --seed 9 --prepare --threads 2")
        self.assertIn("--transparent-background", command.options(settings, 7, 2, True))
        self.assertEqual(command.share_done(settings, 1, 5), 0.5)
        self.assertEqual(command.limits(0, 0, 0), [])

    def test_notes_name_all(self):
        notes = Notes()
        for name in ("a", "b", "a"):
            notes.add(name, "hair is left out")
        self.assertEqual(notes.lines(), ["a, b: hair is left out"])

    def test_a_child_is_stopped_and_heard(self):
        code = "import sys, time; print('warning: x', file=sys.stderr, flush=True); time.sleep(60)"
        child = process.Child([sys.executable, "-c", code], said=lambda line: None)
        deadline = time.monotonic() + 20
        while not child.lines and time.monotonic() < deadline:
            time.sleep(0.02)
        self.assertIsNone(child.wait(0))
        child.stop()
        self.assertNotEqual(child.wait(0), 0)
        self.assertEqual(child.warnings(), ["warning: x"])

    def test_no_program(self):
        with self.assertRaisesRegex(process.NotFound, "preferences"):
            process.find("/nowhere/lacuna-render")


if __name__ == "__main__":
    unittest.main()
