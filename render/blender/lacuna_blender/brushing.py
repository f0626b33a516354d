"""Anisotropic roughness: Blender's widths and tangents as glTF's strength, rotation and TANGENT."""

import math
from dataclasses import dataclass

import numpy

from .sockets import Value, source_of


@dataclass(frozen=True)
class Tangent:
    """The direction in which a surface is brushed: around an axis (0, 1, 2) of the object, or along u of a UV map."""

    axis: int = 2
    uv_map: str = None  # "": the active one; None: by the axis


@dataclass(frozen=True)
class Brushing:
    strength: float
    rotation: float  # radians, from the tangent, counterclockwise about the normal
    tangent: Tangent


def principled_widths(anisotropy):
    """Factors of alpha along the tangent and across it."""
    aspect = math.sqrt(1 - 0.9 * min(max(anisotropy, 0.0), 1.0))
    return 1 / aspect, aspect


def anisotropic_widths(anisotropy):
    """The same for Anisotropic BSDF: across is wider for positive values, along for negative ones."""
    a = min(max(anisotropy, -0.99), 0.99)
    return (1 / (1 + a), 1 + a) if a < 0 else (1 - a, 1 / (1 - a))


def brushed(roughness, along, across, turn, tangent):
    """The roughness across the brushing and the Brushing, in glTF's terms: along its direction alpha is mix(alpha, 1,
    strength^2). `turn`: rotation of the tangent in whole circles."""
    wide, narrow = max(along, across), min(along, across)
    rough = roughness.factor * (0.5 if roughness.texture else 1.0)
    alpha = min(max(rough, 0.0), 1.0) ** 2
    fine, coarse = alpha * narrow, min(alpha * wide, 1.0)
    strength = math.sqrt((coarse - fine) / (1 - fine)) if fine < 1 else 0.0
    rotation = 2 * math.pi * turn + (math.pi / 2 if along < across else 0.0)
    return (Value(roughness.factor * math.sqrt(narrow), roughness.texture),
            Brushing(strength, rotation, tangent or Tangent()))


def tangent_of(socket, groups):
    """The Tangent of a Tangent input; None if its link cannot be followed."""
    found = source_of(socket, groups) if socket else None
    if found is None or found.node is None:
        return Tangent()
    if found.node.type != "TANGENT":
        return None
    if found.node.direction_type == "UV_MAP":
        return Tangent(uv_map=found.node.uv_map)
    return Tangent("XYZ".index(found.node.axis))


def around(axis, points, normals):
    """Unit tangents by corner, around an axis through the centre of the points, as in Cycles: n x 4, the last component
    1."""
    low, high = points.min(axis=0), points.max(axis=0)
    x, y, z = ((points - (low + high) / 2) / numpy.maximum(high - low, 1e-12)).T
    nought = numpy.zeros_like(x)
    way = numpy.stack(((nought, -z, y), (z, nought, -x), (-y, x, nought))[axis], axis=1)
    return across_normals(way, normals)


def across_normals(way, normals):
    """The projections of directions to the surface, normalised; any tangent where the projection is zero."""
    flat = way - normals * (way * normals).sum(axis=1, keepdims=True)
    size = numpy.linalg.norm(flat, axis=1, keepdims=True)
    least = numpy.eye(3)[numpy.abs(normals).argmin(axis=1)]
    other = numpy.cross(normals, least)
    other /= numpy.maximum(numpy.linalg.norm(other, axis=1, keepdims=True), 1e-12)
    unit = numpy.where(size > 1e-6, flat / numpy.maximum(size, 1e-12), other)
    return numpy.concatenate((unit, numpy.ones((len(unit), 1))), axis=1).astype(numpy.float32)
