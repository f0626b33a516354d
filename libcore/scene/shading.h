// Makes the BSDF at a point from a material and its textures.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "libcore/material/albedo_tables.h"
#include "libcore/material/bsdf.h"
#include "libcore/scene/baked.h"
#include "libcore/scene/surfaces.h"

namespace lacuna {

class Shading {
  public:
    /// `description` must outlive the object.
    Shading(const SceneDescription& description, std::span<const BakedMesh> meshes);

    /// Evaluates the material's textures at the point, except those that turn the BSDF, whose
    /// results are in `point`.
    Bsdf bsdfAt(const SurfacePoint& point) const;
    const AlbedoTables& albedoTables() const { return *tables_; }

  private:
    /// A material's precomputed data.
    struct Prepared {
        std::optional<Bsdf> bsdf;  ///< if at most the base colour varies; then with white
        bool colorVaries = false;
    };

    Prepared prepared(const Material& material, bool vertexColors) const;
    Rgb baseColorAt(const Material& material, Vec2 uv, Vec2 uv1) const;
    Bsdf::Parameters parametersAt(const Material& material, Vec2 uv, Vec2 uv1) const;

    const SceneDescription& description_;
    std::unique_ptr<AlbedoTables> tables_;
    std::vector<Prepared> prepared_;  // by material
};

}  // namespace lacuna
