"""Sixteen small scenes, made with Blender's own tools, which together contain everything that the add-on exports."""

import math

import bpy
import numpy
from mathutils import Vector


def material(name, kind, **inputs):
    """One BSDF with these inputs, linked to the output; returns material, tree and node."""
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    tree = made.node_tree
    output = tree.get_output_node("CYCLES")
    tree.nodes.remove(tree.nodes["Principled BSDF"])
    node = tree.nodes.new(kind)
    for key, value in inputs.items():
        node.inputs[key.replace("_", " ")].default_value = value
    tree.links.new(node.outputs[0], output.inputs["Surface"])
    return made, tree, node


def diffuse(name, *color):
    return material(name, "ShaderNodeBsdfDiffuse", Color=(*color, 1))[0]


def principled(name, color, **inputs):
    return material(name, "ShaderNodeBsdfPrincipled", Base_Color=(*color, 1), **inputs)[0]


def textured(name, picture, kind="ShaderNodeBsdfDiffuse"):
    made, tree, node = material(name, kind)
    image = tree.nodes.new("ShaderNodeTexImage")
    image.image = picture
    tree.links.new(image.outputs["Color"], node.inputs["Color"])
    return made, tree, image


def image(name, texels, color=True, deep=False):
    """An image of these texels, height x width x 3 as stored, row 0 at the bottom."""
    height, width, _ = texels.shape
    made = bpy.data.images.new(name, width, height, float_buffer=deep)
    if not deep:
        made.colorspace_settings.name = "sRGB" if color else "Non-Color"
    made.pixels = numpy.dstack([texels, numpy.ones((height, width))]).ravel().tolist()
    made.pack()
    return made


def quarters(name, colors, size=32):
    """An image of four colours: lower left, lower right, upper left, upper right."""
    c = numpy.array(colors, float).reshape(2, 2, 3)
    return image(name, c.repeat(size, axis=0).repeat(size, axis=1))


def add(operator, made=None, smooth=False, **settings):
    operator(**settings)
    thing = bpy.context.object
    if made:
        thing.data.materials.append(made)
    if smooth:
        for face in thing.data.polygons:
            face.use_smooth = True
    return thing


def plane(made, size=1, **place):
    return add(bpy.ops.mesh.primitive_plane_add, made, size=size, **place)


def cube(made, size=1, **place):
    return add(bpy.ops.mesh.primitive_cube_add, made, size=size, **place)


def ball(made, radius=0.5, **place):
    return add(bpy.ops.mesh.primitive_uv_sphere_add, made, smooth=True, radius=radius, segments=48, ring_count=24, **place)


def for_cycles(scene, width, height, edges, samples):
    """Sets Cycles to write an .exr of that size with paths of up to `edges` edges, without features for looks or
    speed."""
    render, cycles = scene.render, scene.cycles
    render.engine = "CYCLES"
    render.resolution_x, render.resolution_y = width, height
    render.image_settings.file_format, render.image_settings.color_mode = "OPEN_EXR", "RGB"
    render.image_settings.color_depth, render.image_settings.exr_codec = "32", "ZIP"
    render.use_file_extension = False
    cycles.samples, cycles.use_adaptive_sampling, cycles.use_denoising = samples, False, False
    cycles.pixel_filter_type, cycles.blur_glossy, cycles.sample_clamp_indirect = "BOX", 0, 0
    # Cycles does not count the edge at the lens and that at the light.
    for kind in ("max", "diffuse", "glossy", "transmission"):
        setattr(cycles, kind + "_bounces", edges - 2)


def lamp(kind, location, to, energy, **settings):
    data = bpy.data.lights.new(kind.title(), kind)
    data.energy = energy
    for key, value in settings.items():
        setattr(data, key, value)
    thing = bpy.data.objects.new(kind.title(), data)
    thing.location = location
    thing.rotation_euler = (Vector(to) - Vector(location)).to_track_quat("-Z", "Y").to_euler()
    bpy.context.collection.objects.link(thing)
    return thing


