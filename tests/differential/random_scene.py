#!/usr/bin/env python3
"""A random small scene of everything that the loader reads: the same one for the same seed.

    random_scene.py SEED FOLDER       writes scene.glb or scene.gltf with its pictures; prints options of lacuna-render

features.py tells which of the loader's features no scene has: what the loader learns to read must be made here as well.
"""

import json
import math
import random
import shlex
import sys
from pathlib import Path

from gltf_writer import Gltf, exr, hdr
from random_meshes import Meshes
from random_packing import Packing
from shapes import box, quad, sphere


class RandomScene(Meshes):
    """`gltf`, the options of lacuna-render that all rows get, and the scene's length of one unit."""

    def __init__(self, seed):
        self.r = random.Random(seed)
        self.gltf = Gltf()
        self.options = []
        self.extras = {}
        self.unit = self.mostly(1.0, lambda: 10 ** self.r.uniform(-3, 3))
        self.power = self.mostly(1.0, lambda: 10 ** self.r.uniform(-9, 9), 0.9)
        self.used = set()  # extensions
        self.roots = []
        self.textures = [self.texture() for _ in range(self.r.randint(1, 4))]
        self.base()
        for _ in range(self.r.choice((1, 2, 2, 3, 4))):
            self.object()
        for _ in range(self.r.choice((1, 1, 2, 3))):
            self.light()
        self.cameras()
        self.idle_entries()
        packing = Packing(self.gltf, seed)
        self.used |= packing.all()
        self.hidden(seed)
        self.scene_entry()
        self.gltf.root.setdefault("extensionsUsed", []).extend(packing.others())
        self.view()
        self.gltf.close(self.mostly("glb", lambda: self.r.choice(("data", "file")), 0.6))

    # Things
    def base(self):
        """What stands around: a closed room, a floor with a wall, or nothing."""
        kind = self.r.random()
        self.closed = kind < 0.45
        if self.closed:
            self.put_fixed(box(inward=True), (0, 0, 0), (1.5, 1.2, 1.5))
        elif kind < 0.85:
            self.put_fixed(quad(), (0, -0.9, 0), (2, 1, 2))
            if self.chance(0.5):
                wall = {"rotation": [math.sqrt(0.5), 0, 0, math.sqrt(0.5)],
                        "translation": [0, 0, -1.5 * self.unit], "scale": [2 * self.unit] * 3}
                self.node({"mesh": self.mesh(quad(), self.material()), **wall})

    def put_fixed(self, shape, centre, sizes):
        plain = {"name": "wall", "pbrMetallicRoughness": {
            "baseColorFactor": [self.r.uniform(0.3, 0.9) for _ in range(3)] + [1], "metallicFactor": 0,
            "roughnessFactor": self.r.uniform(0.3, 1)}, "doubleSided": True}
        material = self.gltf.add("materials", plain) if self.chance(0.7) else self.material()
        self.node({"mesh": self.mesh(shape, material), **self.place(centre, sizes, turned=False)})

    def object(self):
        r = self.r
        centre = [r.uniform(-0.8, 0.8), r.uniform(-0.7, 0.6), r.uniform(-0.8, 0.8)]
        size = r.uniform(0.15, 0.6)
        sizes = [size * self.mostly(1, lambda: r.choice((-1, 1)) * r.uniform(0.3, 1), 0.7) for _ in range(3)]
        if self.chance(0.2):  # a body within a body, glass at least outside
            shape = r.choice((box, lambda: sphere(12, 8)))
            glass = self.material(glass=True)
            extensions = self.gltf.root["materials"][glass]["extensions"]
            extensions.setdefault("KHR_materials_volume", {})["thicknessFactor"] = 1
            self.used.add("KHR_materials_volume")
            self.put(shape(), glass, centre, sizes)
            inner = self.material(glass=self.chance(0.5), lamp=self.chance(0.2))
            self.put(r.choice((box, lambda: sphere(12, 8)))(), inner, centre, [0.5 * s for s in sizes])
            return
        material = self.mostly(self.material(glass=self.chance(0.2)), lambda: None, 0.97)
        self.put(self.shape(), material, centre, sizes)

    # Lights
    def light(self):
        kind = self.r.choice(("lamp", "lamp", "lamp", "point", "spot", "directional", "environment"))
        if kind == "lamp":
            self.lamp()
        elif kind == "environment":
            self.environment()
        else:
            self.punctual(kind)

    def lamp(self):
        r = self.r
        centre = [r.uniform(-0.7, 0.7), r.uniform(0, 1), r.uniform(-0.7, 0.7)]
        size = self.mostly(r.uniform(0.15, 0.5), lambda: r.choice((0.005, 5)), 0.9)
        sizes = [size * r.choice((1, 1, -1)) for _ in range(3)]
        self.put(self.shape(), self.material(lamp=True), centre, sizes)

    def punctual(self, kind):
        r = self.r
        far = kind == "directional"
        strength = self.power * 10 ** r.uniform(-0.5, 1) * (1 if far else self.unit ** 2)
        light = {"type": kind, "intensity": strength}
        if self.chance(0.7):
            light["color"] = self.colour()
        if self.chance(0.3):
            light["name"] = "a light"
        if self.chance(0.1):
            light["range"] = 10 * self.unit
        if kind == "spot":
            outer = r.choice((math.pi / 2, r.uniform(0.05, 1.5), r.uniform(0.3, 1.2)))
            light["spot"] = {"outerConeAngle": outer}
            if self.chance(0.7):
                light["spot"]["innerConeAngle"] = outer * r.choice((0, 1, r.random()))
        lights = self.gltf.root.setdefault("extensions", {}).setdefault("KHR_lights_punctual", {"lights": []})["lights"]
        lights.append(light)
        self.used.add("KHR_lights_punctual")
        centre = [r.uniform(-1, 1), r.uniform(0, 1.1), r.uniform(-1, 1)]
        aim = [r.uniform(-0.3, 0.3) for _ in range(3)]
        node = {**self.look(centre, aim), "name": f"node of {kind}",
                "extensions": {"KHR_lights_punctual": {"light": len(lights) - 1}}}
        if self.chance(0.2):
            node["extras"] = {"lacuna": {"light_group": "lamps"}}
        self.node(node)

    def environment(self):
        r = self.r
        if any(option.startswith("--env") for option in self.options):
            return  # one at a time
        if self.chance(0.2):  # instead of the scene's own, if there is one
            colour = [self.power * c for c in self.colour()]
            self.options += ["--env-colour", ",".join(f"{c:.6g}" for c in colour)]
            return
        width, height = r.choice(((1, 1), (4, 2), (8, 4)))
        texels = [[r.choice((0, 0.2, 1, 1, r.choice((1, 30)))) * c for c in self.colour()] for _ in range(width * height)]
        name, write = r.choice((("sky.hdr", hdr), ("sky.exr", exr)))
        self.gltf.files[name] = write(width, height, texels)
        scale, turn = self.power * r.uniform(0.2, 2), r.uniform(-400, 400)
        if self.chance(0.3):
            self.options += ["--env", name, "--env-rotate", f"{turn:.6g}", "--env-scale", f"{scale:.6g}"]
        elif self.chance(0.2) and self.power == 1:
            self.extras["environment"] = name
        else:
            entry = {"file": name, "scale": scale, "rotation_degrees": turn}
            self.extras["environment"] = self.mostly(entry, lambda: json.dumps(entry), 0.7)

    # Cameras
    def look(self, centre, aim):
        """A transform whose -Z axis points from `centre` to `aim`."""
        z = [a - b for a, b in zip(centre, aim)]
        length = math.hypot(*z) or 1
        z = [x / length for x in z]
        up = [0, 1, 0] if abs(z[1]) < 0.99 else [1, 0, 0]
        x = [up[1] * z[2] - up[2] * z[1], up[2] * z[0] - up[0] * z[2], up[0] * z[1] - up[1] * z[0]]
        length = math.hypot(*x)
        x = [c / length for c in x]
        y = [z[1] * x[2] - z[2] * x[1], z[2] * x[0] - z[0] * x[2], z[0] * x[1] - z[1] * x[0]]
        size = self.mostly(1, lambda: self.r.choice((self.unit, 2)), 0.9)
        return {"matrix": [*(c * size for c in x), 0, *(c * size for c in y), 0, *(c * size for c in z), 0,
                           *(c * self.unit for c in centre), 1]}

    def cameras(self):
        r = self.r
        for i in range(self.mostly(1, lambda: 2, 0.8)):
            distance = r.uniform(0.7, 1.15) if self.closed else r.uniform(1.5, 3)
            d = self.direction()
            if not self.closed:
                d[1] = abs(d[1])
            camera = {"type": "perspective", "name": f"camera {i}", "perspective": {"yfov": r.uniform(0.3, 1.8), "znear": 0.01}}
            if self.chance(0.5):
                camera["perspective"]["aspectRatio"] = r.uniform(0.5, 2)
            centre = [distance * x for x in d]
            self.node({"camera": self.gltf.add("cameras", camera), "name": "eye",
                       **self.look(centre, [r.uniform(-0.3, 0.3) for _ in range(3)])})
            if i:
                self.options += ["--camera", f"camera {r.choice((0, 1))}"]
        if self.chance(0.1):
            flat = {"type": "orthographic", "orthographic": {"xmag": 1, "ymag": 1, "zfar": 10, "znear": 0.1}}
            self.node({"camera": self.gltf.add("cameras", flat)})

    # The rest of the file
    def idle_entries(self):
        """What the loader reads to no effect."""
        if self.chance(0.05):
            self.gltf.root["animations"] = []
        if self.chance(0.2):
            self.gltf.root["asset"]["minVersion"] = "2.0"

    def hidden(self, seed):
        """Nodes that are hidden or not, by a generator of their own: a scene is otherwise the same as without."""
        r = random.Random(f"hidden {seed}")
        if r.random() < 0.9 or "meshes" not in self.gltf.root:
            return
        self.node({"mesh": 0, "scale": [9 * self.unit] * 3, "extensions": {"KHR_node_visibility": {"visible": False}}})
        self.node({"extensions": {"KHR_node_visibility": r.choice(({"visible": True}, {}))}})
        self.used.add("KHR_node_visibility")

    def scene_entry(self):
        gltf, root = self.gltf, self.gltf.root
        if self.chance(0.9):
            root["extensionsUsed"] = sorted(self.used)
            if self.chance(0.3) and self.used:
                root["extensionsRequired"] = sorted(self.used)
        lone = self.chance(0.1) and not self.extras
        if lone:
            return
        if self.chance(0.1):
            gltf.add("scenes", {"nodes": []})
        root["scene"] = gltf.add("scenes", {"nodes": self.roots, "extras": self.extras})

    def view(self):
        """Picture, lens and depth: in the extras or as options."""
        r = self.r
        width, height = r.choice(((16, 12), (20, 10), (12, 16), (1, 40), (17, 11)))
        lacuna = {"width": width, "height": height, "max_depth": r.choice((1, 2, 3, 3, 4, 4, 5, 5, 6, 6, 8, 12))}
        if self.chance(0.25):
            lacuna["aperture"] = r.choice((1e-3, 0.05, 0.3)) * self.unit
            lacuna["focus"] = r.uniform(0.5, 3) * self.unit
        if "scene" in self.gltf.root and self.chance(0.4):
            self.extras["lacuna"] = self.mostly(lacuna, lambda: json.dumps(lacuna), 0.7)
        else:
            self.options += [x for k, v in lacuna.items() for x in (f"--{k.replace('_', '-')}", f"{v:.6g}")]
        if self.chance(0.2):
            x0, y0 = r.randint(0, width // 2), r.randint(0, height // 2)
            self.options += ["--crop", f"{x0},{r.randint(x0 + 1, width)},{y0},{r.randint(y0 + 1, height)}"]
        if self.chance(0.15):
            self.options += ["--shift", f"{r.uniform(-0.5, 0.5):.4g},{r.uniform(-0.5, 0.5):.4g}"]
        if self.chance(0.4):
            self.options += ["--rr-depth", str(r.choice((1, 2, 5, 20)))]
        if self.chance(0.1):
            self.options += ["--tolerance", "0.01"]


def main():
    seed, folder = int(sys.argv[1]), Path(sys.argv[2])
    folder.mkdir(parents=True, exist_ok=True)
    scene = RandomScene(seed)
    print(shlex.join([str(scene.gltf.write(folder)), *scene.options]))


if __name__ == "__main__":
    main()
