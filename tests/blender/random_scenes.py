"""Renders random scenes by Lacuna and by Cycles, to find faults that a list of scenes does not. By hand, as root or not:

  blender -b --factory-startup --python-exit-code 1 -P tests/blender/random_scenes.py -- ADD-ON.zip lacuna-render OUT
      [--first N] [--scenes N]

A line for each scene: Lacuna's mean over Cycles', likewise for the darkest and the brightest region, and what the add-on
leaves out. OUT has both pictures of each scene side by side (Lacuna left), its .blend and its log. Exits with 1 if a whole
picture differs by more than ALLOWED. A region differs by more where Cycles bumps between pixels, where two shaders are
one surface, and under a glossy layer: look at the picture."""

import math
import random
import sys
from pathlib import Path

import bpy
import numpy

sys.dont_write_bytecode = True
sys.path[:0] = [str(Path(__file__).parent)]
import render_scenes  # noqa: E402
import scenes  # noqa: E402

ALLOWED = 0.25
_PROCEDURAL = [f"ShaderNodeTex{kind}" for kind in ("Noise", "Voronoi", "Wave", "Checker", "Magic", "Musgrave", "Brick", "Gradient")]
_BLENDS = ("MIX", "MULTIPLY", "ADD", "SCREEN", "OVERLAY", "DIFFERENCE")
_PRIMITIVES = [f"primitive_{kind}_add" for kind in ("cube", "uv_sphere", "cylinder", "torus", "monkey", "ico_sphere", "cone", "plane")]


