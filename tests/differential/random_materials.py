"""Random numbers, pictures and materials: all that the loader reads of them."""

import json
import math

from gltf_writer import jpeg, png


class Draws:
    """Random draws, from `r`."""

    def chance(self, p):
        return self.r.random() < p

    def mostly(self, usual, other, p=0.8):
        return usual if self.chance(p) else other()

    def share(self):
        """From 0 to 1, both ends among them; now and then a little outside, which the loader cuts off."""
        return self.r.choice((0, 1, self.r.random(), self.r.random(), self.r.random(), self.r.choice((-0.2, 1.3))))

    def colour(self):
        kind = self.r.random()
        if kind < 0.15:
            return [self.r.choice((0.0, 1.0)) for _ in range(3)]
        if kind < 0.4:
            return [self.r.random()] * 3
        return [self.r.random() for _ in range(3)]

    def direction(self):
        while True:
            d = [self.r.gauss(0, 1) for _ in range(3)]
            if math.hypot(*d) > 1e-3:
                return [x / math.hypot(*d) for x in d]

    def quaternion(self):
        q = [self.r.gauss(0, 1) for _ in range(4)]
        length = math.hypot(*q) * self.mostly(1, lambda: 0.5, 0.9)
        return [x / length for x in q]


class Materials(Draws):
    """Adds pictures and materials to `gltf`; `used` collects extensions, `textures` is what there is to choose from."""

    def picture(self):
        r = self.r
        if self.chance(0.15):
            columns, rows = r.choice((1, 2)), r.choice((1, 2))
            return jpeg(columns, rows, [r.randrange(256) for _ in range(columns * rows)])
        width, height = r.choice((1, 2, 3, 5)), r.choice((1, 2, 4))
        return png(width, height, [[r.randrange(256) for _ in range(3)] + [r.choice((0, 255, r.randrange(256)))]
                                   for _ in range(width * height)])

    def texture(self):
        form = self.r.choice(("view", "data", "file"))
        image = self.gltf.image(self.picture(), form, len(self.gltf.root.get("images", [])))
        entry = {"source": image}
        if self.chance(0.8):
            sampler = {}
            for side in ("wrapS", "wrapT"):
                if self.chance(0.8):
                    sampler[side] = self.r.choice((10497, 33071, 33648))
            if self.chance(0.5):
                sampler.update(magFilter=self.r.choice((9728, 9729)), minFilter=self.r.choice((9728, 9987)))
            entry["sampler"] = self.gltf.add("samplers", sampler)
        return self.gltf.add("textures", entry)

    def placed(self):
        """A use of a texture."""
        r = self.r
        use = {"index": r.choice(self.textures)}
        if self.chance(0.4):
            use["texCoord"] = r.choice((0, 1))
        if self.chance(0.4):
            transform = {}
            if self.chance(0.6):
                transform["offset"] = [r.uniform(-2, 2), r.uniform(-2, 2)]
            if self.chance(0.6):
                transform["rotation"] = r.uniform(-4, 4)
            if self.chance(0.6):
                transform["scale"] = [r.uniform(-3, 3), r.uniform(-3, 3)]
            if self.chance(0.3):
                transform["texCoord"] = r.choice((0, 1))
            use["extensions"] = {"KHR_texture_transform": transform}
            self.used.add("KHR_texture_transform")
        return use

    def extension(self, material, name, members):
        material.setdefault("extensions", {})[name] = members
        self.used.add(name)

    def textured(self, members, name, p=0.25):
        if self.chance(p):
            members[name] = self.placed()

    def material(self, lamp=False, glass=False):
        r = self.r
        m = {"name": f"material {len(self.gltf.root.get('materials', []))}"}
        surface = {}
        if self.chance(0.9):
            surface["baseColorFactor"] = self.colour() + [r.choice((0, 1, 1, r.random(), r.random(), r.random()))]
        surface["metallicFactor"] = 0 if glass or self.chance(0.5) else self.share()
        surface["roughnessFactor"] = r.choice((0, r.uniform(0, 0.2), r.uniform(0.2, 1), r.uniform(0.2, 1), 1))
        if self.chance(0.05):
            surface = {}
        self.textured(surface, "baseColorTexture")
        self.textured(surface, "metallicRoughnessTexture", 0.15)
        if surface:
            m["pbrMetallicRoughness"] = surface
        if self.chance(0.15):
            m["normalTexture"] = self.placed()
            if self.chance(0.6):
                m["normalTexture"]["scale"] = r.choice((0, -1, r.uniform(0, 2)))
        if self.chance(0.1):
            m["occlusionTexture"] = {"index": r.choice(self.textures)}
        if self.chance(0.4):
            m["doubleSided"] = self.chance(0.8)
        self.alpha(m, lamp)
        if glass or self.chance(0.15):
            self.transmission(m, glass)
        self.coats(m)
        self.fabrics(m)
        if lamp:
            self.emission(m)
        self.material_extras(m)
        return self.gltf.add("materials", m)

    def alpha(self, m, lamp):
        if self.chance(0.5 if lamp else 0.3):
            m["alphaMode"] = self.r.choice(("OPAQUE", "MASK", "MASK", "BLEND", "BLEND", "BLEND"))
            self.textured(m.setdefault("pbrMetallicRoughness", {}), "baseColorTexture")
            if self.chance(0.6):
                m["alphaCutoff"] = self.r.choice((0, self.r.random(), self.r.random(), 1.5))

    def transmission(self, m, glass):
        r = self.r
        transmission = {"transmissionFactor": 1 if glass and self.chance(0.7) else self.share()}
        self.textured(transmission, "transmissionTexture", 0.2)
        self.extension(m, "KHR_materials_transmission", transmission)
        if self.chance(0.7):
            self.extension(m, "KHR_materials_ior", {"ior": r.choice((1, 1.33, 1.5, r.uniform(1, 2.5), 0))})
        if self.chance(0.7):
            volume = {"thicknessFactor": r.choice((0, 1, 1))}
            if self.chance(0.5):
                volume["attenuationColor"] = self.colour()
                volume["attenuationDistance"] = r.uniform(0.2, 3) * self.unit
            if self.chance(0.1):
                volume["thicknessTexture"] = self.placed()
            self.extension(m, "KHR_materials_volume", volume)

    def coats(self, m):
        r = self.r
        if self.chance(0.25):
            specular = {"specularFactor": self.share()}
            if self.chance(0.6):
                specular["specularColorFactor"] = [c * r.choice((1, 1, 4)) for c in self.colour()]
            self.textured(specular, "specularTexture")
            self.textured(specular, "specularColorTexture")
            self.extension(m, "KHR_materials_specular", specular)
        if self.chance(0.2):
            coat = {"clearcoatFactor": self.share(), "clearcoatRoughnessFactor": r.choice((0, r.random(), r.random()))}
            self.textured(coat, "clearcoatTexture")
            self.textured(coat, "clearcoatRoughnessTexture")
            if self.chance(0.2):
                coat["clearcoatNormalTexture"] = self.placed()
                if self.chance(0.6):
                    coat["clearcoatNormalTexture"]["scale"] = r.choice((0, -1, r.uniform(0, 2)))
            self.extension(m, "KHR_materials_clearcoat", coat)

    def fabrics(self, m):
        """Cloth, brushed metal, leaves."""
        r = self.r
        if self.chance(0.15):
            sheen = {"sheenColorFactor": self.colour(), "sheenRoughnessFactor": self.share()}
            self.textured(sheen, "sheenColorTexture")
            self.textured(sheen, "sheenRoughnessTexture")
            self.extension(m, "KHR_materials_sheen", sheen)
        if self.chance(0.15):
            grain = {"anisotropyStrength": self.share()}
            if self.chance(0.6):
                grain["anisotropyRotation"] = r.uniform(-7, 7)
            self.textured(grain, "anisotropyTexture")
            self.extension(m, "KHR_materials_anisotropy", grain)
        if self.chance(0.15):
            leaf = {"diffuseTransmissionFactor": self.share()}
            if self.chance(0.7):
                leaf["diffuseTransmissionColorFactor"] = self.colour()
            self.textured(leaf, "diffuseTransmissionTexture")
            self.textured(leaf, "diffuseTransmissionColorTexture")
            self.extension(m, "KHR_materials_diffuse_transmission", leaf)

    def emission(self, m):
        m["emissiveFactor"] = self.colour()
        if self.chance(0.9):
            strength = self.power * 10 ** self.r.uniform(-0.5, 1.5)
            self.extension(m, "KHR_materials_emissive_strength", {"emissiveStrength": strength})
        self.textured(m, "emissiveTexture", 0.35)

    def material_extras(self, m):
        lacuna = {}
        if self.chance(0.1):
            lacuna["hidden_from_camera"] = self.chance(0.8)
        if self.chance(0.1):
            lacuna["light_group"] = self.r.choice(("lamps", "others"))
        if lacuna:
            m["extras"] = {"lacuna": self.mostly(lacuna, lambda: json.dumps(lacuna), 0.7)}