def camera(location=(0, -6, 2.2), to=(0, 0, 0.8), lens=35, **settings):
    data = bpy.data.cameras.new("Camera")
    data.lens = lens
    for key, value in settings.items():
        setattr(data, key, value)
    thing = bpy.data.objects.new("Camera", data)
    thing.location = location
    thing.rotation_euler = (Vector(to) - Vector(location)).to_track_quat("-Z", "Y").to_euler()
    bpy.context.collection.objects.link(thing)
    bpy.context.scene.camera = thing
    return thing


def stage():
    """A floor and a wall."""
    plane(diffuse("floor", 0.7, 0.65, 0.6), 12)
    plane(diffuse("wall", 0.5, 0.6, 0.7), 12, location=(0, 3, 0), rotation=(math.pi / 2, 0, 0))


def world(color=(0, 0, 0), strength=1.0):
    made = bpy.data.worlds.new("World")
    made.use_nodes = True
    background = made.node_tree.nodes["Background"]
    background.inputs["Color"].default_value = (*color, 1)
    background.inputs["Strength"].default_value = strength
    bpy.context.scene.world = made
    return made


def sky(rotation):
    """An image whose quarters differ, turned by a Mapping node."""
    made = world(strength=1.5)
    x, y = numpy.meshgrid(numpy.linspace(0, 1, 64), numpy.linspace(0, 1, 32))
    texels = numpy.dstack([0.2 + (x < 0.25) * 2.0, 0.2 + (x > 0.6) * 1.5 * y, 0.3 + 0.7 * y])
    tree = made.node_tree
    node = tree.nodes.new("ShaderNodeTexEnvironment")
    node.image = image("sky", texels, deep=True)
    mapping = tree.nodes.new("ShaderNodeMapping")
    mapping.inputs["Rotation"].default_value = rotation
    place = tree.nodes.new("ShaderNodeTexCoord")
    tree.links.new(place.outputs["Generated"], mapping.inputs["Vector"])
    tree.links.new(mapping.outputs["Vector"], node.inputs["Vector"])
    tree.links.new(node.outputs["Color"], tree.nodes["Background"].inputs["Color"])


def area_lamps():
    stage()
    ball(diffuse("red", 0.7, 0.2, 0.1), location=(-0.8, 0, 0.5))
    lamp("AREA", (1.5, 0.5, 2.5), (0, 0, 0.5), 120, size=0.8, color=(1, 0.9, 0.7))  # in the picture, but invisible
    # In front of the camera.
    lamp("AREA", (0, -3, 0.7), (0, 3, 0.5), 40, shape="ELLIPSE", size=1.0, size_y=0.5).scale = (1.5, 0.5, 1)
    camera()


def bulbs():
    stage()
    cube(diffuse("green", 0.2, 0.6, 0.2), location=(0, 0.4, 0.5))
    lamp("POINT", (-1.2, -0.5, 1.4), (0, 0, 0), 80, shadow_soft_size=0.25, color=(1, 0.7, 0.4))
    lamp("POINT", (1.6, -1, 2.2), (0, 0, 0), 60, shadow_soft_size=0).scale = (2, 2, 2)
    camera()


def spots():
    stage()
    ball(diffuse("blue", 0.2, 0.3, 0.7), location=(0.8, 0, 0.5))
    lamp("SPOT", (-1.5, -2, 3), (-0.8, 0.5, 0), 400, spot_size=0.8, spot_blend=0.5, shadow_soft_size=0.15)
    lamp("SPOT", (2, -2, 3), (0.8, 0, 0.4), 300, spot_size=0.6, spot_blend=0.0, shadow_soft_size=0, color=(1, 0.6, 0.5))
    world((0.02, 0.02, 0.03))
    camera()


def sun_and_colour():
    stage()
    cube(diffuse("white", 0.8, 0.8, 0.8), location=(-0.5, 0, 0.5), rotation=(0, 0, 0.5))
    lamp("SUN", (0, 0, 5), (1.5, 2.5, 0), 3, angle=math.radians(10), color=(1, 0.95, 0.8))
    world((0.1, 0.2, 0.4), 0.8)
    camera()


