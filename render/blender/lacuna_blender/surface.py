"""Converts a shader tree to one surface in glTF's model: each BSDF, and mixtures of them."""

import math
from dataclasses import dataclass, replace

from . import blend
from .brushing import Brushing, anisotropic_widths, brushed, principled_widths, tangent_of
from .sockets import Sockets, Value, luminance, source_of
from .textures import placed_alike, scalar

BLACK = Value((0.0, 0.0, 0.0))
# In Blender 3, Disney's coat of weight 1 reflects a quarter of the Fresnel reflectance.
DISNEY_COAT = 0.25
# Disney's sheen, (1 - cos)^5, expressed as glTF's sheen of microfibres: their albedos differ by at most a third from 30
# to 85 degrees.
DISNEY_SHEEN, DISNEY_SHEEN_ROUGHNESS = 0.1, 0.3


class LieApart(Exception):
    """Textures to be combined are placed differently on the surface: they must be baked."""


@dataclass
class Surface:
    base: Value = BLACK
    metallic: Value = Value(0.0)
    roughness: Value = Value(1.0)
    reflectance: float = 0.0  # of the dielectric layer at normal incidence; 0: Lambertian
    ior: float = 1.5  # for transmission
    transmission: Value = Value(0.0)
    coat: float = 0.0
    coat_roughness: float = 0.0
    alpha: Value = Value(1.0)
    emission: Value = BLACK
    strength: float = 0.0
    normal: object = None
    coat_normal: object = None
    sheen: tuple = (0.0, 0.0, 0.0)
    sheen_roughness: float = 0.0
    brushing: Brushing = None
    absorption: tuple = None  # of the body: transmittance by channel, and the distance in metres


