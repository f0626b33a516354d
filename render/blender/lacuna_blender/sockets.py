"""Follows the links of a shader tree, through reroutes and groups, to constants, images and vertex colours, and to
other nodes, which Cycles evaluates."""

import math
from dataclasses import dataclass, replace

from .body import UNWRAPPED
from .textures import Picture, Use, placed_alike

# Nodes whose outputs are functions of their inputs at the same place.
_POINTWISE = frozenset((
    "BLACKBODY", "BRIGHTCONTRAST", "CLAMP", "COMBHSV", "COMBINE_COLOR", "COMBRGB", "COMBXYZ", "CURVE_FLOAT", "CURVE_RGB", "CURVE_VEC",
    "GAMMA", "HUE_SAT", "INVERT", "LIGHT_PATH", "MAP_RANGE", "MATH", "MIX", "MIX_RGB", "RGB", "RGBTOBW", "SEPARATE_COLOR", "SEPHSV",
    "SEPRGB", "SEPXYZ", "SQUEEZE", "VALTORGB", "VALUE", "VECT_MATH", "WAVELENGTH"))
# Nodes that depend on more than the point on a surface.
_ELSEWHERE = frozenset((
    "AMBIENT_OCCLUSION", "BEVEL", "CAMERA", "FRESNEL", "HAIR_INFO", "LAYER_WEIGHT", "OBJECT_INFO", "PARTICLE_INFO", "POINT_INFO",
    "VOLUME_INFO", "WIREFRAME"))


@dataclass(frozen=True)
class Source:
    """An output of a node, and the groups that contain the node, outermost first."""

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
    """The source of an input, or None if it has none; then the socket's own value counts."""
    while True:
        if not socket.is_linked:
            return None
        link = socket.links[0]
        if link.is_muted:
            return None
        node, output = link.from_node, link.from_socket
        if node.type == "REROUTE":
            socket = node.inputs[0]
        elif node.mute:
            through = next((l.from_socket for l in node.internal_links if l.to_socket == output), None)
            if through is None:
                return None
            socket = through
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


def made_of(found):
    """All sources upstream of an output, each node once, except for those upstream of images that are placed by UV."""
    known, asked = {}, [found]
    while asked:
        source = asked.pop()
        key = (source.node.name, source.output.name, tuple(g.name for g in source.groups))
        if key in known:
            continue
        known[key] = source
        if not _lies_by_uv(source):
            behind = [source_of(s, source.groups) for s in source.node.inputs if s.enabled]
            asked += [b for b in behind if b and b.node]
    return list(known.values())


def _lies_by_uv(source):
    """Whether this is an image placed by a UV map and at most one Mapping node."""
    if source.node.type != "TEX_IMAGE" or source.node.projection != "FLAT":
        return False
    found = source_of(source.node.inputs["Vector"], source.groups)
    if found and found.node and found.node.type == "MAPPING":
        if not _moves_flat(found.node):
            return False
        found = source_of(found.node.inputs["Vector"], found.groups)
    return found is None or found.node is not None and (
        found.node.type == "UVMAP" or found.node.type == "TEX_COORD" and found.output.name == "UV")


def _moves_flat(mapping):
    """Whether a Mapping node can be expressed as KHR_texture_transform."""
    inputs = mapping.inputs
    return mapping.vector_type == "POINT" and not any(s.is_linked for s in inputs[1:] if s.enabled) and \
        not any(inputs["Rotation"].default_value[:2])


def _depends_on_more(source):
    """Whether a source depends on more than the point on a surface: on the eye, on other objects, or on the
    instance."""
    node, output = source.node, source.output.name
    return node.type in _ELSEWHERE or node.type == "TEX_COORD" and output in ("Camera", "Window", "Reflection") or \
        node.type == "NEW_GEOMETRY" and output in ("Incoming", "Backfacing") or \
        node.type == "ATTRIBUTE" and node.attribute_type != "GEOMETRY"


def all_nodes(tree):
    """All nodes of a tree, including those in groups."""
    for node in tree.nodes:
        yield node
        if node.type == "GROUP" and node.node_tree:
            yield from all_nodes(node.node_tree)


def constant(socket):
    value = socket.default_value
    return tuple(value[:3]) if hasattr(value, "__len__") else float(value)


