"""Evaluates shader nodes with Cycles. cycles.py runs it in a second Blender process without a window:

  blender -b --factory-startup -P cycles_child.py

Each line of stdin is a request in JSON. The result goes to its file `out`: a linear picture as .exr, or arrays. The
answer is a line of stdout that begins with _ANSWER: "done", or the error."""

import json
import math
import sys

import bpy
import numpy

_ANSWER = "LACUNA "
_EXACT = 0.01  # filter width in pixels: samples lie at the centres of texels
_PANORAMA = 1 << 24  # samples of a panorama


def load(request):
    """An empty scene and the requested data-block."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    with bpy.data.libraries.load(request["file"]) as (_, wanted):
        setattr(wanted, request["kind"], [request["name"]])
    scene = bpy.context.scene
    scene.frame_set(request["frame"])
    return scene, getattr(wanted, request["kind"])[0]


def panorama(request):
    """A whole world as a latitude-longitude picture whose centre is +X, as in Blender."""
    scene, scene.world = load(request)
    camera = add_camera(scene, "PANO", (0, 0, 0), (math.pi / 2, 0, -math.pi / 2))
    (camera.cycles if hasattr(camera.cycles, "panorama_type") else camera).panorama_type = "EQUIRECTANGULAR"
    # A sun covers only a few texels, which need enough samples.
    render(scene, request, min(max(_PANORAMA // (request["width"] * request["height"]), 1), 64), width_of_filter=1)


def flat(request):
    """An output of a material's node, over the square of the texture coordinates."""
    scene, material = load(request)
    lie_flat(material.node_tree)
    shine(material.node_tree, request)
    add_floor(scene, request, material)
    render(scene, request, samples=1, width_of_filter=_EXACT)


def lamp(request):
    """An output of a lamp's node, which has one colour: what a white floor gets from a sun of that colour."""
    scene, sun = load(request)
    shine(sun.node_tree, request)
    sun.type = "SUN"
    sun = bpy.data.lights[sun.name]  # with a sun's members
    sun.energy, sun.angle, sun.color = math.pi, 0, (1, 1, 1)
    scene.collection.objects.link(bpy.data.objects.new("sun", sun))
    white = bpy.data.materials.new("white")
    white.diffuse_color = (1, 1, 1, 1)  # without nodes: Lambertian
    add_floor(scene, request, white)
    render(scene, request, samples=1, width_of_filter=_EXACT)


