"""Rooms: light reaches them through doors, gaps, windows and panes, or meets little but glossy surfaces."""

from __future__ import annotations

from . import materials as m
from . import objects, pictures
from .building import SUNK, X, Y, boxes, room, slab, table, table_legs
from .glb import SceneFile
from .mesh import Mesh, box, box_at, cylinder, drapery, lathe, quad, sphere, torus
from .vector import Vec3, about, about_x, about_y, about_z, towards


def _put_room(s: SceneFile, sides: dict[str, Mesh], finish: dict[str, int]) -> None:
    group = s.node("room")
    for side, mesh in sides.items():
        s.add(side, mesh, finish.get(side, finish["walls"]), parent=group)


def _put_table(s: SceneFile, name: str, at: Vec3, size: Vec3, wood: int) -> int:
    """Returns the parent node for things on the board; its y = 0 is the floor."""
    width, height, depth = size
    board, leg = table(width, height, depth)
    top = s.node(name, s.mesh(f"{name} board", (board, wood)), at=at)
    leg_mesh = s.mesh(f"{name} leg", (leg, wood))
    for i, place in enumerate(table_legs(width, depth)):
        s.node(f"{name} leg {i + 1}", leg_mesh, parent=top, at=place)
    return top


def door() -> SceneFile:
    s = SceneFile("door", "Two rooms joined by a door ajar; the only lamp is in the other room", 640, 360)
    wall = s.material(m.lambert("wall", (0.72, 0.70, 0.66)))
    tiles = s.material(m.lambert("tiles", (1, 1, 1), s.texture("tiles", pictures.checker((0.62, 0.58, 0.50), (0.22, 0.16, 0.11)))))
    oak = s.material(m.lambert("oak", (0.42, 0.26, 0.14)))
    paint = s.material(m.lambert("door paint", (0.30, 0.42, 0.38)))
    lacquer = s.material(m.coated("red lacquer", (0.45, 0.05, 0.04), 0.2))
    copper = s.material(m.metal("copper", (0.93, 0.58, 0.42), 0.25))
    steel = s.material(m.metal("steel", (0.75, 0.75, 0.78), 0.4))
    glass = s.material(m.glass("glass"))
    canvas = s.material(m.lambert("canvas", (1, 1, 1), s.texture("canvas", pictures.leaves((0.65, 0.50, 0.12), (0.10, 0.20, 0.35)))))
    lamp = s.material(m.emitter("lamp", (3300.0, 3075.0, 2700.0)))

    _put_room(s, room((-2.6, 0, -5.6), (2.6, 2.7, 2.4), 0.2), {"walls": wall, "floor": tiles})
    # The partition is let into floor, ceiling and walls. Its doorway is cut down to the partition's lower edge and ends
    # inside the frame.
    opening = (2.62 - 1.18, 2.62 - 0.22, -0.1, 2.10)
    s.add("partition", slab((-2.62, -0.02, -2.0), X, Y, 5.24, 2.74, 0.14, [opening]), wall)
    frame = boxes(((-1.21, -SUNK, -2.15), (-1.15, 2.11, -1.985)), ((-0.25, -SUNK, -2.15), (-0.19, 2.11, -1.985)),
                  ((-1.15 - SUNK, 2.05, -2.15 + SUNK), (-0.25 + SUNK, 2.11 - SUNK, -1.985 - SUNK)))
    s.add("door frame", frame, oak)
    # Hinged on the right, opening towards the camera; the slit under the leaf is 8 mm.
    hinge = s.node("hinge", at=(-0.255, 0.008, -1.98), turned=about_y(38))
    s.add("door leaf", box((-0.88, 0.0, -0.02), (0.0, 2.03, 0.02)), paint, parent=hinge)
    knob = s.mesh("knob", (sphere(0.03, 8, 16), steel))
    for side in (-1, 1):
        s.node("knob", knob, parent=hinge, at=(-0.81, 1.0, side * 0.055))

    # The lamp sits beside the door, behind the partition: it reaches the first room by way of the second one's walls
    # and, in a narrow wedge, directly.
    s.add("light", quad((-0.3, 0, -0.3), (0.6, 0, 0), (0, 0, 0.6)), lamp, at=(0.9, 2.69, -3.9))
    s.add("wardrobe", box_at((-2.0, -SUNK, -5.2), (1.1, 1.9, 0.6)), oak)

    desk = _put_table(s, "table", (0.62, 0.0, -0.55), (1.5, 0.74, 0.8), oak)
    s.add("copper jug", objects.jug(0.26), copper, parent=desk, at=(-0.42, 0.74 - SUNK, 0.0))
    s.add("glass vase", objects.vase(0.34), glass, parent=desk, at=(0.02, 0.7405, 0.08))
    s.add("glass ball", sphere(0.1, 20, 40), glass, parent=desk, at=(0.3, 0.841, 0.2))
    s.add("lacquer box", box_at((0, 0, 0), (0.3, 0.14, 0.2)), lacquer, parent=desk, at=(0.45, 0.74 - SUNK, -0.15), turned=about_y(-25))
    s.add("chest", box_at((-2.25, -SUNK, -1.25), (0.7, 0.9, 1.2)), oak)
    s.add("steel bowl", objects.bowl(0.2), steel, at=(-2.2, 0.9 - 2 * SUNK, -1.0))
    picture = s.node("picture", at=(1.2, 1.6, -1.985))
    s.add("picture frame", box((-0.5, -0.35, 0), (0.5, 0.35, 0.03)), lacquer, parent=picture)
    s.add("picture canvas", quad((-0.45, -0.3, 0.032), (0.9, 0, 0), (0, 0.6, 0)), canvas, parent=picture)
    s.camera((0.15, 1.5, 2.2), (-0.05, 0.94, -1.2), 41.0)
    return s


