// (theory.md, "Lamps that are seen")
#include "libcore/scene/sky_sides.h"

namespace lacuna {

namespace {
/// No cell is quite dark: some orientations in it face a little more of the sky than its centre.
constexpr double kLeast = 0.05;
}  // namespace

SkySides::SkySides(const Sum& sum) {
    std::vector<Vec3d> fluxes;
    for (const Vec3d& flux : sum.cells_) {
        if (!(flux == Vec3d{})) fluxes.push_back(flux);
    }
    // The mean of the positive part of a cosine over all orientations is a quarter.
    const double mean = 0.25 * sum.whole();
    for (std::size_t i = 0; i < kSide * kSide; ++i) {
        const auto middle = [](std::size_t cell) {
            return (2.0f * float(cell) + 1.0f) / float(kSide) - 1.0f;
        };
        const Vec3d side{octahedronDirection({middle(i % kSide), middle(i / kSide)})};
        double irradiance = 0.0;
        for (const Vec3d& flux : fluxes) irradiance += std::max(0.0, dot(side, flux));
        table_.push_back(float(std::max(kLeast, irradiance / mean)));
    }
}

}  // namespace lacuna
