"""Halls and courts: light enters high up, or comes from little lamps in a large space."""

from __future__ import annotations

from . import materials as m
from . import objects, pictures
from .building import SUNK, arch_panel, barrel_vault, boxes, rib, room, rows, slab
from .glb import SceneFile
from .mesh import box, cylinder, drapery, lathe, merged, moved, quad, sphere, torus
from .vector import about_x, about_y, rotated, towards


def drapery_hall() -> SceneFile:
    s = SceneFile("drapery-hall", "Hall with draperies between columns; the sun enters through openings high up in one wall", 640, 360)
    stone = s.material(m.lambert("stone", (0.62, 0.56, 0.47)))
    flags = s.material(m.lambert("flagstones", (1, 1, 1), s.texture("flagstones", pictures.checker((0.48, 0.44, 0.38), (0.36, 0.32, 0.28)))))
    cloths = [s.material(m.lambert(f"{name} cloth", c)) for name, c in (
        ("red", (0.55, 0.07, 0.06)), ("green", (0.10, 0.32, 0.14)), ("blue", (0.08, 0.16, 0.42)))]
    bronze = s.material(m.metal("bronze", (0.70, 0.50, 0.28), 0.3))

    bays = 5
    openings = [(-10.0 + 2.8 * i, -8.6 + 2.8 * i, 4.3, 5.5) for i in range(bays)]
    sides = room((-4, 0, -11.0), (4, 6, 3.6), 0.4, {"right": openings})
    hall = s.node("hall")
    for side, mesh in sides.items():
        s.add(side, mesh, flags if side == "floor" else stone, parent=hall)
    # Shallow and across the hall: the sun passes above the right row, hits the left row's beam and the wall behind.
    s.light("sun", "directional", 120.0, (1.0, 0.93, 0.80), turned=towards((-1.0, -0.24, -0.12)))

    column = s.mesh("column", (objects.column(3.6, 0.26), stone))
    beam = s.mesh("beam", (box((-0.28, 3.6, -7.4), (0.28, 3.78, 7.0)), stone))
    rod = s.mesh("rod", (moved(cylinder(0.025, 2.4, 8), (0, -1.2, 0)), bronze))
    drapes = [s.mesh(f"{name} drapery", (drapery(2.2, 2.6, folds, 0.13, 72, 16, gather), cloths[k]))
              for k, (name, folds, gather) in enumerate((("red", 4.0, 0.0), ("green", 3.0, 0.45), ("blue", 5.0, 0.25)))]
    for row, x in enumerate((-2.5, 2.5)):
        side = s.node(("left", "right")[row] + " row", at=(x, 0.0, -3.6))
        s.node("beam", beam, parent=side)
        for i, at in enumerate(rows((0.0, 0.0, -7.0), (0.0, 0.0, 2.8), bays + 1)):
            s.node(f"column {i + 1}", column, parent=side, at=at)
            if i == bays:
                continue
            bay = s.node(f"bay {i + 1}", parent=side, at=(0.0, 3.45, at[2] + 1.4), turned=about_y(90 - 180 * row))
            s.node("rod", rod, parent=bay, turned=(0.0, 0.0, 0.70710678, 0.70710678))
            s.node("drapery", drapes[(i + row) % 3], parent=bay, at=(0.0, -2.6, 0.0), scale=(1.0, 1.0, 1.0 if i % 2 else -1.0))
    s.add("bench", box((-0.9, -SUNK, -0.25), (0.9, 0.45, 0.25)), stone, at=(0.3, 0.0, -6.2), turned=about_y(12))
    s.add("bronze bowl", objects.bowl(0.32), bronze, at=(0.3, 0.45 - 2 * SUNK, -6.2))
    s.camera((-0.6, 1.65, 3.2), (0.15, 2.05, -5.0), 50.0)
    return s