def bedroom_curtain() -> SceneFile:
    s = SceneFile("bedroom-curtain", "Bedroom by day; the curtains are drawn but for a gap of a hand's width", 640, 360)
    wall = s.material(m.lambert("wall", (0.70, 0.68, 0.64)))
    floor = s.material(m.coated("floor boards", (0.35, 0.22, 0.12), 0.3))
    cloth = s.material(m.lambert("curtain cloth", (0.35, 0.12, 0.14)))
    linen = s.material(m.lambert("linen", (0.80, 0.78, 0.74)))
    quilt = s.material(m.lambert("quilt", (1, 1, 1), s.texture("quilt", pictures.checker((0.20, 0.30, 0.50), (0.55, 0.58, 0.62)))))
    wood = s.material(m.lambert("wood", (0.40, 0.27, 0.16)))
    mirror = s.material(m.metal("mirror", (0.92, 0.92, 0.92), 0.0))
    brass = s.material(m.metal("brass", (0.90, 0.72, 0.38), 0.2))
    glass = s.material(m.glass("glass"))
    daylight = s.material(m.emitter("daylight", (1080.0, 1200.0, 1380.0)))

    # Window in the left wall; outside hangs a sheet of daylight that looks at the window.
    z0, z1, y0, y1 = -1.5, -0.1, 0.85, 2.2
    _put_room(s, room((-2.1, 0, -2.4), (2.1, 2.5, 2.2), 0.2, {"left": [(z0, z1, y0, y1)]}), {"walls": wall, "floor": floor})
    s.add("light", quad((-3.3, 0.6, -0.4), (0, 0, -0.8), (0, 2.0, 0)), daylight, at=(0, 0, -0.2), turned=about_y(-5))
    s.add("window cross", boxes(((-2.24, y0 - SUNK, -0.83), (-2.2, y1 + SUNK, -0.77)), ((-2.235, 1.6, z0 - SUNK), (-2.205, 1.65, z1 + SUNK))), wood)

    curtain = drapery(0.92, 2.0, 6.0, 0.045, 96, 10)
    leaf = s.mesh("curtain", (curtain, cloth))
    rod = s.node("curtain rod", s.mesh("curtain rod", (cylinder(0.015, 2.4, 12), brass)), at=(-1.98, 2.36, 0.4), turned=about_x(-90))
    for i, z in enumerate((0.71, 1.71)):  # along the rod, whose own +Y runs towards -Z
        s.node(f"curtain {i + 1}", leaf, parent=rod, at=(0.0, z, -2.0), turned=about((1, 1, 1), 120))
    s.add("pelmet", boxes(((-2.1 - SUNK, 2.39, -2.05), (-1.86, 2.42, 0.45)), ((-1.87, 2.2, -2.06), (-1.85, 2.43, 0.46))), wood)

    bed = s.node("bed", at=(0.55, 0.0, -1.2))
    s.add("bed frame", boxes(((-0.85, -SUNK, -1.15), (0.85, 0.95, -1.08)), ((-0.84, 0.12, -1.1), (0.84, 0.34, 0.95))), wood, parent=bed)
    s.add("mattress", box((-0.8, 0.33, -1.07), (0.8, 0.52, 0.92)), linen, parent=bed)
    s.add("quilt", slab((-0.83, 0.545, 0.95), X, (0, 0, -1), 1.66, 1.35, 0.05), quilt, parent=bed)
    pillow = s.mesh("pillow", (sphere(1.0, 14, 28), linen))
    for x in (-0.4, 0.4):
        s.node("pillow", pillow, parent=bed, at=(x, 0.6, -0.78), turned=about_x(20), scale=(0.34, 0.1, 0.22))
    stand = s.node("night stand", s.mesh("night stand", (box_at((0, -SUNK, 0), (0.45, 0.5, 0.4)), wood)), at=(-0.72, 0.0, -2.12))
    s.add("carafe", objects.vase(0.26), glass, parent=stand, at=(0.05, 0.5, 0.0))
    s.add("brass bowl", objects.bowl(0.08), brass, parent=stand, at=(-0.13, 0.5 - 2 * SUNK, 0.1))
    s.add("wall mirror", box((1.3, 0.9, -2.4 - SUNK), (1.9, 2.0, -2.37)), mirror)
    s.add("wardrobe", box_at((1.75, -SUNK, 0.9), (0.7, 2.1, 1.4)), wood)
    s.camera((-0.35, 1.5, 2.05), (-0.1, 0.95, -1.2), 52.0)
    return s