def unwrapped(request):
    """Non-overlapping texture coordinates of a body's triangles: 3 n x 2."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    mesh = add_body(bpy.context.scene, request).data
    mesh.uv_layers.active = mesh.uv_layers.new(name="unwrapped")
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.uv.smart_project(angle_limit=math.radians(66), island_margin=0.01)
    bpy.ops.object.mode_set(mode="OBJECT")
    uvs = numpy.empty(2 * len(mesh.loops), numpy.float32)
    mesh.uv_layers["unwrapped"].data.foreach_get("uv", uvs)
    numpy.save(request["out"], uvs.reshape(-1, 2))


def baked(request):
    """An output of a material's node on a body, over its unwrapped texture coordinates: height x width x 3, row 0 at the top."""
    scene, material = load(request)
    body = add_body(scene, request)
    shine(material.node_tree, request)
    body.data.materials.append(material)
    mesh, (width, height) = body.data, (request["width"], request["height"])
    image = bpy.data.images.new("baked", width, height, float_buffer=True)
    target = material.node_tree.nodes.new("ShaderNodeTexImage")
    target.image, material.node_tree.nodes.active = image, target
    scene.render.engine, scene.cycles.samples, scene.cycles.use_denoising = "CYCLES", 1, False
    scene.render.bake.margin = max(width // 64, 2)
    bpy.ops.object.bake(type="EMIT", uv_layer="unwrapped")
    texels = numpy.empty(width * height * 4, numpy.float32)
    image.pixels.foreach_get(texels)
    numpy.save(request["out"], texels.reshape(height, width, 4)[::-1, :, :3])


def add_body(scene, request):
    """Makes an object of the arrays of body.Body and makes it active."""
    arrays = numpy.load(request["body"])
    mesh = bpy.data.meshes.new("body")
    mesh.from_pydata(arrays["points"].tolist(), [], arrays["triangles"].tolist())
    mesh.use_auto_texspace = False
    mesh.texspace_location, mesh.texspace_size = arrays["texture_space"]
    mesh.polygons.foreach_set("use_smooth", numpy.full(len(mesh.polygons), bool(arrays["smooth"])))
    for name in arrays:
        kind, _, name_of = name.partition(":")
        if kind == "uv":
            layer = mesh.uv_layers.new(name=name_of)
            layer.data.foreach_set("uv", arrays[name].ravel())
            layer.active_render = name_of == str(arrays["active_uv"])
        elif kind == "color":
            mesh.color_attributes.new(name_of, "FLOAT_COLOR", "CORNER").data.foreach_set("color", arrays[name].ravel())
    body = bpy.data.objects.new("body", mesh)
    body.matrix_world = arrays["matrix"].tolist()
    scene.collection.objects.link(body)
    bpy.context.view_layer.objects.active = body
    body.select_set(True)
    return body


def add_camera(scene, kind, location, rotation):
    camera = bpy.data.cameras.new("camera")
    camera.type, camera.ortho_scale = kind, 1
    scene.camera = bpy.data.objects.new("camera", camera)
    scene.collection.objects.link(scene.camera)
    scene.camera.location, scene.camera.rotation_euler = location, rotation
    return camera


def add_floor(scene, request, material):
    """Adds a plane that fills the picture seen from above."""
    bpy.ops.mesh.primitive_plane_add(size=1)
    floor = bpy.context.object
    side = max(request["width"], request["height"])
    floor.scale = (request["width"] / side, request["height"] / side, 1)
    floor.data.materials.append(material)
    add_camera(scene, "ORTHO", (0, 0, 1), (0, 0, 0))


def shine(tree, request):
    """Makes the tree emit the requested output, which may be inside groups."""
    trees = [tree]
    for name in request["groups"]:
        trees.append(trees[-1].nodes[name].node_tree)
    output = by_identifier(trees[-1].nodes[request["node"]].outputs, request["output"])
    for inner, outer, name in zip(trees[:0:-1], trees[-2::-1], request["groups"][::-1]):
        output = lead_out(inner, output, outer.nodes[name])
    emission = tree.nodes.new("ShaderNodeEmission")
    tree.links.new(output, emission.inputs["Color"])
    tree.links.new(emission.outputs[0], tree.get_output_node("CYCLES").inputs["Surface"])


def lie_flat(tree):
    """Removes the transforms of images: the document places them."""
    for node in tree.nodes:
        if node.type == "TEX_IMAGE":
            node.projection = "FLAT"
            for link in list(node.inputs["Vector"].links):
                tree.links.remove(link)
        elif node.type == "GROUP" and node.node_tree:
            lie_flat(node.node_tree)


def lead_out(tree, output, group):
    """Adds an output with the same value to the group's node."""
    if hasattr(tree, "interface"):  # Blender 4
        made = tree.interface.new_socket("lacuna", in_out="OUTPUT", socket_type="NodeSocketColor")
    else:
        made = tree.outputs.new("NodeSocketColor", "lacuna")
    end = next(n for n in tree.nodes if n.type == "GROUP_OUTPUT" and n.is_active_output)
    tree.links.new(output, by_identifier(end.inputs, made.identifier))
    return by_identifier(group.outputs, made.identifier)


def by_identifier(sockets, identifier):
    return next(s for s in sockets if s.identifier == identifier)


def render(scene, request, samples, width_of_filter):
    render, cycles = scene.render, scene.cycles
    render.engine = "CYCLES"
    render.resolution_x, render.resolution_y = request["width"], request["height"]
    render.image_settings.file_format, render.image_settings.color_mode = "OPEN_EXR", "RGB"
    render.image_settings.color_depth, render.image_settings.exr_codec = "32", "ZIP"
    render.use_file_extension = False
    render.filepath = request["out"]
    cycles.samples, cycles.use_adaptive_sampling, cycles.use_denoising = samples, False, False
    cycles.max_bounces, cycles.sample_clamp_direct = 0, 0
    cycles.pixel_filter_type, cycles.filter_width = "BLACKMAN_HARRIS", width_of_filter
    bpy.ops.render.render(write_still=True)


def main():
    makers = {f.__name__: f for f in (panorama, flat, lamp, unwrapped, baked)}
    for line in sys.stdin:
        try:
            request = json.loads(line)
            makers[request["what"]](request)
            said = "done"
        except Exception as error:  # the parent reports it and goes on without the answer
            said = f"{type(error).__name__}: {error}".replace("\n", " ")
        print(_ANSWER + said, flush=True)


main()
