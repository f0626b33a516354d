"""Reads a GLB back and complains about whatever the glTF specification or Lacuna's conventions forbid."""

from __future__ import annotations

import json
import struct
from typing import Any, Iterator

from .coincident import coincident_faces, placed_triangles
from .vector import cross, dot, length, sub

COMPONENTS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}
FORMATS = {5126: "f", 5123: "H"}


class Glb:
    def __init__(self, data: bytes) -> None:
        magic, version, size = struct.unpack_from("<4sII", data)
        assert (magic, version, size) == (b"glTF", 2, len(data)), "bad GLB header"
        length_, kind = struct.unpack_from("<I4s", data, 12)
        assert kind == b"JSON" and length_ % 4 == 0, "bad JSON chunk"
        self.json: dict[str, Any] = json.loads(data[20:20 + length_])
        self.bin = b""
        rest = data[20 + length_:]
        if rest:
            size, kind = struct.unpack_from("<I4s", rest)
            assert kind == b"BIN\0" and size == len(rest) - 8, "bad BIN chunk"
            self.bin = rest[8:]

    def all(self, kind: str) -> list[dict[str, Any]]:
        return self.json.get(kind, [])

    def values(self, index: int) -> list[tuple]:
        accessor = self.all("accessors")[index]
        view = self.all("bufferViews")[accessor["bufferView"]]
        data = self.bin[view["byteOffset"]:view["byteOffset"] + view["byteLength"]]
        layout = f"<{COMPONENTS[accessor['type']]}{FORMATS[accessor['componentType']]}"
        rows = list(struct.iter_unpack(layout, data))
        assert len(rows) == accessor["count"], f"accessor {index}: count {accessor['count']}, data {len(rows)}"
        return rows

    def triangles(self) -> int:
        """The number of triangles as drawn: each instance counts."""
        sizes = [sum(self.all("accessors")[p["indices"]]["count"] // 3 for p in m["primitives"]) for m in self.all("meshes")]
        return sum(sizes[n["mesh"]] for n in self.all("nodes") if "mesh" in n)

    def emissive_triangles(self) -> int:
        total = 0
        for node in self.all("nodes"):
            for p in self.all("meshes")[node["mesh"]]["primitives"] if "mesh" in node else ():
                if "emissiveFactor" in self.all("materials")[p["material"]]:
                    total += self.all("accessors")[p["indices"]]["count"] // 3
        return total


def _references(glb: Glb) -> Iterator[str]:
    """Indices that point outside their list, or nodes that are not a tree."""
    def check(what: str, index: int, kind: str) -> Iterator[str]:
        if not 0 <= index < len(glb.all(kind)):
            yield f"{what}: no {kind}[{index}]"

    parents = [0] * len(glb.all("nodes"))
    for node in glb.all("nodes"):
        for key, kind in (("mesh", "meshes"), ("camera", "cameras")):
            if key in node:
                yield from check(f"node {node['name']}", node[key], kind)
        for child in node.get("children", ()):
            yield from check(f"node {node['name']}", child, "nodes")
            parents[child] += 1
    for root in glb.json["scenes"][0]["nodes"]:
        parents[root] += 1
    yield from (f"node {i} is reached {n} times" for i, n in enumerate(parents) if n != 1)
    for mesh in glb.all("meshes"):
        for p in mesh["primitives"]:
            yield from check(f"mesh {mesh['name']}", p["material"], "materials")
            for accessor in (p["indices"], *p["attributes"].values()):
                yield from check(f"mesh {mesh['name']}", accessor, "accessors")
    used = {n["mesh"] for n in glb.all("nodes") if "mesh" in n}
    yield from (f"mesh {m['name']} is not used" for i, m in enumerate(glb.all("meshes")) if i not in used)


def _packing(glb: Glb) -> Iterator[str]:
    for i, view in enumerate(glb.all("bufferViews")):
        if view["byteOffset"] % 4 or view["byteOffset"] + view["byteLength"] > len(glb.bin):
            yield f"bufferView {i} is misaligned or leaves the buffer"
    for i, accessor in enumerate(glb.all("accessors")):
        rows = glb.values(i)
        for key, pick in (("min", min), ("max", max)):
            if key in accessor and accessor[key] != [pick(c) for c in zip(*rows)]:
                yield f"accessor {i}: wrong {key}"


def _geometry(glb: Glb) -> Iterator[str]:
    """Indices in range, no degenerate triangle, unit normals on the side of the winding."""
    for mesh in glb.all("meshes"):
        for p in mesh["primitives"]:
            points, normals = (glb.values(p["attributes"][k]) for k in ("POSITION", "NORMAL"))
            counts = {glb.all("accessors")[a]["count"] for a in p["attributes"].values()}
            indices = [i for (i,) in glb.values(p["indices"])]
            if len(counts) != 1 or max(indices) >= len(points) or len(indices) % 3:
                yield f"mesh {mesh['name']}: attributes and indices do not fit"
                continue
            if "min" not in glb.all("accessors")[p["attributes"]["POSITION"]]:
                yield f"mesh {mesh['name']}: POSITION without bounds"
            if any(abs(length(n) - 1) > 1e-5 for n in normals):
                yield f"mesh {mesh['name']}: normals are not unit"
            for t in zip(indices[0::3], indices[1::3], indices[2::3]):
                a, b, c = (points[k] for k in t)
                n = cross(sub(b, a), sub(c, a))
                if length(n) < 1e-12:
                    yield f"mesh {mesh['name']}: degenerate triangle {a} {b} {c}"
                    break
                if any(dot(n, normals[k]) <= 0 for k in t):
                    yield f"mesh {mesh['name']}: a normal looks to the back at {a}"
                    break


def _extensions(glb: Glb) -> Iterator[str]:
    found: set[str] = set()

    def visit(value: Any) -> None:
        if isinstance(value, dict):
            found.update(value.get("extensions", {}))
            for v in value.values():
                visit(v)
        elif isinstance(value, list):
            for v in value:
                visit(v)

    visit(glb.json)
    if sorted(found) != sorted(glb.json.get("extensionsUsed", [])):
        yield f"extensionsUsed is {glb.json.get('extensionsUsed')}, found {sorted(found)}"


def _coincidence(glb: Glb) -> Iterator[str]:
    for (a, b), (area, corner) in sorted(coincident_faces(list(placed_triangles(glb))).items()):
        at = ", ".join(f"{c:.3f}" for c in corner)
        yield f"{a} and {b} have {area:.6f} square metres of face in common, near ({at})"


def _conventions(glb: Glb, files: set[str]) -> Iterator[str]:
    extras = glb.json["scenes"][0]["extras"]
    if len(glb.all("cameras")) != 1:
        yield "there must be one camera"
    if not {"width", "height", "max_depth"} <= set(extras["lacuna"]):
        yield "scene.extras.lacuna is incomplete"
    environment = extras.get("environment")
    file = environment["file"] if isinstance(environment, dict) else environment
    if file is not None and file not in files:
        yield f"environment {file} is not among the files"
    if not (environment or glb.emissive_triangles() or "KHR_lights_punctual" in glb.json.get("extensions", {})):
        yield "the scene has no light"


def problems(data: bytes, files: set[str]) -> list[str]:
    """`files`: names that the scene may refer to."""
    glb = Glb(data)
    found = list(_references(glb))
    if not found:
        for check in (_packing(glb), _geometry(glb), _extensions(glb), _coincidence(glb), _conventions(glb, files)):
            found += check
    return found
