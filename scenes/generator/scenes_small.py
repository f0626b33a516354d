"""Boxes with known answers, caustics, and one scene per kind of light."""

from __future__ import annotations

from . import materials as m
from .building import SUNK
from .glb import SceneFile
from .mesh import band_ring, box, box_at, flat_shaded, merged, quad, sphere, torus
from .vector import about, about_x, about_y, about_z, towards


def cornell_box() -> SceneFile:
    s = SceneFile("cornell-box", "Box of 2.4 m with one open side, two blocks, a quad light under the ceiling", 512, 512)
    white = s.material(m.lambert("white"))
    red = s.material(m.lambert("red", (0.60, 0.06, 0.05)))
    green = s.material(m.lambert("green", (0.12, 0.45, 0.10)))
    lamp = s.material(m.emitter("lamp", (20.0, 17.0, 12.0)))
    w, h, d = 1.2, 2.4, 1.2
    s.add("shell", merged([quad((-w, 0, d), (2 * w, 0, 0), (0, 0, -2 * d)),
                           quad((-w, h, -d), (2 * w, 0, 0), (0, 0, 2 * d)),
                           quad((-w, 0, -d), (2 * w, 0, 0), (0, h, 0))]), white)
    s.add("left wall", quad((-w, 0, d), (0, 0, -2 * d), (0, h, 0)), red)
    s.add("right wall", quad((w, 0, -d), (0, 0, 2 * d), (0, h, 0)), green)
    block = s.mesh("block", (box((-0.5, 0, -0.5), (0.5, 1, 0.5)), white))
    s.node("tall block", block, at=(-0.42, -SUNK, -0.38), turned=about_y(19), scale=(0.72, 1.45, 0.72))
    s.node("short block", block, at=(0.45, -SUNK, 0.40), turned=about_y(-17), scale=(0.70, 0.70, 0.70))
    s.add("light", quad((-0.3, h - 0.005, -0.3), (0.6, 0, 0), (0, 0, 0.6)), lamp)
    s.camera((0.0, 1.2, 5.6), (0.0, 1.2, 0.0), 31.0)
    return s


def furnace() -> SceneFile:
    """Albedo a and emission 1 - a everywhere: L = (1 - a) + a L has the only solution L = 1, and paths of up to n edges
    give 1 - a^n. Shading normals are geometric, because smooth ones would lose light at the rims."""
    s = SceneFile("furnace", "Closed room, albedo 0.5 and emission 0.5 on every surface: radiance is exactly 1", 256, 256, 32)
    wall = s.material(m.emitter("half and half", (0.5, 0.5, 0.5), albedo=(0.5, 0.5, 0.5)))
    s.add("room", box((-2, 0, -2), (2, 3, 2), inward=True), wall)
    ball = s.mesh("ball", (flat_shaded(sphere(1.0, 10, 20)), wall))
    block = s.mesh("block", (box((-0.5, -0.5, -0.5), (0.5, 0.5, 0.5)), wall))
    s.node("ball 1", ball, at=(-0.8, 0.6, -0.4), scale=0.5)
    s.node("ball 2", ball, at=(1.1, 1.9, -0.9), turned=about((1, 2, 0), 50), scale=(0.5, 0.25, 0.35))
    s.node("standing block", block, at=(0.9, 0.59, -0.8), turned=about_y(25), scale=(0.6, 1.2, 0.6))
    s.node("floating block", block, at=(-0.7, 1.9, -0.9), turned=about((1, 1, 1), 40), scale=(-0.7, 0.4, 0.4))
    s.camera((0.0, 1.5, 1.9), (0.0, 1.2, -1.0), 70.0)
    return s


def ring_caustic() -> SceneFile:
    s = SceneFile("ring-caustic", "Gold ring and glass ball on a diffuse floor under a small lamp: caustics", 640, 360)
    floor = s.material(m.lambert("floor", (0.65, 0.62, 0.58)))
    gold = s.material(m.metal("gold", (1.0, 0.78, 0.34), 0.05))
    glass = s.material(m.glass("glass"))
    lamp = s.material(m.emitter("lamp", (2700.0, 2460.0, 2100.0)))
    s.add("floor", quad((-3, 0, 3), (6, 0, 0), (0, 0, -6)), floor)
    s.add("back wall", quad((-3, 0, -1.6), (6, 0, 0), (0, 3, 0)), floor)
    s.add("ring", band_ring(0.34, 0.38, 0.20, 0.012, 128), gold, at=(-0.32, 0.0005, 0.05))
    s.add("ball", sphere(0.22, 32, 64), glass, at=(0.52, 0.2205, 0.12))
    s.add("light", quad((-0.03, 0.0, -0.03), (0.06, 0, 0), (0, 0, 0.06)), lamp, at=(1.5, 1.5, -0.9), turned=about_z(-42))
    s.camera((0.12, 1.15, 1.75), (0.05, 0.08, 0.0), 38.0)
    return s


