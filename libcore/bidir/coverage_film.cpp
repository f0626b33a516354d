#include "libcore/bidir/coverage_film.h"

#include <algorithm>

#include "libcore/base/parallel.h"

namespace lacuna {

void CoverageFilm::addIteration(const RenderSetup& setup, const Iteration& iteration) {
    const PixelRect& crop = setup.settings.crop;
    std::vector<RayTally> tallies(std::size_t(crop.height()));
    setup.threads.forEach(tallies.size(), [&](std::size_t row) {
        std::vector<PathVertex> path;
        const int y = crop.y0 + int(row);
        for (int x = crop.x0; x < crop.x1; ++x) {
            Rng rng =
                setup.sampler.stream(iteration.number, StreamKind::EyePath, setup.filmIndex(x, y));
            const Walk walk = setup.startEye(x, y, rng, path);
            const auto hit = setup.scene.trace(walk.origin, walk.ng, walk.direction,
                                               RayKind::Camera, tallies[row]);
            if (hit) met_[setup.cropIndex(x, y)] += 1.0f;
        }
    });
    for (const RayTally& tally : tallies) iteration.statistics.add(tally);
    ++iterations_;
}

Layers CoverageFilm::means() const {
    std::vector<float> alpha = met_;
    if (iterations_ > 0) {
        for (float& a : alpha) a /= float(iterations_);
    }
    return {{"A", std::move(alpha)}};
}

void CoverageFilm::clear() {
    std::ranges::fill(met_, 0.0f);
    iterations_ = 0;
}

}  // namespace lacuna
