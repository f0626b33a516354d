"""Meshes and samples of lamps with a size, in the lamp's own coordinates. Independent of Blender."""

import math

import numpy


def rectangle(width, height):
    """Corners and triangles in the plane z = 0, facing -z like Blender's area lamps."""
    x, y = width / 2, height / 2
    corners = numpy.array([[-x, -y, 0], [-x, y, 0], [x, y, 0], [x, -y, 0]], numpy.float32)
    return corners, numpy.array([0, 1, 2, 0, 2, 3], numpy.uint32)


def ellipse(width, height, sides=48):
    """The same for an ellipse: a fan around its centre."""
    turn = numpy.arange(sides) * (2 * math.pi / sides)
    rim = numpy.stack([numpy.cos(turn) * width / 2, numpy.sin(turn) * height / 2, numpy.zeros(sides)], axis=1)
    corners = numpy.concatenate([[[0, 0, 0]], rim]).astype(numpy.float32)
    at = numpy.arange(sides)
    triangles = numpy.stack([numpy.zeros(sides, int), (at + 1) % sides + 1, at + 1], axis=1)
    return corners, triangles.ravel().astype(numpy.uint32)


def sphere(radius, halvings):
    """The same for a ball around the origin, facing outwards: an icosahedron whose edges are halved `halvings`
    times."""
    g = (1 + math.sqrt(5)) / 2
    points = [(-1, g, 0), (1, g, 0), (-1, -g, 0), (1, -g, 0), (0, -1, g), (0, 1, g), (0, -1, -g), (0, 1, -g),
              (g, 0, -1), (g, 0, 1), (-g, 0, -1), (-g, 0, 1)]
    faces = [(0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4), (11, 10, 2),
             (10, 7, 6), (7, 1, 8), (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8), (3, 8, 9), (4, 9, 5), (2, 4, 11),
             (6, 2, 10), (8, 6, 7), (9, 8, 1)]
    for _ in range(halvings):
        middles, finer = {}, []

        def middle(a, b):
            key = (min(a, b), max(a, b))
            if key not in middles:
                middles[key] = len(points)
                points.append(tuple((p + q) / 2 for p, q in zip(points[a], points[b])))
            return middles[key]

        for a, b, c in faces:
            ab, bc, ca = middle(a, b), middle(b, c), middle(c, a)
            finer += [(a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca)]
        faces = finer
    corners = numpy.array(points, float)
    corners *= radius / numpy.linalg.norm(corners, axis=1, keepdims=True)
    return corners.astype(numpy.float32), numpy.array(faces, numpy.uint32).ravel()


def area(corners, triangles):
    """Area in squared units of the corners."""
    a, b, c = (corners[triangles[i::3]].astype(float) for i in range(3))
    return float(numpy.linalg.norm(numpy.cross(b - a, c - a), axis=1).sum() / 2)


def disk_samples(count):
    """Evenly distributed points of the unit disk, in a sunflower pattern. Their mean is nearly, but not exactly, the
    centre."""
    at = numpy.arange(count) + 0.5
    radius, turn = numpy.sqrt(at / count), at * (math.pi * (3 - math.sqrt(5)))
    return numpy.stack([radius * numpy.cos(turn), radius * numpy.sin(turn)], axis=1)