def court() -> SceneFile:
    s = SceneFile("court", "Courtyard with an arcade under a blue sky with a low sun; the sky is the only light", 640, 360)
    plaster = s.material(m.lambert("plaster", (0.68, 0.60, 0.48)))
    brick = s.material(m.lambert("brick", (0.52, 0.27, 0.18)))
    paving = s.material(m.lambert("paving", (1, 1, 1), s.texture("paving", pictures.checker((0.50, 0.48, 0.44), (0.40, 0.37, 0.33)))))
    water = s.material(m.coated("water", (0.02, 0.06, 0.06), ior=1.33))
    bronze = s.material(m.metal("bronze", (0.70, 0.50, 0.28), 0.2))
    foliage = s.material(m.cut_out(m.lambert("foliage", (1, 1, 1), s.texture("foliage", pictures.leaves((0.25, 0.42, 0.10), (0.10, 0.26, 0.07))))))
    s.environment("sky.hdr", 0.8)

    # Arcades 2.5 m deep run along three sides; the space above the middle is open.
    yard = s.node("court")
    sides = room((-6.5, 0, -7.5), (6.5, 6.5, 5.0), 0.4, {"ceiling": [(-3.98, 3.98, -5, 5.5)]})
    for side, mesh in sides.items():
        if side != "front":
            s.add(side, mesh, {"floor": paving}.get(side, plaster), parent=yard)
    s.add("front", sides["front"], brick, parent=yard)
    arch = s.mesh("arch", (arch_panel(2.0, 4.0 + SUNK, 0.75, 0.5, 20), brick))
    pillar = s.mesh("pillar", (objects.column(2.5, 0.2, 20), plaster))

    def arcade(name: str, count: int, pillars: range, **placing: object) -> None:
        """Along +X from the origin; every bay 2 m. Bay i stands between pillars i and i + 1; those in the court's corners are the back's."""
        group = s.node(name, **placing)
        for i in range(count):
            s.node(f"arch {i + 1}", arch, parent=group, at=(2.0 * i + 1.0, 2.5, 0.0))
        for i in pillars:
            s.node(f"pillar {i + 1}", pillar, parent=group, at=(2.0 * i, 0.0, 0.0))

    arcade("back arcade", 4, range(5), at=(-4.0, 0.0, -5.0))
    arcade("left arcade", 5, range(5), at=(-4.25, 0.0, 5.2), turned=about_y(90))
    arcade("right arcade", 5, range(1, 6), at=(4.25, 0.0, -4.8), turned=about_y(-90))

    well = s.node("fountain", at=(0.4, 0.0, -1.2))
    s.add("basin", lathe([(0.0, -SUNK), (1.25, -SUNK), (1.25, 0.45), (1.05, 0.45), (1.05, 0.1), (0.0, 0.1)], 40), plaster, parent=well)
    s.add("water", lathe([(1.06, 0.36), (0.0, 0.36)], 40), water, parent=well)
    s.add("stem", objects.column(1.0, 0.12), plaster, parent=well, at=(0.0, 0.1, 0.0))
    s.add("bronze bowl", objects.bowl(0.4), bronze, parent=well, at=(0.0, 1.098, 0.0))
    shrub = sphere(0.55, 10, 20)
    shrub.uvs = [(6 * u, 3 * v) for u, v in shrub.uvs]
    shrub_mesh = s.mesh("shrub", (shrub, foliage))
    tub_mesh = s.mesh("tub", (box((-0.3, -SUNK, -0.3), (0.3, 0.5, 0.3)), brick))
    for i, (x, z) in enumerate(((-2.9, -3.9), (2.9, -3.9), (-2.9, 0.6))):
        tub = s.node(f"tub {i + 1}", tub_mesh, at=(x, 0.0, z), turned=about_y(15 * i))
        s.node("shrub", shrub_mesh, parent=tub, at=(0.0, 0.95, 0.0), scale=(0.9, 1.1, 0.9))
    s.camera((-1.2, 1.7, 4.7), (0.15, 2.0, -3.0), 55.0)
    return s


