"""The camera, and lacuna-render's options for the picture."""

import math


class CannotRender(Exception):
    """Tells why the scene cannot be rendered at all."""


def film(render):
    """Width and height of the whole picture, and the part that is rendered: x0, x1, y0, y1 from the upper left, or None."""
    width = max(int(render.resolution_x * render.resolution_percentage / 100), 1)
    height = max(int(render.resolution_y * render.resolution_percentage / 100), 1)
    if not render.use_border:
        return width, height, None
    x0, x1 = int(render.border_min_x * width), int(render.border_max_x * width)
    y0, y1 = int(render.border_min_y * height), int(render.border_max_y * height)
    return width, height, (x0, x1, height - y1, height - y0)


def view(camera, width, height):
    """The vertical angle of camera data in radians, and its shift as a fraction of the larger side."""
    fit = camera.sensor_fit
    across = fit == "HORIZONTAL" or (fit == "AUTO" and width >= height)
    side, sensor = (width if across else height), (camera.sensor_height if fit == "VERTICAL" else camera.sensor_width)
    half = sensor / (2 * camera.lens)  # tangent of half the angle along that side
    share = side / max(width, height)
    return 2 * math.atan(half * height / side), (camera.shift_x * share, camera.shift_y * share)


def lens(thing):
    """Radius of the lens and the distance in focus, or None for a pinhole."""
    camera, dof = thing.data, thing.data.dof
    if not dof.use_dof:
        return None
    focus = dof.focus_distance
    if dof.focus_object:
        to = dof.focus_object.matrix_world.translation - thing.matrix_world.translation
        focus = abs(to.dot(thing.matrix_world.to_3x3() @ _axis()) / (thing.matrix_world.to_3x3() @ _axis()).length)
    # Blender's lens is in mm; its unit of length is one metre.
    radius = camera.lens / (2 * dof.aperture_fstop * 1000) if dof.aperture_fstop > 0 else 0.0
    return (radius, max(focus, 1e-5)) if radius > 0 else None


def _axis():
    from mathutils import Vector
    return Vector((0, 0, -1))


def add(glb, root, thing, render, notes):
    """Adds the camera object to the document; returns options of lacuna-render."""
    width, height, crop = film(render)
    camera = thing.data
    if thing.type != "CAMERA" or camera.type != "PERSP":
        raise CannotRender(f"{thing.name}: expected a perspective camera, found another kind; Lacuna has no other")
    if render.pixel_aspect_x != render.pixel_aspect_y:
        notes.add(thing.name, "pixels are square; their aspect is ignored")
    if camera.dof.use_dof and (camera.dof.aperture_blades > 2 or camera.dof.aperture_ratio != 1):
        notes.add(thing.name, "the lens is round, without blades and ratio")
    yfov, shift = view(camera, width, height)
    index = glb.append("cameras", {"type": "perspective", "name": thing.name, "perspective": {
        "yfov": yfov, "aspectRatio": width / height, "znear": max(camera.clip_start, 1e-6)}})
    place, turn, _ = thing.matrix_world.decompose()
    matrix = turn.to_matrix().to_4x4()
    matrix.translation = place
    glb.node(root, thing.name, [float(v) for column in matrix.col for v in column], camera=index)

    options = ["--width", str(width), "--height", str(height)]
    if crop:
        options += ["--crop", ",".join(map(str, crop))]
    if any(shift):
        options.append("--shift=%.9g,%.9g" % shift)
    opening = lens(thing)
    if opening:
        options += ["--aperture", "%.9g" % opening[0], "--focus", "%.9g" % opening[1]]
    return options
