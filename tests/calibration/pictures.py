"""Pictures as arrays, for calibrations that look at pixels. NumPy is wanted."""

import numpy


def pixels(path):
    """Of a .pfm: (height, width, 3), whichever way up."""
    kind, size, scale, content = path.read_bytes().split(b"\n", 3)
    assert kind == b"PF"
    width, height = map(int, size.split())
    order = "<f4" if float(scale) < 0 else ">f4"
    return numpy.frombuffer(content, order).reshape(height, width, 3).astype(float)
