"""Compares the noise of Lacuna's and Cycles' pictures after the same seconds. Both renderers get scenes.py's scenes from
Blender, and only a time limit and a depth.

  blender -b --factory-startup --python-exit-code 1 -P tests/blender/race.py -- lacuna-render OUT [--only NAME] [--page FILE.md]

Noise needs no reference: it is what two seeds differ by. Lacuna's seconds include reading the scene and the pilot of
`auto`, Cycles' only its render. OUT gets all pictures (.exr), and SHEET.png: the middle of some scenes after each time,
Lacuna left.
"""

import datetime
import os
import subprocess
import sys
from pathlib import Path

import bpy
import numpy

sys.dont_write_bytecode = True
sys.path[:0] = [str(Path(__file__).parent), str(Path(__file__).parents[2] / "render" / "blender")]
sys.path.append(str(Path(__file__).parents[1]))
import lacuna_blender  # noqa: E402
import pages  # noqa: E402
import scenes  # noqa: E402
from lacuna_blender import export, exr, textures  # noqa: E402
from lacuna_blender.notes import Notes  # noqa: E402

WIDTH, HEIGHT, EDGES, SEEDS, SECONDS = 320, 180, 8, (1, 2), (1, 5)
SHOWN = ("area-lamps", "spots", "sky-image", "shaders", "copies-and-modifiers")


class Exporter(bpy.types.RenderEngine):
    """An engine, because Blender gives only engines the scene as it is rendered, and not as the viewport shows it."""
    bl_idname, bl_label = "LACUNA_EXPORTER", "Exporter"
    folder, arguments = "", []

    def render(self, depsgraph):
        Exporter.arguments = export.write(depsgraph, depsgraph.scene.camera, Exporter.folder, Notes(), lambda name: None)


def exported(scene, folder):
    """The arguments of lacuna-render for the scene."""
    Exporter.folder, scene.render.engine = str(folder), Exporter.bl_idname
    bpy.ops.render.render()
    return Exporter.arguments


def cycles(scene, seconds, seed, path):
    scene.render.engine = "CYCLES"
    scene.cycles.time_limit, scene.cycles.seed = seconds, seed
    scene.render.filepath = str(path)
    bpy.ops.render.render(write_still=True)


def lacuna(program, arguments, seconds, seed, path):
    """Each render has its own caches, so that none finds what another has trained."""
    caches = path.with_suffix(f".{seconds}-{seed}.caches")
    subprocess.run([program, *arguments, "-o", path, "--time", f"{seconds}s", "--count-setup", "--seed", str(seed),
                    "--max-depth", str(EDGES), "--cache", caches, "--quiet"], check=True)


def smoothed(picture):
    """Means over 3 x 3 pixels."""
    padded = numpy.pad(picture, ((1, 1), (1, 1), (0, 0)), mode="edge")
    height, width = picture.shape[:2]
    return sum(padded[y:y + height, x:x + width] for y in range(3) for x in range(3)) / 9


def noise(first, second):
    """The relative error of each picture, from the difference of both: the mean over pixels and channels."""
    mean = (first + second) / 2
    return float(numpy.mean(numpy.abs(first - second) / (smoothed(mean) + 0.01 * mean.mean())) / numpy.sqrt(2))


def pixels(path):
    return exr.read(path).stack("R", "G", "B").astype(float)


def race(name, program, out):
    """By seconds: the noise of both renderers, Lacuna's first, and a picture of each."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scenes.for_cycles(scene, WIDTH, HEIGHT, EDGES, samples=1 << 20)  # the time limit comes first
    scene.render.threads_mode, scene.render.threads = "FIXED", os.cpu_count()
    scenes.SCENES[name][0]()
    scene.render.resolution_x, scene.render.resolution_y = WIDTH, HEIGHT  # some scenes have their own
    scene.render.use_border = False
    folder = out / name
    folder.mkdir(parents=True, exist_ok=True)
    arguments = exported(scene, folder)
    found = {}
    for seconds in SECONDS:
        ours, theirs = [], []
        for seed in SEEDS:
            path = folder / f"lacuna-{seconds}s-{seed}.exr"
            lacuna(program, arguments, seconds, seed, path)
            ours.append(pixels(path))
            path = folder / f"cycles-{seconds}s-{seed}.exr"
            cycles(scene, seconds, seed, path)
            theirs.append(pixels(path))
        found[seconds] = noise(*ours), noise(*theirs), ours[0], theirs[0]
    return found


def save_sheet(path, found):
    """One row for each scene shown: its middle, from the shortest time to the longest, Lacuna left of Cycles."""
    def shown(picture, other):
        middle = picture[HEIGHT // 4:HEIGHT // 4 + HEIGHT // 2, WIDTH // 4:WIDTH // 4 + WIDTH // 2]
        return textures.to_srgb(middle * 0.4 / max(other.mean(), 1e-6))

    rows = [numpy.concatenate([shown(p, found[name][SECONDS[-1]][3]) for s in SECONDS for p in found[name][s][2:]], axis=1)
            for name in SHOWN if name in found]
    if rows:
        path.write_bytes(textures.png((numpy.clip(numpy.concatenate(rows), 0, 1) * 255 + 0.5).astype(numpy.uint8)))


def write_page(path, found):
    day = datetime.date.today().isoformat()
    lines = ["# Lacuna and Cycles after the same seconds", "",
             f"{day}, commit {pages.commit()}, {pages.machine()}, Blender {bpy.app.version_string}. "
             "Made by `tests/blender/race.py`.", "",
             f"{WIDTH} x {HEIGHT} pixels, paths of up to {EDGES} edges, scenes of `tests/blender/scenes.py`: lamps, suns and skies in "
             "plain sight, where a path tracer is at home. Lacuna is told the time and nothing else (`auto`); its seconds count "
             "reading the scene and choosing a method, Cycles' its render alone, without denoiser. Noise: what a picture is off by, "
             "relative to what it shows, from the difference of two seeds. Time: Lacuna's over Cycles' to the same noise, if noise falls as "
             "the root of time.", "",
             "| scene | " + " | ".join(f"{s} s: Lacuna | Cycles | time" for s in SECONDS) + " |",
             "|---|" + "---|" * 3 * len(SECONDS)]
    for name, of in found.items():
        lines.append(f"| {name} | " + " | ".join(f"{of[s][0]:.3f} | {of[s][1]:.3f} | {(of[s][0] / of[s][1]) ** 2:.2f}" for s in SECONDS) + " |")
    means = [numpy.exp(numpy.mean([2 * numpy.log(of[s][0] / of[s][1]) for of in found.values()])) for s in SECONDS]
    lines.append("| geometric mean | " + " | ".join(f" | | {m:.2f}" for m in means) + " |")
    path.write_text("\n".join(lines) + "\n")


def main():
    given = sys.argv[sys.argv.index("--") + 1:]
    options = {given[i]: given[i + 1] for i in range(len(given)) if given[i].startswith("--")}
    program, out = (Path(a).resolve() for a in given[:2])
    lacuna_blender.register()  # its settings
    bpy.utils.register_class(Exporter)
    found = {}
    for name in scenes.SCENES:
        if options.get("--only") in (None, name):
            found[name] = race(name, program, out)
            print(name, {s: tuple(round(v, 4) for v in of[:2]) for s, of in found[name].items()}, flush=True)
    save_sheet(out / "SHEET.png", found)
    if "--page" in options:
        write_page(Path(options["--page"]), found)


main()
