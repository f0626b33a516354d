"""Denoises a picture with its layers albedo and normal by Open Image Denoise, if that is installed:

    python3 -m lacuna.denoise picture.exr denoised.exr

runs its program oidnDenoise, 2.0 or newer, from the PATH or as --program names it. Debian 12 has no package of it:
https://www.openimagedenoise.org. The result is the picture alone; alpha and layers stay in the first file.
"""

from __future__ import annotations

import argparse
import os
import shutil
import subprocess
import sys
import tempfile

from . import Error, Image, InputError, RunError, UsageError

_INPUTS = {"": "--hdr", "albedo": "--alb", "normal": "--nrm"}


def denoise(image: Image, program: str = "oidnDenoise") -> Image:
    """The denoised picture. Raises UsageError if there is no such program, InputError for a picture
    without the layers, RunError if the program fails."""
    found = shutil.which(program)
    if found is None:
        raise UsageError(
            f"{program}: expected the program of Open Image Denoise, found none; install it "
            "(https://www.openimagedenoise.org), or name it with --program"
        )
    for layer in _INPUTS:
        if layer not in image.layers:
            raise InputError(f"denoise: expected a layer {layer}, found {list(image.layers)}; render an .exr")
    with tempfile.TemporaryDirectory(prefix="lacuna-") as folder:
        line = [found]
        for layer, option in _INPUTS.items():
            path = os.path.join(folder, (layer or "picture") + ".pfm")
            Image(image.layers[layer]).save(path)
            line += [option, path]
        result = os.path.join(folder, "result.pfm")
        run = subprocess.run([*line, "-o", result], capture_output=True, text=True, errors="replace", check=False)
        if run.returncode != 0 or not os.path.exists(result):
            said = (run.stderr or run.stdout).strip().splitlines()
            raise RunError(f"{program}: expected a result, found: {said[-1] if said else run.returncode}")
        return Image.load(result)


def main() -> int:
    parser = argparse.ArgumentParser(prog="python3 -m lacuna.denoise", description=(__doc__ or "").split("\n\n")[0])
    parser.add_argument("picture", help="an .exr of lacuna-render")
    parser.add_argument("output", help=".exr, .pfm or .png")
    parser.add_argument("--program", default="oidnDenoise", help="default: oidnDenoise")
    options = parser.parse_args()
    try:
        denoise(Image.load(options.picture), options.program).save(options.output)
    except Error as error:
        print(error, file=sys.stderr)
        return {UsageError: 2, InputError: 3}.get(type(error), 1)
    return 0


if __name__ == "__main__":
    sys.exit(main())
