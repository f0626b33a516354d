"""Follows the links of a shader tree: through reroutes and groups, to constants, images and vertex colours."""

import math
from dataclasses import dataclass, replace

from .textures import Use



@dataclass(frozen=True)
class Source:
    """An output of a node, and the groups that the node is in, outermost first."""

    node: object
    output: object
    groups: tuple


@dataclass(frozen=True)
class Value:
    """`factor` (a number, or three) times the texture, times the vertex colours of that name."""

    factor: object
    texture: Use = None
    vertex_colors: str = None


def source_of(socket, groups=()):
    """What feeds an input, or None where nothing does; then the socket's own value counts."""
    while True:
        if not socket.is_linked:
            return None
        link = socket.links[0]
        if link.is_muted:
            return None
        node, output = link.from_node, link.from_socket
        if node.type == "REROUTE":
            socket = node.inputs[0]
        elif node.type == "GROUP" and node.node_tree:
            inside = next((n for n in node.node_tree.nodes if n.type == "GROUP_OUTPUT" and n.is_active_output), None)
            if inside is None:
                return None
            socket = next(s for s in inside.inputs if s.identifier == output.identifier)
            groups += (node,)
        elif node.type == "GROUP_INPUT" and groups:
            socket = next(s for s in groups[-1].inputs if s.identifier == output.identifier)
            groups = groups[:-1]
            if not socket.is_linked:
                return Source(None, socket, groups)  # the group's own constant
        else:
            return Source(node, output, groups)


def constant(socket):
    value = socket.default_value
    return tuple(value[:3]) if hasattr(value, "__len__") else float(value)


