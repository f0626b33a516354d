"""A tiny mesh library. Every shape is counter-clockwise seen from outside; closed shapes are closed exactly
(equal corners have equal coordinates), as glass needs it."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Callable, Iterable, Sequence

from .vector import Vec3, add, cross, scaled, sub, unit

Triangle = tuple[int, int, int]
ProfilePoint = tuple[float, float]  # (radius, height)


@dataclass
class Mesh:
    positions: list[Vec3] = field(default_factory=list)
    normals: list[Vec3] = field(default_factory=list)
    uvs: list[tuple[float, float]] = field(default_factory=list)
    triangles: list[Triangle] = field(default_factory=list)

    def vertex(self, position: Vec3, normal: Vec3, uv: tuple[float, float]) -> int:
        self.positions.append(position)
        self.normals.append(normal)
        self.uvs.append(uv)
        return len(self.positions) - 1

    def face(self, corners: Sequence[Vec3], uvs: Sequence[tuple[float, float]] | None = None) -> None:
        """A flat, convex polygon."""
        normal = unit(cross(sub(corners[1], corners[0]), sub(corners[2], corners[0])))
        uvs = uvs or ((0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0))
        first = [self.vertex(p, normal, uv) for p, uv in zip(corners, uvs)][0]
        for i in range(1, len(corners) - 1):
            self.triangles.append((first, first + i, first + i + 1))

    def grid_triangles(self, index: Callable[[int, int], int], nu: int, nv: int) -> None:
        """Two triangles per cell of a grid of vertices; cells that shrink to a point or a line are left out."""
        for j in range(nv):
            for i in range(nu):
                a, b, c, d = index(i, j), index(i + 1, j), index(i + 1, j + 1), index(i, j + 1)
                for t in ((a, b, c), (a, c, d)):
                    if len({self.positions[k] for k in t}) == 3:
                        self.triangles.append(t)


def merged(meshes: Iterable[Mesh]) -> Mesh:
    out = Mesh()
    for m in meshes:
        base = len(out.positions)
        out.positions += m.positions
        out.normals += m.normals
        out.uvs += m.uvs
        out.triangles += [(a + base, b + base, c + base) for a, b, c in m.triangles]
    return out


def moved(mesh: Mesh, offset: Sequence[float]) -> Mesh:
    return Mesh([add(p, offset) for p in mesh.positions], list(mesh.normals), list(mesh.uvs), list(mesh.triangles))


def inside_out(mesh: Mesh) -> Mesh:
    """The mesh turned inside out, for the inner side of a hollow body."""
    normals = [scaled(n, -1.0) for n in mesh.normals]
    return Mesh(list(mesh.positions), normals, list(mesh.uvs), [(a, c, b) for a, b, c in mesh.triangles])


def flat_shaded(mesh: Mesh) -> Mesh:
    """The mesh with separate corners for every triangle, where shading normals must be geometric (furnace)."""
    out = Mesh()
    for t in mesh.triangles:
        out.face([mesh.positions[k] for k in t], [mesh.uvs[k] for k in t])
    return out


def quad(origin: Vec3, u: Vec3, v: Vec3) -> Mesh:
    """Parallelogram whose front looks along u x v."""
    out = Mesh()
    out.face([origin, add(origin, u), add(add(origin, u), v), add(origin, v)])
    return out


def _box_sides(lo: Vec3, hi: Vec3) -> list[tuple[Vec3, Vec3, Vec3]]:
    """(corner, u, v) of the six sides, u x v outwards."""
    (x, y, z), (dx, dy, dz) = lo, sub(hi, lo)
    u, v, w = (dx, 0.0, 0.0), (0.0, dy, 0.0), (0.0, 0.0, dz)
    minus = lambda a: scaled(a, -1.0)  # noqa: E731
    return [((x, y, hi[2]), u, v), ((hi[0], y, z), minus(u), v), ((hi[0], y, hi[2]), minus(w), v),
            ((x, y, z), w, v), ((x, hi[1], hi[2]), u, minus(w)), ((x, y, z), u, w)]


def box(lo: Vec3, hi: Vec3, inward: bool = False) -> Mesh:
    out = Mesh()
    for corner, u, v in _box_sides(lo, hi):
        # Corners are picked from lo and hi instead of summed, so that neighbours agree to the last bit.
        points = [corner, add(corner, u), add(add(corner, u), v), add(corner, v)]
        points = [tuple(lo[k] if abs(p[k] - lo[k]) < abs(p[k] - hi[k]) else hi[k] for k in range(3)) for p in points]
        out.face(points[::-1] if inward else points)
    return out


def box_at(centre_bottom: Vec3, size: Vec3) -> Mesh:
    (x, y, z), (w, h, d) = centre_bottom, size
    return box((x - w / 2, y, z - d / 2), (x + w / 2, y + h, z + d / 2))


def grid(point: Callable[[float, float], Vec3], nu: int, nv: int) -> Mesh:
    """Smooth sheet point(u, v) over the unit square; its front looks along dp/du x dp/dv. Normals are averaged over the
    faces, because exact ones may look to a face's back if a fold is only a few cells wide."""
    out = Mesh()
    for j in range(nv + 1):
        for i in range(nu + 1):
            out.vertex(point(i / nu, j / nv), (0.0, 0.0, 0.0), (i / nu, j / nv))
    out.grid_triangles(lambda i, j: j * (nu + 1) + i, nu, nv)
    for t in out.triangles:
        a, b, c = (out.positions[k] for k in t)
        normal = cross(sub(b, a), sub(c, a))
        for k in t:
            out.normals[k] = add(out.normals[k], normal)
    out.normals = [unit(n) for n in out.normals]
    return out