def nave() -> SceneFile:
    s = SceneFile("nave", "Church nave with columns and a barrel vault; two small lamps in the aisles, a glossy floor", 640, 360)
    stone = s.material(m.lambert("stone", (0.62, 0.58, 0.52)))
    texture = s.texture("floor", pictures.checker((0.50, 0.46, 0.40), (0.12, 0.10, 0.10)))
    # Slabs carry metres as texture coordinates; two squares per repeat make this 0.6 m each.
    texture["extensions"] = {"KHR_texture_transform": {"scale": [0.833333, 0.833333], "offset": [0.25, 0.0]}}
    floor = s.material(m.coated("polished floor", (1, 1, 1), 0.15, texture=texture))
    wood = s.material(m.lambert("wood", (0.30, 0.19, 0.11)))
    gold = s.material(m.metal("gold", (0.95, 0.75, 0.40), 0.2))
    lamp = s.material(m.emitter("flame", (3200.0, 2300.0, 1300.0)))

    bays, bay = 5, 3.6
    far = -bays * bay
    shell = s.node("shell")
    for side, mesh in room((-5.6, 0, far), (5.6, 9.6, 3.6), 0.4).items():
        s.add(side, mesh, floor if side == "floor" else stone, parent=shell)
    depth = 3.6 - far
    # Roofs of the aisles reach into the walls and the arcades; the vault springs from the middle of the arcades.
    for name, x0, x1 in (("left aisle roof", -5.61, -2.8), ("right aisle roof", 2.8, 5.61)):
        s.add(name, box((x0, 6.0, far - 0.01), (x1, 6.3, 3.61)), stone, parent=shell)
    s.add("vault", barrel_vault(2.9, depth + 0.2, 32), stone, parent=shell, at=(0.0, 6.5, 3.7))

    column = s.mesh("column", (objects.column(3.7, 0.33), stone))
    panel = s.mesh("arch", (arch_panel(bay, 2.9, 1.42, 0.5, 24), stone))
    vault_rib = s.mesh("rib", (rib(2.62, 2.95, 0.32, 32), stone))
    pew = s.mesh("pew", (boxes(((-0.9, 0.38, -0.2), (0.9, 0.43, 0.2)), ((-0.905, 0.4, 0.17), (0.905, 0.895, 0.21)),
                               ((-0.93, -SUNK, -0.22), (-0.89, 0.9, 0.22)), ((0.89, -SUNK, -0.22), (0.93, 0.9, 0.22))), wood))

    def half(name: str, **placing: object) -> None:
        """One side of the nave; the other is the same, mirrored."""
        side = s.node(name, **placing)
        for i in range(bays + 1):
            z = 3.6 - bay * i
            s.node(f"arch {i + 1}", panel, parent=side, at=(2.9, 3.7, z - bay / 2), turned=about_y(90))
            if i > 0:
                s.node(f"column {i}", column, parent=side, at=(2.9, 0.0, z))
        for i in range(7):
            s.node(f"pew {i + 1}", pew, parent=side, at=(1.5, 0.0, -4.0 - 1.3 * i))

    half("right half")
    half("left half", scale=(-1, 1, 1))
    for i in range(1, bays + 1):
        s.node(f"rib {i}", vault_rib, at=(0.0, 6.5, 3.6 - bay * i))

    s.add("altar", box((-1.0, -SUNK, far + 1.2), (1.0, 1.05, far + 1.9)), stone)
    s.add("gold cup", objects.goblet(0.4), gold, at=(0.0, 1.05 - SUNK, far + 1.55))
    s.add("gold disc", torus(0.7, 0.07, 48, 12), gold, at=(0.0, 3.6, far + 0.1), turned=about_x(90))
    flame = s.mesh("flame", (sphere(0.06, 8, 16), lamp))
    holder = s.mesh("lamp holder", (objects.bowl(0.14), gold))
    cord = s.mesh("lamp cord", (cylinder(0.006, 3.2, 6), gold))
    for name, at in (("left lamp", (-4.2, 2.9, -5.4)), ("right lamp", (4.3, 2.9, -12.8))):
        hanging = s.node(name, flame, at=at)
        s.node("holder", holder, parent=hanging, at=(0.0, -0.16, 0.0))
        s.node("cord", cord, parent=hanging, at=(0.0, 0.05, 0.0))
    s.camera((0.35, 1.7, 3.1), (-0.1, 2.35, -6.0), 58.0)
    return s