def sky_image():
    plane(diffuse("ground", 0.6, 0.6, 0.6), 6)
    ball(material("mirror", "ShaderNodeBsdfGlossy", Color=(0.9, 0.9, 0.9, 1), Roughness=0)[0], 0.7, location=(-0.9, 0, 0.7))
    ball(diffuse("white", 0.8, 0.8, 0.8), 0.6, location=(0.9, 0, 0.6))
    sky((0.3, 0, math.radians(50)))
    camera()


def lens_and_film():
    """A shifted camera with a lens and another sensor fit, which looks up, and a picture that is higher than wide."""
    stage()
    for i in range(4):
        cube(diffuse(f"pillar {i}", 0.2 + 0.2 * i, 0.5, 0.8 - 0.2 * i), location=(-1.5 + i, -1 + i, 1), scale=(0.4, 0.4, 2))
    sky((0, 0, math.radians(-30)))
    thing = camera(to=(0, 0, 2.2), sensor_fit="HORIZONTAL", shift_x=0.1, shift_y=-0.3)
    thing.data.dof.use_dof, thing.data.dof.focus_distance, thing.data.dof.aperture_fstop = True, 6.0, 0.2
    bpy.context.scene.render.resolution_x, bpy.context.scene.render.resolution_y = 72, 96


def shaders():
    stage()
    ball(principled("plastic", (0.7, 0.1, 0.1), Roughness=0.3), 0.4, location=(-1.8, 0, 0.4))
    ball(principled("gold", (0.9, 0.7, 0.3), Metallic=1.0, Roughness=0.3), 0.4, location=(-0.9, 0, 0.4))
    ball(material("glass", "ShaderNodeBsdfGlass", Color=(1, 1, 1, 1), Roughness=0, IOR=1.5)[0], 0.4, location=(0, 0, 0.45))
    ball(material("lamp", "ShaderNodeEmission", Color=(0.4, 0.8, 1, 1), Strength=2.0)[0], 0.3, location=(0.9, 0, 0.4))
    made, tree, node = material("veil", "ShaderNodeMixShader", Fac=0.4)
    output = tree.nodes.new("ShaderNodeBsdfTransparent"), tree.nodes.new("ShaderNodeBsdfDiffuse")
    for i in range(2):
        tree.links.new(output[i].outputs[0], node.inputs[1 + i])
    plane(made, 1.0, location=(1.8, 0, 0.6), rotation=(math.pi / 2, 0, 0))
    lamp("AREA", (0, -2, 4), (0, 0, 0), 200, size=1.5)
    world((0.1, 0.1, 0.1))
    camera()


def waves(name, height):
    """A normal map of waves along u."""
    x = numpy.linspace(0, 8 * math.pi, 64)
    slope = height * numpy.sin(x)[None, :].repeat(64, axis=0)
    normal = numpy.dstack([slope, 0 * slope, numpy.sqrt(1 - slope * slope)])
    return image(name, 0.5 * normal + 0.5, color=False)


def bumps(tree, node, shader, input_):
    """Links an image's colour to that input as a normal map."""
    bump = tree.nodes.new("ShaderNodeNormalMap")
    tree.links.new(node.outputs["Color"], bump.inputs["Color"])
    tree.links.new(bump.outputs["Normal"], shader.inputs[input_])