def _circle(segments: int) -> list[tuple[float, float]]:
    """Directions around +Y; the last equals the first exactly, so that turned shapes close."""
    ring = [(math.cos(2 * math.pi * i / segments), math.sin(2 * math.pi * i / segments)) for i in range(segments)]
    return ring + ring[:1]


def lathe(profile: Sequence[ProfilePoint], segments: int, crease_degrees: float = 40.0, closed: bool = False) -> Mesh:
    """Turns a profile about +Y. The outside lies to the right of the profile's direction: upwards along the outer
    wall. Edges sharper than `crease_degrees` stay sharp. `closed` joins the last point to the first (rings)."""
    points = list(profile) + ([profile[0]] if closed else [])
    bands = [(points[i], points[i + 1]) for i in range(len(points) - 1)]
    normals = [_band_normal(*band) for band in bands]
    smooth = math.cos(math.radians(crease_degrees))
    out, circle = Mesh(), _circle(segments)

    def joint(i: int, j: int) -> tuple[float, float]:
        """Normal of band i at the end that it shares with band j."""
        if not closed and not 0 <= j < len(bands):
            return normals[i]
        a, b = normals[i], normals[j % len(bands)]
        if a[0] * b[0] + a[1] * b[1] < smooth:
            return a
        s = math.hypot(a[0] + b[0], a[1] + b[1])
        return ((a[0] + b[0]) / s, (a[1] + b[1]) / s)

    for i, band in enumerate(bands):
        base = len(out.positions)
        for k, ((radius, height), (nr, ny)) in enumerate(zip(band, (joint(i, i - 1), joint(i, i + 1)))):
            for s, (c, d) in enumerate(circle):
                # -d: with rising height this makes u x v look outwards.
                out.vertex((radius * c, height, -radius * d), (nr * c, ny, -nr * d), (s / segments, (i + k) / len(bands)))
        out.grid_triangles(lambda s, k: base + k * (segments + 1) + s, segments, 1)
    return out


def _band_normal(a: ProfilePoint, b: ProfilePoint) -> tuple[float, float]:
    dr, dy = b[0] - a[0], b[1] - a[1]
    size = math.hypot(dr, dy)
    return (dy / size, -dr / size)


def sphere(radius: float, rings: int, segments: int) -> Mesh:
    """Centred, with the sphere's own normals (vertices shared, unlike lathe's bands)."""
    out, circle = Mesh(), _circle(segments)
    for j in range(rings + 1):
        polar = math.pi * j / rings
        y, r = -math.cos(polar), (0.0 if j in (0, rings) else math.sin(polar))
        for i, (c, s) in enumerate(circle):
            normal = (r * c, y, -r * s)
            out.vertex(scaled(normal, radius), normal, (i / segments, j / rings))
    out.grid_triangles(lambda i, j: j * (segments + 1) + i, segments, rings)
    return out


def cylinder(radius: float, height: float, segments: int) -> Mesh:
    """Closed, standing on y = 0."""
    return lathe([(0.0, 0.0), (radius, 0.0), (radius, height), (0.0, height)], segments)


def torus(major: float, minor: float, segments: int, sides: int) -> Mesh:
    ring = [(major + minor * c, minor * s) for c, s in _circle(sides)[:-1]]
    return lathe(ring, segments, crease_degrees=180.0, closed=True)


def band_ring(inner: float, outer: float, height: float, bevel: float, segments: int) -> Mesh:
    """Finger-ring of rectangular section with bevelled edges, standing on y = 0."""
    i, o, h, b = inner, outer, height, bevel
    section = [(o - b, 0.0), (o, b), (o, h - b), (o - b, h), (i + b, h), (i, h - b), (i, b), (i + b, 0.0)]
    return lathe(section, segments, closed=True)


def drapery(width: float, height: float, folds: float, depth: float, nu: int, nv: int, gather: float = 0.0) -> Mesh:
    """Cloth hanging from y = height to y = 0, x in [-width/2, width/2], front +Z. Folds are sinusoidal and open
    towards the lower edge; `gather` (0..1) pulls it together at a third of its height, like a curtain tied up."""

    def point(u: float, v: float) -> Vec3:
        waist = 1.0 - gather * math.exp(-((v - 0.35) / 0.18) ** 2)
        opening = 0.45 + 0.55 * (1.0 - v)
        phase = 2 * math.pi * folds * u
        z = depth * opening * (math.sin(phase) + 0.3 * math.sin(2.3 * phase + 1.1 + 1.5 * v))
        return ((u - 0.5) * width * waist, v * height, z)

    return grid(point, nu, nv)


def signed_volume(mesh: Mesh) -> float:
    """Positive for closed meshes whose winding looks outwards."""
    total = 0.0
    for t in mesh.triangles:
        a, b, c = (mesh.positions[k] for k in t)
        n = cross(b, c)
        total += a[0] * n[0] + a[1] * n[1] + a[2] * n[2]
    return total / 6


def is_closed(mesh: Mesh) -> bool:
    """Every edge, joined by position, has exactly one partner that runs the other way."""
    edges: dict[tuple[Vec3, Vec3], int] = {}
    for t in mesh.triangles:
        p = [mesh.positions[k] for k in t]
        for a, b in ((p[0], p[1]), (p[1], p[2]), (p[2], p[0])):
            edges[(a, b)] = edges.get((a, b), 0) + 1
    return all(n == 1 and edges.get((b, a)) == 1 for (a, b), n in edges.items())