class Sockets:
    """Reads inputs of one material; what it cannot follow goes into `notes` by the material's name."""

    def __init__(self, name, notes):
        self._name, self._notes = name, notes

    def color(self, socket, groups=()):
        found = source_of(socket, groups)
        if found is None or found.node is None:
            return Value(_three(constant(found.output if found else socket)))
        node = found.node
        if node.type == "TEX_IMAGE" and found.output.name == "Color":
            return Value((1.0, 1.0, 1.0), self.image(node, found.groups)) if self._usable(node) else Value((0.8, 0.8, 0.8))
        if node.type == "RGB":
            return Value(tuple(node.outputs[0].default_value[:3]))
        if node.type == "VALUE":
            return Value(_three(float(node.outputs[0].default_value)))
        if node.type == "VERTEX_COLOR":
            return Value((1.0, 1.0, 1.0), None, node.layer_name)
        if node.type == "ATTRIBUTE" and node.attribute_type == "GEOMETRY":
            return Value((1.0, 1.0, 1.0), None, node.attribute_name)
        product = self._product(node, found.groups)
        if product:
            return product
        return Value(_three(self._unknown(found, socket)))

    def scalar(self, socket, groups=()):
        found = source_of(socket, groups)
        if found is None or found.node is None:
            return Value(luminance(constant(found.output if found else socket)))
        node = found.node
        if node.type == "TEX_IMAGE" and self._usable(node):
            channel = "A" if found.output.name == "Alpha" else ""
            return Value(1.0, replace(self.image(node, found.groups), channel=channel))
        if node.type == "VALUE":
            return Value(float(node.outputs[0].default_value))
        if node.type in ("SEPRGB", "SEPARATE_COLOR"):
            color = self.color(node.inputs[0], found.groups)
            at = list(node.outputs).index(found.output)
            return Value(color.factor[at], color.texture and replace(color.texture, channel="RGB"[at]))
        if node.type == "MATH" and node.operation == "MULTIPLY":
            a, b = self.scalar(node.inputs[0], found.groups), self.scalar(node.inputs[1], found.groups)
            if not (a.texture and b.texture):
                return Value(a.factor * b.factor, a.texture or b.texture)
        return Value(luminance(self._unknown(found, socket)))

    def normal(self, socket, groups=()):
        """A normal map and its strength, or None."""
        found = source_of(socket, groups)
        if found is None or found.node is None:
            return None
        node = found.node
        if node.type == "NORMAL_MAP" and node.space == "TANGENT":
            color = self.color(node.inputs["Color"], found.groups)
            if color.texture:
                use = replace(color.texture, uv_map=node.uv_map or color.texture.uv_map)
                return use, self.scalar(node.inputs["Strength"], found.groups).factor
        self._notes.add(self._name, f"the node {node.bl_label} for normals is left out: the surface is smooth")
        return None

    def image(self, node, groups):
        place, uv_map = None, ""
        found = source_of(node.inputs["Vector"], groups)
        if found and found.node and found.node.type == "MAPPING":
            place = self._place(found.node, found.groups)
            found = source_of(found.node.inputs["Vector"], found.groups)
        if found and found.node:
            if found.node.type == "UVMAP":
                uv_map = found.node.uv_map
            elif not (found.node.type == "TEX_COORD" and found.output.name == "UV"):
                self._notes.add(self._name, f"the image {node.image.name} lies by UV and not by "
                                f"{found.node.bl_label}, {found.output.name}")
        if node.extension == "CLIP":
            self._notes.add(self._name, f"the image {node.image.name} ends in its rim's colour, not in black")
        return Use(node.image, uv_map, place, node.extension)

    def _place(self, node, groups):
        """Blender moves coordinates whose v points up, glTF those whose v points down."""
        inputs = node.inputs
        if node.vector_type != "POINT" or any(s.is_linked for s in inputs[1:] if s.enabled):
            self._notes.add(self._name, f"a Mapping node of type {node.vector_type.title()}, or with links, is left out")
            return None
        (tx, ty, _), (ax, ay, turn), (sx, sy, _) = (tuple(inputs[n].default_value) for n in ("Location", "Rotation", "Scale"))
        if ax or ay:
            self._notes.add(self._name, "a Mapping node turns about Z only")
        c, s = math.cos(turn), math.sin(turn)
        return (tx - s * sy, 1 - ty - c * sy), turn, (sx, sy)

    def _product(self, node, groups):
        """The product of two colours, of which one at most has a texture; or None."""
        if node.type == "MIX_RGB":
            factor, a, b = node.inputs[0], node.inputs[1], node.inputs[2]
        elif node.type == "MIX" and node.data_type == "RGBA":
            factor, a, b = (s for s in node.inputs if s.enabled)
        else:
            return None
        if node.blend_type != "MULTIPLY" or factor.is_linked or factor.default_value != 1:
            return None
        a, b = self.color(a, groups), self.color(b, groups)
        if (a.texture and b.texture) or (a.vertex_colors is not None and b.vertex_colors is not None):
            return None
        colors = a.vertex_colors if a.vertex_colors is not None else b.vertex_colors
        return Value(tuple(p * q for p, q in zip(a.factor, b.factor)), a.texture or b.texture, colors)

    def _usable(self, node):
        image = node.image
        if image and image.source in ("FILE", "GENERATED", "VIEWER") and image.size[0] > 0:
            return True
        what = f"the image {image.name}" if image else "an Image Texture without an image"
        self._notes.add(self._name, what + " cannot be read, or is no plain image: grey is used")
        return False

    def _unknown(self, found, socket):
        value = constant(socket) if hasattr(socket, "default_value") else 0.5
        self._notes.add(self._name, f"the node {found.node.bl_label} for {socket.name} is left out: "
                        f"{_said(value)} is used, the value beside the input")
        return value


def _said(value):
    return "%.3g" % value if isinstance(value, float) else "(%.3g, %.3g, %.3g)" % tuple(value)


def _three(value):
    return (value,) * 3 if isinstance(value, float) else tuple(value)


def luminance(value):
    """Of a colour; a number is its own."""
    return value if isinstance(value, float) else 0.2126 * value[0] + 0.7152 * value[1] + 0.0722 * value[2]