def brushed_cloth_and_lacquer():
    stage()
    steel = dict(Metallic=1.0, Roughness=0.5)
    ball(principled("around z", (0.9, 0.9, 0.9), Anisotropic=0.9, **steel), 0.5, location=(-1.9, 0, 0.5))
    cube(principled("turned", (0.9, 0.7, 0.5), Anisotropic=0.9, Anisotropic_Rotation=0.25, **steel), 0.7,
         location=(-0.8, 0, 0.4), rotation=(0, 0, 0.4))
    made, tree, shader = material("by a map", "ShaderNodeBsdfAnisotropic", Color=(0.6, 0.8, 0.9, 1), Roughness=0.4,
                                  Anisotropy=0.7)
    tangent = tree.nodes.new("ShaderNodeTangent")
    tangent.direction_type = "UV_MAP"
    tree.links.new(tangent.outputs[0], shader.inputs["Tangent"])
    plane(made, 1.2, location=(0.4, 1, 0.8), rotation=(1.2, 0, 0))
    ball(principled("cloth", (0.1, 0.05, 0.2), Roughness=1.0, Specular=0.0, Sheen=1.0), 0.5, location=(1.0, -0.2, 0.5))
    made, tree, shader = material("lacquer", "ShaderNodeBsdfPrincipled", Base_Color=(0.1, 0.1, 0.1, 1), Specular=0.0,
                                  Roughness=1.0, Clearcoat=1.0, Clearcoat_Roughness=0.1)
    node = tree.nodes.new("ShaderNodeTexImage")
    node.image = waves("ripples", 0.3)
    bumps(tree, node, shader, "Clearcoat Normal")
    plane(made, 1.2, location=(2.2, 0.6, 0.8), rotation=(1.2, 0, -0.3))
    lamp("AREA", (-1, -2.5, 3), (0, 0, 0.5), 150, size=1)
    lamp("AREA", (3, -3, 2.5), (1, 0, 0.5), 80, size=0.6)
    world((0.2, 0.2, 0.25))
    camera()


def images_on_surfaces():
    made, tree, node = textured("quarters", quarters("four", [(.9, .2, .2), (.2, .9, .2), (.2, .2, .9), (.9, .9, .2)]))
    mapping = tree.nodes.new("ShaderNodeMapping")
    mapping.inputs["Location"].default_value = (0.1, 0.3, 0)
    mapping.inputs["Rotation"].default_value = (0, 0, 0.4)
    mapping.inputs["Scale"].default_value = (1.5, 0.8, 1)
    place = tree.nodes.new("ShaderNodeTexCoord")
    tree.links.new(place.outputs["UV"], mapping.inputs["Vector"])
    tree.links.new(mapping.outputs["Vector"], node.inputs["Vector"])
    plane(made, 4, location=(-1, 2, 2), rotation=(math.pi / 2, 0, 0))
    plane(textured("plain", quarters("grey", [(.2,) * 3, (.8,) * 3, (.5,) * 3, (.9,) * 3]))[0], 6)
    made, tree, node = textured("waves", waves("waves", 0.6))
    shader = tree.nodes["Diffuse BSDF"]
    bumps(tree, node, shader, "Normal")
    tree.links.remove(shader.inputs["Color"].links[0])
    shader.inputs["Color"].default_value = (0.8, 0.8, 0.8, 1)
    plane(made, 2, location=(2, 1, 1), rotation=(math.pi / 2, 0, -0.6))
    made, tree, shader = material("painted", "ShaderNodeBsdfDiffuse")
    colors = tree.nodes.new("ShaderNodeVertexColor")
    colors.layer_name = "paint"
    tree.links.new(colors.outputs["Color"], shader.inputs["Color"])
    thing = cube(made, location=(0.5, -0.5, 0.5), rotation=(0, 0, 0.5))
    paint = thing.data.color_attributes.new("paint", "BYTE_COLOR", "CORNER")
    for i, entry in enumerate(paint.data):
        entry.color = ((i % 4) / 3, 0.5, 1 - (i % 3) / 2, 1)
    lamp("SUN", (0, 0, 5), (-1.5, 3, 0), 3, angle=0)
    world((0.2, 0.2, 0.2))
    camera()


