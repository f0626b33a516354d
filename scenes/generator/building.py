"""Parts of buildings. Walls are slabs with thickness whose corners overlap without coinciding faces, so that no
light leaks at edges and no ray meets two surfaces at once."""

from __future__ import annotations

import math
from typing import Sequence

from .mesh import Mesh, box, grid, merged
from .vector import Vec3, add, cross, scaled

Rect = tuple[float, float, float, float]  # u0, u1, v0, v1
SUNK = 0.002  # metres by which standing things sink into their support, so that no faces coincide


def slab(origin: Vec3, u: Vec3, v: Vec3, width: float, height: float, thickness: float, openings: Sequence[Rect] = ()) -> Mesh:
    """Plate with rectangular openings; its front, through `origin`, looks along u x v (u, v: unit, orthogonal).
    Cut into a grid along the openings' edges: neighbours share whole edges. Texture coordinates are metres."""
    us = sorted({0.0, width, *(min(max(x, 0.0), width) for r in openings for x in r[:2])})
    vs = sorted({0.0, height, *(min(max(y, 0.0), height) for r in openings for y in r[2:])})
    inside = -thickness
    n = cross(u, v)

    def point(x: float, y: float, z: float) -> Vec3:
        return add(add(add(origin, scaled(u, x)), scaled(v, y)), scaled(n, z))

    def solid(i: int, j: int) -> bool:
        if not (0 <= i < len(us) - 1 and 0 <= j < len(vs) - 1):
            return False
        x, y = (us[i] + us[i + 1]) / 2, (vs[j] + vs[j + 1]) / 2
        return not any(r[0] < x < r[1] and r[2] < y < r[3] for r in openings)

    out = Mesh()

    def face(*corners: tuple[float, float, float]) -> None:
        """Texture coordinates are the two coordinates in which the face extends."""
        axes = [k for k in range(3) if len({c[k] for c in corners}) > 1]
        out.face([point(*c) for c in corners], [(c[axes[0]], c[axes[1]]) for c in corners])

    for j in range(len(vs) - 1):
        for i in range(len(us) - 1):
            if not solid(i, j):
                continue
            x0, x1, y0, y1, z0, z1 = us[i], us[i + 1], vs[j], vs[j + 1], inside, 0.0
            face((x0, y0, z1), (x1, y0, z1), (x1, y1, z1), (x0, y1, z1))
            face((x1, y0, z0), (x0, y0, z0), (x0, y1, z0), (x1, y1, z0))
            if not solid(i - 1, j):
                face((x0, y0, z0), (x0, y0, z1), (x0, y1, z1), (x0, y1, z0))
            if not solid(i + 1, j):
                face((x1, y0, z1), (x1, y0, z0), (x1, y1, z0), (x1, y1, z1))
            if not solid(i, j - 1):
                face((x0, y0, z0), (x1, y0, z0), (x1, y0, z1), (x0, y0, z1))
            if not solid(i, j + 1):
                face((x0, y1, z1), (x1, y1, z1), (x1, y1, z0), (x0, y1, z0))
    return out


X, Y, Z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
NX, NZ = (-1.0, 0.0, 0.0), (0.0, 0.0, -1.0)


def room(lo: Vec3, hi: Vec3, thickness: float, openings: dict[str, Sequence[Rect]] | None = None) -> dict[str, Mesh]:
    """The six sides of a room whose free space is lo..hi. Openings are given in world coordinates: (x0, x1, y0, y1)
    in back and front, (z0, z1, y0, y1) in left and right, (x0, x1, z0, z1) in floor and ceiling.
    Floor and ceiling reach under and over the walls, back and front reach past left and right."""
    t, cut = thickness, openings or {}
    (x0, y0, z0), (x1, y1, z1) = lo, hi
    w, h, d = x1 - x0, y1 - y0, z1 - z0

    def across(side: str, rise: float, start: float, sign: float) -> list[Rect]:
        """World rectangles in the slab's coordinates; `sign` is -1 if u runs against the world's axis."""
        return [(*sorted((sign * (a - start), sign * (b - start))), c - rise, e - rise) for a, b, c, e in cut.get(side, ())]

    floor = [(a - x0 + t, b - x0 + t, z1 + t - e, z1 + t - c) for a, b, c, e in cut.get("floor", ())]
    ceiling = [(a - x0 + t, b - x0 + t, c - z0 + t, e - z0 + t) for a, b, c, e in cut.get("ceiling", ())]
    return {
        "floor": slab((x0 - t, y0, z1 + t), X, NZ, w + 2 * t, d + 2 * t, t, floor),
        "ceiling": slab((x0 - t, y1, z0 - t), X, Z, w + 2 * t, d + 2 * t, t, ceiling),
        "back": slab((x0 - t, y0, z0), X, Y, w + 2 * t, h, t, across("back", y0, x0 - t, 1)),
        "front": slab((x1 + t, y0, z1), NX, Y, w + 2 * t, h, t, across("front", y0, x1 + t, -1)),
        "left": slab((x0, y0, z1), NZ, Y, d, h, t, across("left", y0, z1, -1)),
        "right": slab((x1, y0, z0), Z, Y, d, h, t, across("right", y0, z0, 1)),
    }


