"""Operations on textures, texel by texel: mixtures by a mask, and normal maps from heights. Independent of Blender's
nodes."""

import math
from dataclasses import replace

import numpy

from .textures import Picture, linear, resized, scalar


def white(name, use):
    """A white Picture with as many texels as the use's image."""
    return Picture(f"{name}, white", numpy.ones((*scalar(use).shape, 3)))


def mixed(name, a, b, mask):
    """(1 - mask) a + mask b, texel by texel. Returns a factor and the Use of the new picture, which is called `name`.
    `a`, `b`: pairs of a factor (a number, or three) and a Use or None; `mask`: such a pair with a number. All uses must
    be placed alike."""
    share = numpy.clip(_texels(*mask), 0, 1)
    sides = [_texels(*side) for side in (a, b)]
    shape = max((share.shape, *(s.shape for s in sides)), key=lambda s: s[0] * s[1])
    share, first, second = (resized(values, shape) for values in (share, *sides))
    made = (1 - share) * first + share * second
    use = next((use for _, use in (mask, a, b) if use), None)
    if use is None:
        return (float(made[0, 0, 0]) if isinstance(a[0], float) else tuple(float(c) for c in made[0, 0])), None
    most = max(float(made.max()), 1.0)
    rgb = numpy.broadcast_to(made / most, (*shape[:2], 3))
    return most if isinstance(a[0], float) else (most,) * 3, replace(use, image=Picture(name, rgb), channel="")


def _texels(factor, use):
    """The values of a factor times a Use: height x width x 1 or 3."""
    if isinstance(factor, float):
        return numpy.full((1, 1, 1), factor, numpy.float32) if use is None else factor * scalar(use)[..., None]
    texels = numpy.ones((1, 1, 3), numpy.float32) if use is None else linear(use.image)[..., :3]
    return numpy.array(factor, numpy.float32) * texels


def normals_of_heights(name, use, distance, strength, size):
    """The normal map of a bump, as a Use. `distance`: metres between heights 0 and 1; `size`: side of the square of
    texture coordinates in metres; `strength`: weight of the bump."""
    heights = scalar(use) * (distance / size)
    rows, columns = heights.shape
    wrapped = use.wrap == "REPEAT"
    padded = numpy.pad(heights, 1, mode="wrap" if wrapped else "edge")
    across = (padded[1:-1, 2:] - padded[1:-1, :-2]) * (columns / 2)
    up = (padded[:-2, 1:-1] - padded[2:, 1:-1]) * (rows / 2)
    if use.place:
        _, turn, (sx, sy) = use.place
        c, s = math.cos(turn), math.sin(turn)
        across, up = sx * (c * across + s * up), sy * (c * up - s * across)
    bumped = numpy.dstack([-across, -up, numpy.ones_like(up)])
    bumped /= numpy.linalg.norm(bumped, axis=2, keepdims=True)
    bumped *= strength
    bumped[..., 2] += 1 - strength
    bumped /= numpy.linalg.norm(bumped, axis=2, keepdims=True)
    return replace(use, image=Picture(name, 0.5 * bumped + 0.5), channel="")
