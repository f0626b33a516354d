"""Pictures as arrays, for calibrations that look at pixels. Needs NumPy."""

import numpy


def pixels(path):
    """The pixels of a .pfm: (height, width, 3), in the file's order of rows."""
    kind, size, scale, content = path.read_bytes().split(b"\n", 3)
    assert kind == b"PF"
    width, height = map(int, size.split())
    order = "<f4" if float(scale) < 0 else ">f4"
    return numpy.frombuffer(content, order).reshape(height, width, 3).astype(float)