def table(width: float, height: float, depth: float, top: float = 0.04, leg: float = 0.06) -> tuple[Mesh, Mesh]:
    """(board, one leg); the leg is to be instanced at table_legs()."""
    board = box((-width / 2, height - top, -depth / 2), (width / 2, height, depth / 2))
    return board, box((-leg / 2, -SUNK, -leg / 2), (leg / 2, height - top + SUNK, leg / 2))


def table_legs(width: float, depth: float, inset: float = 0.08) -> list[Vec3]:
    x, z = width / 2 - inset, depth / 2 - inset
    return [(-x, 0.0, -z), (x, 0.0, -z), (-x, 0.0, z), (x, 0.0, z)]


def arch_panel(width: float, height: float, radius: float, thickness: float, segments: int) -> Mesh:
    """Closed wall panel x in [-width/2, width/2], y in [0, height], centred in z, with a half-round opening below."""
    out, h, t = Mesh(), width / 2, thickness / 2
    arc = [(radius * math.cos(math.pi * (1 - i / segments)), radius * math.sin(math.pi * i / segments))
           for i in range(segments + 1)]
    arc[0], arc[-1] = (-radius, 0.0), (radius, 0.0)
    lower = [(-h, 0.0), *arc, (h, 0.0)]
    for (xa, ya), (xb, yb) in zip(lower, lower[1:]):
        out.face([(xa, ya, t), (xb, yb, t), (xb, height, t), (xa, height, t)])
        out.face([(xb, yb, -t), (xa, ya, -t), (xa, height, -t), (xb, height, -t)])
        out.face([(xa, height, t), (xb, height, t), (xb, height, -t), (xa, height, -t)])
    for xa, xb in ((-h, -radius), (radius, h)):
        out.face([(xa, 0.0, -t), (xb, 0.0, -t), (xb, 0.0, t), (xa, 0.0, t)])
    out.face([(h, 0.0, t), (h, 0.0, -t), (h, height, -t), (h, height, t)])
    out.face([(-h, 0.0, -t), (-h, 0.0, t), (-h, height, t), (-h, height, -t)])
    base = len(out.positions)
    for x, y in arc:
        for z in (t, -t):
            out.vertex((x, y, z), (-x / radius, -y / radius, 0.0), (0.0, 0.0))
    out.grid_triangles(lambda i, j: base + 2 * j + i, 1, segments)
    return out


def barrel_vault(radius: float, depth: float, segments: int) -> Mesh:
    """Half cylinder above y = 0 along z in [-depth, 0]; its front looks down into the room."""
    def point(u: float, v: float) -> Vec3:
        return (radius * math.cos(math.pi * u), radius * math.sin(math.pi * u), -depth * v)

    return grid(point, segments, 1)


def rib(inner: float, outer: float, width: float, segments: int) -> Mesh:
    """Half ring of rectangular section above y = 0, centred in z; its feet stay open (they stand in walls)."""
    w = width / 2

    def strip(r0: float, z0: float, r1: float, z1: float) -> Mesh:
        def point(u: float, v: float) -> Vec3:
            r, z = r0 + (r1 - r0) * v, z0 + (z1 - z0) * v
            return (r * math.cos(math.pi * u), r * math.sin(math.pi * u), z)
        return grid(point, segments, 1)

    return merged([strip(inner, w, inner, -w), strip(inner, -w, outer, -w), strip(outer, -w, outer, w),
                   strip(outer, w, inner, w)])


def rows(first: Vec3, step: Vec3, count: int) -> list[Vec3]:
    return [add(first, scaled(step, i)) for i in range(count)]


def boxes(*corners: tuple[Vec3, Vec3]) -> Mesh:
    return merged(box(lo, hi) for lo, hi in corners)
