#!/usr/bin/env python3
"""import lacuna: pixels, scenes from arrays, images, errors, callbacks, interrupts.

  PYTHONPATH=build/python python3 tests/python/test_lacuna.py
"""

from __future__ import annotations

import ast
import gc
import json
import math
import re
import signal
import subprocess
import sys
import threading
import time
import unittest
import warnings
from pathlib import Path

from package import CORNELL, InFolder, lacuna, program, small

import numpy as np


class Pixels(InFolder):
    def test_are_those_of_the_program_in_every_layer(self):
        file = self.folder / "program.exr"
        program(CORNELL, "--method", "risbpt", "--set", "candidates=50", "--iterations", 3,
                "--width", 12, "--height", 10, "--crop", "1,9,2,8", "--threads", 1, "-o", file)
        here = lacuna.render(CORNELL, method="risbpt", set={"candidates": 50}, iterations=3,
                             width=12, height=10, crop=(1, 9, 2, 8), threads=2)
        there = lacuna.Image.load(file)
        self.assertEqual(list(here.layers), list(there.layers))
        for name in ("", "albedo", "normal", "Z", "variance"):
            self.assertIn(name, here.layers)
        for name, layer in here.layers.items():
            np.testing.assert_array_equal(layer, there.layers[name], name)
        self.assertEqual(here.rgb.shape, (6, 8, 3))
        self.assertGreater(here.rgb.max(), 0)

    def test_layers_of_expressions_are_a_mapping(self):
        image = small(square(base_colour=(0.5, 0.5, 0.5), emission=(1, 1, 1)), method="pt",
                      iterations=1, layer={"seen": "CL", "lit": "C.+L"})
        np.testing.assert_array_equal(image.layers["seen"], image.rgb)
        np.testing.assert_array_equal(image.layers["lit"], 0 * image.rgb)
        self.assertEqual(image.statistics["layers"], {"seen": "CL", "lit": "C.+L"})

    def test_lamps_are_changed_afterwards(self):
        scene = square(base_colour=(0.5, 0.5, 0.5))
        scene.add_lamp("point", (1, 1, 1), lacuna.look_at((0, 0, 1), (0, 0, 0)))
        image = small(scene, method="pt", iterations=4, env_colour=(1, 1, 1), light_noise=True)
        relit = image.relight({"environment": (2, 1, 0), "unnamed": 0.5})
        sky, lamp = image.layers["light.environment"], image.layers["light.unnamed"]
        self.assertGreater(min(sky.max(), lamp.max()), 0)
        np.testing.assert_allclose(relit.rgb, sky * (2, 1, 0) + lamp * 0.5, rtol=1e-6)
        self.assertEqual(json.loads(relit.statistics["relit"])["environment"], [2, 1, 0])
        noise = image.layers["covariance.g00g00"]
        off = image.relight({image.statistics["light_groups"][1]: 0})
        np.testing.assert_allclose(off.layers["variance"], noise, rtol=1e-6)
        np.testing.assert_array_equal(image.relight({}).rgb, image.rgb)
        for wrong in ({"sun": 1}, {"unnamed": -1}, {"unnamed": (1, 2)}):
            self.assertRaises(lacuna.UsageError, image.relight, wrong)
        self.assertRaises(lacuna.InputError, small(scene, iterations=1).relight, {"unnamed": 1})

    def test_layers_of_techniques_add_up(self):
        image = small(CORNELL, iterations=4, techniques=True)
        weighted = [name for name in image.layers if re.fullmatch(r"weighted\.s\d+t\d+", name)]
        self.assertIn("weighted.s02t03", weighted)
        self.assertEqual(image.layers["variance.s02t03"].shape, (6, 8))
        total = sum(image.layers[name].astype(float) for name in weighted)
        np.testing.assert_allclose(total, image.rgb, rtol=1e-4, atol=1e-6)

    def test_options_reach_the_program_as_python_has_them(self):
        image = small(CORNELL, iterations=np.int64(2), seed=7, max_depth=np.uint8(5),
                      effect={"glossy": False}, sampler=None, verify=True, prepare=False)
        self.assertEqual(image.statistics["iterations"], 2)
        self.assertEqual(image.statistics["seed"], 7)
        self.assertEqual(image.statistics["max_depth"], 5)
        self.assertIn("verify", image.statistics)
        self.assertIn("--effect=glossy=off", image.statistics["command_line"])


def square(**material):
    """A square of two by two that faces +Z, seen from so near that it fills the picture."""
    scene = lacuna.Scene()
    scene.add_mesh([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], [[0, 1, 2], [0, 2, 3]],
                   material=scene.add_material(**material))
    scene.add_camera(lacuna.look_at((0, 0, 1), (0, 0, 0)), yfov=2 * math.atan(0.25), aspect=1)
    return scene


