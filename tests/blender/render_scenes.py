"""Renders the scenes of scenes.py by Lacuna and by Cycles, and compares the means of regions.

  blender -b --factory-startup --python-exit-code 1 -P tests/blender/render_scenes.py -- ADD-ON.zip lacuna-render OUT
      [--only NAME] [--page FILE.md]

Each scene is a .blend in OUT, rendered by `blender -b FILE -E LACUNA -f 1` with the add-on from the zip. OUT has both
pictures as .exr and side by side as .png (Lacuna left). Exits with 1 where a region differs by more than is allowed.
"""

import datetime
import os
import subprocess
import sys
import zipfile
from pathlib import Path

import bpy
import numpy

sys.dont_write_bytecode = True
sys.path[:0] = [str(Path(__file__).parent), str(Path(__file__).parents[2] / "render" / "blender")]
sys.path.append(str(Path(__file__).parents[1]))
import pages  # noqa: E402
import scenes  # noqa: E402
from lacuna_blender import exr, textures  # noqa: E402

EDGES, SAMPLES, ROWS, COLUMNS = 8, 192, 3, 4


def arguments():
    given = sys.argv[sys.argv.index("--") + 1:]
    options = {given[i]: given[i + 1] for i in range(len(given)) if given[i].startswith("--")}
    archive, program, out = (Path(a).resolve() for a in given[:3])
    return archive, program, out, options.get("--only"), options.get("--page")


def installed(archive, program, out):
    """The environment of a Blender that has the add-on from the zip, and finds the program."""
    addons = out / "scripts" / "addons"
    addons.mkdir(parents=True, exist_ok=True)
    zipfile.ZipFile(archive).extractall(addons)
    return {**os.environ, "BLENDER_USER_SCRIPTS": str(out / "scripts"), "PATH": f"{program.parent}{os.pathsep}{os.environ['PATH']}"}


def make(name, fill, out):
    """Writes the .blend of an empty scene with what `fill` adds, and Cycles' picture of it."""
    for old in out.glob(f"{name}-*"):
        old.unlink()
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scenes.for_cycles(scene, 96, 72, EDGES, samples=256)
    scene.view_settings.view_transform = "Standard"
    scene.cycles.light_sampling_threshold = 0
    fill()
    scene.render.filepath = str(out / f"{name}-cycles.exr")
    bpy.ops.render.render(write_still=True)
    scene.render.filepath = str(out / f"{name}-lacuna.exr")
    bpy.ops.wm.save_as_mainfile(filepath=str(out / f"{name}.blend"))


def render(name, out, environment):
    """Runs the command that users type; returns what the add-on says it leaves out. A line of Python sets the scene's
    settings of Lacuna."""
    chosen = f"import bpy; s = bpy.context.scene.lacuna; s.samples, s.seconds, s.depth = {SAMPLES}, 0, {EDGES}"
    done = subprocess.run([bpy.app.binary_path, "-b", "--factory-startup", "--addons", "lacuna_blender", str(out / f"{name}.blend"),
                           "--python-expr", chosen, "-E", "LACUNA", "-o", str(out / f"{name}-lacuna.exr"), "-x", "0", "-f", "1"],
                          env=environment, capture_output=True, text=True)
    (out / f"{name}.log").write_text(done.stdout + done.stderr)
    return [line[len("Lacuna: "):] for line in done.stdout.splitlines() if line.startswith("Lacuna: ")]


def regions(picture):
    """ROWS x COLUMNS means of red, green and blue."""
    rgb = picture.stack("R", "G", "B").astype(float)
    return numpy.array([[block.mean(axis=(0, 1)) for block in numpy.array_split(row, COLUMNS, axis=1)]
                        for row in numpy.array_split(rgb, ROWS, axis=0)])


def differences(ours, theirs):
    """Relative differences by region. Nearly black regions count relative to a twentieth of the picture's mean."""
    return (ours - theirs).mean(axis=2) / numpy.maximum(theirs.mean(axis=2), 0.05 * theirs.mean())


def save_png(path, *pictures):
    exposure = 0.4 / max(pictures[-1].stack("R", "G", "B").mean(), 1e-6)
    rows = [textures.to_srgb(p.stack("R", "G", "B") * exposure) for p in pictures]
    sheet = numpy.concatenate(rows, axis=1).repeat(3, axis=0).repeat(3, axis=1)
    path.write_bytes(textures.png((numpy.clip(sheet, 0, 1) * 255 + 0.5).astype(numpy.uint8)))


def pictures(name, out):
    """Lacuna's and Cycles' pictures; also saves them side by side."""
    # Blender adds the number of the frame.
    places = (out / f"{name}-lacuna.exr0001", out / f"{name}-lacuna0001.exr", out / f"{name}-lacuna.exr")
    ours, theirs = exr.read(next(p for p in places if p.exists())), exr.read(out / f"{name}-cycles.exr")
    save_png(out / f"{name}.png", ours, theirs)
    return ours, theirs


def main():
    archive, program, out, only, page = arguments()
    environment = installed(archive, program, out)
    rows, failed = [], []
    for name, (fill, allowed, why) in scenes.SCENES.items():
        if only and name != only:
            continue
        make(name, fill, out)
        notes = render(name, out, environment)
        ours, theirs = pictures(name, out)
        error = differences(regions(ours), regions(theirs))
        ratio = regions(ours).mean() / regions(theirs).mean()
        rows.append((name, ratio, 1 + error.min(), 1 + error.max(), allowed, why))
        print(f"{name}: whole {ratio:.3f}, regions {1 + error.min():.3f} to {1 + error.max():.3f}, allowed {allowed}", flush=True)
        for note in notes:
            print("   ", note)
        if numpy.abs(error).max() > allowed:
            failed.append(name)
            print(numpy.round(1 + error, 3))
    if page:
        write_page(Path(page), rows)
    if failed:
        raise SystemExit("differs from Cycles: " + ", ".join(failed))


def write_page(path, rows):
    day = datetime.date.today().isoformat()
    lines = ["# The add-on against Cycles", "",
             f"{day}, commit {pages.commit()}, {pages.machine()}, Blender {bpy.app.version_string}. "
             "Made by `tests/blender/render_scenes.py --page`.", "",
             f"Each scene is rendered by the add-on (`auto`, {SAMPLES} samples, depth {EDGES}) and by Cycles (256 samples, as many edges), "
             "96 x 72 pixels. The ratio is that of the means, Lacuna's over Cycles'; the picture is cut into "
             f"{COLUMNS} x {ROWS} regions, whose mean of the three channels may differ by what is allowed.", "",
             "| scene | whole | darkest and brightest region | allowed | what differs by design |", "|---|---|---|---|---|"]
    lines += [f"| {n} | {r:.3f} | {low:.3f} to {high:.3f} | {a:.0%} | {why or 'nothing'} |" for n, r, low, high, a, why in rows]
    path.write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