def copies_and_modifiers():
    """What is hidden from renders (a cutter, the collection that is instanced) must not appear."""
    stage()
    brick = cube(diffuse("brick", 0.7, 0.3, 0.2), 0.4, location=(-2.2, 0.8, 0.2))
    array = brick.modifiers.new("Array", "ARRAY")
    array.count, array.relative_offset_displace = 6, (1.3, 0, 0)
    cutter = ball(diffuse("cutter", 1, 0, 1), 0.7, location=(1.2, -0.8, 1.0))
    cutter.hide_render = True
    block = cube(diffuse("block", 0.3, 0.6, 0.6), location=(1.2, -0.3, 0.5))
    cut = block.modifiers.new("Cut", "BOOLEAN")
    cut.object, cut.operation = cutter, "DIFFERENCE"
    round_ = cube(diffuse("round", 0.8, 0.7, 0.2), 0.9, location=(0, 0, 0.5))
    round_.modifiers.new("Subdivision", "SUBSURF").render_levels = 3
    source = bpy.data.collections.new("Source")
    bpy.context.scene.collection.children.link(source)
    tower = cube(diffuse("tower", 0.2, 0.3, 0.8), 0.4)
    tower.scale = (0.5, 0.5, 3)
    for collection in list(tower.users_collection):
        collection.objects.unlink(tower)
    source.objects.link(tower)
    bpy.context.view_layer.layer_collection.children["Source"].exclude = True
    for i in range(3):
        copy = bpy.data.objects.new(f"copy {i}", None)
        copy.instance_type, copy.instance_collection = "COLLECTION", source
        copy.location, copy.scale = (-1.6 + 0.5 * i, -1, 0.5), (1 - 2 * (i % 2), 1, 1)
        bpy.context.collection.objects.link(copy)
    ring = add(bpy.ops.curve.primitive_bezier_circle_add, radius=0.5, location=(1.6, 0.6, 1.8), rotation=(1.2, 0, 0))
    ring.data.bevel_depth = 0.1
    lamp("POINT", (-1, -3, 3), (0, 0, 0), 300, shadow_soft_size=0.3)
    world((0.1, 0.1, 0.1))
    camera()


def ray_visibility():
    stage()
    blind = plane(diffuse("blind", 0.8, 0.2, 0.2), 3, location=(0, -2.5, 1.5), rotation=(math.pi / 2, 0, 0))
    blind.visible_camera = False  # its shadow stays
    shining = plane(material("tube", "ShaderNodeEmission", Color=(1, 0.8, 0.5, 1), Strength=4)[0], 1, location=(-1.5, 1, 1.5),
                    rotation=(1.2, 0, 0.5))
    shining.scale = (-1, 0.3, 1)
    cube(None, 0.8, location=(0.6, 0.6, 0.4))  # Blender's grey
    lamp("AREA", (0.4, -4.2, 1.6), (0.4, 3, 0.8), 60, size=0.5)  # seen from behind
    world((0.15, 0.15, 0.2))
    camera()


def sky_texture():
    """Blender's own sky, tinted, whose sun shines from the side through a gap."""
    stage()
    for x in (-1.9, 1.9):
        cube(diffuse(f"beside {x}", 0.7, 0.7, 0.7), location=(x, -1, 1.5), scale=(0.1, 3, 3))
    cube(diffuse("white", 0.8, 0.8, 0.8), location=(0, 0.5, 0.4), rotation=(0, 0, 0.5), scale=(0.8,) * 3)
    tree = world(strength=0.2).node_tree
    sky = tree.nodes.new("ShaderNodeTexSky")
    sky.sky_type, sky.sun_elevation, sky.sun_rotation = "NISHITA", math.radians(50), math.radians(160)
    tint = tree.nodes.new("ShaderNodeHueSaturation")
    tint.inputs["Saturation"].default_value = 0.6
    tree.links.new(sky.outputs["Color"], tint.inputs["Color"])
    tree.links.new(tint.outputs["Color"], tree.nodes["Background"].inputs["Color"])
    camera()


def node(tree, kind, source, input_, **inputs):
    """A node of that kind with these inputs, whose `input_` is linked to the output `source`."""
    made = tree.nodes.new(kind)
    for key, value in inputs.items():
        made.inputs[key].default_value = value
    tree.links.new(source, made.inputs[input_])
    return made


