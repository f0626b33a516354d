"""Lamps. Lamps with a size become emissive meshes or many point lights."""

import math

from . import shapes
from .sockets import Sockets, source_of

SPOT_SAMPLES = 32  # points that represent a spot's disk
SMALL_SUN, SUN_SAMPLES = math.radians(2), (16, 64)  # directions that represent a sun, below and above SMALL_SUN
# A ball's outline has corners, where rays to it miss: a little noise with 320 faces, a quarter of that with 1280. Lacuna takes no more than
# 4096 faces for one ball.
FINE_BALLS = 64
SPOT_RAMP = 0.75  # of Blender's ramp in the cosine: glTF's squared ramp then passes as much light


class Lights:
    """Writes lamps below a root node whose coordinates are Blender's."""

    def __init__(self, glb, root, materials, notes, cycles):
        self._glb, self._root, self._materials, self._notes, self._cycles = glb, root, materials, notes, cycles
        self._balls = 0

    def add(self, thing, matrix):
        """Adds an evaluated lamp object. `matrix`: its transform to world space (mathutils.Matrix)."""
        lamp, name = thing.data, thing.name
        if lamp.type == "AREA" and getattr(getattr(lamp, "cycles", None), "is_portal", False):
            return  # it guides Cycles and does not emit
        power = self._power(lamp, name)
        if max(power) <= 0:
            return
        self._say_what_is_lost(thing, lamp)
        {"AREA": self._area, "POINT": self._point, "SPOT": self._spot, "SUN": self._sun}[lamp.type](lamp, name, matrix, power)

    def _power(self, lamp, name):
        """Power by channel in W; for suns, W/m2."""
        color, factor = lamp.color, lamp.energy
        if lamp.use_nodes and lamp.node_tree:
            output = lamp.node_tree.get_output_node("CYCLES")
            found = output and source_of(output.inputs["Surface"])
            if found and found.node and found.node.type == "EMISSION":
                sockets = Sockets(lamp, self._notes, self._cycles)
                node = sockets.color(found.node.inputs["Color"], found.groups)
                factor *= sockets.scalar(found.node.inputs["Strength"], found.groups).factor
                color = [a * b for a, b in zip(color, node.factor)]
                if node.texture:
                    self._notes.add(name, "the lamp's texture is left out")
            else:
                self._notes.add(name, "the lamp's nodes are left out, except for an Emission node")
        return [c * factor for c in color]

    def _say_what_is_lost(self, thing, lamp):
        if lamp.type == "AREA" and lamp.spread < math.pi - 1e-3:
            self._notes.add(thing.name, "the Spread of the area lamp is left out: it shines in all directions in front of it")
        if not getattr(getattr(lamp, "cycles", lamp), "cast_shadow", True):
            self._notes.add(thing.name, "the lamp casts shadows")
        for kind in ("diffuse", "glossy", "transmission"):
            if not getattr(thing, "visible_" + kind, True):
                self._notes.add(thing.name, f"the lamp is seen by {kind} rays, too")

    def _shape(self, lamp, name, corners, triangles, matrix, radiant):
        """Adds an emissive mesh. `radiant`: radiance times area by channel, in W/sr."""
        scale = abs(matrix.to_3x3().determinant()) if lamp.type == "POINT" else matrix.col[0].xyz.cross(matrix.col[1].xyz).length
        area = shapes.area(corners, triangles) * scale
        if area <= 0:
            self._notes.add(name, "a lamp of no size is left out")
            return
        material = self._materials.lamp(name, [p / area for p in radiant])
        mesh = self._glb.mesh(name, [({"POSITION": corners}, triangles, material.index)])
        self._node(name, matrix, mesh=mesh)

    def _node(self, name, matrix, **members):
        return self._glb.node(self._root, name, _columns(matrix), **members)

    def _area(self, lamp, name, matrix, power):
        width = lamp.size
        height = lamp.size_y if lamp.shape in ("RECTANGLE", "ELLIPSE") else lamp.size
        shape = shapes.ellipse if lamp.shape in ("DISK", "ELLIPSE") else shapes.rectangle
        # Cycles: radiance = W / (4 area).
        self._shape(lamp, name, *shape(width, height), matrix, [p / 4 for p in power])

    def _point(self, lamp, name, matrix, power):
        at = _unscaled(matrix)
        if lamp.shadow_soft_size > 0:
            # Cycles: radiance = W / (4 pi^2 r^2) on the ball, that is W / pi over the ball's area
            # of 4 pi r^2.
            halvings = 3 if self._balls < FINE_BALLS else 2
            self._balls += 1
            self._shape(lamp, name, *shapes.sphere(lamp.shadow_soft_size, halvings), at, [p / math.pi for p in power])
        else:
            self._punctual(name, at, {"type": "point"}, [p / (4 * math.pi) for p in power])

    def _spot(self, lamp, name, matrix, power):
        outer = math.cos(lamp.spot_size / 2)
        inner = outer + SPOT_RAMP * (1 - outer) * lamp.spot_blend
        cone = {"outerConeAngle": min(lamp.spot_size / 2, math.pi / 2), "innerConeAngle": min(math.acos(inner), lamp.spot_size / 2 - 1e-5)}
        if lamp.spot_size > math.pi:
            self._notes.add(name, "a spot wider than 180 degrees has 180")
        at, radius = _unscaled(matrix), lamp.shadow_soft_size
        count = SPOT_SAMPLES if radius > 0 else 1
        intensity = [p / (4 * math.pi * count) for p in power]
        for x, y in shapes.disk_samples(count) * (radius if count > 1 else 0):
            moved = at.copy()
            moved.translation = at @ _vector(x, y, 0)
            self._punctual(name, moved, {"type": "spot", "spot": cone}, intensity)

    def _sun(self, lamp, name, matrix, power):
        at = _unscaled(matrix)
        count = 1 if lamp.angle <= 0 else SUN_SAMPLES[lamp.angle > SMALL_SUN]
        radius = math.tan(lamp.angle / 2) if count > 1 else 0
        for x, y in shapes.disk_samples(count) * radius:
            turned = at @ _vector(0, 0, -1).rotation_difference(_vector(x, y, -1)).to_matrix().to_4x4()
            self._punctual(name, turned, {"type": "directional"}, [p / count for p in power])

    def _punctual(self, name, matrix, light, intensity):
        most = max(intensity)
        light = {**light, "color": [max(i, 0.0) / most for i in intensity], "intensity": most}
        self._glb.light(self._root, name, _columns(matrix), light)


def _vector(*values):
    from mathutils import Vector
    return Vector(values)


def _columns(matrix):
    return [float(v) for column in matrix.col for v in column]


def _unscaled(matrix):
    """Position and rotation alone: the sizes of points, spots and suns do not scale with the object."""
    from mathutils import Matrix
    place, turn, _ = matrix.decompose()
    return Matrix.Translation(place) @ turn.to_matrix().to_4x4()
