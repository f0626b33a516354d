"""The world: one colour, or a latitude-longitude image with its rotation. Cycles renders all others to an image."""

import math
import os

import numpy

from . import exr
from .sockets import all_nodes, constant, source_of
from .textures import linear

# The centre of an image is +X in Blender, and -Z (Blender's +Y) in Lacuna.
BETWEEN = 90.0
_PLAIN, _WITH_SUN, _WIDEST = 512, 2048, 4096  # widths of panoramas in texels


def options(world, folder, notes, cycles):
    """The options of lacuna-render for the world; an image is written to `folder`."""
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
    plain = _plain(found, folder)
    return _panorama(world, folder, notes, cycles) if plain is None else plain


def _plain(found, folder):
    """The options for a Background of constants, or of an image and a Mapping node; None for all others."""
    if found.node.type != "BACKGROUND":
        return None
    strength = _constant(found.node.inputs["Strength"], found.groups)
    colour = _constant(found.node.inputs["Color"], found.groups)
    if strength is None:
        return None
    if colour is not None:
        return _colour([strength * c for c in colour])
    picture = source_of(found.node.inputs["Color"], found.groups)
    return _image(picture, strength, folder) if picture.node.type == "TEX_ENVIRONMENT" else None


def _constant(socket, groups):
    """The value of an input without nodes, or None."""
    found = source_of(socket, groups)
    if found is None:
        return constant(socket)
    return constant(found.output) if found.node is None or found.node.type in ("RGB", "VALUE") else None


def _panorama(world, folder, notes, cycles):
    nodes = list(all_nodes(world.node_tree))
    images = [n.image.size[0] for n in nodes if n.type in ("TEX_ENVIRONMENT", "TEX_IMAGE") and n.image]
    # A sun is half a degree wide; a rotated image needs twice its texels.
    widths = [_WITH_SUN if any(n.type == "TEX_SKY" for n in nodes) else _PLAIN, *(2 * i for i in images)]
    values = cycles.panorama(world, min(max(widths), _WIDEST))
    if values is None:
        notes.add(world.name, "the world's nodes cannot be followed: it is black")
        return []
    if any(n.type == "LIGHT_PATH" for n in nodes):
        notes.add(world.name, "Light Path: all light is that of the world that the camera sees")
    if (values == values[0, 0]).all():
        return _colour([float(c) for c in values[0, 0]])
    return _map(values, BETWEEN, 1.0, folder)


def _colour(colour):
    colour = [max(c, 0.0) for c in colour]
    return ["--env-colour", "%.9g,%.9g,%.9g" % tuple(colour)] if max(colour) > 0 else []


def _image(found, strength, folder):
    """The options for an unchanged image, if it is at most rotated about Z; else None."""
    node = found.node
    if node.image is None or node.image.size[0] == 0 or node.projection != "EQUIRECTANGULAR":
        return None
    turn = _turn(source_of(node.inputs["Vector"], found.groups))
    if turn is None:
        return None
    return _map(linear(node.image)[..., :3], BETWEEN + math.degrees(turn), strength, folder)


def _turn(found):
    """The angle by which the source of an image's Vector rotates it about Z; None if it does anything else."""
    if found is None or _is_direction(found):
        return 0.0
    if found.node is None or found.node.type != "MAPPING" or found.node.vector_type == "TEXTURE":
        return None
    inputs = found.node.inputs
    if any(s.is_linked for s in inputs[1:] if s.enabled) or not _is_direction(source_of(inputs["Vector"], found.groups)):
        return None
    moved = any(inputs["Location"].default_value) if inputs["Location"].enabled else False
    x, y, z = inputs["Rotation"].default_value
    plain = not moved and abs(x) + abs(y) < 1e-6 and all(abs(s - 1) < 1e-6 for s in inputs["Scale"].default_value)
    return z if plain else None


def _is_direction(found):
    return bool(found and found.node and found.node.type == "TEX_COORD" and found.output.name == "Generated")


def _map(values, turn, strength, folder):
    path = os.path.join(folder, "world.exr")
    exr.write(path, numpy.maximum(numpy.nan_to_num(values, posinf=0), 0))
    return ["--env", path, "--env-rotate", "%.9g" % (turn % 360), "--env-scale", "%.9g" % max(strength, 0.0)]
