"""The world: one colour, or a latitude-longitude image, turned as Blender turns it."""

import math
import os

import numpy

from . import exr
from .sockets import Sockets, source_of
from .textures import linear

# The middle of an image is +X in Blender, and -Z (Blender's +Y) in Lacuna.
BETWEEN = 90.0


def options(world, folder, notes):
    """What lacuna-render is told; an image is written into `folder`."""
    if world is None:
        return []
    if not world.use_nodes:
        return _colour(world.color)
    output = world.node_tree.get_output_node("CYCLES")
    if output is None:
        return []
    if output.inputs["Volume"].is_linked:
        notes.add(world.name, "the world's volume is left out")
    found = source_of(output.inputs["Surface"])
    if found is None or found.node is None:
        return []
    if found.node.type != "BACKGROUND":
        notes.add(world.name, f"the world's {found.node.bl_label} is left out, and with it the world: a Background node is expected")
        return []
    sockets = Sockets(world.name, notes)
    strength = sockets.scalar(found.node.inputs["Strength"], found.groups).factor
    picture = source_of(found.node.inputs["Color"], found.groups)
    if picture and picture.node and picture.node.type == "TEX_ENVIRONMENT":
        return _image(world, picture, strength, folder, notes)
    return _colour([strength * c for c in sockets.color(found.node.inputs["Color"], found.groups).factor])


def _colour(colour):
    colour = [max(c, 0.0) for c in colour]
    return ["--env-colour", "%.9g,%.9g,%.9g" % tuple(colour)] if max(colour) > 0 else []


def _image(world, found, strength, folder, notes):
    node = found.node
    if node.image is None or node.image.size[0] == 0 or node.projection != "EQUIRECTANGULAR":
        notes.add(world.name, "the world's image cannot be read, or is no latitude-longitude map: the world is black")
        return []
    values = linear(node.image)[..., :3]
    turn = BETWEEN
    mapping = source_of(node.inputs["Vector"], found.groups)
    if mapping and mapping.node and mapping.node.type == "MAPPING":
        matrix = _matrix(mapping.node, world, notes)
        if _turns_about_z(matrix):
            turn += math.degrees(math.atan2(matrix[1, 0], matrix[0, 0]))
        else:
            values = _resampled(values, matrix)
    path = os.path.join(folder, "world.exr")
    exr.write(path, numpy.maximum(numpy.nan_to_num(values, posinf=0), 0))
    return ["--env", path, "--env-rotate", "%.9g" % (turn % 360), "--env-scale", "%.9g" % max(strength, 0.0)]


def _matrix(node, world, notes):
    """From the direction of a ray to that which is looked up."""
    from mathutils import Euler
    if any(s.is_linked for s in list(node.inputs)[1:] if s.enabled) or any(
            node.inputs["Location"].default_value if "Location" in node.inputs and node.inputs["Location"].enabled else ()):
        notes.add(world.name, "Location and links of the world's Mapping node are left out")
    turn = numpy.array(Euler(node.inputs["Rotation"].default_value).to_matrix())
    scale = numpy.diag(numpy.array(node.inputs["Scale"].default_value))
    matrix = turn @ scale
    return numpy.linalg.pinv(matrix) if node.vector_type == "TEXTURE" else matrix


def _turns_about_z(matrix):
    turn = math.atan2(matrix[1, 0], matrix[0, 0])
    c, s = math.cos(turn), math.sin(turn)
    return numpy.allclose(matrix, [[c, -s, 0], [s, c, 0], [0, 0, 1]], atol=1e-6)


def _resampled(values, matrix):
    """The map as it would have to be without the Mapping node; linear between texels."""
    height, width, _ = values.shape
    longitude = (0.5 - (numpy.arange(width) + 0.5) / width) * 2 * math.pi
    latitude = (0.5 - (numpy.arange(height) + 0.5) / height) * math.pi
    x = numpy.cos(latitude)[:, None] * numpy.cos(longitude)
    y = numpy.cos(latitude)[:, None] * numpy.sin(longitude)
    z = numpy.sin(latitude)[:, None] * numpy.ones(width)
    x, y, z = numpy.moveaxis(numpy.stack([x, y, z], axis=-1) @ matrix.T, -1, 0)
    u = (0.5 - numpy.arctan2(y, x) / (2 * math.pi)) * width - 0.5
    v = (0.5 - numpy.arctan2(z, numpy.hypot(x, y)) / math.pi) * height - 0.5
    column, row = numpy.floor(u).astype(int), numpy.floor(v).astype(int)
    fu, fv = (u - column)[..., None], (v - row)[..., None]

    def texel(r, c):
        return values[numpy.clip(r, 0, height - 1), c % width]

    return (texel(row, column) * (1 - fu) + texel(row, column + 1) * fu) * (1 - fv) + \
        (texel(row + 1, column) * (1 - fu) + texel(row + 1, column + 1) * fu) * fv