def classroom_windows() -> SceneFile:
    s = SceneFile("classroom-windows", "Classroom with rows of desks; the sky outside three windows is the only light", 640, 360)
    wall = s.material(m.lambert("wall", (0.72, 0.71, 0.66)))
    floor = s.material(m.lambert("floor", (0.38, 0.28, 0.18)))
    board = s.material(m.coated("blackboard", (0.03, 0.08, 0.06), 0.3))
    wood = s.material(m.coated("varnished wood", (0.50, 0.32, 0.16), 0.15))
    tube = s.material(m.metal("tube", (0.6, 0.6, 0.62), 0.3))
    frame = s.material(m.lambert("window frame", (0.65, 0.65, 0.65)))
    paper = s.material(m.lambert("paper", (0.8, 0.8, 0.75)))
    pane = s.material(m.thin_glass("window pane"))

    windows = [(z, z + 1.5, 0.95, 2.6) for z in (-2.6, -0.5, 1.6)]
    _put_room(s, room((-3.6, 0, -3.6), (3.6, 3.1, 3.6), 0.25, {"left": windows}), {"walls": wall, "floor": floor})
    bars = boxes(((-0.03, -0.85, -0.03), (0.03, 0.85, 0.03)), ((-0.025, 0.2, -0.77), (0.025, 0.25, 0.77)))
    bars_mesh = s.mesh("window bars", (bars, frame))
    pane_mesh = s.mesh("window pane", (quad((0, -0.825, 0.75), (0, 0, -1.5), (0, 1.65, 0)), pane))
    for i, (z, *_rest) in enumerate(windows):
        window = s.node(f"window {i + 1}", bars_mesh, at=(-3.72, 1.775, z + 0.75))
        if i == 0:  # the others are open
            s.node("window pane", pane_mesh, parent=window)
    s.environment("sky.hdr", 4.5)

    top = boxes(((-0.34, 0.69, -0.24), (0.34, 0.72, 0.24)), ((-0.32, 0.52, -0.22), (0.32, 0.54, 0.22)))
    legs = boxes(*(((x - 0.015, -SUNK, z - 0.015), (x + 0.015, 0.70, z + 0.015)) for x in (-0.31, 0.31) for z in (-0.2, 0.2)))
    desk_mesh = s.mesh("desk", (top, wood), (legs, tube))
    chair_mesh = s.mesh("chair", (objects.chair(), wood))
    desks = s.node("desks", at=(0.0, 0.0, -0.9))
    for i in range(16):
        column, row = i % 4, i // 4
        # A fixed scatter: no classroom is tidy.
        turn, slip = (i * 37 % 11) - 5, ((i * 53 % 17) - 8) * 0.01
        desk = s.node(f"desk {i + 1}", desk_mesh, parent=desks, at=(-2.1 + 1.4 * column + slip, 0.0, 1.1 * row - 0.3), turned=about_y(turn / 2))
        s.node(f"chair {i + 1}", chair_mesh, parent=desk, at=(slip, 0.0, 0.42 + slip), turned=about_y(2 * turn))
    s.add("blackboard", box((-1.8, 0.95, -3.6 - SUNK), (1.8, 2.25, -3.57)), board)
    s.add("ledge", box((-1.8, 0.9, -3.6 - SUNK), (1.8, 0.94, -3.48)), frame)
    teacher = _put_table(s, "teacher's desk", (1.6, 0.0, -2.5), (1.4, 0.76, 0.65), wood)
    s.add("papers", box((-0.15, 0.76 - SUNK, -0.1), (0.07, 0.78, 0.2)), paper, parent=teacher, turned=about_y(8))
    s.camera((2.9, 1.75, 3.4), (-0.6, 0.95, -1.6), 50.0)
    return s


