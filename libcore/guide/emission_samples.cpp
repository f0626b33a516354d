#include "libcore/guide/emission_samples.h"

#include <algorithm>
#include <cmath>

#include "libcore/guide/technique_worth.h"

namespace lacuna {

namespace {
/// W. The guide serves methods whose light subpaths stand for many samples each. By bpt's own count of one they would
/// seem to bring too little to be worth learning. (8 is worse than 32 and 128, which are alike.)
constexpr double kWorth = TechniqueWorth::kOfPool;
}  // namespace

void EmissionSamples::add(FullPath& path, const TechniqueCounts& counts, const Lights& lights,
                          float contribution, std::uint32_t pixel) {
    const int k = path.edges;
    if (!(contribution > 0.0f) || !std::isfinite(contribution) || k < 2) return;
    const auto alone = float(misWeight(path, counts, k));
    const float withRay = std::max(0.0f, 1.0f - alone - float(misWeight(path, counts, k + 1)));
    if (!(alone + withRay > 0.0f)) return;
    const PathVertex& y0 = *path.vertex[0];
    const LightPlace place{y0.light, y0.position, y0.ng, y0.lightUv};
    const Vec3 direction = path.directionOf(0), x1 = path.vertex[1]->position;
    Sample s{y0.light,
             pixel,
             lights.pointSquare(place),
             lights.raySquare(place, direction, x1),
             contribution,
             withRay,
             alone,
             1.0f,
             1.0f};
    const Lights::GuidedPdfs pdfs = lights.guidedPdfs(place, direction, x1);
    s.pdfPoint = pdfs.point;
    s.pdfRay = pdfs.ray;
    samples_.push_back(s);
}

void EmissionSamples::relate(const PixelScale& scale) {
    for (Sample& s : samples_) s.contribution = float(double(s.contribution) / scale.of(s.pixel));
}

float EmissionSamples::outlierLimit() const {
    std::vector<float> contributions;
    for (const Sample& s : samples_) contributions.push_back(s.contribution);
    return lacuna::outlierLimit(contributions);
}

void EmissionSamples::lowerTo(float limit) {
    for (Sample& s : samples_) s.contribution = std::min(s.contribution, limit);
}

PlainMoments plainMoments(const EmissionSamples::Sample& s) {
    const double withRay = double(s.withRay);
    const double density = 1.0 + (kWorth - 1.0) * withRay;  // over p_D
    const double g = double(s.contribution) / density, square = g * g * double(s.pdfPoint);
    return {square * kWorth * withRay * double(s.pdfRay), square * double(s.alone)};
}

}  // namespace lacuna
