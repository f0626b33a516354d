"""Which passes of Blender are filled from which layers of lacuna-render's .exr."""

import numpy

# Of our own: name, channels, their names, kind, property of the view layer, layers of the .exr.
OWN = (("Albedo", 3, "RGB", "COLOR", "use_albedo", ("albedo.R", "albedo.G", "albedo.B")),
       ("Variance", 3, "RGB", "COLOR", "use_variance", ("variance.R", "variance.G", "variance.B")))
_FAR = 1e10  # what Blender's depth is where nothing is hit


def pixels(name, picture):
    """Values of a pass (pixels x channels, rows from the bottom), or None where the picture does not have them."""
    values = _values(name, picture)
    return None if values is None else values[::-1].reshape(picture.width * picture.height, -1)


def _values(name, picture):
    if name == "Combined":
        rgb = picture.stack("R", "G", "B")
        return numpy.concatenate([rgb, numpy.ones_like(rgb[..., :1])], axis=-1)
    if name == "Depth":
        depth = picture.stack("Z")
        return None if depth is None else numpy.where(depth > 0, depth, _FAR)
    if name == "Normal":
        normal = picture.stack("normal.X", "normal.Y", "normal.Z")
        return None if normal is None else normal[..., (0, 2, 1)] * numpy.array([1, -1, 1], numpy.float32)
    return next((picture.stack(*layers) for own, _, _, _, _, layers in OWN if own == name), None)