def kitchen_glass() -> SceneFile:
    s = SceneFile("kitchen-glass", "Kitchen corner seen through a solid pane; its lamps shine on metal, lacquer and glass", 640, 360)
    wall = s.material(m.lambert("wall", (0.70, 0.70, 0.68)))
    tiles = s.material(m.coated("wall tiles", (1, 1, 1), 0.1, texture=s.texture("wall tiles", pictures.checker((0.70, 0.72, 0.70), (0.15, 0.35, 0.42)))))
    floor = s.material(m.coated("stone floor", (0.30, 0.28, 0.26), 0.2))
    front = s.material(m.coated("lacquered front", (0.68, 0.66, 0.60), 0.12))
    worktop = s.material(m.coated("worktop", (0.10, 0.10, 0.11)))
    steel = s.material(m.metal("brushed steel", (0.72, 0.72, 0.74), 0.3))
    chrome = s.material(m.metal("chrome", (0.85, 0.85, 0.87), 0.05))
    mirror = s.material(m.metal("polished steel", (0.9, 0.9, 0.9), 0.0))
    copper = s.material(m.metal("copper", (0.94, 0.60, 0.44), 0.18))
    glass = s.material(m.glass("glass"))
    frosted = s.material(m.glass("frosted glass", roughness=0.25))
    sieve = s.material(m.cut_out(m.lambert("perforated sheet", (1, 1, 1), s.texture("perforation", pictures.perforated((0.5, 0.5, 0.52))))))
    lamp = s.material(m.emitter("strip light", (75.0, 70.0, 60.0)))
    bulb = s.material(m.emitter("bulb", (900.0, 750.0, 520.0)))

    sides = room((-1.9, 0, -1.6), (1.9, 2.5, 2.6), 0.2)
    _put_room(s, sides, {"walls": wall, "floor": floor})
    # The pane is let one centimetre into the partition around it.
    opening = (1.92 - 1.5, 1.92 + 1.5, 0.57, 2.27)
    s.add("partition", slab((-1.92, -0.02, 1.3), X, Y, 3.84, 2.54, 0.12, [opening]), wall)
    s.add("pane", box((-1.51, 0.54, 1.23), (1.51, 2.26, 1.242)), glass)
    s.add("tiled wall", slab((-1.9 - SUNK, 0.88, -1.59), X, Y, 3.8 + 2 * SUNK, 0.72, 0.025), tiles)

    # Parts that overlap inside the walls and the corner are let in to different depths.
    counter = s.node("counter")
    s.add("cupboards", boxes(((-1.9 - SUNK, 0.1, -1.6 - SUNK), (1.235, 0.86, -1.0)), ((-1.9 - 2 * SUNK, 0.1 + SUNK, -1.02), (-1.3, 0.86 - SUNK, 0.6))), front, parent=counter)
    s.add("plinth", boxes(((-1.9 - 3 * SUNK, -SUNK, -1.6 - 2 * SUNK), (1.225, 0.12, -1.06)), ((-1.9 - 4 * SUNK, -2 * SUNK, -1.1), (-1.36, 0.12 - SUNK, 0.56))), steel, parent=counter)
    s.add("worktop", slab((-1.9 - 5 * SUNK, 0.9, 0.63), X, (0, 0, -1), 3.15, 2.24, 0.045, [(0.64, 4.0, -1.0, 1.6)]), worktop, parent=counter)
    handle = s.mesh("handle", (cylinder(0.008, 0.3, 10), chrome))
    for x in (-0.95, -0.35, 0.25, 0.85):
        s.node("handle", handle, parent=counter, at=(x - 0.15, 0.78, -0.97), turned=about_z(-90))
    s.add("fridge", box((1.25, -SUNK, -1.6 - SUNK), (1.9 + 2 * SUNK, 1.95, -0.95)), mirror)
    s.add("wall cupboard", box((-1.1, 1.6 - SUNK, -1.6 - SUNK), (1.0, 2.25, -1.25)), front)
    s.add("under-cupboard light", quad((-0.9, 1.594, -1.5), (1.7, 0, 0), (0, 0, 0.06)), lamp)

    s.add("pot", objects.pot(0.13, 0.15), steel, at=(0.62, 0.899, -1.22), turned=about_y(20))
    s.add("copper jug", objects.jug(0.24), copper, at=(0.12, 0.899, -1.25))
    s.add("kettle", objects.jug(0.2), mirror, at=(-0.95, 0.899, -1.2))
    goblet = s.mesh("goblet", (objects.goblet(0.2), glass))
    for x, z in ((-0.42, -1.12), (-0.22, -1.3), (-0.58, -1.32)):
        s.node("goblet", goblet, at=(x, 0.9005, z))
    s.add("frosted jar", cylinder(0.07, 0.2, 32), frosted, at=(-1.55, 0.9005, -0.55))
    s.add("knife rail", box((-1.9 - SUNK, 1.25, -0.7), (-1.876, 1.275, -0.1)), steel)
    screen = quad((0, 0, 0), (0.6, 0, 0), (0, 0.4, 0))
    screen.uvs = [(0, 0), (18, 0), (18, 12), (0, 12)]
    s.add("perforated screen", screen, sieve, at=(-1.62, 0.895, 0.25), turned=about_y(70))

    # Bulb under a metal shade: the light leaves downwards and upwards through a hole.
    pendant = s.node("pendant", at=(0.35, 1.72, 0.0))
    shade = lathe([(0.17, 0.0), (0.15, 0.09), (0.05, 0.17), (0.04, 0.17), (0.14, 0.085), (0.165, 0.0)], 32, closed=True)
    s.add("shade", shade, copper, parent=pendant)
    s.add("bulb", sphere(0.035, 10, 20), bulb, parent=pendant, at=(0.0, 0.06, 0.0))
    s.add("cord", cylinder(0.004, 0.7, 6), steel, parent=pendant, at=(0.0, 0.1, 0.0))
    s.camera((0.6, 1.55, 2.45), (-0.2, 1.12, -1.0), 38.0)
    return s