class Scenes(InFolder):
    def test_a_square_under_a_sun_has_its_closed_form(self):
        scene = square(base_colour=(0.5, 0.25, 0.125), specular=0)
        slanted = lacuna.look_at((0, 1, 1), (0, 0, 0))
        scene.add_lamp("directional", (3, 3, 3), slanted)
        image = small(scene, method="pt", iterations=4)
        irradiance = 3 * math.cos(math.pi / 4)
        expected = np.array([0.5, 0.25, 0.125]) * irradiance / math.pi
        np.testing.assert_allclose(image.rgb, np.broadcast_to(expected, (6, 8, 3)), rtol=1e-4)

    def test_a_saved_scene_gives_the_program_the_same_pixels(self):
        scene = square(base_colour=(0.5, 0.6, 0.7), roughness=0.4)
        texture = scene.add_texture(np.full((2, 3, 4), 200, np.uint8))
        lamp = scene.add_material(base_colour=(0, 0, 0), emission=(4, 3, 2), double_sided=True,
                                  emission_texture=texture, alpha_mode="mask")
        mesh = scene.add_mesh(
            np.array([[-1, 0, 0], [1, 0, 0], [0, 0, 1]]), np.array([[0, 1, 2]], np.int8),
            normals=[[0, -1, 0]] * 3, uvs=[[0, 0], [1, 0], [0, 1]], colours=[[1, 1, 1, 1]] * 3,
            material=lamp, place=False)
        up = np.eye(4)
        up[1, 3] = 1.5
        scene.add_instance(mesh, up)
        scene.add_lamp("point", (1, 1, 1), lacuna.look_at((1, 1, 2), (0, 0, 0)))
        scene.add_lamp("spot", (1, 2, 1), lacuna.look_at((1, 1, 2), (0, 0, 0)), inner=.1, outer=.5)
        scene.save(self.folder / "scene.glb")
        self.assertEqual((self.folder / "scene.glb").read_bytes(), scene.glb())
        program(self.folder / "scene.glb", "--method", "bpt", "--iterations", 2, "--width", 8,
                "--height", 6, "-o", self.folder / "program.exr")
        there = lacuna.Image.load(self.folder / "program.exr")
        np.testing.assert_array_equal(small(scene, iterations=2).rgb, there.rgb)

    def test_look_at_is_a_matrix_of_rows(self):
        matrix = lacuna.look_at((1, 2, 3), (1, 2, 0))
        np.testing.assert_allclose(matrix @ [0, 0, -1, 1], [1, 2, 2, 1])

    def test_what_does_not_fit_is_refused(self):
        scene = square()
        triangle = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]
        for wrong in (
            lambda: scene.add_mesh(triangle, [[0, 1, 3]]),
            lambda: scene.add_mesh(triangle, [[0, 1, -1]]),
            lambda: scene.add_mesh(triangle, [[0.0, 1.0, 2.0]]),
            lambda: scene.add_mesh(triangle, [0, 1, 2]),
            lambda: scene.add_mesh(triangle, [[0, 1, 2]], normals=[[0, 0, 1]]),
            lambda: scene.add_mesh(triangle, [[0, 1, 2]], uvs=[[0, 0, 1]] * 3),
            lambda: scene.add_mesh(triangle, [[0, 1, 2]], material=9),
            lambda: scene.add_instance(0, np.eye(3)),
            lambda: scene.add_instance(9),
            lambda: scene.add_texture(np.zeros((2, 2, 3), np.uint8)),
            lambda: scene.add_texture(np.zeros((2, 2, 4))),
            lambda: scene.add_material(colour=(1, 0, 0)),
            lambda: scene.add_material(alpha_mode="clear"),
            lambda: scene.add_lamp("sun", (1, 1, 1), np.eye(4)),
            lambda: lacuna.look_at((0, 0, 0), (0, 1, 0)),
        ):
            self.assertRaises(lacuna.UsageError, wrong)
        self.assertRaises(lacuna.RunError, scene.save, self.folder / "none" / "scene.glb")


