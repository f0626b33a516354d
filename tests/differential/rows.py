"""The rows of lacuna-render, settings for them drawn from what --help-method says, and what a row cannot make."""

import math
import re
import subprocess

# Parameters that are drawn no larger than this, to save time. MANY is for those that count many things and have no
# entry.
MOST = {"connections": 6, "first_connections": 8, "deep_connections": 6, "voxels.resolution": 32, "train.epochs": 3,
        "train.subspaces": 40, "train.paths": 1500, "train.light_paths": 1500, "emission_paths": 1500,
        "walk_paths": 1500, "cache_density": 0.1, "record_density": 0.1, "node_acceptance": 10}
MANY = 300
# Set in every render that takes them: the defaults are for large pictures.
SMALL = {"candidates": 100, "voxels.resolution": 16, "train.paths": 600, "train.subspaces": 20,
         "train.light_paths": 600, "train.epochs": 2, "emission_paths": 600, "walk_paths": 600, "second_candidates": 40}
LEARNED = {"emission_paths", "walk_paths"}  # 0 means half a million of them
# Never drawn: a box in the scene's coordinates, and what merging is set to below.
UNDRAWN = {"voxels.domain", "radius", "photons"}
RADIUS = 0.003  # in units; no test here can see what merging then blurs
SPLATS = 2000  # light paths where little else makes the picture: few of them meet what the camera sees
# Photon mapping alone is too noisy with few photons and a small radius, and blurs with a large one: no mean of it is
# judged.
PHOTONS, PHOTON_RADIUS = 500, 0.06

# Effects that can be forced on where nothing calls for them, which changes no picture; and those of rows, not of
# scenes.
FORCED_ON = ("emissive_textures", "textures", "alpha_mask", "normal_maps", "vertex_colors", "attenuation")
TECHNIQUES = {"hits": "s = 0", "connections": "s >= 1, t >= 2", "splats": "t = 1"}  # and how --help-method tells of them
# What a row may say instead of rendering a scene: skeletons are of the space between surfaces.
REFUSALS = {"skelbpt": ("expected the box of the space in front of the surfaces",
                        "expected a scene with an extent, found a point",
                        "expected voxels fine enough to leave empty ones where the camera looks")}
DELTAS = {"mirror", "smooth_refraction", "smooth_thin_transmission"}
NARROW = 0.15  # roughness
PUNCTUAL = {"point_lights", "spot_lights", "directional_lights"}


class Row:
    def __init__(self, name, merges, techniques, parameters):
        self.name, self.merges, self.techniques, self.parameters = name, merges, techniques, parameters


def _answer(render, *arguments):
    return subprocess.run([render, *arguments], check=True, capture_output=True, text=True).stdout


def rows(render):
    """All rows but experiments with a bias, with their parameters as (name, what it may be)."""
    found = []
    for line in _answer(render, "--list-methods").splitlines():
        name = line.split()[0]
        if name == "auto" or "(biased" in line:
            continue
        text = _answer(render, "--help-method", name)
        parameters = re.findall(r"^  ([\w.]+)  .*\n +([^;\n]*)",
                                text[text.index("\nparameters"):], re.M)
        techniques = {technique for technique, sign in TECHNIQUES.items() if f"\n  {sign}  " in text}
        found.append(Row(name, "(consistent" in line, techniques, parameters))
    return found


def _drawn(r, name, kind):
    """A value of a parameter; None where it is not to be drawn."""
    if name in UNDRAWN:
        return None
    if kind == "on or off":
        return r.choice(("on", "off"))
    if kind.startswith("one of "):
        return r.choice(kind.split()[2:])
    limits = re.match(r"an? (integer|number) from (\S+) to (\S+)", kind)
    if not limits:
        raise ValueError(f"{name}: expected a kind of parameter that is known here, found '{kind}'")
    low, high = float(limits[2]), float(limits[3])
    high = min(high, MOST.get(name, MANY if high > 1e4 else high))
    if limits[1] == "number":
        value = r.choice((low, high, r.uniform(low, high)))
        return f"{max(value, 0.05) if name == 'defensive' else value:.4g}"  # 0 is allowed only with points=weighted
    if low == 0 and r.random() < 0.2 and name not in LEARNED:
        return "0"
    return str(round(math.exp(r.uniform(math.log(max(low, 1)), math.log(high)))))


