"""Builds a still life in Blender 3.4 and exports it as an artist would: writes blender-still-life.glb beside this file.

  blender -b --factory-startup --python-exit-code 1 -P scenes/make_blender_scene.py [-- OUT.glb]

Blender is not needed for anything else: the file is kept in the repository, and make_scenes.py only checks that it is a
sound glTF. What matters here is that everything comes from Blender's own nodes, lights and exporter.
"""

import math
import sys
from pathlib import Path

import bpy
import numpy
from mathutils import Vector

# Debian's numpy 1.24 no longer has these, which Blender 3.4's exporter uses.
for _name, _type in {"bool": bool, "int": int, "float": float, "object": object}.items():
    if _name not in numpy.__dict__:
        setattr(numpy, _name, _type)


def image(name, texels, color):
    """Packed picture of `texels` (height x width x 3, 0 to 1 as stored, row 0 at the bottom)."""
    height, width, _ = texels.shape
    made = bpy.data.images.new(name, width, height)
    made.colorspace_settings.name = "sRGB" if color else "Non-Color"
    made.pixels = numpy.dstack([texels, numpy.ones((height, width))]).ravel().tolist()
    made.pack()
    return made


def grid(size):
    """x and y of each texel's middle, from 0 to 1."""
    at = (numpy.arange(size) + 0.5) / size
    return numpy.meshgrid(at, at)


def tiles():
    """Floor tiles, 2 x 2 of them, with dark joints."""
    x, y = grid(64)
    light = (numpy.floor(2 * x) + numpy.floor(2 * y)) % 2 > 0
    joint = (numpy.minimum(2 * x % 1, 2 * y % 1) < 0.06)[..., None]
    color = numpy.where(light[..., None], [0.80, 0.75, 0.68], [0.45, 0.30, 0.25])
    return image("tiles", numpy.where(joint, 0.12, color), True)


def bands():
    """Metal and enamel in turn: roughness in green, metallic in blue, as glTF has them."""
    x, y = grid(32)
    metal = (numpy.floor(8 * x) % 2 > 0).astype(float)
    return image("bands", numpy.dstack([numpy.zeros_like(x), 0.45 - 0.2 * metal, metal]), False)


def dents():
    """Normal map of round dents, 4 x 4 of them."""
    x, y = (2 * (4 * a % 1) - 1 for a in grid(64))
    radius = numpy.hypot(x, y)
    slope = numpy.where(radius < 0.8, 0.5 * numpy.sin(math.pi * radius / 0.8) / numpy.maximum(radius, 1e-6), 0)
    normal = numpy.dstack([slope * x, slope * y, numpy.ones_like(x)])
    normal /= numpy.linalg.norm(normal, axis=2, keepdims=True)
    return image("dents", 0.5 * normal + 0.5, False)


def material(name, **inputs):
    """Principled BSDF with these inputs; backface culling, so that it is not exported as double-sided."""
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    made.use_backface_culling = True
    shader = made.node_tree.nodes["Principled BSDF"]
    for key, value in inputs.items():
        shader.inputs[key.replace("_", " ")].default_value = value
    return made, made.node_tree, shader


def texture(tree, picture):
    node = tree.nodes.new("ShaderNodeTexImage")
    node.image = picture
    return node.outputs["Color"]


def gltf_output(tree, **inputs):
    """The exporter's own group node, for what Principled BSDF has no input for."""
    group = bpy.data.node_groups.get("glTF Material Output")
    if not group:
        group = bpy.data.node_groups.new("glTF Material Output", "ShaderNodeTree")
        for kind, name in (("Float", "Occlusion"), ("Float", "Thickness"), ("Float", "Specular"), ("Color", "Specular Color")):
            group.inputs.new("NodeSocket" + kind, name)
        group.inputs["Specular"].default_value = 1.0
        group.inputs["Specular Color"].default_value = (1, 1, 1, 1)
    node = tree.nodes.new("ShaderNodeGroup")
    node.node_tree = group
    for key, value in inputs.items():
        node.inputs[key].default_value = value


def lambert(name, color, picture=None):
    made, tree, shader = material(name, Base_Color=(*color, 1), Roughness=1.0)
    if picture:
        tree.links.new(texture(tree, picture), shader.inputs["Base Color"])
    gltf_output(tree, Specular=0.0)
    return made


def glass(name):
    made, tree, _ = material(name, Base_Color=(1, 1, 1, 1), Roughness=0.0, Transmission=1.0, IOR=1.5)
    gltf_output(tree, Thickness=1.0)
    return made


def enamelled():
    made, tree, shader = material("enamel", Base_Color=(0.95, 0.72, 0.35, 1))
    parts = tree.nodes.new("ShaderNodeSeparateColor")
    tree.links.new(texture(tree, bands()), parts.inputs["Color"])
    tree.links.new(parts.outputs["Green"], shader.inputs["Roughness"])
    tree.links.new(parts.outputs["Blue"], shader.inputs["Metallic"])
    return made


def hammered():
    made, tree, shader = material("copper", Base_Color=(0.90, 0.55, 0.40, 1), Metallic=1.0, Roughness=0.3)
    bump = tree.nodes.new("ShaderNodeNormalMap")
    tree.links.new(texture(tree, dents()), bump.inputs["Color"])
    tree.links.new(bump.outputs["Normal"], shader.inputs["Normal"])
    return made


def named(name, made):
    thing = bpy.context.object
    thing.name = thing.data.name = name
    thing.data.materials.append(made)
    return thing


def smooth(thing):
    for face in thing.data.polygons:
        face.use_smooth = True
    return thing