class Maker:
    """Makes the scene of a number."""

    def __init__(self, seed):
        self.r = random.Random(seed)

    def fill(self):
        r = self.r
        scenes.plane(self.material("floor"), 12)
        scenes.plane(self.material("wall"), 12, location=(0, 3, 0), rotation=(math.pi / 2, 0, 0))
        for i in range(r.choice((2, 3, 4))):
            self.thing(i)
        for _ in range(r.choice((1, 2))):
            self.lamp()
        self.world()
        scenes.camera(lens=r.choice((28, 35, 50)))

    def rgb(self, low=0.05, high=0.9):
        return tuple(self.r.uniform(low, high) for _ in range(3))

    def chance(self, share):
        return self.r.random() < share

    # Nodes; each returns an output.

    def picture(self):
        side = self.r.choice((8, 16, 33))
        texels = numpy.random.default_rng(self.r.randrange(1 << 30)).random((side, side, 3))
        if self.chance(0.3):
            texels = texels.round() * 0.8 + 0.1
        return scenes.image(f"image {len(bpy.data.images)}", texels, color=self.chance(0.7))

    def place(self, tree, node):
        """Links coordinates to an image or a texture; sometimes none, which means UV or the object's box."""
        r = self.r
        if self.chance(0.2):
            return
        output = tree.nodes.new("ShaderNodeTexCoord").outputs[r.choice(("UV", "Generated", "Object"))]
        if self.chance(0.5):
            mapping = scenes.node(tree, "ShaderNodeMapping", output, "Vector", Scale=[r.uniform(0.5, 3) for _ in range(3)],
                                  Rotation=(r.uniform(-1, 1) * self.chance(0.3), 0, r.uniform(-2, 2)))
            mapping.vector_type = r.choice(("POINT", "POINT", "TEXTURE", "VECTOR"))
            output = mapping.outputs[0]
        tree.links.new(output, node.inputs["Vector"])

    def color(self, tree, depth=0):
        r = self.r
        kind = r.choice(("image", "image", "procedural", "constant") + (
            ("ramp", "hue", "invert", "mix", "mix") if depth < 2 else ()))
        if kind == "image":
            node = tree.nodes.new("ShaderNodeTexImage")
            node.image, node.extension, node.interpolation = self.picture(), r.choice(("REPEAT", "EXTEND")), r.choice(("Linear", "Closest"))
            if self.chance(0.2):
                node.projection, node.projection_blend = "BOX", 0.2
            self.place(tree, node)
            return node.outputs["Color"]
        if kind == "procedural":
            node = tree.nodes.new(r.choice(_PROCEDURAL))
            if "Scale" in node.inputs:
                node.inputs["Scale"].default_value = r.uniform(1, 4)
            self.place(tree, node)
            return node.outputs[0]
        if kind == "constant":
            node = tree.nodes.new("ShaderNodeRGB")
            node.outputs[0].default_value = (*self.rgb(), 1)
            return node.outputs[0]
        if kind == "ramp":
            node = scenes.node(tree, "ShaderNodeValToRGB", self.color(tree, depth + 1), "Fac")
            for element, place in zip(node.color_ramp.elements, (r.uniform(0, 0.4), r.uniform(0.5, 1))):
                element.position, element.color = place, (*self.rgb(), 1)
            return node.outputs["Color"]
        if kind == "hue":
            return scenes.node(tree, "ShaderNodeHueSaturation", self.color(tree, depth + 1), "Color", Hue=r.random(),
                               Saturation=r.uniform(0, 1.5), Value=r.uniform(0.3, 1)).outputs[0]
        if kind == "invert":
            return scenes.node(tree, "ShaderNodeInvert", self.color(tree, depth + 1), "Color").outputs[0]
        node = scenes.node(tree, "ShaderNodeMixRGB", self.color(tree, depth + 1), "Color1", Fac=r.random(), Color2=(*self.rgb(), 1))
        node.blend_type, node.use_clamp = r.choice(_BLENDS), True
        for name in ("Color2", "Fac"):
            if self.chance(0.4):
                tree.links.new(self.color(tree, depth + 1), node.inputs[name])
        return node.outputs[0]

    def feed(self, tree, socket, low, high):
        """Links a number between the two, made from a colour."""
        node = scenes.node(tree, "ShaderNodeMapRange", self.color(tree, 1), "Value")
        node.inputs["To Min"].default_value, node.inputs["To Max"].default_value = low, high
        tree.links.new(node.outputs[0], socket)

    def grouped(self, tree):
        """A colour that comes from inside a group."""
        inside = bpy.data.node_groups.new("group", "ShaderNodeTree")
        inside.outputs.new("NodeSocketColor", "Color")
        inside.links.new(self.color(inside, 1), inside.nodes.new("NodeGroupOutput").inputs[0])
        node = tree.nodes.new("ShaderNodeGroup")
        node.node_tree = inside
        return node.outputs[0]

    def shader(self, tree, nested=False):
        r = self.r
        kind = r.choice(("diffuse",) * 4 + ("glossy",) * 2 + ("principled",) * 2 + (("clear",) if nested else ("mix",)) * 2)
        if kind == "clear":
            return tree.nodes.new("ShaderNodeBsdfTransparent").outputs[0]
        if kind == "mix":
            node = tree.nodes.new("ShaderNodeMixShader")
            node.inputs["Fac"].default_value = r.random()
            for i in (1, 2):
                tree.links.new(self.shader(tree, True), node.inputs[i])
            if self.chance(0.5):
                self.feed(tree, node.inputs["Fac"], 0, 1)
            return node.outputs[0]
        node = tree.nodes.new({"diffuse": "ShaderNodeBsdfDiffuse", "glossy": "ShaderNodeBsdfGlossy",
                               "principled": "ShaderNodeBsdfPrincipled"}[kind])
        color = node.inputs["Base Color" if kind == "principled" else "Color"]
        color.default_value = (*self.rgb(*{"glossy": (0.4, 0.9), "principled": (0.05, 0.6)}.get(kind, ())), 1)
        if kind != "diffuse":
            node.inputs["Roughness"].default_value = r.uniform(0.3, 0.9)
            if self.chance(0.3):
                self.feed(tree, node.inputs["Roughness"], 0.3, 0.9)
        if kind == "principled":
            node.inputs["Metallic"].default_value, node.inputs["Specular"].default_value = r.choice((0, 0, 1)), r.choice((0, 0.2, 0.5))
            for name, low in (("Metallic", 0), ("Alpha", 0.2)):
                if self.chance(0.2):
                    self.feed(tree, node.inputs[name], low, 1)
            if self.chance(0.2):
                node.inputs["Emission"].default_value, node.inputs["Emission Strength"].default_value = (*self.rgb(), 1), r.random()
        if self.chance(0.6):
            tree.links.new(self.grouped(tree) if self.chance(0.2) else self.color(tree), color)
        if self.chance(0.2):
            bump = scenes.node(tree, "ShaderNodeBump", self.color(tree, 1), "Height", Distance=0.05, Strength=r.uniform(0.2, 1))
            tree.links.new(bump.outputs[0], node.inputs["Normal"])
        return node.outputs[0]

    def material(self, name):
        made = bpy.data.materials.new(name)
        made.use_nodes = True
        tree = made.node_tree
        tree.nodes.remove(tree.nodes["Principled BSDF"])
        tree.links.new(self.shader(tree), tree.get_output_node("CYCLES").inputs["Surface"])
        return made

    # Objects.

    def thing(self, number):
        r = self.r
        getattr(bpy.ops.mesh, r.choice(_PRIMITIVES))(location=(r.uniform(-2.2, 2.2), r.uniform(-1, 1.5), r.uniform(0.3, 1.8)),
                                                     rotation=[r.uniform(-3, 3) for _ in range(3)])
        made = bpy.context.object
        made.scale = [r.uniform(0.4, 1.2) * r.choice((1, 1, 1, -1)) for _ in range(3)]
        for i in range(r.choice((1, 1, 2))):
            made.data.materials.append(self.material(f"material {number}.{i}"))
        smooth = self.chance(0.4)
        for face in made.data.polygons:
            face.material_index, face.use_smooth = r.randrange(len(made.data.materials)), smooth
        modifier = r.choice((None, None, None, "ARRAY", "BEVEL", "COPY", "DECIMATE", "MIRROR", "SOLIDIFY", "SUBSURF"))
        if modifier == "COPY":
            copy = bpy.data.objects.new("copy", made.data)
            copy.location, copy.scale = (made.location.x + 0.8, made.location.y + 0.5, made.location.z), (-0.5, 0.5, 0.5)
            bpy.context.collection.objects.link(copy)
        elif modifier:
            settings = made.modifiers.new(modifier, modifier)
            for name, value in {"SOLIDIFY": {"thickness": 0.1}, "DECIMATE": {"ratio": 0.5}, "SUBSURF": {"render_levels": 2}}.get(
                    modifier, {}).items():
                setattr(settings, name, value)

    def lamp(self):
        r = self.r
        at, to = (r.uniform(-3, 3), r.uniform(-5, -2), r.uniform(2.5, 4)), (r.uniform(-1, 1), r.uniform(0, 2), 0.5)
        kind = r.choice(("SUN", "POINT", "AREA", "SPOT"))
        power = {"SUN": (1, 4), "SPOT": (200, 600)}.get(kind, (50, 300))
        settings = {"SUN": {"angle": r.choice((0, 0.01, 0.1))}, "POINT": {"shadow_soft_size": r.choice((0, 0.2))},
                    "AREA": {"size": r.uniform(0.3, 1.5), "shape": r.choice(("SQUARE", "DISK"))},
                    "SPOT": {"spot_size": 1.2, "spot_blend": 0.3, "shadow_soft_size": 0}}[kind]
        scenes.lamp(kind, at, to, r.uniform(*power), color=self.rgb(0.5, 1), **settings)

    def world(self):
        r = self.r
        kind = r.choice(("colour", "colour", "image", "sky"))
        if kind == "image":
            scenes.sky((r.uniform(-1, 1) * self.chance(0.5), 0, r.uniform(-3, 3)))
            return
        tree = scenes.world(self.rgb(0.1, 0.5)).node_tree
        if kind == "colour":
            return
        sky = tree.nodes.new("ShaderNodeTexSky")
        sky.sky_type = r.choice(("NISHITA", "HOSEK_WILKIE", "PREETHAM"))
        sky.sun_elevation, sky.sun_rotation, sky.sun_size, sky.sun_intensity = r.uniform(0.2, 1.3), r.uniform(0, 6), 0.03, 0.05
        tree.nodes["Background"].inputs["Strength"].default_value = 0.15 if sky.sky_type == "NISHITA" else 0.6
        tree.links.new(sky.outputs[0], tree.nodes["Background"].inputs["Color"])


def main():
    given = sys.argv[sys.argv.index("--") + 1:]
    archive, program, out = (Path(a).resolve() for a in given[:3])
    options = dict(zip(given[3::2], given[4::2]))
    out.mkdir(parents=True, exist_ok=True)
    environment = render_scenes.installed(archive, program, out)
    first, failed = int(options.get("--first", 0)), []
    for seed in range(first, first + int(options.get("--scenes", 20))):
        name = f"random-{seed}"
        render_scenes.make(name, Maker(seed).fill, out)
        notes = render_scenes.render(name, out, environment)
        ours, theirs = (render_scenes.regions(p) for p in render_scenes.pictures(name, out))
        error = render_scenes.differences(ours, theirs)
        ratio = ours.mean() / theirs.mean()
        print(f"{name}: whole {ratio:.3f}, regions {1 + error.min():.3f} to {1 + error.max():.3f}", *notes, sep="\n    ", flush=True)
        if abs(ratio - 1) > ALLOWED:
            failed.append(name)
    if failed:
        raise SystemExit("differs from Cycles: " + ", ".join(failed))


if __name__ == "__main__":
    main()
