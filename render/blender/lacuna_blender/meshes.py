"""Meshes of the .glb, from Blender's objects after modifiers."""

import numpy

from . import brushing
from .body import UNWRAPPED, Body, colors_of, is_smooth, read, uv_layer

GEOMETRY = ("MESH", "CURVE", "SURFACE", "META", "FONT")


class Meshes:
    """Objects that share a mesh and materials also share a mesh in the .glb."""

    def __init__(self, glb, materials, notes, cycles):
        self._glb, self._materials, self._notes, self._cycles, self._made = glb, materials, notes, cycles, {}

    def of(self, thing, hidden):
        """The mesh of an evaluated object, or None if it has no faces."""
        slots = [slot.material for slot in thing.material_slots] or [None]
        source = thing.data if thing.type == "MESH" else thing.original
        key = (source.as_pointer(), tuple(m and m.name_full for m in slots), hidden)
        if key not in self._made:
            try:
                mesh = thing.to_mesh()
            except RuntimeError:  # for example a curve without a body
                mesh = None
            self._made[key] = self._write(thing, mesh, slots, hidden) if mesh else None
            thing.to_mesh_clear()
        return self._made[key]

    def _write(self, thing, mesh, slots, hidden):
        name = thing.name
        mesh.calc_loop_triangles()
        if not mesh.loop_triangles:
            return None
        corners = read(mesh.loop_triangles, "loops", 3, numpy.int32)
        slot_of = numpy.minimum(read(mesh.loop_triangles, "material_index", 1, numpy.int32), len(slots) - 1)
        points = read(mesh.vertices, "co", 3)[read(mesh.loops, "vertex_index", 1, numpy.int32)]
        bodies = {slot: Body(thing, mesh, slot, corners[slot_of == slot], self._cycles) for slot in numpy.unique(slot_of)}
        materials = {slot: self._materials.of(slots[slot], hidden, body) for slot, body in bodies.items()}
        smooth = is_smooth(mesh)
        normals = _corner_normals(mesh) if smooth or any(m.tangent for m in materials.values()) else None
        primitives = []
        for slot, material in materials.items():
            attributes = {"POSITION": points}
            if smooth or material.tangent:  # flat faces need no normals, but TANGENT does
                attributes["NORMAL"] = normals
            if material.tangent:
                attributes["TANGENT"] = self._tangents(name, mesh, material.tangent, points, normals)
            for i, uv_map in enumerate(material.uv_maps):
                uvs = self._uvs(name, mesh, uv_map) if uv_map != UNWRAPPED else None
                if uvs is not None:
                    attributes[f"TEXCOORD_{i}"] = uvs
            if material.vertex_colors is not None:
                colors = self._colors(name, mesh, material.vertex_colors)
                if colors is not None:
                    attributes["COLOR_0"] = colors
            by_corner = {key: values[bodies[slot].corners.ravel()] for key, values in attributes.items()}
            if UNWRAPPED in material.uv_maps:
                by_corner[f"TEXCOORD_{material.uv_maps.index(UNWRAPPED)}"] = bodies[slot].unwrapped()
            primitives.append((*_compact(by_corner), material.index))
        return self._glb.mesh(name, primitives)

    def _uvs(self, name, mesh, uv_map):
        layer = uv_layer(mesh, uv_map)
        if layer is None:
            if uv_map:
                self._notes.add(name, f"there is no UV map {uv_map}: its texture has one colour")
            return None
        uvs = read(layer.data, "uv", 2)
        uvs[:, 1] = 1 - uvs[:, 1]
        return uvs

    def _tangents(self, name, mesh, tangent, points, normals):
        if tangent.uv_map is not None:
            layer = uv_layer(mesh, tangent.uv_map)
            try:
                mesh.calc_tangents(uvmap=layer.name if layer else "")
                return brushing.across_normals(read(mesh.loops, "tangent", 3), normals)
            except (RuntimeError, TypeError):  # no such map, or faces with more than four corners
                self._notes.add(name, f"tangents by the UV map {tangent.uv_map} cannot be made: brushed around Z")
        return brushing.around(tangent.axis, points, normals)

    def _colors(self, name, mesh, wanted):
        attributes = mesh.color_attributes
        colors = attributes.get(wanted) if wanted else (
            attributes[attributes.render_color_index] if len(attributes) else None)
        if colors is None:
            self._notes.add(name, f"there are no vertex colours {wanted}: white is used")
            return None
        values = colors_of(mesh, colors)
        values[:, 3] = 1
        return values


def _corner_normals(mesh):
    """Normals by corner."""
    if hasattr(mesh, "corner_normals"):  # Blender 4.1
        return read(mesh.corner_normals, "vector", 3)
    mesh.calc_normals_split()
    return read(mesh.loops, "normal", 3)


def _compact(attributes):
    """Merges corners with equal attributes; returns the values and the indices."""
    rows = numpy.ascontiguousarray(numpy.concatenate(list(attributes.values()), axis=1), numpy.float32)
    keys = rows.view(numpy.dtype((numpy.void, rows.shape[1] * 4))).ravel()
    _, first, indices = numpy.unique(keys, return_index=True, return_inverse=True)
    return ({name: numpy.ascontiguousarray(a[first], numpy.float32) for name, a in attributes.items()}, indices.astype(numpy.uint32))
