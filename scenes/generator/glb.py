"""Builds one scene and writes it as a self-contained, binary glTF 2.0 file."""

from __future__ import annotations

import json
import math
import struct
from typing import Any, Sequence

from .mesh import Mesh, is_closed, signed_volume
from .vector import Quat, Vec3, camera_matrix

FLOAT, U16 = 5126, 5123
VERTEX_BUFFER, INDEX_BUFFER = 34962, 34963


def clean(x: float) -> float:
    """Rounds to a micrometre and drops the sign of zero: sin and cos differ in the last bit between C libraries,
    and the files must not."""
    return round(float(x), 6) + 0.0


def cleaned(values: Sequence[float]) -> list[float]:
    return [clean(v) for v in values]


def padded(data: bytes, fill: bytes = b"\0") -> bytes:
    return data + fill * (-len(data) % 4)


class SceneFile:
    """A glTF document in the making. Indices are glTF's own, so what a method returns can be stored in nodes."""

    def __init__(self, name: str, description: str, width: int, height: int, max_depth: int = 12) -> None:
        self.name, self.description = name, description
        self.width, self.height = width, height
        self.buffer = b""
        self.materials: list[dict[str, Any]] = []
        self.meshes: list[dict[str, Any]] = []
        self.nodes: list[dict[str, Any]] = []
        self.roots: list[int] = []
        self.cameras: list[dict[str, Any]] = []
        self.lights: list[dict[str, Any]] = []
        self.images: list[dict[str, Any]] = []
        self.accessors: list[dict[str, Any]] = []
        self.views: list[dict[str, Any]] = []
        self.extras: dict[str, Any] = {
            "description": description, "lacuna": {"width": width, "height": height, "max_depth": max_depth}}

    # --- contents

    def material(self, material: dict[str, Any]) -> int:
        assert material["name"] not in [m["name"] for m in self.materials], material["name"]
        self.materials.append(material)
        return len(self.materials) - 1

    def texture(self, name: str, png: bytes) -> dict[str, Any]:
        """Stores a picture; the result is a textureInfo for a material. Textures and images share their index."""
        self.images.append({"bufferView": self._view(png, None), "mimeType": "image/png", "name": name})
        return {"index": len(self.images) - 1}

    def mesh(self, name: str, *parts: tuple[Mesh, int]) -> int:
        primitives = [self._primitive(f"{self.name}: {name}", mesh, material) for mesh, material in parts]
        self.meshes.append({"name": name, "primitives": primitives})
        return len(self.meshes) - 1

    def node(self, name: str, mesh: int | None = None, parent: int | None = None, at: Vec3 | None = None,
             turned: Quat | None = None, scale: Sequence[float] | float | None = None, **more: Any) -> int:
        node: dict[str, Any] = {"name": name}
        if mesh is not None:
            node["mesh"] = mesh
        if at is not None:
            node["translation"] = cleaned(at)
        if turned is not None:
            node["rotation"] = cleaned(turned)
        if scale is not None:
            node["scale"] = cleaned([scale] * 3 if isinstance(scale, (int, float)) else scale)
        self.nodes.append({**node, **more})
        index = len(self.nodes) - 1
        siblings = self.roots if parent is None else self.nodes[parent].setdefault("children", [])
        siblings.append(index)
        return index

    def add(self, name: str, mesh: Mesh, material: int, **placing: Any) -> int:
        """Adds a mesh that is used once."""
        return self.node(name, self.mesh(name, (mesh, material)), **placing)

    def camera(self, position: Vec3, target: Vec3, vertical_degrees: float) -> None:
        aspect = self.width / self.height
        self.cameras.append({"type": "perspective", "name": "camera", "perspective": {
            "yfov": clean(math.radians(vertical_degrees)), "aspectRatio": clean(aspect), "znear": 0.01}})
        self.node("camera", camera=len(self.cameras) - 1, matrix=cleaned(camera_matrix(position, target)))

    def light(self, name: str, kind: str, intensity: float, colour: Vec3, cone_degrees: tuple[float, float] | None = None,
              **placing: Any) -> None:
        light: dict[str, Any] = {"name": name, "type": kind, "intensity": intensity, "color": list(colour)}
        if cone_degrees:
            inner, outer = (clean(math.radians(a)) for a in cone_degrees)
            light["spot"] = {"innerConeAngle": inner, "outerConeAngle": outer}
        self.lights.append(light)
        self.node(name, extensions={"KHR_lights_punctual": {"light": len(self.lights) - 1}}, **placing)

    def environment(self, file: str, scale: float | None = None) -> None:
        self.extras["environment"] = file if scale is None else {"file": file, "scale": scale}

    # --- packing

    def _view(self, data: bytes, target: int | None) -> int:
        view: dict[str, Any] = {"buffer": 0, "byteOffset": len(self.buffer), "byteLength": len(data)}
        if target is not None:
            view["target"] = target
        self.views.append(view)
        self.buffer += padded(data)
        return len(self.views) - 1

    def _floats(self, kind: str, rows: Sequence[Sequence[float]], bounds: bool = False) -> int:
        data = b"".join(struct.pack(f"<{len(row)}f", *cleaned(row)) for row in rows)
        accessor: dict[str, Any] = {"bufferView": self._view(data, VERTEX_BUFFER), "componentType": FLOAT,
                                    "count": len(rows), "type": kind}
        if bounds:  # of the floats as stored, not of what they were rounded from
            stored = list(struct.iter_unpack(f"<{len(rows[0])}f", data))
            accessor["min"] = [min(column) for column in zip(*stored)]
            accessor["max"] = [max(column) for column in zip(*stored)]
        self.accessors.append(accessor)
        return len(self.accessors) - 1

    def _indices(self, triangles: Sequence[tuple[int, int, int]]) -> int:
        data = b"".join(struct.pack("<3H", *t) for t in triangles)
        self.accessors.append({"bufferView": self._view(data, INDEX_BUFFER), "componentType": U16,
                               "count": 3 * len(triangles), "type": "SCALAR"})
        return len(self.accessors) - 1

    def _primitive(self, label: str, mesh: Mesh, material: int) -> dict[str, Any]:
        kind = self.materials[material]
        if "KHR_materials_volume" in kind.get("extensions", {}):
            assert is_closed(mesh), f"{label}: glass must be closed"
            assert signed_volume(mesh) > 0, f"{label}: glass must be wound outwards"
        attributes = {"POSITION": self._floats("VEC3", mesh.positions, bounds=True),
                      "NORMAL": self._floats("VEC3", mesh.normals)}
        if "Texture" in json.dumps(kind):
            attributes["TEXCOORD_0"] = self._floats("VEC2", mesh.uvs)
        return {"attributes": attributes, "indices": self._indices(mesh.triangles), "material": material, "mode": 4}

    def _extensions_used(self) -> list[str]:
        used: set[str] = set()

        def visit(value: Any) -> None:
            if isinstance(value, dict):
                used.update(value.get("extensions", {}))
                value = list(value.values())
            if isinstance(value, list):
                for v in value:
                    visit(v)

        visit([self.materials, self.nodes])
        return sorted(used)

    def document(self) -> dict[str, Any]:
        out: dict[str, Any] = {
            "asset": {"version": "2.0", "generator": "Lacuna scenes/make_scenes.py",
                      "copyright": "The Lacuna authors; same licence as the project"},
            "scene": 0,
            "scenes": [{"name": self.name, "nodes": self.roots, "extras": self.extras}],
            "nodes": self.nodes,
            "cameras": self.cameras,
        }
        if self.meshes:
            out |= {"meshes": self.meshes, "materials": self.materials, "accessors": self.accessors}
        if self.images:
            out |= {"textures": [{"sampler": 0, "source": i} for i in range(len(self.images))], "images": self.images,
                    "samplers": [{"magFilter": 9729, "minFilter": 9729, "wrapS": 10497, "wrapT": 10497}]}
        if self.views:
            out |= {"bufferViews": self.views, "buffers": [{"byteLength": len(self.buffer)}]}
        if self._extensions_used():
            out["extensionsUsed"] = self._extensions_used()
        if self.lights:
            out["extensions"] = {"KHR_lights_punctual": {"lights": self.lights}}
        return out

    def glb(self) -> bytes:
        text = padded(json.dumps(self.document(), separators=(",", ":")).encode(), b" ")
        chunks = struct.pack("<I4s", len(text), b"JSON") + text
        if self.buffer:
            chunks += struct.pack("<I4s", len(self.buffer), b"BIN\0") + self.buffer
        return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks
