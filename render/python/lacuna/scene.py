"""Scenes from arrays. Units and axes are glTF's: +Y up, radiance and W/sr unscaled."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._lacuna import SceneBuilder, UsageError


def look_at(
    eye: Sequence[float], target: Sequence[float], up: Sequence[float] = (0, 1, 0)
) -> NDArray[np.float64]:
    """The matrix (4, 4) of a camera or lamp at `eye` whose -Z axis points at `target`."""
    return np.array(SceneBuilder.look_at(eye, target, up)).reshape(4, 4).T


def _columns(matrix: Any) -> list[float]:
    array = np.eye(4) if matrix is None else np.asarray(matrix, dtype=float)
    if array.shape != (4, 4):
        raise UsageError(f"transform: expected an array (4, 4), found {array.shape}")
    columns: list[float] = array.T.ravel().tolist()
    return columns


def _rows(name: str, values: Any, width: int, dtype: Any) -> NDArray[Any]:
    array = np.asarray(values)
    if array.ndim != 2 or array.shape[1] != width:
        raise UsageError(f"{name}: expected an array (n, {width}), found {array.shape}")
    if np.issubdtype(dtype, np.unsignedinteger):
        if not np.issubdtype(array.dtype, np.integer):
            raise UsageError(f"{name}: expected integers, found {array.dtype}")
        for index in (array.min(), array.max()) if array.size else ():
            if not 0 <= index <= np.iinfo(dtype).max:
                raise UsageError(f"{name}: expected indices from 0, of 32 bits, found {index}")
    return np.ascontiguousarray(array, dtype=dtype)


def _rows_or_none(name: str, values: Any, width: int) -> NDArray[np.float32] | None:
    return None if values is None else _rows(name, values, width, np.float32)


class Scene:
    """Meshes, materials, textures, lamps and cameras. Each kind is numbered from 0, in the order of adding."""

    def __init__(self) -> None:
        self._builder = SceneBuilder()

    def add_texture(self, rgba: Any) -> int:
        """Adds an image (height, width, 4) of 8-bit R, G, B, A, top row first. Returns its
        index."""
        array = np.asarray(rgba)
        if array.dtype != np.uint8:
            raise UsageError(f"add_texture: expected 8-bit unsigned integers, found {array.dtype}")
        return self._builder.add_texture(array)

    def add_material(self, **values: Any) -> int:
        """A material of glTF's kind. `values`, with their defaults:

        name "", base_colour (1, 1, 1), alpha 1, metallic 0, roughness 1, specular 1 (0: Lambert),
        ior 1.5, transmission 0, solid False (a body that refracts; else a thin sheet), attenuation
        (1, 1, 1) over attenuation_distance 0, clearcoat 0, clearcoat_roughness 0, sheen (0, 0, 0),
        sheen_roughness 0, anisotropy 0 (how much rougher along u), anisotropy_rotation 0 (radians),
        diffuse_transmission 0, diffuse_transmission_colour (1, 1, 1), emission (0, 0, 0) in
        radiance, double_sided False (emission), alpha_mode "opaque" ("mask", "blend"),
        alpha_cutoff .5, normal_scale 1; and the textures base_colour_texture,
        metallic_roughness_texture, normal_texture, emission_texture, transmission_texture.
        """
        material = SceneBuilder.Material()
        for name, value in values.items():
            if not hasattr(material, name):
                raise UsageError(f"add_material: there is no value '{name}'; see its help")
            if name == "alpha_mode":
                modes = SceneBuilder.Alpha.__members__
                if value not in modes:
                    raise UsageError(f"alpha_mode: expected one of {list(modes)}, found {value!r}")
                value = modes[value]
            setattr(material, name, value)
        return self._builder.add_material(material)

    def add_mesh(
        self,
        positions: Any,
        triangles: Any,
        *,
        normals: Any = None,
        uvs: Any = None,
        colours: Any = None,
        material: int | None = None,
        place: bool = True,
    ) -> int:
        """Adds a mesh of positions (n, 3) and triangles (m, 3), counterclockwise seen from the
        front. Normals (n, 3), uvs (n, 2; v points down) and colours (n, 4; factors of the base
        colour) are optional. The mesh is placed once, untransformed, unless `place` is False: see
        add_instance. Returns its index.
        """
        mesh = self._builder.add_mesh(
            _rows("positions", positions, 3, np.float32),
            _rows("triangles", triangles, 3, np.uint32),
            _rows_or_none("normals", normals, 3),
            _rows_or_none("uvs", uvs, 2),
            _rows_or_none("colours", colours, 4),
            material,
        )
        if place:
            self.add_instance(mesh)
        return mesh

    def add_instance(self, mesh: int, to_world: Any = None) -> None:
        """Places a mesh by a matrix (4, 4). A mesh can be placed any number of times."""
        self._builder.add_instance(mesh, _columns(to_world))

    def add_camera(
        self, to_world: Any, *, yfov: float = 0.8, aspect: float = 0.0, name: str = ""
    ) -> None:
        """Adds a camera that looks along -Z of its matrix (look_at). `yfov`: full vertical angle in
        radians."""
        self._builder.add_camera(name, _columns(to_world), yfov, aspect)

    def add_lamp(
        self,
        kind: str,
        intensity: Sequence[float],
        to_world: Any,
        *,
        inner: float = 0.0,
        outer: float = np.pi / 4,
    ) -> None:
        """Adds a lamp: "point", "spot" (W/sr) or "directional" (W/m^2 normal to its rays). It
        shines along -Z. `inner` and `outer` are the half angles of a spot in radians.
        """
        self._builder.add_lamp(kind, intensity, _columns(to_world), inner, outer)

    def glb(self) -> bytes:
        """The scene as a .glb file."""
        return self._builder.glb()

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the .glb. Raises RunError."""
        self._builder.save(os.fspath(path))