def images_through_nodes():
    """Images that go through other nodes, in groups too; a lamp by its temperature; a pane that only the camera sees."""
    greys = quarters("grey steps", [(.1,) * 3, (.4,) * 3, (.7,) * 3, (.9,) * 3])
    made, tree, place = textured("ramp", greys)
    ramp = node(tree, "ShaderNodeValToRGB", place.outputs["Color"], "Fac").color_ramp
    ramp.elements[0].color, ramp.elements[1].color = (0.8, 0.1, 0.1, 1), (0.1, 0.2, 0.9, 1)
    tree.links.new(tree.nodes["ColorRamp"].outputs["Color"], tree.nodes["Diffuse BSDF"].inputs["Color"])
    plane(made, 4, location=(-1, 2, 2), rotation=(math.pi / 2, 0, 0))
    made, tree, place = textured("grouped", quarters("warm", [(.9, .2, .2), (.2, .9, .2), (.2, .2, .9), (.9, .9, .2)]))
    inside = bpy.data.node_groups.new("duller", "ShaderNodeTree")
    inside.inputs.new("NodeSocketColor", "Color")
    inside.outputs.new("NodeSocketColor", "Color")
    ends = inside.nodes.new("NodeGroupInput"), inside.nodes.new("NodeGroupOutput")
    duller = node(inside, "ShaderNodeHueSaturation", ends[0].outputs[0], "Color", Saturation=0.4, Value=0.7)
    inside.links.new(duller.outputs[0], ends[1].inputs[0])
    group = tree.nodes.new("ShaderNodeGroup")
    group.node_tree = inside
    tree.links.new(place.outputs["Color"], group.inputs[0])
    tree.links.new(group.outputs[0], tree.nodes["Diffuse BSDF"].inputs["Color"])
    plane(made, 6)
    made, tree, place = textured("polished", greys, "ShaderNodeBsdfGlossy")
    tree.nodes["Glossy BSDF"].inputs["Color"].default_value = (0.9, 0.8, 0.6, 1)
    tree.links.remove(tree.nodes["Glossy BSDF"].inputs["Color"].links[0])
    tree.links.new(node(tree, "ShaderNodeInvert", place.outputs["Color"], "Color").outputs[0], tree.nodes["Glossy BSDF"].inputs["Roughness"])
    plane(made, 2, location=(2, 1, 1), rotation=(math.pi / 2, 0, -0.6))
    made, tree, mix = material("pane", "ShaderNodeMixShader")
    for i, kind in enumerate(("ShaderNodeBsdfDiffuse", "ShaderNodeBsdfTransparent")):
        tree.links.new(tree.nodes.new(kind).outputs[0], mix.inputs[1 + i])
    tree.links.new(tree.nodes.new("ShaderNodeLightPath").outputs["Is Shadow Ray"], mix.inputs["Fac"])
    cube(made, location=(0.4, -0.5, 0.4), scale=(0.8,) * 3)
    bulb = lamp("POINT", (-1, -3, 3), (0, 0, 0), 1, shadow_soft_size=0.3)
    bulb.data.use_nodes = True
    tree = bulb.data.node_tree
    warm = tree.nodes.new("ShaderNodeBlackbody")
    warm.inputs[0].default_value = 3200
    tree.links.new(warm.outputs[0], tree.nodes["Emission"].inputs["Color"])
    tree.nodes["Emission"].inputs["Strength"].default_value = 300
    world((0.2, 0.2, 0.2))
    camera()


def hills(name):
    """Heights: a bump in the middle of each quarter."""
    x = numpy.sin(numpy.linspace(0, 4 * math.pi, 128)) ** 2
    return image(name, numpy.dstack([numpy.outer(x, x)] * 3), color=False)


