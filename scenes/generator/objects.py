"""Things to put into rooms; all stand on y = 0 around the origin unless said otherwise."""

from __future__ import annotations

import math

from .building import SUNK
from .mesh import Mesh, box, inside_out, lathe, merged, moved, sphere, torus


def vase(height: float) -> Mesh:
    """Slender, hollow, closed: fit for glass and for metal."""
    outer = [(0.00, 0.00), (0.16, 0.00), (0.22, 0.10), (0.25, 0.25), (0.22, 0.45), (0.14, 0.65), (0.11, 0.80), (0.13, 0.92),
             (0.17, 1.00)]
    inner = [(0.15, 1.00), (0.11, 0.92), (0.09, 0.80), (0.12, 0.65), (0.19, 0.45), (0.22, 0.25), (0.18, 0.10), (0.00, 0.06)]
    return lathe([(r * height, y * height) for r, y in outer + inner], 32, crease_degrees=50.0)


def goblet(height: float) -> Mesh:
    """Foot, stem and bowl; closed."""
    outer = [(0.00, 0.00), (0.26, 0.00), (0.26, 0.02), (0.06, 0.06), (0.035, 0.14), (0.035, 0.40), (0.12, 0.48), (0.24, 0.58),
             (0.29, 0.72), (0.28, 0.86), (0.25, 1.00)]
    inner = [(0.235, 1.00), (0.265, 0.86), (0.275, 0.72), (0.225, 0.60), (0.11, 0.51), (0.00, 0.48)]
    return lathe([(r * height, y * height) for r, y in outer + inner], 32, crease_degrees=50.0)


def bowl(radius: float) -> Mesh:
    arc = [math.radians(a) for a in (20, 35, 50, 65, 80)]
    outer = [(0.0, 0.0)] + [(math.sin(a), 1 - math.cos(a)) for a in arc]
    inner = [(0.94 * math.sin(a), 1 - 0.94 * math.cos(a)) for a in reversed(arc)] + [(0.0, 0.06)]
    return lathe([(r * radius, y * radius) for r, y in outer + inner], 32, crease_degrees=50.0)


def pot(radius: float, height: float) -> Mesh:
    """Cooking pot with a lid, a knob and two ring handles."""
    r, h = radius, height
    body = lathe([(0.0, 0.0), (0.92 * r, 0.0), (r, 0.08 * h), (r, h), (1.05 * r, h), (1.05 * r, 1.04 * h), (0.6 * r, 1.16 * h),
                  (0.0, 1.2 * h)], 40)
    knob = moved(sphere(0.12 * r, 8, 16), (0.0, 1.27 * h, 0.0))
    ring = torus(0.22 * r, 0.05 * r, 20, 8)
    return merged([body, knob] + [moved(ring, (s * 1.18 * r, 0.8 * h, 0.0)) for s in (-1, 1)])


def jug(height: float) -> Mesh:
    """Pot-bellied, closed at the top by a lid; a stand-in for the teapots of other people's scenes."""
    profile = [(0.00, 0.00), (0.28, 0.00), (0.42, 0.12), (0.50, 0.30), (0.49, 0.48), (0.38, 0.68), (0.27, 0.78), (0.30, 0.84),
               (0.20, 0.92), (0.07, 0.95), (0.09, 1.01), (0.00, 1.05)]
    return lathe([(r * height, y * height) for r, y in profile], 40, crease_degrees=50.0)


def chair() -> Mesh:
    """Seat at 0.45 m, back towards +Z."""
    legs = [box((x - 0.02, -SUNK, z - 0.02), (x + 0.02, 0.44, z + 0.02)) for x in (-0.17, 0.17) for z in (-0.17, 0.17)]
    posts = [box((x - 0.018, 0.44, 0.16), (x + 0.018, 0.85, 0.19)) for x in (-0.15, 0.15)]
    return merged([box((-0.2, 0.43, -0.2), (0.2, 0.46, 0.2)), box((-0.2, 0.66, 0.165), (0.2, 0.84, 0.185)), *legs, *posts])


def globe(radius: float, thickness: float) -> Mesh:
    """A hollow ball of glass around the origin, as lamps have."""
    return merged([sphere(radius, 8, 16), inside_out(sphere(radius - thickness, 8, 16))])


def column(height: float, radius: float, segments: int = 24) -> Mesh:
    """Base, shaft with entasis, capital."""
    r, h = radius, height
    shaft = [(0.98 * r + 0.02 * r * math.sin(math.pi * t), 0.07 * h + 0.84 * h * t) for t in (0.0, 0.25, 0.5, 0.75, 1.0)]
    return lathe([(0.0, -SUNK), (1.35 * r, -SUNK), (1.35 * r, 0.03 * h), (1.15 * r, 0.06 * h), *shaft, (1.1 * r, 0.93 * h),
                  (1.4 * r, 0.97 * h), (1.4 * r, h + SUNK), (0.0, h + SUNK)], segments)