class Images(InFolder):
    def test_views_are_of_the_picture_and_stay_when_it_is_gone(self):
        image = small(CORNELL, iterations=1)
        rgb, depth = image.rgb, image.layers["Z"]
        self.assertTrue(np.shares_memory(rgb, image.rgb))
        self.assertTrue(np.shares_memory(depth, image.layers["Z"]))
        for view in (rgb, depth):
            self.assertEqual(view.dtype, np.float32)
            self.assertFalse(view.flags.writeable)
            self.assertRaises(ValueError, view.__setitem__, 0, 1)
            with self.assertRaises(ValueError):
                view.flags.writeable = True
        before = rgb.copy(), depth.copy()
        del image
        gc.collect()
        np.ones((64, 64, 3), np.float32)  # would reuse their memory
        np.testing.assert_array_equal(rgb, before[0])
        np.testing.assert_array_equal(depth, before[1])

    def test_go_to_files_and_back(self):
        image = small(CORNELL, iterations=2)
        for name in ("image.exr", "image.pfm"):
            image.save(self.folder / name)
            np.testing.assert_array_equal(lacuna.Image.load(self.folder / name).rgb, image.rgb)
        image.save(str(self.folder / "image.png"))
        self.assertEqual(lacuna.Image.load(self.folder / "image.png").rgb.shape, (6, 8, 3))
        there = lacuna.Image.load(self.folder / "image.exr")
        self.assertEqual(list(there.layers), list(image.layers))
        self.assertEqual(there.statistics["method"], "bpt")

    def test_of_arrays_are_compared_as_the_formulas_say(self):
        reference = np.array([[[1, 2, 4], [2, 1, 1]]], np.float32)
        picture = reference + np.array([[[1, 0, -1], [0, 0, 0.5]]], np.float32)
        e = 0.01 * reference.mean()
        d = picture - reference
        errors = lacuna.Image(picture).compare(reference)
        self.assertAlmostEqual(errors["mae"], abs(d).mean(), 6)
        self.assertAlmostEqual(errors["rmse"], math.sqrt((d**2).mean()), 6)
        self.assertAlmostEqual(errors["mape"], (abs(d) / (reference + e)).mean(), 6)
        self.assertAlmostEqual(errors["relmse"], (d**2 / (reference**2 + e**2)).mean(), 6)
        self.assertEqual(lacuna.Image(picture).compare(lacuna.Image(picture))["rmse"], 0)
        np.testing.assert_array_equal(lacuna.Image(picture), picture)
        with self.assertRaises(lacuna.InputError):
            lacuna.Image(picture).compare(np.ones((2, 2, 3)))
        with self.assertRaises(lacuna.UsageError):
            lacuna.Image(np.ones((2, 2)))

    def test_any_layout_of_an_array_is_read_as_it_looks(self):
        wide = np.arange(4 * 6 * 3, dtype=float).reshape(6, 4, 3)
        turned = wide.transpose(1, 0, 2)[::-1, ::2]
        np.testing.assert_array_equal(lacuna.Image(turned).rgb, turned)

    def test_a_layer_that_is_not_there_is_named(self):
        with self.assertRaisesRegex(KeyError, "depth.*albedo"):
            small(CORNELL, iterations=1).layers["depth"]


class Errors(InFolder):
    def test_are_of_the_kind_that_the_program_ends_with(self):
        for kind, options in (
            (lacuna.UsageError, {"method": "nothing"}),
            (lacuna.UsageError, {"colour": "red"}),
            (lacuna.UsageError, {"iterations": 0}),
            (lacuna.UsageError, {"set": {"no_such": 1}}),
            (lacuna.UsageError, {"list_methods": True}),
            (lacuna.InputError, {"env": self.folder / "none.exr"}),
            (lacuna.InputError, {"method": "spcbpt", "cache": self.folder / "empty"}),
            (lacuna.RunError, {"output": self.folder / "none" / "out.exr"}),
        ):
            with self.subTest(options), self.assertRaises(kind):
                small(CORNELL, **{"iterations": 1} | options)
        self.assertRaises(lacuna.InputError, lacuna.render, "nowhere.glb")
        self.assertRaises(lacuna.InputError, small, lacuna.Scene())
        self.assertRaises(lacuna.InputError, lacuna.Image.load, self.folder / "none.exr")
        for kind in (lacuna.UsageError, lacuna.InputError, lacuna.RunError, lacuna.Interrupted):
            self.assertTrue(issubclass(kind, lacuna.Error))

    def test_an_unknown_option_is_named(self):
        with self.assertRaisesRegex(lacuna.UsageError, "colour"):
            small(CORNELL, colour="red")

    def test_warnings_are_python_s(self):
        with self.assertWarnsRegex(lacuna.LacunaWarning, "(?i)light") as caught:
            small(square(), iterations=1)
        self.assertEqual(Path(caught.filename).name, "package.py")  # the caller of render()

    def test_methods_have_their_parameters(self):
        rows = {row["name"]: row for row in lacuna.methods()}
        self.assertTrue({"pt", "lt", "bpt", "risbpt", "spcbpt"} <= rows.keys())
        self.assertIn("candidates", rows["risbpt"]["parameters"])
        self.assertTrue(rows["risbpt"]["summary"] and rows["risbpt"]["reference"])

    def test_stub_names_what_the_module_has(self):
        stub = ast.parse((Path(lacuna.__file__).parent / "_lacuna.pyi").read_text("utf-8"))

        def names(body):
            found = {}
            for node in body:
                if isinstance(node, (ast.ClassDef, ast.FunctionDef)):
                    found[node.name] = node
                elif isinstance(node, ast.AnnAssign):
                    found[node.target.id] = node
            return found

        def check(stubbed, real, place):
            mine = {n for n in names(stubbed) if not n.startswith("__")}
            theirs = {n for n in vars(real) if not n.startswith("_")}
            self.assertEqual(mine, theirs, place)
            for name, node in names(stubbed).items():
                if isinstance(node, ast.ClassDef) and not issubclass(getattr(real, name), Exception):
                    check(node.body, getattr(real, name), name)

        check(stub.body, lacuna._lacuna, "_lacuna")


