"""Finds faces that coincide and look the same way. A ray that meets both takes whichever the machine's tracer finds
first, so pictures would differ between machines. Faces that look at each other are where solids touch, and no ray gets
there."""

from __future__ import annotations

import math
from collections import defaultdict
from itertools import product
from typing import Any, Iterator, Sequence

from .vector import Vec3, add, cross, dot, length, scaled, sub, unit

GAP = 1e-4       # metres: planes nearer than this are one; SUNK things are twenty times farther apart
OVERLAP = 1e-5   # square metres: less is rounding along a shared edge
ANGLE = 1e-3     # sine between the normals of faces that are parallel

Triangle = tuple[Vec3, Vec3, Vec3]
Affine = tuple[Vec3, Vec3, Vec3, Vec3]  # images of the axes, and of the origin


def _apply(m: Affine, p: Sequence[float], point: bool = True) -> Vec3:
    moved = add(add(scaled(m[0], p[0]), scaled(m[1], p[1])), scaled(m[2], p[2]))
    return add(moved, m[3]) if point else moved


def _local(node: dict[str, Any]) -> Affine:
    if "matrix" in node:
        c = node["matrix"]
        return (tuple(c[0:3]), tuple(c[4:7]), tuple(c[8:11]), tuple(c[12:15]))
    x, y, z, w = node.get("rotation", (0.0, 0.0, 0.0, 1.0))
    sx, sy, sz = node.get("scale", (1.0, 1.0, 1.0))
    return (scaled((1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)), sx),
            scaled((2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)), sy),
            scaled((2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)), sz),
            tuple(node.get("translation", (0.0, 0.0, 0.0))))


def placed_triangles(glb: Any) -> Iterator[tuple[str, Triangle]]:
    """All triangles as drawn, in metres, each with the name of its node."""
    def visit(index: int, parent: Affine) -> Iterator[tuple[str, Triangle]]:
        node = glb.all("nodes")[index]
        local = _local(node)
        world = (*(_apply(parent, axis, point=False) for axis in local[:3]), _apply(parent, local[3]))
        if "mesh" in node:
            for p in glb.all("meshes")[node["mesh"]]["primitives"]:
                points = [_apply(world, q) for q in glb.values(p["attributes"]["POSITION"])]
                indices = [i for (i,) in glb.values(p["indices"])]
                for t in zip(indices[0::3], indices[1::3], indices[2::3]):
                    yield node.get("name", str(index)), tuple(points[k] for k in t)
        for child in node.get("children", ()):
            yield from visit(child, world)

    for root in glb.json["scenes"][0]["nodes"]:
        yield from visit(root, ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0), (0.0, 0.0, 0.0)))


def _plane(t: Triangle) -> tuple[Vec3, float]:
    """Normal on the side of the winding, and distance from the origin along it."""
    n = unit(cross(sub(t[1], t[0]), sub(t[2], t[0])))
    return n, dot(n, t[0])


def _overlap(a: Triangle, b: Triangle, normal: Vec3) -> float:
    """Area that two triangles of one plane share: `a` clipped by the edges of `b`."""
    drop = max(range(3), key=lambda k: abs(normal[k]))
    u, v = (k for k in range(3) if k != drop)
    shape, knife = ([(p[u], p[v]) for p in t] for t in (a, b))
    turn = lambda p, q, r: (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])  # noqa: E731
    side = math.copysign(1.0, turn(*knife))
    for p, q in zip(knife, knife[1:] + knife[:1]):
        clipped = []
        for r, s in zip(shape, shape[1:] + shape[:1]):
            dr, ds = side * turn(p, q, r), side * turn(p, q, s)
            if dr >= 0:
                clipped.append(r)
            if (dr >= 0) != (ds >= 0):
                clipped.append((r[0] + (s[0] - r[0]) * dr / (dr - ds), r[1] + (s[1] - r[1]) * dr / (dr - ds)))
        shape = clipped
    twice = sum(p[0] * q[1] - q[0] * p[1] for p, q in zip(shape, shape[1:] + shape[:1]))
    return abs(twice) / 2 / abs(normal[drop])


def coincident_faces(triangles: Sequence[tuple[str, Triangle]]) -> dict[tuple[str, str], tuple[float, Vec3]]:
    """Pairs of names of nodes whose faces coincide: the area that they share (square metres) and a corner of one of them."""
    planes = [_plane(t) for _, t in triangles]
    bounds = [[(min(c), max(c)) for c in zip(*t)] for _, t in triangles]
    buckets: dict[tuple[int, ...], list[int]] = defaultdict(list)
    for i, (n, d) in enumerate(planes):
        # A triangle near a bucket's border lies in both, so that neighbours always meet in one.
        cells = [{math.floor((x - e) / size), math.floor((x + e) / size)}
                 for x, e, size in ((n[0], ANGLE, 0.05), (n[1], ANGLE, 0.05), (n[2], ANGLE, 0.05), (d, GAP, 0.01))]
        for key in product(*cells):
            buckets[key].append(i)

    found: dict[tuple[str, str], tuple[float, Vec3]] = {}
    seen: set[tuple[int, int]] = set()
    for members in buckets.values():
        members.sort(key=lambda i: bounds[i][0][0])
        for at, i in enumerate(members):
            n, d = planes[i]
            for j in members[at + 1:]:
                if bounds[j][0][0] > bounds[i][0][1]:
                    break  # the rest lies beyond, along x
                if any(a[0] > b[1] or b[0] > a[1] for a, b in zip(bounds[i][1:], bounds[j][1:])) or (i, j) in seen:
                    continue
                if dot(n, planes[j][0]) < 0 or length(cross(n, planes[j][0])) > ANGLE or any(abs(dot(n, p) - d) > GAP for p in triangles[j][1]):
                    continue
                seen.update(((i, j), (j, i)))
                area = _overlap(triangles[i][1], triangles[j][1], n)
                if area > OVERLAP:
                    pair = tuple(sorted((triangles[i][0], triangles[j][0])))
                    found[pair] = (found.get(pair, (0.0,))[0] + area, triangles[i][1][0])
    return found
