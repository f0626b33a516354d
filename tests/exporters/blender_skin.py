"""Run by Blender: exports a column that an armature bends and shape keys swell, with both ("skin"), or as the mesh that
Blender makes of them ("baked").

    blender -b --factory-startup --python blender_skin.py -- OUT.glb skin|baked
"""

import math
import sys

import bpy

# Debian's NumPy no longer has a name that the exporter of Blender 3.4 uses.
import numpy

numpy.bool = bool

output, kind = sys.argv[sys.argv.index("--") + 1:]
bpy.ops.wm.read_factory_settings(use_empty=True)
collection = bpy.context.scene.collection


def grey(name: str, value: float, rough: float) -> bpy.types.Material:
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    surface = material.node_tree.nodes["Principled BSDF"]
    surface.inputs["Base Color"].default_value = (value, value * 0.8, value * 0.6, 1)
    surface.inputs["Roughness"].default_value = rough
    return material


def bones(column: bpy.types.Object) -> bpy.types.Object:
    """An armature of two bones, the upper one turned, that `column` follows by its height."""
    armature = bpy.data.objects.new("rig", bpy.data.armatures.new("rig"))
    collection.objects.link(armature)
    bpy.context.view_layer.objects.active = armature
    bpy.ops.object.mode_set(mode="EDIT")
    lower = armature.data.edit_bones.new("lower")
    lower.head, lower.tail = (0, 0, 0), (0, 0, 1)
    upper = armature.data.edit_bones.new("upper")
    upper.head, upper.tail, upper.parent = (0, 0, 1), (0, 0, 2), lower
    bpy.ops.object.mode_set(mode="POSE")
    pose = armature.pose.bones["upper"]
    pose.rotation_mode = "XYZ"
    pose.rotation_euler = (math.radians(20), 0, math.radians(50))
    bpy.ops.object.mode_set(mode="OBJECT")
    groups = [column.vertex_groups.new(name=name) for name in ("lower", "upper")]
    for vertex in column.data.vertices:
        share = min(max((vertex.co.z - 0.6) / 0.8, 0.0), 1.0)
        groups[0].add([vertex.index], 1 - share, "REPLACE")
        groups[1].add([vertex.index], share, "REPLACE")
    column.parent = armature
    column.modifiers.new("rig", "ARMATURE").object = armature
    return armature


bpy.ops.mesh.primitive_plane_add(size=6)
bpy.context.object.data.materials.append(grey("floor", 0.5, 0.9))
bpy.ops.mesh.primitive_grid_add(x_subdivisions=12, y_subdivisions=8, size=1)
column = bpy.context.object
for vertex in column.data.vertices:
    angle, height = 2 * math.pi * vertex.co.x, 2 * (vertex.co.y + 0.5)
    vertex.co = (0.3 * math.cos(angle), 0.3 * math.sin(angle), height)
bpy.ops.object.shade_smooth()
column.data.materials.append(grey("column", 0.8, 0.4))
column.shape_key_add(name="Basis")
swollen = column.shape_key_add(name="swollen")
for point in swollen.data:
    point.co.x *= 1 + 0.6 * math.sin(1.5 * point.co.z)
swollen.value = 0.7
armature = bones(column)
if kind == "baked":
    evaluated = column.evaluated_get(bpy.context.evaluated_depsgraph_get())
    baked = bpy.data.objects.new("column", bpy.data.meshes.new_from_object(evaluated))
    baked.matrix_world = column.matrix_world
    collection.objects.link(baked)
    bpy.data.objects.remove(column)
    bpy.data.objects.remove(armature)

sun = bpy.data.objects.new("sun", bpy.data.lights.new("sun", "SUN"))
sun.data.energy = 3
sun.rotation_euler = (0.7, 0.2, 0.4)
collection.objects.link(sun)
camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
camera.location, camera.rotation_euler = (0.5, -5, 2), (math.radians(79), 0, math.radians(5))
collection.objects.link(camera)
bpy.context.scene.camera = camera
bpy.ops.export_scene.gltf(filepath=output, export_format="GLB", export_cameras=True, export_lights=True,
                          export_skins=True, export_morph=True, export_animations=True, export_current_frame=True,
                          convert_lighting_mode="COMPAT")