def masks_and_bumps():
    """Two shaders mixed by an image, heights in two Bump nodes, an alpha cut by an image alone, a screen that emits an
    image."""
    stage()
    mask = quarters("mask", [(0,) * 3, (1,) * 3, (1,) * 3, (.3,) * 3])
    made, tree, place = textured("painted steel", mask)
    paint = tree.nodes["Diffuse BSDF"]
    tree.links.remove(paint.inputs["Color"].links[0])
    paint.inputs["Color"].default_value = (0.7, 0.1, 0.1, 1)
    steel = tree.nodes.new("ShaderNodeBsdfGlossy")
    steel.inputs["Color"].default_value, steel.inputs["Roughness"].default_value = (0.8, 0.8, 0.8, 1), 0.5
    mix = node(tree, "ShaderNodeMixShader", place.outputs["Color"], "Fac")
    tree.links.new(paint.outputs[0], mix.inputs[1])
    tree.links.new(steel.outputs[0], mix.inputs[2])
    tree.links.new(mix.outputs[0], tree.get_output_node("CYCLES").inputs["Surface"])
    plane(made, 2, location=(-2, 1.5, 1), rotation=(math.pi / 2, 0, 0.3))
    heights = hills("hills")
    for name, distance, side, at in (("hilly", 0.3, 3, (0.6, 2, 1.5)), ("pits", -0.6, 3, (4, 2.2, 1.5))):
        made, tree, place = textured(name, heights)
        shader = tree.nodes["Diffuse BSDF"]
        tree.links.remove(shader.inputs["Color"].links[0])
        shader.inputs["Color"].default_value = (0.8, 0.8, 0.8, 1)
        bump = node(tree, "ShaderNodeBump", place.outputs["Color"], "Height", Distance=distance, Strength=0.8)
        tree.links.new(bump.outputs["Normal"], shader.inputs["Normal"])
        plane(made, side, location=at, rotation=(math.pi / 2, 0, 0))
    made, tree, place = textured("cut", mask)
    shader = tree.nodes["Diffuse BSDF"]
    tree.links.remove(shader.inputs["Color"].links[0])
    mix = node(tree, "ShaderNodeMixShader", place.outputs["Color"], "Fac")
    tree.links.new(tree.nodes.new("ShaderNodeBsdfTransparent").outputs[0], mix.inputs[1])
    tree.links.new(shader.outputs[0], mix.inputs[2])
    tree.links.new(mix.outputs[0], tree.get_output_node("CYCLES").inputs["Surface"])
    plane(made, 1.2, location=(-0.6, -0.5, 0.6), rotation=(math.pi / 2, 0, 0))
    made, tree, shader = material("screen", "ShaderNodeEmission", Color=(0.4, 0.7, 1, 1))
    place = tree.nodes.new("ShaderNodeTexImage")
    place.image = mask
    tree.links.new(node(tree, "ShaderNodeMath", place.outputs["Color"], 0).outputs[0], shader.inputs["Strength"])
    tree.nodes["Math"].operation, tree.nodes["Math"].inputs[1].default_value = "MULTIPLY", 4
    plane(made, 1, location=(2.4, 0.5, 0.8), rotation=(math.pi / 2, 0, -0.6))
    lamp("SUN", (0, 0, 5), (2.5, 2.5, 1.5), 3, angle=0)
    lamp("AREA", (2, -3, 3), (-1, 1, 1), 100, size=1)
    world((0.2, 0.2, 0.2))
    camera()


