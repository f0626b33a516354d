#!/usr/bin/python3
"""Renders a scene from memory by the library, with caches in the user's cache folder, or in the temporary one."""

import sys

import lacuna

scene = lacuna.Scene()
scene.add_mesh([[-1, -1, 0], [1, -1, 0], [0, 1, 0]], [[0, 1, 2]], material=scene.add_material())
scene.add_lamp("point", (1, 1, 1), lacuna.look_at((0, 0, 1), (0, 0, 0)))
scene.add_camera(lacuna.look_at((0, 0, 1), (0, 0, 0)), yfov=0.5, aspect=1)
few = {"light_paths": 200, "candidates": 100, "train.paths": 2000, "train.light_paths": 2000, "train.subspaces": 20}
try:
    lacuna.render(scene, method="spcbpt", set=few, prepare=True, width=8, height=6, iterations=2, threads=2)
except lacuna.Error as error:
    sys.exit(str(error))