def night_window() -> SceneFile:
    s = SceneFile("night-window", "Living room by night; a street lamp shines in through a double window of solid glass", 640, 360)
    wall = s.material(m.lambert("wall", (0.68, 0.66, 0.60)))
    floor = s.material(m.coated("parquet", (0.34, 0.21, 0.11), 0.25))
    wood = s.material(m.lambert("wood", (0.36, 0.24, 0.14)))
    cloth = s.material(m.lambert("sofa cloth", (0.18, 0.32, 0.34)))
    cushion = s.material(m.lambert("cushion", (0.70, 0.38, 0.12)))
    carpet = s.material(m.lambert("carpet", (0.42, 0.16, 0.13)))
    canvas = s.material(m.lambert("canvas", (0.20, 0.30, 0.42)))
    brass = s.material(m.metal("brass", (0.90, 0.72, 0.38), 0.2))
    frame = s.material(m.lambert("window frame", (0.72, 0.72, 0.70)))
    glass = s.material(m.glass("glass"))
    lamp = s.material(m.emitter("street lamp", (26000.0, 19500.0, 11000.0)))

    # Two panes, each let two millimetres into the wall around it, and the street lamp beyond them.
    z0, z1, y0, y1 = -1.5, 0.5, 0.8, 2.2
    _put_room(s, room((-2.4, 0, -2.6), (2.4, 2.6, 2.4), 0.2, {"left": [(z0, z1, y0, y1)]}), {"walls": wall, "floor": floor})
    pane = s.mesh("pane", (box((-0.002, y0 - SUNK, z0 - SUNK), (0.002, y1 + SUNK, z1 + SUNK)), glass))
    for name, x in (("outer pane", -2.53), ("inner pane", -2.49)):
        s.node(name, pane, at=(x, 0.0, 0.0))
    s.add("window bars", boxes(((-2.46, y0 - SUNK, -0.53), (-2.42, y1 + SUNK, -0.47)), ((-2.455, 1.65, z0 - SUNK), (-2.425, 1.69, z1 + SUNK))), frame)
    s.add("light", quad((0, -0.1, -0.1), (0, 0.2, 0), (0, 0, 0.2)), lamp, at=(-6.4, 4.2, -0.9), turned=about_z(-25))

    sofa = s.node("sofa", at=(1.35, 0.0, -0.5), turned=about_y(-90))
    s.add("sofa frame", boxes(((-1.0, 0.08, -0.42), (1.0, 0.42, 0.45)), ((-1.0 + SUNK, 0.4, -0.42 - SUNK), (1.0 - SUNK, 0.85, -0.2)),
                              ((-1.2, 0.08 + SUNK, -0.4), (-0.99, 0.6, 0.44)), ((0.99, 0.08 + SUNK, -0.4), (1.2, 0.6, 0.44))), cloth, parent=sofa)
    pillow = s.mesh("cushion", (sphere(1.0, 10, 20), cushion))
    for x in (-0.72, 0.7):
        s.node("cushion", pillow, parent=sofa, at=(x, 0.66, -0.1), turned=about_x(-20), scale=(0.26, 0.24, 0.08))
    s.add("carpet", box((-1.3, -SUNK, -1.7), (0.75, 0.008, 0.7)), carpet)
    desk = _put_table(s, "low table", (-0.35, 0.006, -0.5), (1.0, 0.42, 0.6), wood)
    s.add("glass ball", sphere(0.09, 12, 24), glass, parent=desk, at=(-0.2, 0.511, 0.05))
    s.add("brass cup", cylinder(0.05, 0.12, 24), brass, parent=desk, at=(0.22, 0.42 - SUNK, -0.05))
    s.add("shelf", box_at((-0.9, -SUNK, -2.4), (1.6, 1.1, 0.45)), wood)
    s.add("books", boxes(((-1.6, 1.1 - 2 * SUNK, -2.5), (-1.35, 1.36, -2.3)), ((-1.35 + SUNK, 1.1 - 3 * SUNK, -2.48), (-1.29, 1.32, -2.31)),
                         ((-0.7, 1.1 - 2 * SUNK, -2.5), (-0.38, 1.17, -2.28))), cloth)
    picture = s.node("picture", at=(0.95, 1.6, -2.585))
    s.add("picture frame", box((-0.45, -0.35, -SUNK), (0.45, 0.35, 0.03)), wood, parent=picture)
    s.add("picture canvas", quad((-0.4, -0.3, 0.032), (0.8, 0, 0), (0, 0.6, 0)), canvas, parent=picture)
    s.camera((0.9, 1.45, 2.25), (-0.35, 0.95, -1.2), 50.0)
    return s