def mirror_caustic() -> SceneFile:
    """Cornell box in the manner of SmallVCM's with both small balls and the point light: the caustic of the glass ball is
    seen on the floor and again in the mirror ball, where no light path can be joined to the camera."""
    s = SceneFile("mirror-caustic", "Box with a glossy floor, a mirror ball, a glass ball and a point light", 512, 512)
    white = s.material(m.lambert("white"))
    red = s.material(m.lambert("red", (0.60, 0.06, 0.05)))
    blue = s.material(m.lambert("blue", (0.08, 0.12, 0.55)))
    floor = s.material(m.coated("floor", (0.45, 0.43, 0.40), 0.25))
    mirror = s.material(m.metal("mirror", (0.95, 0.95, 0.95), 0.0))
    glass = s.material(m.glass("glass"))
    w, h, d = 1.28, 2.56, 1.28
    s.add("floor", quad((-w, 0, d), (2 * w, 0, 0), (0, 0, -2 * d)), floor)
    s.add("shell", merged([quad((-w, h, -d), (2 * w, 0, 0), (0, 0, 2 * d)),
                           quad((-w, 0, -d), (2 * w, 0, 0), (0, h, 0))]), white)
    s.add("left wall", quad((-w, 0, d), (0, 0, -2 * d), (0, h, 0)), red)
    s.add("right wall", quad((w, 0, -d), (0, 0, 2 * d), (0, h, 0)), blue)
    ball = sphere(0.5, 20, 40)
    s.add("mirror ball", ball, mirror, at=(-0.58, 0.5005, -0.42))
    s.add("glass ball", ball, glass, at=(0.52, 0.5005, 0.36))
    s.light("light", "point", 24.0, (1.0, 0.96, 0.88), at=(1.0, 1.8, 0.9))
    s.camera((0.0, 1.28, 5.8), (0.0, 1.22, 0.0), 31.0)
    return s


def torus_in_glass() -> SceneFile:
    """The torus floats inside the block, so that no edge of L S D S E ends at a point that light or lens can be joined
    to. A sun cannot be hit either: only specular chains and merging show the torus lit directly."""
    s = SceneFile("torus-in-glass", "Diffuse torus inside a block of smooth glass under a small sun", 480, 360)
    floor = s.material(m.lambert("floor", (0.62, 0.60, 0.56)))
    red = s.material(m.lambert("red", (0.75, 0.28, 0.16)))
    glass = s.material(m.glass("glass"))
    s.add("floor", quad((-3, 0, 3), (6, 0, 0), (0, 0, -6)), floor)
    s.add("back wall", quad((-3, -SUNK, -1.5), (6, 0, 0), (0, 3, 0)), floor)
    s.add("block", box((-0.45, -0.3, -0.45), (0.45, 0.3, 0.45)), glass, at=(0.0, 0.3005, 0.0), turned=about_y(24))
    s.add("torus", torus(0.2, 0.075, 24, 12), red, at=(0.0, 0.31, 0.0), turned=about_x(62))
    s.light("sun", "directional", 3.0, (1.0, 0.95, 0.85), turned=towards((-0.55, -1.0, -0.45)))
    s.camera((0.5, 1.25, 2.3), (0.0, 0.26, 0.0), 32.0)
    return s


def _light_stage(name: str, description: str) -> SceneFile:
    """The set that all light-* scenes share: what differs between them is the light alone."""
    s = SceneFile(name, description, 320, 240)
    grey = s.material(m.lambert("grey", (0.6, 0.6, 0.6)))
    warm = s.material(m.lambert("warm", (0.65, 0.35, 0.20)))
    cool = s.material(m.lambert("cool", (0.25, 0.35, 0.60)))
    steel = s.material(m.metal("steel", (0.9, 0.9, 0.9), 0.3))
    s.add("floor", quad((-2, 0, 2), (4, 0, 0), (0, 0, -4)), grey)
    s.add("back wall", quad((-2, 0, -2), (4, 0, 0), (0, 3, 0)), grey)
    s.add("left wall", quad((-2, 0, 2), (0, 0, -4), (0, 3, 0)), warm)
    s.add("ball", sphere(0.55, 20, 40), steel, at=(0.7, 0.551, -0.1))
    s.add("block", box_at((0, 0, 0), (0.8, 1.3, 0.8)), cool, at=(-0.7, -SUNK, -0.7), turned=about_y(28))
    s.camera((1.0, 1.9, 4.6), (-0.15, 0.85, -0.3), 40.0)
    return s


