"""Tests how the programs' outputs are read, and the page that is made of them."""

import math
import sys
import tempfile
import unittest
from pathlib import Path

sys.dont_write_bytecode = True
sys.path.insert(0, str(Path(__file__).parent))

import long_render  # noqa: E402
import page  # noqa: E402
import parts  # noqa: E402


class Outputs(unittest.TestCase):
    def test_ctest(self):
        output = ("98% tests passed, 2 tests failed out of 426\n\nTotal Test time (real) =  12.50 sec\n\n"
                  "The following tests did not run:\n\t  7 - Shared (Skipped)\n\n"
                  "The following tests FAILED:\n\t  3 - Film (Failed)\n\t 12 - All/Exact.of/pt (Timeout)\n")
        self.assertEqual(parts.tests_of(output), (426, 12.5, ["Film", "All/Exact.of/pt"]))
        self.assertEqual(parts.tests_of("100% tests passed, 0 tests failed out of 9\n"), (9, 0.0, []))

    def test_fuzzer(self):
        output = ("#2\tINITED cov: 100 ft: 120 corp: 1/9b\n#900\tNEW    cov: 130 ft: 200 corp: 3/30b\n"
                  "artifact_prefix='x'; Test unit written to out/findings/png-crash-ab\n"
                  "stat::number_of_executed_units: 900\nstat::peak_rss_mb: 80\n")
        self.assertEqual(parts.fuzzed(output), (900, 130, 200, ["out/findings/png-crash-ab"]))
        self.assertEqual(parts.fuzzed("killed"), (0, 0, 0, []))

    def test_faults(self):
        output = "part0.exr: 24 x 24 pixels\n    12  render: writes that fail\n     3  kills\nrender, write 4: left .lacuna-1.tmp\n1 wrong\n"
        self.assertEqual(parts.counted(output), ([["render: writes that fail", 12], ["kills", 3]],
                                                 ["render, write 4: left .lacuna-1.tmp"]))

    def test_random_scenes(self):
        output = "scene 5, pt: mean: off by 3 errors\n8 scenes, 32 comparisons\nscene 5: 1 finds\n"
        self.assertEqual(parts.compared(output), ("8 scenes, 32 comparisons", ["scene 5, pt: mean: off by 3 errors"]))

    def test_random_command_lines(self):
        output = "line 7: parts make another picture: lacuna-render scene.glb\n9 command lines, 2 of them refused\n"
        self.assertEqual(parts.tried(output), ("9 command lines, 2 of them refused",
                                               ["line 7: parts make another picture: lacuna-render scene.glb"]))


class LongRender(unittest.TestCase):
    def test_memory(self):
        # 1, 2, 4, 8 iterations have one sum; 3, 5, 6, 9 have two. The memory of a second sum is no growth.
        flat = [(1, 100), (2, 100), (3, 150), (4, 100), (5, 150), (6, 150), (8, 100), (9, 150)]
        self.assertAlmostEqual(long_render.growth(flat), 1.0)
        self.assertAlmostEqual(long_render.growth([(n, m + 3 * (n > 4)) for n, m in flat]), 1.025)
        self.assertTrue(math.isnan(long_render.growth([(1, 100), (3, 100)])))
        self.assertEqual(long_render.iterations_in("rendering  iteration 7  1s\rrendering  iteration 12  2s"), 12)
        self.assertEqual(long_render.iterations_in("preparing"), 0)
        with tempfile.NamedTemporaryFile() as log:
            self.assertEqual(long_render.end_of(log.name), "")
            Path(log.name).write_text("rendering  iteration 7\r" * 1000 + "rendering  iteration 1234\r")
            self.assertEqual(long_render.iterations_in(long_render.end_of(log.name)), 1234)
            self.assertLessEqual(len(long_render.end_of(log.name)), 4096)
        self.assertTrue(long_render.resident("self") > 1e6)
        self.assertIsNone(long_render.resident("none"))

    def test_iterations_of_an_exr(self):
        head = b"v/1\0channels\0chlist\0" + b"iterations\0int\0\x04\0\0\0\x02\x01\0\0name\0"
        self.assertEqual(long_render.iterations_of(head), 258)
        self.assertEqual(long_render.iterations_of(b"\0iterations\0string\0\x0b\0\0\0" + b"123456789017"), 12345678901)
        self.assertEqual(long_render.iterations_of(b"no such"), 0)

    def test_slope_of_parts_of_one_picture(self):
        last = 1000
        for falls in (0.5, 0.3):
            errors = [(n, 0.1 * n ** -falls * (1 - n / last) ** 0.5) for n in (80, 160, 320, 500)]
            self.assertAlmostEqual(long_render.slope(errors, last), -falls)
            # The errors of few iterations do not count.
            self.assertAlmostEqual(long_render.slope([(10, 0.001), *errors], last), -falls)
        self.assertTrue(math.isnan(long_render.slope([(10, 0.1)], 100)))


class Page(unittest.TestCase):
    def test_every_part_is_there_with_what_it_found(self):
        ran = {"summary": "libFuzzer, 900 executions", "rows": [["parser", "executions"], ["`png`", 900]],
               "findings": ["png: out/findings/png-crash-ab"], "seconds": 120.0, "date": "2026-11-26", "commit": "abc"}
        text = page.text({"fuzz": ran, "hostile": ran | {"findings": [], "rows": []}})
        for name in parts.PARTS:
            self.assertIn(f"## {name}\n", text)
        self.assertIn("2026-11-26, commit abc, 2 minutes: libFuzzer, 900 executions.", text)
        self.assertIn("| parser | executions |\n|---|---|\n| `png` | 900 |\n", text)
        self.assertIn("- png: out/findings/png-crash-ab", text)
        self.assertEqual(text.count("Has not run."), len(parts.PARTS) - 2)
        self.assertEqual(text.count("Found nothing."), 1)


if __name__ == "__main__":
    unittest.main()
