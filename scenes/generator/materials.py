"""glTF materials as Lacuna reads them."""

from __future__ import annotations

from typing import Any, Sequence

Rgb = Sequence[float]
WHITE = (0.75, 0.75, 0.75)


def _base(name: str, colour: Rgb, metallic: float, roughness: float, texture: dict[str, Any] | None) -> dict[str, Any]:
    pbr: dict[str, Any] = {"baseColorFactor": [*colour, 1.0], "metallicFactor": metallic, "roughnessFactor": roughness}
    if texture:
        pbr["baseColorTexture"] = texture
    return {"name": name, "pbrMetallicRoughness": pbr, "doubleSided": True}


def lambert(name: str, colour: Rgb = WHITE, texture: dict[str, Any] | None = None) -> dict[str, Any]:
    return {**_base(name, colour, 0.0, 1.0, texture), "extensions": {"KHR_materials_specular": {"specularFactor": 0.0}}}


def metal(name: str, colour: Rgb, roughness: float) -> dict[str, Any]:
    return _base(name, colour, 1.0, roughness, None)


def coated(name: str, colour: Rgb, roughness: float = 0.0, ior: float = 1.5,
           texture: dict[str, Any] | None = None) -> dict[str, Any]:
    """Diffuse under a dielectric layer; roughness 0 is a smooth, mirror-like coat."""
    return {**_base(name, colour, 0.0, roughness, texture), "extensions": {"KHR_materials_ior": {"ior": ior}}}


def glass(name: str, roughness: float = 0.0, ior: float = 1.5) -> dict[str, Any]:
    """Solid body: single-sided by convention, refracts; its mesh must be closed."""
    return {**_base(name, (1.0, 1.0, 1.0), 0.0, roughness, None), "doubleSided": False, "extensions": {
        "KHR_materials_ior": {"ior": ior}, "KHR_materials_transmission": {"transmissionFactor": 1.0},
        "KHR_materials_volume": {"thicknessFactor": 1.0}}}


def thin_glass(name: str, colour: Rgb = (1.0, 1.0, 1.0)) -> dict[str, Any]:
    """No volume: light goes straight through a sheet without thickness."""
    return {**_base(name, colour, 0.0, 0.0, None), "extensions": {
        "KHR_materials_ior": {"ior": 1.5}, "KHR_materials_transmission": {"transmissionFactor": 1.0}}}


def cut_out(material: dict[str, Any]) -> dict[str, Any]:
    """Where the texture's alpha is below a half there is nothing."""
    return {**material, "alphaMode": "MASK", "alphaCutoff": 0.5}


def emitter(name: str, radiance: Rgb, albedo: Rgb = (0.0, 0.0, 0.0), double_sided: bool = False) -> dict[str, Any]:
    """Emits on the side of its winding unless double_sided; its colour is stored as glTF asks, within 0..1."""
    strength = max(radiance)
    out = {**lambert(name, albedo), "doubleSided": double_sided, "emissiveFactor": [round(r / strength, 6) for r in radiance]}
    out["extensions"] = {**out["extensions"], "KHR_materials_emissive_strength": {"emissiveStrength": strength}}
    return out