def light_quad() -> SceneFile:
    s = _light_stage("light-quad", "One-sided quad facing down")
    lamp = s.material(m.emitter("lamp", (28.0, 26.0, 22.0)))
    s.add("light", quad((-0.4, 0, -0.4), (0.8, 0, 0), (0, 0, 0.8)), lamp, at=(0.3, 2.6, 0.3))
    return s


def light_sphere() -> SceneFile:
    s = _light_stage("light-sphere", "Tessellated emissive sphere")
    lamp = s.material(m.emitter("lamp", (40.0, 36.0, 30.0)))
    s.add("light", sphere(0.15, 12, 24), lamp, at=(0.2, 1.9, 0.5))
    return s


def light_two_sided() -> SceneFile:
    s = _light_stage("light-two-sided", "Upright sheet that emits from both sides (doubleSided)")
    lamp = s.material(m.emitter("lamp", (6.0, 7.0, 9.0), double_sided=True))
    s.add("light", quad((-0.35, -0.35, 0), (0.7, 0, 0), (0, 0.7, 0)), lamp, at=(0.15, 1.9, -0.5), turned=about((0.5, 1, 0), 55))
    return s


def light_point() -> SceneFile:
    s = _light_stage("light-point", "KHR_lights_punctual point light")
    s.light("light", "point", 9.0, (1.0, 0.9, 0.75), at=(0.4, 2.2, 0.6))
    return s


def light_spot() -> SceneFile:
    s = _light_stage("light-spot", "KHR_lights_punctual spot light, cone 20 to 35 degrees")
    s.light("light", "spot", 26.0, (1.0, 0.95, 0.85), cone_degrees=(20.0, 35.0), at=(1.4, 2.8, 1.4),
            turned=towards((-1.5, -2.2, -1.7)))
    return s


def light_directional() -> SceneFile:
    s = _light_stage("light-directional", "KHR_lights_punctual directional light")
    s.light("light", "directional", 3.0, (1.0, 0.95, 0.85), turned=towards((-0.5, -1.0, -0.75)))
    return s


def light_environment() -> SceneFile:
    s = _light_stage("light-environment", "Sky with a sun (latitude-longitude picture)")
    s.environment("sky.hdr", 0.7)
    return s


def light_mesh_instanced() -> SceneFile:
    """The lamp is a tilted, one-sided sheet. Mirroring (negative determinant) turns the winding over, and with it the
    emitting side: the mirrored lamp must shine down like the others, not at the sky."""
    s = _light_stage("light-mesh-instanced", "One emissive mesh in four nodes; one of them mirrored")
    lamp = s.material(m.emitter("lamp", (16.0, 14.0, 11.0)))
    sheet = merged([quad((-0.25, 0, -0.15), (0.5, -0.2, 0), (0, 0, 0.3)), quad((-0.25, 0, -0.15), (0, -0.12, 0), (0, 0, 0.3))])
    mesh = s.mesh("lamp", (sheet, lamp))
    rail = s.node("rail", at=(0.0, 2.05, -0.1), turned=about_y(10))
    s.node("lamp 1", mesh, parent=rail, at=(-1.1, 0.0, 0.0))
    s.node("lamp 2", mesh, parent=rail, at=(-0.3, 0.1, 0.4), turned=about_y(40), scale=0.7)
    s.node("lamp 3, mirrored", mesh, parent=rail, at=(0.6, 0.0, 0.0), scale=(-1, 1, 1))
    s.node("lamp 4", mesh, parent=rail, at=(1.2, 0.1, 0.5), turned=about_z(-15), scale=(1.2, 1, 0.6))
    return s


SCENES = [cornell_box, furnace, ring_caustic, mirror_caustic, torus_in_glass, light_quad, light_sphere, light_two_sided,
          light_point, light_spot, light_directional, light_environment, light_mesh_instanced]