def plane(name, made, size, location, rotation=(0, 0, 0), repeat=1):
    bpy.ops.mesh.primitive_plane_add(size=size, location=location, rotation=rotation)
    thing = named(name, made)
    for corner in thing.data.uv_layers[0].data:
        corner.uv *= repeat
    return thing


def lathe(name, made, profile, around=20):
    """Body of revolution; `profile`: (radius, height), from below."""
    points = [(r * math.cos(a), r * math.sin(a), z) for r, z in profile
              for a in (2 * math.pi * i / around for i in range(around))]
    faces = [(row + i, row + (i + 1) % around, row + around + (i + 1) % around, row + around + i)
             for row in range(0, len(points) - around, around) for i in range(around)]
    faces += [tuple(range(around))[::-1], tuple(range(len(points) - around, len(points)))]
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(points, [], faces)
    mesh.materials.append(made)
    thing = smooth(bpy.data.objects.new(name, mesh))
    mesh.polygons[-1].use_smooth = mesh.polygons[-2].use_smooth = False
    bpy.context.collection.objects.link(thing)
    return thing


def lamp(kind, name, location, target, **settings):
    data = bpy.data.lights.new(name, kind)
    for key, value in settings.items():
        setattr(data, key, value)
    thing = bpy.data.objects.new(name, data)
    thing.location = location
    thing.rotation_euler = (Vector(target) - Vector(location)).to_track_quat("-Z", "Y").to_euler()
    bpy.context.collection.objects.link(thing)


def build():
    bpy.ops.wm.read_factory_settings(use_empty=True)

    plane("floor", lambert("tiles", (1, 1, 1), tiles()), 4, (0, 0, 0), repeat=4)
    plane("wall", lambert("plaster", (0.65, 0.62, 0.55)), 4, (0, 1.2, 2), (math.pi / 2, 0, 0))

    bpy.ops.mesh.primitive_uv_sphere_add(segments=32, ring_count=16, radius=0.3, location=(-0.55, -0.25, 0.31))
    smooth(named("glass ball", glass("glass")))
    bpy.ops.mesh.primitive_torus_add(major_radius=0.32, minor_radius=0.12, major_segments=40, minor_segments=14,
                                     location=(0.1, 0.35, 0.33), rotation=(math.radians(70), 0, math.radians(15)))
    smooth(named("enamel ring", enamelled()))
    bpy.ops.mesh.primitive_uv_sphere_add(segments=24, ring_count=12, radius=0.22, location=(0.35, -0.4, 0.225))
    smooth(named("copper ball", hammered()))

    # Linked duplicates: one mesh, five objects; one of them mirrored and one stretched.
    clay = material("clay", Base_Color=(0.55, 0.20, 0.12, 1), Roughness=0.5)[0]
    first = lathe("skittle", clay, [(0.07, 0), (0.11, 0.08), (0.1, 0.2), (0.04, 0.34), (0.065, 0.42), (0.03, 0.48)])
    first.location = (0.75, 0.1, 0.001)
    for i, (place, scale) in enumerate([((0.95, 0.4, 0.001), (1, 1, 1)), ((0.65, 0.7, 0.001), (-1, 1, 1)),
                                        ((1.15, 0.05, 0.001), (1, 1, 1.4)), ((1.2, 0.75, 0.001), (0.8, 0.8, 0.8))]):
        copy = first.copy()
        copy.name = f"skittle {i + 2}"
        copy.location, copy.scale = place, scale
        bpy.context.collection.objects.link(copy)

    # The strength is the radiance: glTF has the rest as it is in Blender.
    panel = material("panel", Base_Color=(0, 0, 0, 1), Emission=(1, 0.85, 0.65, 1), Emission_Strength=12.0)[0]
    plane("panel", panel, 0.6, (-1.1, -0.2, 1.5), (0, math.radians(130), 0))
    lamp("POINT", "bulb", (0.9, -0.6, 1.3), (0, 0, 0), energy=12, color=(1, 0.8, 0.6), shadow_soft_size=0)
    lamp("SPOT", "spot", (0.2, -1.2, 1.8), (0.1, 0.35, 0.3), energy=40, spot_size=math.radians(36), spot_blend=0.4,
         shadow_soft_size=0)
    lamp("SUN", "sun", (-2, -2, 3), (0, 0, 0), energy=0.5, color=(0.8, 0.9, 1), angle=0)

    view = bpy.data.cameras.new("camera")
    view.lens, view.sensor_width = 45, 36
    camera = bpy.data.objects.new("camera", view)
    camera.location = (0.25, -3.1, 1.35)
    camera.rotation_euler = (Vector((0.18, 0.1, 0.3)) - camera.location).to_track_quat("-Z", "Y").to_euler()
    bpy.context.collection.objects.link(camera)

    scene = bpy.context.scene
    scene.camera = camera
    scene.render.resolution_x, scene.render.resolution_y = 640, 360
    # Custom properties, which the exporter writes as scene.extras.
    scene["description"] = "Still life made and exported by Blender 3.4: glass, metal, textures, linked duplicates, four kinds of light"
    scene["lacuna"] = {"width": 640, "height": 360, "max_depth": 12}


def main():
    arguments = sys.argv[sys.argv.index("--") + 1:] if "--" in sys.argv else []
    out = Path(arguments[0]) if arguments else Path(__file__).with_name("blender-still-life.glb")
    build()
    # ../render/README.md, "From Blender". COMPAT is what the exporter's panel calls Unitless.
    bpy.ops.export_scene.gltf(filepath=str(out.resolve()), export_format="GLB", export_cameras=True, export_lights=True,
                              export_extras=True, convert_lighting_mode="COMPAT", export_tangents=True,
                              export_original_specular=True, export_animations=False)


main()
