// From a material and its textures to the BSDF at a point.
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
    /// `description` must outlive it.
    Shading(const SceneDescription& description, std::span<const BakedMesh> meshes);

    /// Evaluates the material's textures at the point; what turns the BSDF is there already.
    Bsdf bsdfAt(const SurfacePoint& point) const;
    const AlbedoTables& albedoTables() const { return *tables_; }

  private:
    /// What a material has in common wherever it is.
    struct Prepared {
        std::optional<Bsdf> bsdf;  ///< where nothing but the base colour varies; white then
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