class Callbacks(InFolder):
    def test_see_phases_iterations_and_the_picture(self):
        seen, previews, last = [], [], []

        def look(now):
            seen.append((now.phase, now.iterations, now.limit))
            previews.append(now.preview())
            last[:] = [now]

        image = small(CORNELL, iterations=3, on_progress=look)
        self.assertEqual(seen[0][0], "loading")
        rendered = [i for phase, i, limit in seen if phase == "rendering" and limit == 3 and i]
        self.assertEqual(rendered, [1, 2, 3])
        shown = [p for p in previews if p is not None]
        np.testing.assert_array_equal(shown[-1], image.rgb)
        self.assertFalse(np.array_equal(shown[0], image.rgb))
        self.assertIsNone(last[0].preview())  # the callback is over
        self.assertGreater(last[0].seconds, 0)

    def test_what_they_raise_ends_the_render(self):
        class Enough(Exception):
            pass

        def stop(now):
            if now.iterations == 2:
                raise Enough("of it")

        with self.assertRaisesRegex(Enough, "of it"):
            small(CORNELL, iterations=1000000, on_progress=stop)

    def test_two_renders_in_two_threads_do_not_meet(self):
        alone = [small(CORNELL, iterations=4, seed=seed).rgb for seed in (1, 2)]
        both = [None, None]

        def run(i):
            both[i] = small(CORNELL, iterations=4, seed=i + 1).rgb

        threads = [threading.Thread(target=run, args=(i,)) for i in range(2)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        for a, b in zip(alone, both):
            np.testing.assert_array_equal(a, b)

    def test_other_threads_run_meanwhile(self):
        counted, over = [0], threading.Event()

        def count():
            while not over.is_set():
                counted[0] += 1
                time.sleep(0.001)

        thread = threading.Thread(target=count)
        thread.start()
        try:
            before = counted[0]
            image = small(CORNELL, time=0.5, width=64, height=48)
            during = counted[0] - before
        finally:
            over.set()
            thread.join()
        self.assertGreaterEqual(image.statistics["seconds"], 0.4)
        self.assertGreater(during, 20)  # about 500 on an idle machine, one if the lock is kept


INTERRUPTED = """
import sys, lacuna
def look(now):
    if now.iterations == 1 and now.phase == "rendering": print("rendering", flush=True)
try:
    lacuna.render(sys.argv[1], method="bpt", width=8, height=6, time="10m", output=sys.argv[2],
                  on_progress=look)
except KeyboardInterrupt:
    print("interrupted", flush=True)
"""


class Interrupts(InFolder):
    def test_ctrl_c_saves_the_picture_and_raises(self):
        file = self.folder / "out.exr"
        child = subprocess.Popen([sys.executable, "-c", INTERRUPTED, CORNELL, file],
                                 stdout=subprocess.PIPE, text=True)
        with child:
            try:
                self.assertEqual(child.stdout.readline(), "rendering\n")
                child.send_signal(signal.SIGINT)
                said, _ = child.communicate(timeout=60)
            finally:
                child.kill()
        self.assertEqual((said, child.returncode), ("interrupted\n", 0))
        image = lacuna.Image.load(file)
        self.assertGreater(image.rgb.max(), 0)
        self.assertIn("interrupt", image.statistics["stopped"])

    def test_a_handler_of_one_s_own_is_called_and_the_render_goes_on(self):
        called = []
        before = signal.signal(signal.SIGUSR1, lambda *_: called.append(True))
        self.addCleanup(signal.signal, signal.SIGUSR1, before)
        threading.Timer(0.3, signal.raise_signal, [signal.SIGUSR1]).start()
        image = small(CORNELL, time=1)
        self.assertEqual(called, [True])
        self.assertEqual(image.statistics["stopped"], "time")

    def test_what_a_handler_raises_comes_out(self):
        def give_up(*_):
            raise TimeoutError("long enough")

        before = signal.signal(signal.SIGUSR1, give_up)
        self.addCleanup(signal.signal, signal.SIGUSR1, before)
        threading.Timer(0.3, signal.raise_signal, [signal.SIGUSR1]).start()
        with self.assertRaisesRegex(TimeoutError, "long enough"):
            small(CORNELL, time="10m")


if __name__ == "__main__":
    warnings.simplefilter("error", lacuna.LacunaWarning)
    unittest.main()