def settings(row, r, unit, switches):
    """Options of lacuna-render for a row, beside what is switched: in half of all draws the defaults, made small."""
    chosen = {name: SMALL[name] for name, _ in row.parameters if name in SMALL}
    if r.random() < 0.5:
        for name, kind in row.parameters:
            value = _drawn(r, name, kind) if r.random() < 0.4 else None
            if value is not None:
                chosen[name] = value
    if any(f"{technique}=off" in switches for technique in TECHNIQUES):
        chosen.pop("merge", None)  # which would bring what is left out
    if row.techniques == {"splats"} or "connections=off" in switches and "splats" in row.techniques:
        chosen["light_paths"] = SPLATS
    if row.name == "ppm":
        chosen.update(photons=PHOTONS, radius=f"{PHOTON_RADIUS * unit:.4g}")
    elif any(name == "radius" for name, _ in row.parameters):
        chosen["radius"] = f"{RADIUS * unit:.4g}"
    options = [x for name, value in chosen.items() for x in ("--set", f"{name}={value}")]
    if r.random() < 0.1:
        options += ["--sampler", "sobol"]
    return options


def switched_off(effects, r):
    """Options that leave out effects of the scene for all rows: none as a rule. `effects`: names of all."""
    names = r.sample(sorted(set(effects) - set(TECHNIQUES)), 2) if r.random() < 0.2 else []
    return [x for name in names for x in ("--effect", f"{name}=off")]


def switches(row, left_out, r):
    """Options for one row: one of its techniques off, whose light the others must bring, or one of the effects that
    are not there forced on."""
    if r.random() < 0.3 and len(row.techniques) > 1 and not row.merges:
        return ["--effect", f"{r.choice(sorted(row.techniques))}=off"]
    names = [name for name in FORCED_ON if name in left_out]
    return ["--effect", f"{r.choice(names)}=on"] if names and r.random() < 0.1 else []


def effects(render, scene):
    """The names of all effects."""
    return [line.split()[1] for line in _answer(render, scene, "--effects").splitlines()]


def merges(row, options):
    return row.merges or "merge=on" in options


def nearly_smooth(materials):
    """Whether any has a lobe so narrow that a row without the technique for a mirror hardly ever meets its light."""
    def roughness(m):
        surface, extensions = m.get("pbrMetallicRoughness", {}), m.get("extensions", {})
        yield 0 if "metallicRoughnessTexture" in surface else surface.get("roughnessFactor", 1)
        yield extensions.get("KHR_materials_clearcoat", {}).get("clearcoatRoughnessFactor", 1)
        yield extensions.get("KHR_materials_ior", {}).get("ior", 2) - 1
    return any(r < NARROW for m in materials for r in roughness(m))


def expectation(row, options, simulated, nearly):
    """`same` as the reference, bpt; `at most` as much; or `any`. `simulated`: effects, as its report has them."""
    if row.name == "ppm":
        return "any"
    deltas, punctual = nearly or bool(DELTAS & simulated), bool(PUNCTUAL & simulated)
    if merges(row, options) and deltas and punctual:
        return "any"  # few photons make what bpt's chains find in each iteration
    left = {technique for technique in row.techniques if f"{technique}=off" not in options}
    if left == {"hits"}:
        lacks = punctual  # a point cannot be hit
    elif left == {"connections"}:
        lacks = True  # lamps in sight of the lens
    elif "hits" not in left or "connections" not in left:
        lacks = deltas  # what is seen through mirrors and smooth glass, of lamps or of all
    else:
        lacks = "splats" not in left and deltas and punctual  # a shadow ray does not bend
    return "at most" if lacks else "same"
