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
from lacuna_blender import brushing, camera, command, exr, passes, process, shapes, textures  # noqa: E402
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
        corners, triangles = shapes.sphere(2)
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
