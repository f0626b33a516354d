"""Exports a scene of Blender as a .glb and command-line options for the rest. It uses the evaluated depsgraph and not
Blender's own exporter. Therefore modifiers, instances and render visibility are those of a render engine, and lamps and
worlds, which that exporter leaves out, are exported too."""

import os

from . import camera, lights, materials, meshes, textures, world
from .cycles import Cycles
from .glb import Glb

# Blender's z is up, glTF's y.
_UP = [1, 0, 0, 0, 0, 0, -1, 0, 0, 1, 0, 0, 0, 0, 0, 1]
_NO_BODY = ("CAMERA", "EMPTY", "ARMATURE", "LATTICE", "SPEAKER", "LIGHT_PROBE")


def write(depsgraph, view, folder, notes, asking):
    """Writes scene.glb and its further files to `folder`; returns the scene's command-line arguments. `view`: the
    camera object; `asking`: see cycles.Cycles. Raises camera.CannotRender."""
    scene = depsgraph.scene
    if view is None:
        raise camera.CannotRender("expected a camera, found none; add one, or choose it in the scene's properties")
    glb = Glb()
    root = glb.node(None, "Blender", _UP)
    arguments = camera.add(glb, root, view.evaluated_get(depsgraph), scene.render, notes)
    with Cycles(folder, scene.frame_current, scene.lacuna.baked, asking) as cycles:
        _add_objects(glb, root, depsgraph, notes, cycles)
        _say_what_the_scene_loses(scene, notes)
        path = os.path.join(folder, "scene.glb")
        glb.write(path)
        return [path, *arguments, *world.options(depsgraph.scene_eval.world, folder, notes, cycles)]


def _add_objects(glb, root, depsgraph, notes, cycles):
    made = materials.Materials(glb, textures.Textures(glb), notes, cycles)
    bodies = meshes.Meshes(glb, made, notes, cycles)
    lamps = lights.Lights(glb, root, made, notes, cycles)
    for instance in depsgraph.object_instances:
        thing = instance.object
        _say_what_is_lost(thing, notes)
        if not instance.show_self:
            continue
        if thing.type == "LIGHT":
            lamps.add(thing, instance.matrix_world.copy())
        elif thing.type in meshes.GEOMETRY:
            mesh = bodies.of(thing, _hidden(thing, depsgraph))
            if mesh is not None:
                glb.node(root, thing.name, [float(v) for c in instance.matrix_world.col for v in c], mesh=mesh)
        elif thing.type not in _NO_BODY:
            notes.add(thing.name, f"objects of type {thing.type.title()} are left out")


def _hidden(thing, depsgraph):
    original = thing.original
    indirect = original.indirect_only_get(view_layer=depsgraph.view_layer)
    return not original.visible_camera or indirect


def _say_what_is_lost(thing, notes):
    if thing.type in meshes.GEOMETRY:
        for kind in ("diffuse", "glossy", "transmission", "shadow"):
            if not getattr(thing, "visible_" + kind, True):
                notes.add(thing.name, f"the object is visible to {kind} rays, too")
        if thing.is_holdout or thing.is_shadow_catcher:
            notes.add(thing.name, "holdouts and shadow catchers are rendered as plain objects")
    for system in thing.particle_systems:
        if system.settings.type == "HAIR" and system.settings.render_type == "PATH":
            notes.add(thing.name, "hair is left out")


def _say_what_the_scene_loses(scene, notes):
    render = scene.render
    for on, text in ((render.use_motion_blur, "motion blur is left out"),
                     (render.use_freestyle, "Freestyle's lines are left out"),
                     (render.use_multiview, "of several views one is rendered")):
        if on:
            notes.add(scene.name, text)
