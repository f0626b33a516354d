"""Types of the native module, which is for this package alone."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

__version__: str

class Error(RuntimeError): ...
class UsageError(Error): ...
class InputError(Error): ...
class RunError(Error): ...
class Interrupted(Error): ...

class Progress:
    @property
    def phase(self) -> str: ...
    @property
    def iterations(self) -> int: ...
    @property
    def limit(self) -> int: ...
    @property
    def seconds(self) -> float: ...
    @property
    def time_limit(self) -> float: ...
    @property
    def accuracy(self) -> str: ...
    def preview(self) -> NDArray[np.float32] | None: ...

class Picture:
    def __init__(self, rgb: NDArray[np.float32]) -> None: ...
    @staticmethod
    def load(path: str) -> Picture: ...
    @property
    def width(self) -> int: ...
    @property
    def height(self) -> int: ...
    @property
    def rgb(self) -> NDArray[np.float32]: ...
    def channels(self) -> list[str]: ...
    def channel(self, name: str) -> NDArray[np.float32]: ...
    def statistics(self) -> str: ...
    def save(self, path: str) -> None: ...
    def relight(self, factors: Mapping[str, Sequence[float]]) -> Picture: ...
    def compare(self, reference: Picture) -> dict[str, float]: ...

class SceneBuilder:
    class Alpha:
        __members__: ClassVar[dict[str, SceneBuilder.Alpha]]
        opaque: ClassVar[SceneBuilder.Alpha]
        mask: ClassVar[SceneBuilder.Alpha]
        blend: ClassVar[SceneBuilder.Alpha]
        @property
        def name(self) -> str: ...
        @property
        def value(self) -> int: ...

    class Material:
        name: str
        base_colour: Sequence[float]
        alpha: float
        metallic: float
        roughness: float
        specular: float
        ior: float
        transmission: float
        solid: bool
        attenuation: Sequence[float]
        attenuation_distance: float
        clearcoat: float
        clearcoat_roughness: float
        sheen: Sequence[float]
        sheen_roughness: float
        anisotropy: float
        anisotropy_rotation: float
        diffuse_transmission: float
        diffuse_transmission_colour: Sequence[float]
        emission: Sequence[float]
        double_sided: bool
        alpha_mode: SceneBuilder.Alpha
        alpha_cutoff: float
        base_colour_texture: int | None
        metallic_roughness_texture: int | None
        normal_texture: int | None
        normal_scale: float
        emission_texture: int | None
        transmission_texture: int | None
        def __init__(self) -> None: ...

    def __init__(self) -> None: ...
    @staticmethod
    def look_at(
        eye: Sequence[float], target: Sequence[float], up: Sequence[float] = ...
    ) -> list[float]: ...
    def add_texture(self, rgba: NDArray[np.uint8]) -> int: ...
    def add_material(self, material: SceneBuilder.Material) -> int: ...
    def add_mesh(
        self,
        positions: NDArray[np.float32],
        triangles: NDArray[np.uint32],
        normals: NDArray[np.float32] | None,
        uvs: NDArray[np.float32] | None,
        colours: NDArray[np.float32] | None,
        material: int | None,
    ) -> int: ...
    def add_instance(self, mesh: int, to_world: Sequence[float]) -> None: ...
    def add_camera(
        self, name: str, to_world: Sequence[float], yfov: float, aspect: float
    ) -> None: ...
    def add_lamp(
        self,
        kind: str,
        intensity: Sequence[float],
        to_world: Sequence[float],
        inner: float,
        outer: float,
    ) -> None: ...
    def glb(self) -> bytes: ...
    def save(self, path: str) -> None: ...

def render(
    scene: str | SceneBuilder,
    options: list[tuple[str, str]],
    flags: list[str],
    settings: list[tuple[str, str]],
    on_progress: Callable[[Progress], None] | None,
    on_warning: Callable[[str], None],
) -> Picture: ...
def methods() -> list[dict[str, Any]]: ...
