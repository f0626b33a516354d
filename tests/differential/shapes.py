"""Shapes in the cube from -1 to 1, with all that a mesh may say of its vertices."""

import math


class Mesh:
    """Points of the unit cube (-1 to 1) with all that may go with them."""

    def __init__(self, points, normals, places, triangles, mode=4, strip=None):
        self.points, self.normals, self.places = points, normals, places
        self.triangles, self.mode, self.strip = triangles, mode, strip


def box(inward=False):
    points, normals, places, triangles = [], [], [], []
    for axis in range(3):
        for side in (-1, 1):
            first = len(points)
            for u, v in ((-1, -1), (1, -1), (1, 1), (-1, 1)):
                point = [0, 0, 0]
                point[axis], point[(axis + 1) % 3], point[(axis + 2) % 3] = side, u, v
                points.append(tuple(point))
                normal = [0, 0, 0]
                normal[axis] = -side if inward else side
                normals.append(tuple(normal))
                places.append(((u + 1) / 2, (v + 1) / 2))
            order = (0, 1, 2, 0, 2, 3) if (side > 0) != inward else (0, 2, 1, 0, 3, 2)
            triangles += [tuple(first + i for i in order[:3]), tuple(first + i for i in order[3:])]
    return Mesh(points, normals, places, triangles)


def sphere(columns, rows):
    points, places, triangles = [], [], []
    for j in range(rows + 1):
        for i in range(columns + 1):
            phi, theta = 2 * math.pi * (i % columns) / columns, math.pi * j / rows
            points.append((math.sin(theta) * math.cos(phi), math.cos(theta), math.sin(theta) * math.sin(phi)))
            places.append((i / columns, j / rows))
    for j in range(rows):
        for i in range(columns):
            a, b = j * (columns + 1) + i, (j + 1) * (columns + 1) + i
            triangles += ([(a, a + 1, b)] if j else []) + ([(a + 1, b + 1, b)] if j + 1 < rows else [])
    return Mesh(points, points, places, triangles)


def quad():
    """In the plane y = 0, seen from above; its corners are a strip."""
    points = [(-1, 0, 1), (1, 0, 1), (-1, 0, -1), (1, 0, -1)]
    places = [((x + 1) / 2, (z + 1) / 2) for x, _, z in points]
    return Mesh(points, [(0, 1, 0)] * 4, places, [(0, 1, 2), (2, 1, 3)], 5, [0, 1, 2, 3])


def disc(corners):
    rim = [(math.cos(2 * math.pi * i / corners), 0, -math.sin(2 * math.pi * i / corners)) for i in range(corners)]
    points = [(0, 0, 0), *rim, rim[0]]
    places = [((x + 1) / 2, (z + 1) / 2) for x, _, z in points]
    return Mesh(points, [(0, 1, 0)] * len(points), places, [(0, i + 1, i + 2) for i in range(corners)], 6,
                list(range(len(points))))


def splinters(r, count):
    points = [tuple(r.uniform(-1, 1) for _ in range(3)) for _ in range(3 * count)]
    normals = [tuple(r.gauss(0, 1) for _ in range(3)) for _ in points]
    return Mesh(points, normals, [(r.random(), r.random()) for _ in points],
                [(3 * i, 3 * i + 1, 3 * i + 2) for i in range(count)])
