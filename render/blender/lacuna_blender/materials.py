"""Materials of the .glb."""

import math
from dataclasses import dataclass, replace

from .blend import white
from .surface import LieApart, Surface, SurfaceReader
from .sockets import Value, all_nodes
from .textures import placed_alike


@dataclass
class Written:
    """A material of the .glb, and the attributes that it needs from its meshes."""

    index: int
    uv_maps: list  # names in the order of TEXCOORD_n
    vertex_colors: str = None
    tangent: object = None  # brushing.Tangent, if TANGENT is needed


class Materials:
    def __init__(self, glb, textures, notes, cycles):
        self._glb, self._textures, self._notes, self._cycles, self._made = glb, textures, notes, cycles, {}

    def of(self, material, hidden, body):
        """The Written for a material. `material`: bpy.types.Material, or None, which Blender renders grey. `hidden`:
        invisible to the camera. `body`: the body.Body with the material, which matters if it has bumps or is baked."""
        metres = _rounded(body.size()) if _has_bumps(material) else 1.0
        shared = (material and material.name_full, hidden, metres)
        own = (*shared, *body.key)
        if shared not in self._made and own not in self._made:
            name = material.name if material else "without a material"
            written = self._write(name, self._surface(material, name, metres, body), hidden)
            self._made[own if body.is_baked else shared] = written
        return self._made[shared] if shared in self._made else self._made[own]

    def lamp(self, name, radiance):
        """A material like Blender's lamps: black, emits to the front, invisible to the camera."""
        surface = Surface(emission=Value(tuple(radiance)), strength=1.0)
        return self._write(name, surface, True, two_sided=False)

    def _surface(self, material, name, metres, body):
        if material is None:
            return Surface(base=Value((0.8, 0.8, 0.8)))
        if not material.use_nodes:
            return Surface(base=Value(tuple(material.diffuse_color[:3])))
        output = material.node_tree.get_output_node("CYCLES")
        if output is None:
            return Surface()
        if output.inputs["Displacement"].is_linked:
            self._notes.add(name, "the displacement is left out")
        reader = SurfaceReader(material, body, metres, self._notes, self._cycles)
        try:
            found = reader.read(output.inputs["Surface"])
        except LieApart:
            found = None
        if found is None or not _fits(found):
            found = SurfaceReader(material, body, metres, self._notes, self._cycles, baked=True).read(output.inputs["Surface"])
        if output.inputs["Volume"].is_linked:
            found = replace(found, absorption=reader.absorption(output.inputs["Volume"]))
        return found

    def _write(self, name, s, hidden, two_sided=True):
        uv_maps = []

        def info(texture, use):
            if use.uv_map not in uv_maps:
                if len(uv_maps) == 2:
                    self._notes.add(name, f"the UV map {use.uv_map} is left out: two can be used")
                    return self._textures.info(texture, use, 0)
                uv_maps.append(use.uv_map)
            return self._textures.info(texture, use, uv_maps.index(use.uv_map))

        entry = {"name": name, "doubleSided": two_sided}
        entry["pbrMetallicRoughness"] = pbr = {
            "baseColorFactor": [*_shares(s.base.factor), _share(s.alpha.factor)],
            "metallicFactor": _share(s.metallic.factor), "roughnessFactor": _share(s.roughness.factor)}
        alpha, color = s.alpha.texture, s.base.texture
        if alpha and color and not placed_alike((color, alpha)):
            self._notes.add(name, "the alpha texture is placed like that of the colour")
        if alpha and not color:
            color = replace(alpha, image=white(name, alpha), channel="")
        if color:
            pbr["baseColorTexture"] = info(self._textures.color(color, alpha), color)
        if s.alpha.texture or s.alpha.factor < 1:
            entry["alphaMode"] = "BLEND"
        rough, metal = s.roughness.texture, s.metallic.texture
        if rough and metal and not placed_alike((rough, metal)):
            self._notes.add(name, "the metallic texture is placed like that of the roughness")
        if rough or metal:
            pbr["metallicRoughnessTexture"] = info(self._textures.scalars(G=rough, B=metal), rough or metal)
        if s.normal:
            entry["normalTexture"] = self._normals(s.normal, info)
        self._extend(entry, s, info)
        if hidden:
            entry["extras"] = {"lacuna": {"hidden_from_camera": True}}
        tangent = s.brushing and s.brushing.tangent
        if tangent and s.normal:
            self._notes.add(name, "the surface is brushed along u of the normal map's UV map")
            tangent = None  # the renderer's own tangents, which the normal map needs
        return Written(self._glb.append("materials", entry), uv_maps or [""], s.base.vertex_colors, tangent)

    def _normals(self, normal, info):
        """A normal map and its strength."""
        use, strength = normal
        return {**info(self._textures.normals(use), use), "scale": strength}

    def _extend(self, entry, s, info):
        transmits = s.transmission.texture or s.transmission.factor > 0
        # The material's index of refraction if it transmits; else that whose reflectance equals
        # Blender's layer.
        root = min(max(s.reflectance, 0.0), 0.9) ** 0.5
        ior = s.ior if transmits else (1 + root) / (1 - root)
        own = ((ior - 1) / (ior + 1)) ** 2
        self._glb.extension(entry, "KHR_materials_ior", {"ior": ior})
        whole = transmits or s.reflectance >= own > 0  # transmission: by the index alone
        self._glb.extension(entry, "KHR_materials_specular",
                            {"specularFactor": 1.0 if whole else s.reflectance / own if own > 0 else 0.0})
        if transmits:
            values = {"transmissionFactor": _share(s.transmission.factor)}
            if s.transmission.texture:
                values["transmissionTexture"] = info(self._textures.scalars(R=s.transmission.texture), s.transmission.texture)
            self._glb.extension(entry, "KHR_materials_transmission", values)
            body = {"thicknessFactor": 1.0}  # a solid, not a sheet
            if s.absorption:
                body["attenuationColor"], body["attenuationDistance"] = list(s.absorption[0]), s.absorption[1]
            self._glb.extension(entry, "KHR_materials_volume", body)
        elif s.absorption:
            self._notes.add(entry["name"], "the volume is left out: no light gets in by the surface")
        if s.coat > 0:
            values = {"clearcoatFactor": _share(s.coat), "clearcoatRoughnessFactor": _share(s.coat_roughness)}
            if s.coat_normal:
                values["clearcoatNormalTexture"] = self._normals(s.coat_normal, info)
            self._glb.extension(entry, "KHR_materials_clearcoat", values)
        if max(s.sheen) > 0:
            self._glb.extension(entry, "KHR_materials_sheen", {"sheenColorFactor": _shares(s.sheen),
                                                               "sheenRoughnessFactor": _share(s.sheen_roughness)})
        if s.brushing:
            self._glb.extension(entry, "KHR_materials_anisotropy", {"anisotropyStrength": _share(s.brushing.strength),
                                                                    "anisotropyRotation": s.brushing.rotation})
        light = [max(c * s.strength, 0.0) for c in s.emission.factor]
        most = max(light)
        if most > 0:
            entry["emissiveFactor"] = [c / most for c in light]
            self._glb.extension(entry, "KHR_materials_emissive_strength", {"emissiveStrength": most})
            if s.emission.texture:
                entry["emissiveTexture"] = info(self._textures.color(s.emission.texture), s.emission.texture)


def _fits(s):
    """Whether glTF can use its textures as they are placed: some must share an image, and there are only two sets of
    coordinates."""
    uses = [v.texture for v in (s.base, s.alpha, s.metallic, s.roughness, s.transmission, s.emission)]
    base, alpha, metallic, roughness = ([use] if use else [] for use in uses[:4])
    maps = {use.uv_map for use in (*uses, s.normal and s.normal[0], s.coat_normal and s.coat_normal[0]) if use}
    return placed_alike(base + alpha) and placed_alike(metallic + roughness) and len(maps) <= 2


def _has_bumps(material):
    return bool(material and material.use_nodes) and any(n.type == "BUMP" for n in all_nodes(material.node_tree))


def _rounded(size):
    """The size rounded to quarters of an octave, so that meshes of similar size share a material."""
    return 2 ** (round(4 * math.log2(size)) / 4) if size > 0 else 1.0


def _share(value):
    return min(max(value, 0.0), 1.0)


def _shares(values):
    return [_share(v) for v in values]