def frosted_bath() -> SceneFile:
    s = SceneFile("frosted-bath", "Bathroom behind a window of frosted glass, with a bulb in a frosted globe", 640, 360)
    plaster = s.material(m.lambert("plaster", (0.72, 0.71, 0.68)))
    tiles = s.material(m.coated("wall tiles", (0.24, 0.46, 0.50), 0.3))
    slate = s.material(m.coated("slate floor", (0.20, 0.20, 0.21), 0.3))
    enamel = s.material(m.coated("enamel", (0.78, 0.78, 0.76), 0.15))
    oak = s.material(m.lambert("oak", (0.42, 0.27, 0.15)))
    towel = s.material(m.lambert("towel", (0.62, 0.24, 0.16)))
    steel = s.material(m.metal("steel", (0.75, 0.75, 0.77), 0.3))
    mirror = s.material(m.metal("mirror", (0.92, 0.92, 0.92), 0.0))
    glass = s.material(m.glass("glass"))
    etched = s.material(m.glass("etched pane", roughness=0.2))
    satin = s.material(m.glass("satin globe", roughness=0.1))
    bulb = s.material(m.emitter("bulb", (2600.0, 2200.0, 1600.0)))

    z0, z1, y0, y1 = -1.1, -0.1, 1.0, 2.0
    _put_room(s, room((-1.5, 0, -1.7), (1.5, 2.4, 1.9), 0.2, {"left": [(z0, z1, y0, y1)]}), {"walls": plaster, "floor": slate})
    s.add("etched pane", box((-1.553, y0 - SUNK, z0 - SUNK), (-1.547, y1 + SUNK, z1 + SUNK)), etched)
    s.add("window bar", box((-1.53, y0 - SUNK, -0.62), (-1.505, y1 + SUNK, -0.58)), oak)
    s.light("sun", "directional", 20.0, (1.0, 0.93, 0.82), turned=towards((0.8, -0.62, 0.22)))
    s.add("tiled wall", slab((-1.5 - SUNK, -SUNK, -1.69), X, Y, 3.0 + 2 * SUNK, 1.35, 0.03), tiles)

    s.add("cabinet", boxes(((0.1, 0.15, -1.69), (1.2, 0.75, -1.2)), ((0.06, 0.75 - SUNK, -1.695), (1.24, 0.79, -1.16))), oak)
    s.add("basin", slab((0.4, 0.788, -1.22), X, (0, 0, -1), 0.44, 0.36, 0.1, [(0.03, 0.41, 0.03, 0.33)]), enamel)
    s.add("tap", boxes(((0.60, 0.789, -1.64), (0.63, 1.02, -1.61)), ((0.602, 0.985, -1.615), (0.628, 1.018, -1.48))), steel)
    s.add("tumbler", cylinder(0.035, 0.11, 12), glass, at=(0.97, 0.7905, -1.36))
    s.add("mirror", box((0.2, 1.42, -1.7 - SUNK), (1.05, 2.1, -1.68)), mirror)
    lamp = s.node("wall lamp", at=(-0.25, 1.72, -1.5))
    s.add("globe", objects.globe(0.12, 0.006), satin, parent=lamp)
    s.add("bulb", sphere(0.022, 6, 12), bulb, parent=lamp)
    s.add("bracket", box((-0.03, -0.19, -0.2 - SUNK), (0.03, -0.13, 0.03)), steel, parent=lamp)
    s.add("bath", boxes(((-1.5 - SUNK, -SUNK, -1.66), (-0.62, 0.55, -0.1)), ((-1.5 - 2 * SUNK, 0.55 - SUNK, -1.665), (-0.58, 0.60, -0.06))), enamel)
    s.add("towel rail", box((-1.43, 1.42, 0.2), (-1.41, 1.44 + SUNK, 0.85)), steel)
    s.add("towel", box((-1.44, 0.8, 0.3), (-1.4, 1.44, 0.75)), towel)
    _put_table(s, "stool", (0.52, 0.0, -0.32), (0.45, 0.43, 0.45), oak)
    s.camera((0.95, 1.55, 1.75), (-0.3, 1.05, -1.2), 55.0)
    return s


