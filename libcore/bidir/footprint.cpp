// (theory.md, "Merging")
#include "libcore/bidir/footprint.h"

#include <algorithm>
#include <cmath>

namespace lacuna {

double medianFootprint(const Walker& walker) {
    constexpr int kSide = 32;  // of a grid of rays over the film
    const Camera::Film film = walker.camera().film();
    std::vector<double> sides;
    std::vector<PathVertex> path;
    RayTally tally;  // not part of the render: these rays are counted nowhere
    for (int i = 0; i < kSide * kSide; ++i) {
        Rng rng(0, 0, StreamKind::Features, std::uint64_t(i));
        const Vec2 raster{(float(i % kSide) + 0.5f) / kSide * float(film.width),
                          (float(i / kSide) + 0.5f) / kSide * float(film.height)};
        walker.traceEye(raster, rng, tally, path);
        double distance = 0;
        for (std::size_t n = 1; n < path.size() && path[n].kind == VertexKind::Surface; ++n) {
            distance += length(Vec3d(path[n].position) - Vec3d(path[n - 1].position));
            if (!path[n].connectable()) continue;
            const float pdfW = walker.camera().directionAt(path[0].position, raster).pdfW;
            sides.push_back(distance / std::sqrt(double(pdfW)));
            break;
        }
    }
    if (sides.empty()) return 1e-3 * double(walker.scene().radius());
    const auto middle = sides.begin() + std::ptrdiff_t(sides.size() / 2);
    std::nth_element(sides.begin(), middle, sides.end());
    return *middle;
}

}  // namespace lacuna
