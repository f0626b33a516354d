"""Three-vectors as tuples, unit quaternions in glTF's order (x, y, z, w), and the camera's matrix."""

from __future__ import annotations

import math
from typing import Sequence

Vec3 = tuple[float, float, float]
Quat = tuple[float, float, float, float]


def add(a: Sequence[float], b: Sequence[float]) -> Vec3:
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2])


def sub(a: Sequence[float], b: Sequence[float]) -> Vec3:
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def scaled(a: Sequence[float], s: float) -> Vec3:
    return (a[0] * s, a[1] * s, a[2] * s)


def dot(a: Sequence[float], b: Sequence[float]) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a: Sequence[float], b: Sequence[float]) -> Vec3:
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def length(a: Sequence[float]) -> float:
    return math.sqrt(dot(a, a))


def unit(a: Sequence[float]) -> Vec3:
    return scaled(a, 1.0 / length(a))


def about(axis: Sequence[float], degrees: float) -> Quat:
    """Rotation by `degrees` about `axis`, counter-clockwise seen from the axis' tip."""
    half = math.radians(degrees) / 2
    s = scaled(unit(axis), math.sin(half))
    return (s[0], s[1], s[2], math.cos(half))


def about_x(degrees: float) -> Quat:
    return about((1, 0, 0), degrees)


def about_y(degrees: float) -> Quat:
    return about((0, 1, 0), degrees)


def about_z(degrees: float) -> Quat:
    return about((0, 0, 1), degrees)


def rotated(q: Quat, v: Sequence[float]) -> Vec3:
    """`v` turned by the rotation `q`."""
    t = scaled(cross(q[:3], v), 2.0)
    return add(add(v, scaled(t, q[3])), cross(q[:3], t))


def towards(direction: Sequence[float]) -> Quat:
    """Rotation that turns -Z, along which glTF's lights shine, into `direction`."""
    d = unit(direction)
    axis = cross((0, 0, -1), d)
    if length(axis) < 1e-9:
        return (0.0, 0.0, 0.0, 1.0) if d[2] < 0 else (0.0, 1.0, 0.0, 0.0)
    return about(axis, math.degrees(math.acos(-d[2])))


def camera_matrix(position: Sequence[float], target: Sequence[float]) -> list[float]:
    """Column-major camera-to-world matrix: looks along -Z, +Y up."""
    back = unit(sub(position, target))
    right = unit(cross((0, 1, 0), back))
    up = cross(back, right)
    return [*right, 0.0, *up, 0.0, *back, 0.0, *position, 1.0]
