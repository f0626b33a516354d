"""Lacuna, an offline renderer for scenes in which light has to find its way.

    import lacuna
    image = lacuna.render("door.glb", width=640, time=30)
    image.rgb                  # NumPy, (height, width, 3), float32, linear Rec. 709 radiance
    image.layers["albedo"]     # the same for every layer of an .exr
    image.statistics           # what lacuna-render --json writes
    image.save("door.exr")

Options have the names of `lacuna-render --help`, with _ for -. Pixels are those of the program, bit
for bit. Errors are exceptions: UsageError, InputError, RunError.
"""

from __future__ import annotations

import json
import os
import warnings as _warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._lacuna import (
    Error,
    InputError,
    Interrupted,
    Progress,
    RunError,
    UsageError,
    __version__,
)
from . import _lacuna
from .scene import Scene, look_at
from .study import study

__all__ = [
    "Error", "Image", "InputError", "Interrupted", "LacunaWarning", "Progress", "RunError", "Scene",
    "UsageError", "__version__", "look_at", "methods", "render", "study",
]


class LacunaWarning(UserWarning):
    """The picture may not be what was meant."""


class Layers(Mapping[str, NDArray[np.float32]]):
    """The layers of an image by name: "albedo", "normal", "Z", "variance", ..; "" is the picture.

    A layer of three channels is an array (height, width, 3), any other one (height, width).
    """

    _PARTS = ("RGB", "XYZ")

    def __init__(self, picture: _lacuna.Picture):
        self._picture = picture
        self._channels = picture.channels()
        names = dict.fromkeys(self._layer_of(channel) for channel in self._channels)
        self._names = list(names)

    def _parts(self, layer: str) -> list[str] | None:
        prefix = layer + "." if layer else ""
        for parts in self._PARTS:
            channels = [prefix + part for part in parts]
            if all(channel in self._channels for channel in channels):
                return channels
        return None

    def _layer_of(self, channel: str) -> str:
        layer = channel.rpartition(".")[0]
        triple = self._parts(layer)
        return layer if triple and channel in triple else channel

    def __getitem__(self, layer: str) -> NDArray[np.float32]:
        triple = self._parts(layer)
        if triple:
            return np.stack([self._picture.channel(channel) for channel in triple], axis=-1)
        if layer not in self._names:
            raise KeyError(f"{layer!r}: expected one of {self._names}")
        return self._picture.channel(layer)

    def __iter__(self) -> Iterator[str]:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)

    def __repr__(self) -> str:
        return f"Layers({self._names})"


class Image:
    """A picture with its layers and statistics. It is immutable."""

    def __init__(self, rgb: Any):
        """`rgb`: an array (height, width, 3), or the picture of a render."""
        own = isinstance(rgb, _lacuna.Picture)
        self._picture: _lacuna.Picture = (
            rgb if own else _lacuna.Picture(np.asarray(rgb, dtype=np.float32))
        )

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Image:
        """Reads an .exr with its layers, an .hdr, .pfm or .png. Raises InputError."""
        return cls(_lacuna.Picture.load(os.fspath(path)))

    @property
    def width(self) -> int:
        return self._picture.width

    @property
    def height(self) -> int:
        return self._picture.height

    @property
    def rgb(self) -> NDArray[np.float32]:
        """Linear Rec. 709 radiance: (height, width, 3), float32. A read-only view."""
        return self._picture.rgb

    @property
    def layers(self) -> Layers:
        return Layers(self._picture)

    @property
    def statistics(self) -> dict[str, Any]:
        """The statistics that `lacuna-render --json` writes; for an image that was read or relit,
        its header."""
        statistics: dict[str, Any] = json.loads(self._picture.statistics())
        return statistics

    def relight(self, lights: Mapping[str, float | Sequence[float]]) -> Image:
        """The image under changed light: {"sun": .1, "lamps": (2, 1.8, 1.4)} multiplies these
        groups by a number, or by one number per channel; the others stay as they are. The render
        must have had light_groups=True; with light_noise=True the result has a "variance" as well.
        Layers that depend on the old light are left out. Raises UsageError for a group that does
        not exist or a factor below 0, InputError for an image without groups.
        """
        factors = {group: _three(factor) for group, factor in lights.items()}
        return Image(self._picture.relight(factors))

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes an .exr with all layers, a .pfm, or a .png with automatic exposure. Raises RunError."""
        self._picture.save(os.fspath(path))

    def compare(self, reference: Image | NDArray[Any]) -> dict[str, float]:
        """mae, rmse, mape and relmse against a reference. Raises InputError if sizes differ."""
        other = reference if isinstance(reference, Image) else Image(reference)
        return self._picture.compare(other._picture)

    def __array__(self, dtype: Any = None) -> NDArray[Any]:
        return np.asarray(self.rgb, dtype=dtype)

    def __repr__(self) -> str:
        return f"<lacuna.Image {self.width} x {self.height}>"


def _three(factor: float | Sequence[float]) -> list[float]:
    values = np.ravel(np.asarray(factor, dtype=float))
    if values.size not in (1, 3):
        raise UsageError(f"relight: expected a factor or three of them, found {values.size}")
    return [float(v) for v in np.broadcast_to(values, 3)]


def _text(value: Any) -> str:
    if isinstance(value, (str, os.PathLike)):
        return os.fspath(value)
    if isinstance(value, bool):
        return "on" if value else "off"
    if isinstance(value, (list, tuple, np.ndarray)):
        return ",".join(_text(v) for v in value)
    if isinstance(value, (float, np.floating)):
        return repr(float(value))
    return str(value)


def _assignments(values: Mapping[str, Any] | None) -> list[tuple[str, str]]:
    return [(key, _text(value)) for key, value in (values or {}).items()]


def render(
    scene: str | os.PathLike[str] | Scene,
    *,
    set: Mapping[str, Any] | None = None,
    on_progress: Callable[[Progress], None] | None = None,
    **options: Any,
) -> Image:
    """Renders a scene: a .glb or .gltf file, or a lacuna.Scene.

    `options` are those of `lacuna-render --help`: method="bpt", width=640, time=30 (seconds, or
    "10m"), crop=(0, 32, 0, 32), until={"mape": .05}, effect={"clearcoat": False}, prepare=True,
    layer={"caustics": "C.*D[GS]+L"}, output="door.exr". None leaves an option out. `set` holds parameters of the
    method: set={"candidates": 200}.

    `on_progress` is called when a phase begins and after each iteration, with a Progress: phase,
    iterations, limit, seconds, time_limit, accuracy, and preview(), the current picture or None. An
    exception that it raises ends the render. Ctrl-C ends it as well: the output is written, then
    KeyboardInterrupt is raised. Other Python threads run meanwhile.

    Raises UsageError, InputError, RunError. Warnings are LacunaWarning.
    """
    given: list[tuple[str, str]] = []
    flags: list[str] = []
    for name, value in options.items():
        if value is None or value is False:
            continue
        if value is True:
            flags.append(name)
        elif isinstance(value, Mapping):
            given += [(name, f"{key}={text}") for key, text in _assignments(value)]
        else:
            given.append((name, _text(value)))
    source: str | _lacuna.SceneBuilder = (
        scene._builder if isinstance(scene, Scene) else os.fspath(scene)
    )
    told: list[str] = []
    picture = _lacuna.render(source, given, flags, _assignments(set), on_progress, told.append)
    for text in told:
        _warnings.warn(text.removeprefix("warning: "), LacunaWarning, stacklevel=2)
    return Image(picture)


def methods() -> list[dict[str, Any]]:
    """All methods: name, summary, reference, and parameters with their defaults as text."""
    return _lacuna.methods()