class SurfaceReader:
    """Reads one material on a body whose square of texture coordinates has sides of `size` metres."""

    def __init__(self, material, body, size, notes, cycles, baked=False):
        """`baked`: whether all textures are baked on the body and thus placed alike."""
        self._name, self._size, self._notes, self._baked = material.name, size, notes, baked
        self._sockets = Sockets(material, notes, cycles, body, baked)
        self._readers = {
            "BSDF_PRINCIPLED": self._principled, "EMISSION": self._emission, "BSDF_DIFFUSE": self._diffuse,
            "BSDF_GLOSSY": self._glossy, "BSDF_ANISOTROPIC": self._glossy, "BSDF_GLASS": self._glass,
            "BSDF_REFRACTION": self._refraction, "BSDF_TRANSPARENT": self._transparent, "MIX_SHADER": self._mix,
            "ADD_SHADER": self._add, "BACKGROUND": self._emission}

    def read(self, socket, groups=()):
        """The surface of a shader input; black if nothing is linked."""
        found = source_of(socket, groups)
        if found is None or found.node is None:
            return Surface()
        reader = self._readers.get(found.node.type, self._other)
        return reader(found.node, found.groups)

    def absorption(self, socket):
        """Surface.absorption of a volume input; None, with a note, if it is not supported."""
        found = source_of(socket)
        if found and found.node and found.node.type == "VOLUME_ABSORPTION":
            density = self._number(found.node, found.groups, "Density")
            color = self._color(found.node, found.groups, "Color")
            if density > 0 and not color.texture:
                return tuple(math.exp(min(c, 1.0) - 1) for c in color.factor), 1 / density
        self._note("the volume is left out")
        return None

    def _note(self, text):
        self._notes.add(self._name, text)

    def _color(self, node, groups, *names):
        return self._sockets.color(_input(node, *names), groups)

    def _scalar(self, node, groups, *names, otherwise=0.0):
        socket = _input(node, *names)
        return self._sockets.scalar(socket, groups) if socket else Value(otherwise)

    def _number(self, node, groups, *names, otherwise=0.0):
        """A value without a texture; a texture is replaced by a number, with a note."""
        value = self._scalar(node, groups, *names, otherwise=otherwise)
        if value.texture:
            self._note(f"the texture of {names[0]} is left out: 0.5 is used")
            return 0.5
        return value.factor

    def _normal(self, node, groups, *names):
        """A normal map and its strength, or None."""
        socket = _input(node, *(names or ("Normal",)))
        found = socket and source_of(socket, groups)
        if found and found.node and found.node.type == "BUMP":
            return self._bump(found.node, found.groups)
        return self._sockets.normal(socket, groups) if socket else None

    def _bump(self, node, groups):
        under = source_of(node.inputs["Normal"], groups)
        if under and under.node:
            self._note("the normals under a Bump node are left out")
        heights = self._scalar(node, groups, "Height")
        if not heights.texture:
            return None  # a constant height has no effect
        distance = self._number(node, groups, "Distance") * heights.factor * (-1 if node.invert else 1)
        strength = min(max(self._number(node, groups, "Strength"), 0.0), 1.0)
        size = heights.texture.size or self._size
        name = self._sockets.name_of(node, groups, heights.texture.image.name, f"{size:.3g} m")
        return blend.normals_of_heights(name, heights.texture, distance, strength, size), 1.0

    def _sheen(self, node, groups, base):
        """Colour and roughness."""
        weight = self._number(node, groups, "Sheen", "Sheen Weight")
        if weight <= 0:
            return (0.0, 0.0, 0.0), 0.0
        if _input(node, "Sheen Roughness"):  # Blender 4
            tint = self._color(node, groups, "Sheen Tint").factor
            return tuple(weight * t for t in tint), self._number(node, groups, "Sheen Roughness")
        tint = self._number(node, groups, "Sheen Tint")
        brightness = luminance(base.factor)
        hue = tuple(c / brightness for c in base.factor) if brightness > 0 else (1.0, 1.0, 1.0)
        return tuple(min(DISNEY_SHEEN * weight * (1 - tint + tint * h), 1.0) for h in hue), DISNEY_SHEEN_ROUGHNESS

    def _brush(self, s, node, groups, widths):
        """Sets the surface's brushing if the node is anisotropic. `widths`: function from the anisotropy to factors of
        alpha."""
        along, across = widths(self._number(node, groups, "Anisotropic", "Anisotropy"))
        if along == across:
            return s
        if s.roughness.texture:
            self._note("a surface with a roughness texture is brushed as at half of its roughness")
        tangent = tangent_of(_input(node, "Tangent"), groups)
        if tangent is None:
            self._note("the node for the tangent is left out: brushed around Z")
        turn = self._number(node, groups, "Anisotropic Rotation", "Rotation")
        roughness, brushing = brushed(s.roughness, along, across, turn, tangent)
        return replace(s, roughness=roughness, brushing=brushing)

    def _principled(self, node, groups):
        for names in (("Subsurface", "Subsurface Weight"), ("Transmission Roughness",), ("Specular Tint",),
                      ("Thin Film Thickness",), ("Clearcoat Tint", "Coat Tint")):
            socket = _input(node, *names)
            value = socket and socket.default_value
            plain = 1.0 if "Tint" in names[0] and hasattr(value, "__len__") else 0.0
            if socket and (socket.is_linked or _differs(value, plain)):
                self._note(f"{socket.name} is left out")
        s = Surface(base=self._color(node, groups, "Base Color"), metallic=self._scalar(node, groups, "Metallic"),
                    roughness=self._scalar(node, groups, "Roughness"),
                    transmission=self._scalar(node, groups, "Transmission", "Transmission Weight"),
                    alpha=self._scalar(node, groups, "Alpha", otherwise=1.0), normal=self._normal(node, groups))
        s.ior = max(self._number(node, groups, "IOR", otherwise=1.45), 1.0)
        if _input(node, "Specular IOR Level"):  # Blender 4
            s.reflectance = 2 * self._number(node, groups, "Specular IOR Level") * ((s.ior - 1) / (s.ior + 1)) ** 2
        else:
            s.reflectance = 0.08 * self._number(node, groups, "Specular")
        s.coat = self._number(node, groups, "Clearcoat", "Coat Weight")
        if _input(node, "Clearcoat"):
            s.coat *= DISNEY_COAT
        s.coat_roughness = self._number(node, groups, "Clearcoat Roughness", "Coat Roughness")
        if s.coat > 0:
            s.coat_normal = self._normal(node, groups, "Clearcoat Normal", "Coat Normal")
        s.sheen, s.sheen_roughness = self._sheen(node, groups, s.base)
        s = self._shining(s, node, groups, "Emission", "Emission Color")
        return self._brush(s, node, groups, principled_widths)

    def _emission(self, node, groups):
        return self._shining(Surface(), node, groups, "Color")

    def _shining(self, s, node, groups, *colors):
        """Adds the emission of an input to the surface; only one of colour and strength may have a texture."""
        s.emission, strength = self._color(node, groups, *colors), self._scalar(node, groups, "Emission Strength", "Strength")
        s.strength = strength.factor
        if strength.texture and not s.emission.texture and not strength.texture.channel:
            s.emission = replace(s.emission, texture=strength.texture)
        elif strength.texture:
            self._note("the texture of the emission's strength is left out: half of it is used")
            s.strength *= 0.5
        return s

    def _diffuse(self, node, groups):
        if _input(node, "Roughness").is_linked or _input(node, "Roughness").default_value > 0:
            self._note("Roughness of Diffuse BSDF is left out: Lambert's is rendered")
        return Surface(base=self._color(node, groups, "Color"), normal=self._normal(node, groups))

    def _glossy(self, node, groups):
        sharp = getattr(node, "distribution", "") == "SHARP"
        s = Surface(base=self._color(node, groups, "Color"), metallic=Value(1.0), normal=self._normal(node, groups),
                    roughness=Value(0.0) if sharp else self._scalar(node, groups, "Roughness"))
        # Blender 4 has one node for both; the isotropic node of Blender 3 has no such input.
        return self._brush(s, node, groups, anisotropic_widths) if _input(node, "Anisotropy") and not sharp else s

    def _glass(self, node, groups):
        s = self._glossy(node, groups)
        s.metallic, s.transmission = Value(0.0), Value(1.0)
        s.ior = max(self._number(node, groups, "IOR"), 1.0)
        s.reflectance = ((s.ior - 1) / (s.ior + 1)) ** 2
        return s

    def _refraction(self, node, groups):
        self._note("Refraction BSDF is rendered as Glass BSDF: it reflects as well")
        return self._glass(node, groups)

    def _transparent(self, node, groups):
        color = self._color(node, groups, "Color")
        if color.texture or min(color.factor) < 1:
            self._note("the colour of Transparent BSDF is left out: it lets everything through")
        return Surface(alpha=Value(0.0))

    def _other(self, node, groups):
        color = _input(node, "Color", "Base Color")
        s = Surface(base=self._sockets.color(color, groups) if color else Value((0.5, 0.5, 0.5)))
        self._note(f"{node.bl_label} is rendered as " + ("Diffuse BSDF of its colour" if color else "grey"))
        return s

    def _mix(self, node, groups):
        a, b = self.read(node.inputs[1], groups), self.read(node.inputs[2], groups)
        for first, second, flip in ((a, b, False), (b, a, True)):
            if _is_clear(first) and not _is_clear(second):
                return self._thinned(second, node, groups, flip)
        found = source_of(node.inputs[0], groups)
        if found and found.node and found.node.type in ("FRESNEL", "LAYER_WEIGHT"):
            return self._layered(a, b)
        share = self._scalar(node, groups, "Fac", "Factor")
        if not share.texture and not 0 < share.factor < 1:
            return b if share.factor > 0 else a
        if not share.texture:
            self._note("a Mix Shader is rendered as one surface with the mean of both")
        return self._mixture(a, b, share, node, groups)

    def _thinned(self, solid, node, groups, flip):
        """A mixture with Transparent BSDF; the node's factor is the weight of the second shader."""
        share = self._scalar(node, groups, "Fac", "Factor")
        if not share.texture:
            factor = 1 - share.factor if flip else share.factor
            return replace(solid, alpha=replace(solid.alpha, factor=solid.alpha.factor * factor))
        sides = (solid.alpha, Value(0.0)) if flip else (Value(0.0), solid.alpha)
        return replace(solid, alpha=self._mixed("alpha", *sides, share, node, groups))

    def _layered(self, under, over):
        self._note("a mixture by Fresnel or Layer Weight is rendered as a glossy layer over the first shader")
        return replace(under, roughness=over.roughness, reflectance=0.04)

    def _mixture(self, a, b, share, node, groups):
        """A mixture of two shaders as one surface. Values that can have a texture are mixed texel by texel; the others
        are mixed as numbers."""
        f = min(max(share.factor * (float(scalar(share.texture).mean()) if share.texture else 1.0), 0.0), 1.0)

        def mean(p, q):
            return tuple(mean(x, y) for x, y in zip(p, q)) if isinstance(p, tuple) else (1 - f) * p + f * q

        made = Surface(normal=a.normal or b.normal, coat_normal=a.coat_normal or b.coat_normal, brushing=a.brushing or b.brushing,
                       ior=b.ior if b.transmission.factor > 0 else a.ior, sheen_roughness=max(a.sheen_roughness, b.sheen_roughness),
                       strength=1.0)
        for field in ("reflectance", "coat", "coat_roughness", "sheen"):
            setattr(made, field, mean(getattr(a, field), getattr(b, field)))
        for field in ("base", "metallic", "roughness", "transmission", "alpha"):
            setattr(made, field, self._mixed(field, getattr(a, field), getattr(b, field), share, node, groups))
        made.emission = self._mixed("emission", _light(a), _light(b), share, node, groups)
        lost = [word for word in ("reflectance", "coat", "sheen", "normal") if getattr(a, word) != getattr(b, word)]
        if share.texture and lost:
            self._note(f"both shaders of a Mix Shader by an image have the same {', '.join(lost)}")
        return made

    def _mixed(self, field, p, q, share, node, groups):
        """The mixture of two Values of a surface's field."""
        uses = [use for use in (share.texture, p.texture, q.texture) if use]
        if p == q:
            return p
        if p.vertex_colors is None and q.vertex_colors is None and placed_alike(uses):
            name = self._sockets.name_of(node, groups, field, *(use.image.name for use in uses))
            return Value(*blend.mixed(name, (p.factor, p.texture), (q.factor, q.texture), (share.factor, share.texture)))
        if not self._baked:
            raise LieApart
        self._note(f"images that lie apart cannot be mixed: the {field} of {node.name} is that of the second shader")
        return q

    def _add(self, node, groups):
        a, b = self.read(node.inputs[0], groups), self.read(node.inputs[1], groups)
        if b.base != BLACK or b.metallic.factor:
            a, b = b, a
        if b.base != BLACK:
            self._note("an Add Shader of two reflecting shaders is rendered as one surface with the mean of both")
            return self._mixture(a, b, Value(0.5), node, groups)
        half = self._mixed("emission", _light(a), _light(b), Value(0.5), node, groups)
        return replace(a, emission=half, strength=2.0)


def _light(s):
    """The surface's emission, including its strength."""
    return replace(s.emission, factor=tuple(s.strength * c for c in s.emission.factor))


def _input(node, *names):
    return next((node.inputs[n] for n in names if n in node.inputs), None)


def _differs(value, plain):
    return any(abs(v - plain) > 1e-6 for v in (value[:3] if hasattr(value, "__len__") else (value,)))


def _is_clear(surface):
    return surface.alpha.factor == 0 and not surface.alpha.texture
