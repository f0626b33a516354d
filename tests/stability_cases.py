"""The hard cases that the renderer and its tools stay stable in; stability_table.py says what they are for."""

from typing import NamedTuple


class Case(NamedTuple):
    name: str   # as stabilityCase() in the tests has it
    what: str   # what is hard about it
    holds: str  # what must hold


GROUPS = [
    ("Weights and densities", [
        Case("weights-sum", "10^4 paths of each of seven scenes",
             "weights of all strategies sum to one; each equals its full products within 1e-6"),
        Case("zero-densities", "strategies that meet a density of zero on the way",
             "they have no weight, the others sum to one"),
        Case("zero-targets", "targets that are zero on half of what can be picked", "picks keep their mean"),
        Case("other-pool", "another light pool under the same path", "the same weight, to the last bit"),
        Case("tiny-pools", "1, 2 and 4 light subpaths", "the mean that 10^4 give, both known to 0.1 %"),
        Case("strategies-alone", "each strategy by itself, unweighted", "all that make a path agree about its light"),
        Case("long-paths", "64 bounces at an albedo of 0.99", "1 - 0.99^65"),
        Case("roulette", "Russian roulette from the first vertex or never", "the same picture"),
        Case("overflow", "contributions beyond what a float holds",
             "dropped, counted, and named for replay; the picture stays finite"),
    ]),
    ("Materials", [
        Case("bsdf-contract", "lobes of alpha 1e-4 to 1, up to 89.9 degrees, tilted normals",
             "one evaluation for samples and densities; symmetric; both walks agree"),
        Case("roughness", "roughness from 1 to 0 on metal, glass and coats", "every method agrees with path tracing"),
        Case("delta-limit", "the smoothest rough lobe beside the delta", "the same picture"),
        Case("delta-shares", "the same, strategy by strategy", "each strategy's share is that beside a delta"),
        Case("grazing", "a floor at 89.9 degrees in the furnace", "the furnace's radiance"),
        Case("bent-normals", "shading normals bent hard against the faces", "every method agrees with path tracing"),
        Case("refraction", "glass in a white sky, glass in glass, a camera inside glass",
             "1 outside, the squared index inside, without noise"),
        Case("light-in-glass", "a lamp inside rough glass", "every method agrees with path tracing"),
        Case("glass-slab", "a slab before the camera, the lamp and anywhere between",
             "dims by its transmittance, whatever the distance"),
    ]),
    ("Lights", [
        Case("light-kinds", "every pair of seven kinds of light", "every method agrees with path tracing"),
        Case("sky-alone", "nothing, or one convex body, under a constant sky", "the sky; the body's albedo"),
        Case("tiny-light", "a lamp of a millionth of the scene", "every method agrees with path tracing"),
        Case("huge-light", "a lamp a million times the scene", "the radiance under an endless one"),
        Case("light-near-surface", "a lamp 1e-4 off a surface", "radiance by form factor; nothing leaks from the gap"),
        Case("thin-gap", "light through a gap of a thousandth", "the gap's form factor"),
        Case("intensities", "radiances from 1e-30 to 1e37", "the furnace's mean, in proportion"),
        Case("saturated-colours", "blue light on a red wall", "black"),
        Case("no-light", "no lamp, lamps that are shut in, without power, without area", "black"),
        Case("emission-side", "lamps mirrored by a negative scale", "light on the side of their winding alone"),
        Case("point-light-spike", "a point light close to walls", "no pixel above 50 times its neighbours"),
    ]),
    ("Sizes and geometry", [
        Case("scale", "scenes of 1e-3, 1e3 and 1e6 of their size", "the same picture; bits, for powers of two"),
        Case("offset", "a scene 1e5 away from the origin", "the same picture and hits"),
        Case("corner", "a thousandth of a corner fills the film", "the furnace's radiance"),
        Case("connection-spikes", "vertices that nearly touch, inside a bent sphere",
             "agrees with path tracing; no pixel above 10 times the mean"),
        Case("broken-geometry", "triangles of a line or a point, normals of zero", "the picture without them"),
        Case("duplicate-faces", "every face twice in one place", "the picture of one"),
    ]),
    ("Film, lens, iterations", [
        Case("film-border", "the furnace at the film's border", "what it is inside"),
        Case("film-round-trip", "raster to direction and back, any camera", "within a thousandth of a pixel"),
        Case("pixel-filter", "edges of a lamp across pixels", "the covered part, for hits and for splats"),
        Case("crop", "a crop of an odd-sized film", "that part of the whole picture"),
        Case("one-pixel", "a film of one pixel", "the mean of many"),
        Case("thin-lens", "a lens of radius 1e-5, and a wide one", "the pinhole's picture; path tracing's"),
        Case("half-lens", "one half of a wide lens covered", "one half of the light, to the blind's parallax"),
        Case("strange-cameras", "orthographic cameras", "skipped, with a warning"),
        Case("iterations", "1, 4 and 64 iterations", "the same mean"),
        Case("threads", "1, 2 and 7 threads", "the same bits"),
    ]),
    ("Distributions", [
        Case("pmf-range", "weights from denormal to 1e308, zeros among them",
             "probabilities as drawn, none of zero is drawn"),
        Case("pmf-of-nothing", "no weights, or zeros alone", "empty, and says so"),
        Case("many-entries", "twenty million equal weights", "the last is as likely as the first"),
        Case("nonsense-skeletons", "nodes and balls anywhere, a random map", "every mean stays"),
        Case("nonsense-subspaces", "random trees, Q and Gamma", "every mean stays"),
        Case("subspace-range", "Q and populations over thirty decades", "every mean stays"),
    ]),
    ("Voxels", [
        Case("voxel-scale", "scenes of 1e-3 to 1e6 units", "the voxels that exact arithmetic says"),
        Case("voxel-thin-walls", "sheets, and walls down to 1e-6 of a voxel, at any angle", "two sides stay two parts"),
        Case("voxel-borders", "faces, edges and corners on the lattice", "every voxel that they touch"),
        Case("voxel-duplicates", "coplanar faces, faces twice and back to front", "voxels and distances of one"),
        Case("voxel-no-surface", "edges of many faces, faces through each other",
             "the voxels that exact arithmetic says"),
        Case("voxel-needles", "triangles of width 1e-7, of a line, of a point", "voxels and distances of the line"),
        Case("voxel-flat", "all triangles in one plane", "refused, asking for a domain; with one, a skeleton"),
    ]),
    ("Skeletons", [
        Case("space-one-voxel", "one voxel of empty space", "one node, which it is mapped to"),
        Case("space-none", "none at all", "no node, and look-ups say so"),
        Case("space-flat", "space one voxel high", "its loops, and no more"),
        Case("space-scale", "rooms of 1e-3 and of 1e6 units", "the same skeleton and node map"),
        Case("node-sides", "points on one slanted wall, of no thickness or less than a voxel's",
             "the node of the path's side"),
        Case("node-wedges", "points in wedges between two and three walls", "the node of the path's room, but for 1.2 %"),
    ]),
    ("Training", [
        Case("train-scale", "scenes of 1e-3 and 1e6 of their size, 1e-18 and 1e18 of their brightness",
             "subspaces and Gamma the same in every bit, Q in proportion"),
        Case("train-range", "lamps thirty decades apart", "finite numbers, losses and all"),
        Case("tree-range", "positions and labels over sixty decades", "a tree of bounded depth that its reader accepts"),
        Case("centroid-range", "weights over sixty decades", "the heaviest is among the drawn"),
        Case("lamp-range", "lamps over thirty decades of power", "no more cells than asked for, and one more"),
        Case("gamma-range", "contributions and densities over thirty decades",
             "losses finite and falling, columns sum to one"),
    ]),
]