def procedural():
    """Procedural textures: over the object's box, its coordinates or UV; as colour, roughness and bump."""
    made, tree, shader = material("tiles", "ShaderNodeBsdfDiffuse")
    place = tree.nodes.new("ShaderNodeTexCoord")
    node(tree, "ShaderNodeTexChecker", place.outputs["UV"], "Vector", Scale=16, Color1=(.7, .6, .5, 1), Color2=(.2, .2, .3, 1))
    tree.links.new(tree.nodes["Checker Texture"].outputs["Color"], shader.inputs["Color"])
    plane(made, 12)
    made, tree, shader = material("bricks", "ShaderNodeBsdfDiffuse")
    bricks = node(tree, "ShaderNodeTexBrick", tree.nodes.new("ShaderNodeTexCoord").outputs["Object"], "Vector", Scale=1.0)
    tree.links.new(bricks.outputs["Color"], shader.inputs["Color"])
    plane(made, 12, location=(0, 3, 0), rotation=(math.pi / 2, 0, 0))
    made, tree, shader = material("marble", "ShaderNodeBsdfDiffuse")
    noise = tree.nodes.new("ShaderNodeTexNoise")  # by the object's box
    ramp = node(tree, "ShaderNodeValToRGB", noise.outputs["Fac"], "Fac")
    ramp.color_ramp.elements[0].position, ramp.color_ramp.elements[1].position = 0.4, 0.6
    ramp.color_ramp.elements[0].color, ramp.color_ramp.elements[1].color = (0.05, 0.1, 0.3, 1), (0.9, 0.8, 0.7, 1)
    tree.links.new(ramp.outputs["Color"], shader.inputs["Color"])
    mix = node(tree, "ShaderNodeMixShader", shader.outputs[0], 1, Fac=0.2)
    tree.links.new(tree.nodes.new("ShaderNodeBsdfDiffuse").outputs[0], mix.inputs[2])
    tree.links.new(mix.outputs[0], tree.get_output_node("CYCLES").inputs["Surface"])
    ball(made, 0.8, location=(-1.3, 0.3, 0.8))
    cube(made, 0.9, location=(-2.6, -0.4, 0.45), rotation=(0, 0, 0.3))  # another shape's texture
    made, tree, shader = material("worn", "ShaderNodeBsdfGlossy", Color=(0.9, 0.8, 0.5, 1))
    wave = node(tree, "ShaderNodeTexWave", tree.nodes.new("ShaderNodeTexCoord").outputs["Object"], "Vector", Scale=1.5)
    half = node(tree, "ShaderNodeMath", wave.outputs["Fac"], 0)
    half.operation, half.inputs[1].default_value = "MULTIPLY", 0.6
    tree.links.new(half.outputs[0], shader.inputs["Roughness"])
    cube(made, 1.2, location=(0.5, 0.3, 0.6), rotation=(0, 0, 0.5))
    made, tree, shader = material("rough", "ShaderNodeBsdfDiffuse", Color=(0.7, 0.7, 0.7, 1))
    noise = tree.nodes.new("ShaderNodeTexVoronoi")
    noise.inputs["Scale"].default_value = 4
    bump = node(tree, "ShaderNodeBump", noise.outputs["Distance"], "Height", Distance=0.4, Strength=1.0)
    tree.links.new(bump.outputs["Normal"], shader.inputs["Normal"])
    ball(made, 0.8, location=(2.2, 0.3, 0.8))
    lamp("SUN", (0, 0, 5), (2.5, 2.5, 1.5), 3, angle=0)
    world((0.3, 0.3, 0.3))
    camera()


def tinted_glass():
    """Glass cubes with weak to strong absorption under a bright sky."""
    stage()
    for x, density in ((-1.5, 0.5), (0, 2.0), (1.5, 4.0)):
        made, tree, _ = material(f"tinted {density}", "ShaderNodeBsdfGlass", Color=(1, 1, 1, 1), Roughness=0, IOR=1.2)
        absorbs = tree.nodes.new("ShaderNodeVolumeAbsorption")
        absorbs.inputs["Color"].default_value, absorbs.inputs["Density"].default_value = (0.9, 0.5, 0.2, 1), density
        tree.links.new(absorbs.outputs[0], tree.get_output_node("CYCLES").inputs["Volume"])
        cube(made, 0.9, location=(x, 0, 0.5))
    world((0.8, 0.8, 0.8))
    camera()


# Allowed relative difference of a region's mean from Cycles', and why it is more than noise.
SCENES = {
    "area-lamps": (area_lamps, 0.04, ""), "bulbs": (bulbs, 0.04, ""),
    "spots": (spots, 0.12, "the cone fades by glTF's curve"),
    "sun-and-colour": (sun_and_colour, 0.04, ""), "sky-image": (sky_image, 0.05, ""),
    "lens-and-film": (lens_and_film, 0.05, ""),
    "shaders": (shaders, 0.15, "what is diffuse under a glossy layer is darker"),
    "brushed-cloth-and-lacquer": (brushed_cloth_and_lacquer, 0.06, ""),
    "images-on-surfaces": (images_on_surfaces, 0.08, "normal maps end at the surface's own horizon"),
    "copies-and-modifiers": (copies_and_modifiers, 0.04, ""), "ray-visibility": (ray_visibility, 0.05, ""),
    "sky-texture": (sky_texture, 0.05, ""), "images-through-nodes": (images_through_nodes, 0.05, ""),
    "masks-and-bumps": (masks_and_bumps, 0.06, ""), "procedural": (procedural, 0.06, ""),
    "tinted-glass": (tinted_glass, 0.06, "")}
