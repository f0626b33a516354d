"""The mapping from layers of lacuna-render's .exr to Blender's passes."""

import numpy

# Passes of the add-on: name, number of channels, their names, kind, property of the view layer,
# channels of the .exr.
OWN = (("Albedo", 3, "RGB", "COLOR", "use_albedo", ("albedo.R", "albedo.G", "albedo.B")),
       ("Variance", 3, "RGB", "COLOR", "use_variance", ("variance.R", "variance.G", "variance.B")))
_FAR = 1e10  # Blender's depth where nothing is hit


def pixels(name, picture):
    """Values of a pass (pixels x channels, rows from the bottom), or None if the picture does not have them."""
    values = _values(name, picture)
    return None if values is None else values[::-1].reshape(picture.width * picture.height, -1)


def _values(name, picture):
    if name == "Combined":
        rgb = picture.stack("R", "G", "B")
        alpha = picture.stack("A")
        return numpy.concatenate([rgb, numpy.ones_like(rgb[..., :1]) if alpha is None else alpha], axis=-1)
    if name == "Depth":
        depth = picture.stack("Z")
        return None if depth is None else numpy.where(depth > 0, depth, _FAR)
    if name in ("Normal", "Position"):
        vector = picture.stack(*(name.lower() + axis for axis in (".X", ".Y", ".Z")))
        return None if vector is None else vector[..., (0, 2, 1)] * numpy.array([1, -1, 1], numpy.float32)
    return next((picture.stack(*layers) for own, _, _, _, _, layers in OWN if own == name), None)