def glossy_room() -> SceneFile:
    s = SceneFile("glossy-room", "Everything is glossy (roughness 0.1 to 0.3); the lamp shines up into a cove", 640, 360)
    wall = s.material(m.coated("satin wall", (0.55, 0.52, 0.48), 0.25))
    blue = s.material(m.coated("blue wall", (0.12, 0.22, 0.45), 0.15))
    panel = s.material(m.metal("metal panel", (0.80, 0.76, 0.70), 0.3))
    floor = s.material(m.coated("polished checker", (1, 1, 1), 0.12, texture=s.texture("checker", pictures.checker((0.60, 0.58, 0.55), (0.06, 0.06, 0.07)))))
    metals = [s.material(m.metal(f"metal {r}", c, r)) for r, c in ((0.1, (0.95, 0.80, 0.45)), (0.2, (0.90, 0.55, 0.42)), (0.3, (0.80, 0.82, 0.85)))]
    mirror = s.material(m.metal("mirror", (0.92, 0.92, 0.92), 0.0))
    lacquer = s.material(m.coated("smooth coat", (0.50, 0.06, 0.05)))
    frosted = s.material(m.glass("frosted glass", roughness=0.2))
    glass = s.material(m.glass("glass"))
    foliage = s.material(m.cut_out(m.lambert("leaves", (1, 1, 1), s.texture("leaves", pictures.leaves((0.25, 0.45, 0.08), (0.08, 0.25, 0.06))))))
    lamp = s.material(m.emitter("lamp", (140.0, 126.0, 104.0)))

    _put_room(s, room((-2.2, 0, -2.4), (2.2, 2.6, 2.4), 0.2), {"walls": wall, "floor": floor, "left": blue, "back": panel})
    # A trough along the right wall hides the lamp from everything below it.
    s.add("trough", boxes(((1.76, 1.88, -2.19), (2.2 + SUNK, 1.9, 1.99)), ((1.75, 1.87, -2.2), (1.77, 2.08, 2.0))), wall)
    s.add("light", quad((1.9, 1.92, 1.4), (0.18, 0, 0), (0, 0, -2.9)), lamp)

    ball = sphere(0.32, 20, 40)
    for i, material in enumerate([*metals, lacquer, mirror]):
        s.add(f"ball {i + 1}", ball, material, at=(-1.5 + 0.75 * i, 0.321, -1.3 + 0.12 * (i % 2)))
    s.add("plinth", box_at((0, 0, 0), (0.7, 0.45, 0.7)), lacquer, at=(-0.95, -SUNK, -0.1), turned=about_y(30))
    s.add("frosted ball", sphere(0.25, 20, 40), frosted, at=(-0.95, 0.6985, -0.1))
    s.add("ring", torus(0.3, 0.07, 40, 16), metals[0], at=(0.15, 0.0705, 0.1))
    s.add("goblet", objects.goblet(0.5), glass, at=(0.95, 0.0005, 0.0))
    s.add("tilted block", box((-0.25, -0.25, -0.25), (0.25, 0.25, 0.25)), metals[1], at=(1.35, 0.42, -0.55), turned=about((1, 0.3, 1), 45))
    leaf = quad((-0.35, 0, 0), (0.7, 0, 0), (0, 1.4, 0))
    leaf.uvs = [(0, 4), (2, 4), (2, 0), (0, 0)]
    plant = s.mesh("plant", (leaf, foliage))
    pot = s.node("flower pot", s.mesh("flower pot", (objects.bowl(0.22), metals[2])), at=(-1.75, 0.0005, -0.75))
    for angle in (10, 70, 130):
        s.node("plant", plant, parent=pot, at=(0.0, 0.1, 0.0), turned=about_y(angle))
    s.camera((0.15, 1.35, 2.3), (-0.1, 0.75, -0.9), 50.0)
    return s


SCENES = [door, bedroom_curtain, classroom_windows, kitchen_glass, night_window, frosted_bath, glossy_room]
