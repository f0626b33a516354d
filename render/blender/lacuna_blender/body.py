"""The part of a mesh with one material, as far as the material depends on it."""

import math

import numpy

UNWRAPPED = "lacuna:unwrapped"  # name of texture coordinates; no UV map of Blender has it
MOST_TRIANGLES = 200000  # limit of unwrapping: about ten seconds


def read(collection, attribute, width, kind=numpy.float32):
    """An attribute of all members of one of Blender's collections, as a flat array with `width` values per member."""
    values = numpy.empty(len(collection) * width, kind)
    collection.foreach_get(attribute, values)
    return values.reshape(-1, width) if width > 1 else values


def uv_layer(mesh, wanted):
    """The UV map of the name `wanted`, or the one for renders if no name is given. None if there is none."""
    layers = mesh.uv_layers
    return layers.get(wanted) if wanted else next((l for l in layers if l.active_render), None)


def colors_of(mesh, colors):
    """The values of a colour attribute by loop: red, green, blue and alpha, linear whatever their type."""
    values = read(colors.data, "color", 4)
    return values[read(mesh.loops, "vertex_index", 1, numpy.int32)] if colors.domain == "POINT" else values


def is_smooth(mesh):
    """Whether some face is not flat. glTF leaves out the normals of meshes with flat faces only."""
    return mesh.has_custom_normals or bool(read(mesh.polygons, "use_smooth", 1, bool).any())


class Body:
    """`slot`: index of the material; `corners`: the loops of its triangles, n x 3. Valid as long as the mesh."""

    def __init__(self, thing, mesh, slot, corners, cycles):
        self.corners, self.arrays = corners, None
        self.key = (thing.original.name_full, f"slot {slot}")  # unique
        self._thing, self._mesh, self._cycles, self._tried = thing, mesh, cycles, False

    @property
    def is_baked(self):
        return self.arrays is not None

    def size(self):
        """The mean side of the square of texture coordinates, in metres."""
        layer = uv_layer(self._mesh, "")
        return self._side(read(layer.data, "uv", 2)[self.corners]) if layer else 1.0

    def texels(self, owner, found, side):
        """The values of a material's output (sockets.Source) on the body: side x side x 3, or None; and the size as
        above, for the unwrapped coordinates."""
        if not self._tried:
            self._tried = True
            self._unwrap()
        if self.arrays is None:
            return None, 1.0
        texels = self._cycles.baked(owner, found, self, side)
        return texels, self._side(self.arrays["uv:unwrapped"].reshape(-1, 3, 2))

    def unwrapped(self):
        """Texture coordinates by corner, 3 n x 2, in glTF's convention."""
        u, v = self.arrays["uv:unwrapped"].T
        return numpy.stack([u, 1 - v], axis=1)

    def _unwrap(self):
        if len(self.corners) > MOST_TRIANGLES:
            return
        self.arrays = self._arrays()
        uvs = self._cycles.unwrapped(self._thing.name, self)
        self.arrays = None if uvs is None else {**self.arrays, "uv:unwrapped": uvs}

    def _arrays(self):
        """The arrays from which cycles_child.add_body makes the body again."""
        mesh, loops = self._mesh, self.corners.ravel()
        used, triangles = numpy.unique(read(mesh.loops, "vertex_index", 1, numpy.int32)[loops], return_inverse=True)
        points = read(mesh.vertices, "co", 3)
        low, high = points.min(axis=0), points.max(axis=0)
        space = getattr(self._thing.original.data, "texspace_location", (low + high) / 2), \
            getattr(self._thing.original.data, "texspace_size", (high - low) / 2)
        layer = uv_layer(mesh, "")
        arrays = {"points": points[used], "triangles": triangles.reshape(-1, 3), "texture_space": numpy.array(space),
                  "smooth": is_smooth(mesh), "matrix": numpy.array(self._thing.matrix_world), "active_uv": layer.name if layer else ""}
        for layer in mesh.uv_layers:
            arrays["uv:" + layer.name] = read(layer.data, "uv", 2)[loops]
        for colors in mesh.color_attributes:
            arrays["color:" + colors.name] = colors_of(mesh, colors)[loops]
        return arrays

    def _side(self, uvs):
        """The mean side of the square of the coordinates `uvs`, n x 3 x 2, in metres."""
        points = read(self._mesh.vertices, "co", 3)[read(self._mesh.loops, "vertex_index", 1, numpy.int32)[self.corners]]
        scale = abs(self._thing.matrix_world.to_3x3().determinant()) ** (1 / 3)
        area, of_map = (_area(p).sum() for p in (points, numpy.pad(uvs, ((0, 0), (0, 0), (0, 1)))))
        return scale * math.sqrt(area / of_map) if of_map > 0 else 1.0


def _area(corners):
    """Twice the areas of triangles, n x 3 x 3."""
    a, b, c = numpy.moveaxis(corners, 1, 0)
    return numpy.linalg.norm(numpy.cross(b - a, c - a), axis=1)