def lamp_warehouse() -> SceneFile:
    """Cells of 6 m in 25 columns and 20 rows, each closed and each with the same twenty lamps; one doorway, in the camera's cell."""
    s = SceneFile("lamp-warehouse", "Warehouse of 500 closed cells with twenty small lamps each; the camera is in one of them", 640, 360)
    plaster = s.material(m.lambert("plaster", (0.70, 0.68, 0.64)))
    concrete = s.material(m.lambert("concrete", (0.45, 0.44, 0.42)))
    wood = s.material(m.lambert("wood", (0.46, 0.30, 0.17)))
    steel = s.material(m.metal("steel", (0.80, 0.80, 0.82), 0.25))
    enamel = s.material(m.coated("enamel", (0.50, 0.08, 0.06), 0.1))
    lamp = s.material(m.emitter("lamp", (1150.0, 980.0, 760.0)))

    cell, height, columns, lines = 6.0, 3.0, 25, 20
    x1, z1 = cell * columns / 2, cell * lines / 2
    for side, mesh in room((-x1, 0, -z1), (x1, height, z1), 0.3).items():
        s.add(side, mesh, concrete if side == "floor" else plaster)
    # Partitions reach into floor, ceiling, outer walls and each other, all to different depths.
    across = s.mesh("partition across", (box((-x1 - 0.1, -0.02, -0.05), (x1 + 0.1, height + 0.02, 0.05)), plaster))
    along = s.mesh("partition along", (box((-0.05, -0.03, -z1 - 0.1), (0.05, height + 0.03, z1 + 0.1)), plaster))
    for i in range(1, lines):
        s.node(f"partition across {i}", across, at=(0.0, 0.0, cell * i - z1))
    door = 12  # the partition with the doorway; the camera's cell is to its right
    for i in range(1, columns):
        if i != door:
            s.node(f"partition along {i}", along, at=(cell * i - x1, 0.0, 0.0))
    middle = cell * door - x1 + cell / 2
    doorway = (z1 + 0.1 + 2.2, z1 + 0.1 + 3.2, 0.0, 2.13)
    s.add("partition with a doorway", slab((cell * door - x1 + 0.05, -0.03, z1 + 0.1), (0.0, 0.0, -1.0), (0.0, 1.0, 0.0),
                                           2 * z1 + 0.2, height + 0.06, 0.1, [doorway]), plaster)

    shades = []
    for i in range(20):
        # Steps of the golden ratio: even, and not in rows.
        u, v = (0.618034 * i) % 1.0, (i + 0.5) / 20
        shade = quad((-0.02, 0.0, -0.02), (0.04, 0.0, 0.0), (0.0, 0.0, 0.04))
        turn, lean = about_y(137.5 * i), about_x(35.0 * ((0.7548777 * i) % 1.0))
        place = lambda p: rotated(turn, rotated(lean, p))  # noqa: E731
        shade.positions, shade.normals = [place(p) for p in shade.positions], [place(n) for n in shade.normals]
        shades.append(moved(shade, (5.0 * u - 2.5, 2.3 + 0.5 * ((0.5698403 * i) % 1.0), 5.0 * v - 2.5)))
    # Five cells at a time: a node takes as many bytes as a lamp.
    lamps = s.mesh("lamps of five cells", (merged(moved(shade, (0.0, 0.0, cell * (k + 0.5))) for k in range(5) for shade in shades), lamp))
    for i in range(columns):
        for j in range(0, lines, 5):
            s.node(f"lamps {i} {j}", lamps, at=(cell * (i + 0.5) - x1, 0.0, cell * j - z1))

    here = s.node("cell", at=(middle, 0.0, -cell / 2))
    crate = s.mesh("crate", (box((-0.4, -SUNK, -0.4), (0.4, 0.8, 0.4)), wood))
    for i, (x, y, z, turn) in enumerate(((-1.9, 0.0, -2.2, 8), (-0.9, 0.0, -2.3, -5), (-1.45, 0.8, -2.25, 21), (1.9, 0.0, -1.9, 33))):
        s.node(f"crate {i + 1}", crate, parent=here, at=(x, y, z), turned=about_y(turn))
    s.add("drum", cylinder(0.33, 0.95, 32), steel, parent=here, at=(0.75, -SUNK, -1.7))
    s.add("jug", objects.jug(0.34), enamel, parent=here, at=(1.9, 0.8 - 2 * SUNK, -1.9))
    s.camera((middle + 1.6, 1.6, -cell / 2 + 2.6), (middle - 0.7, 1.15, -cell / 2 - 1.4), 58.0)
    return s


SCENES = [drapery_hall, court, nave, lamp_warehouse]
