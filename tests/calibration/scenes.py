"""Scenes that calibrations render: some of scenes/, and some by others if $LACUNA_SHARED_SCENES is their folder."""

import os
import pathlib

OURS = pathlib.Path(__file__).resolve().parents[2] / "scenes"
LIGHT = {"classroom": "classroom_env.hdr"}  # environments that shared scenes do not bring along


def of(ours, shared, names):
    """The arguments of lacuna-render for each scene, by the scene's name on a page. `names`: the scenes, or all if
    there are none."""
    found = {stem: [OURS / f"{stem}.glb"] for stem in ours if not names or stem in names}
    if folder := os.environ.get("LACUNA_SHARED_SCENES"):
        for stem in (stem for stem in shared if not names or stem in names):
            light = ["--env", pathlib.Path(folder) / LIGHT[stem]] if stem in LIGHT else []
            found[f"{stem} (shared)"] = [pathlib.Path(folder) / f"{stem}.glb", *light]
    return found
