"""What the loader reads, taken from its sources, and which of it a scene has.

There are four kinds of features. A path is one of the loader's table of rules (rules.cpp: every value that it uses). A
word is any name in quotes in its sources. A constant is one of tinygltf's that they ask for. A lamp's feature is the
path of a value in a material that also emits. `run.py --features` fails if the loader has a new feature in no scene.
"""

import json
import re
from pathlib import Path

LOADER = Path(__file__).resolve().parents[2] / "libcore" / "gltf"
# Words that are no feature: parts of messages, names of phases, what identifies Blender's lamps.
OTHER_WORDS = {"none", "more", "neither", "both", "default", "parse", "decode", "meshes", "glTF", "VEC", "Blender",
               "Standard", "Raw", "triangles", "vertices"}
# Where a constant of tinygltf is seen in a file: member and value.
CONSTANTS = {
    "TINYGLTF_COMPONENT_TYPE_BYTE": ("componentType", 5120),
    "TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE": ("componentType", 5121),
    "TINYGLTF_COMPONENT_TYPE_SHORT": ("componentType", 5122),
    "TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT": ("componentType", 5123),
    "TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT": ("componentType", 5125),
    "TINYGLTF_COMPONENT_TYPE_FLOAT": ("componentType", 5126),
    "TINYGLTF_MODE_POINTS": ("mode", 0),
    "TINYGLTF_MODE_TRIANGLES": ("mode", 4),
    "TINYGLTF_MODE_TRIANGLE_STRIP": ("mode", 5),
    "TINYGLTF_MODE_TRIANGLE_FAN": ("mode", 6),
    "TINYGLTF_TEXTURE_FILTER_NEAREST": ("magFilter", 9728),
    "TINYGLTF_TEXTURE_WRAP_REPEAT": ("wrapS", 10497),
    "TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE": ("wrapS", 33071),
    "TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT": ("wrapS", 33648),
    "TINYGLTF_TYPE_VEC3": ("type", "VEC3"),
}
# Refused by the loader: no scene has them.
REFUSED = {"TINYGLTF_TYPE_MAT2", "TINYGLTF_TYPE_MAT4"}


def of_loader():
    """Every feature, as text."""
    sources = {path.name: path.read_text(encoding="utf-8") for path in sorted(LOADER.glob("*.cpp"))}
    found = {"path " + p.replace("\n", "") for p in re.findall(r'\{"([\w*/]+)", Shape::', sources["rules.cpp"])}
    for name, text in sources.items():
        text = re.sub(r"//.*", "", text)
        found |= {"constant " + c for c in re.findall(r"\bTINYGLTF_\w+", text)}
        if name != "rules.cpp":
            found |= {"word " + w for w in re.findall(r'"([A-Za-z_]\w*)"', text)}
    found |= {"lamp's " + f.removeprefix("path materials/*/") for f in found if f.startswith("path materials/*/")}
    return sorted(found - {"word " + w for w in OTHER_WORDS} - {"constant " + c for c in REFUSED})


def _leads(value, path):
    """Whether a path of the table of rules leads to something; * stands for every element or member."""
    if not path:
        return True
    name, *rest = path
    if name == "*" and isinstance(value, (dict, list)):
        return any(_leads(member, rest) for member in (value.values() if isinstance(value, dict) else value))
    return isinstance(value, dict) and name in value and _leads(value[name], rest)


def _words(value, found):
    """Names of members, texts, and constants by the numbers that stand for them."""
    if isinstance(value, dict):
        for key, member in value.items():
            found.add("word " + key)
            found |= {"constant " + name for name, seen in CONSTANTS.items() if seen == (key, member)}
            _words(member, found)
    elif isinstance(value, list):
        for member in value:
            _words(member, found)
    elif isinstance(value, str):
        found.add("word " + value)
        if value.startswith("{"):  # an object as text
            _words(json.loads(value), found)


def of_scene(root, features):
    """The features that a file's JSON shows."""
    found = set()
    _words(root, found)
    lamps = [m for m in root["materials"] if "emissiveFactor" in m]
    tests = {"path": lambda path: _leads(root, path), "lamp's": lambda path: any(_leads(m, path) for m in lamps)}
    for feature in features:
        kind, name = feature.split(" ", 1)
        if kind in tests and tests[kind](name.split("/")):
            found.add(feature)
    return found & set(features)