class Sockets:
    """Reads inputs of one material, lamp or world. Inputs that it cannot follow are reported in `notes` under its
    name."""

    def __init__(self, owner, notes, cycles, body=None, baked=False):
        """`body`: the body with the material; `baked`: whether all textures are baked on it."""
        self._owner, self._name, self._notes, self._cycles, self._body, self._all = owner, owner.name, notes, cycles, body, baked

    def color(self, socket, groups=()):
        found = source_of(socket, groups)
        return self._baked_if_all(found) or self._color(socket, found)

    def _color(self, socket, found):
        if found is None or found.node is None:
            return Value(_three(constant(found.output if found else socket)))
        node = found.node
        if _lies_by_uv(found) and found.output.name == "Color":
            return Value((1.0, 1.0, 1.0), self.image(node, found.groups)) if self._usable(node) else Value((0.8, 0.8, 0.8))
        if node.type == "RGB":
            return Value(tuple(node.outputs[0].default_value[:3]))
        if node.type == "VALUE":
            return Value(_three(float(node.outputs[0].default_value)))
        if node.type == "VERTEX_COLOR":
            return Value((1.0, 1.0, 1.0), None, node.layer_name)
        if node.type == "ATTRIBUTE" and node.attribute_type == "GEOMETRY":
            return Value((1.0, 1.0, 1.0), None, node.attribute_name)
        return self._product(node, found.groups) or self._evaluated(found) or Value(_three(self._unknown(found, socket)))

    def scalar(self, socket, groups=()):
        found = source_of(socket, groups)
        value = self._baked_if_all(found)
        if value:
            return Value(luminance(value.factor), value.texture)
        if found is None or found.node is None:
            return Value(luminance(constant(found.output if found else socket)))
        node = found.node
        if _lies_by_uv(found) and self._usable(node):
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
        value = self._evaluated(found)
        return Value(luminance(value.factor), value.texture) if value else Value(luminance(self._unknown(found, socket)))

    def normal(self, socket, groups=()):
        """A normal map and its strength, or None."""
        found = source_of(socket, groups)
        if found is None or found.node is None:
            return None
        node = found.node
        if node.type == "NORMAL_MAP" and node.space == "TANGENT":
            socket = node.inputs["Color"]
            color = self._color(socket, source_of(socket, found.groups))  # never baked: it refers to its own UV map
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
        if found and found.node and found.node.type == "UVMAP":
            uv_map = found.node.uv_map
        if node.extension == "CLIP":
            self._notes.add(self._name, f"the image {node.image.name} ends in its rim's colour, not in black")
        return Use(node.image, uv_map, place, node.extension, node.interpolation == "Closest")

    def _place(self, node, groups):
        """The transform of a Mapping node for glTF: v points up in Blender and down in glTF."""
        (tx, ty, _), (_, _, turn), (sx, sy, _) = (tuple(node.inputs[n].default_value) for n in ("Location", "Rotation", "Scale"))
        c, s = math.cos(turn), math.sin(turn)
        return (tx - s * sy, 1 - ty - c * sy), turn, (sx, sy)

    def _product(self, node, groups):
        """The product of two colours, of which at most one has a texture; or None."""
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

    def _evaluated(self, found):
        """Cycles's evaluation of the nodes upstream of an output: on the square of their images if they depend on
        nothing else, or on the body if its position matters. None if it cannot be evaluated."""
        behind = made_of(found)
        if any(map(_depends_on_more, behind)) or not all(self._usable(s.node) for s in behind if s.node.type == "TEX_IMAGE"):
            return None
        images = [self.image(s.node, s.groups) for s in behind if _lies_by_uv(s)]
        flat = all(_lies_by_uv(source) or source.node.type in _POINTWISE for source in behind) and placed_alike(images)
        value = self._flat(found, images) if flat else self._baked(found)
        if value and any(source.node.type == "LIGHT_PATH" for source in behind):
            self._notes.add(self._name, "Light Path: all light meets what the camera sees")
        return value

    def _baked_if_all(self, found):
        """The baked value if all textures are to be baked and this is more than a constant; else None."""
        if not self._all or found is None or found.node is None or found.node.type in ("RGB", "VALUE"):
            return None
        behind = made_of(found)
        constant_ = all(source.node.type in _POINTWISE for source in behind)
        return None if constant_ or any(map(_depends_on_more, behind)) else self._baked(found)

    def _baked(self, found):
        texels, size = self._body.texels(self._owner, found, self._cycles.side) if self._body and self._cycles.side else (None, 0.0)
        if texels is None:
            return None
        name = self.name_of(found.node, found.groups, found.output.identifier, *self._body.key)
        return self._scaled(Use(Picture(name, texels), UNWRAPPED, None, "EXTEND", size=size))

    def name_of(self, node, groups, *more):
        """A unique name for a Picture made at a node. `more` must name everything else on which it depends."""
        return ", ".join((self._owner.name_full, *(g.name for g in groups), node.name, *more))

    @staticmethod
    def _scaled(use):
        """Moves the excess of texels above one into the factor."""
        most = max(float(use.image.texels.max()), 1.0)
        use.image.texels[..., :3] /= most
        return Value((most,) * 3, use)

    def _flat(self, found, images):
        size = [max((use.image.size[i] for use in images), default=1) for i in (0, 1)]
        texels = self._cycles.flat(self._owner, found, size)
        if texels is None:
            return None
        if not images:
            return Value(tuple(float(c) for c in texels[0, 0]))
        name = self.name_of(found.node, found.groups, found.output.identifier)
        return self._scaled(replace(images[0], image=Picture(name, texels)))

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
    """Luminance of a colour; a number is returned as it is."""
    return value if isinstance(value, float) else 0.2126 * value[0] + 0.7152 * value[1] + 0.0722 * value[2]
