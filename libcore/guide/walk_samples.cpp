// (theory.md, "Guided walks")
#include "libcore/guide/walk_samples.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace lacuna {

namespace {
constexpr double kLeastWeight = 1e-6;  // of a step, over that of all strategies: rounding of sums
}

void WalkSamples::add(FullPath& path, const TechniqueCounts& counts, const Walker& walker,
                      const TechniqueWorth& worth, float contribution, std::uint32_t pixel) {
    const int k = path.edges;
    if (!(contribution > 0.0f) || !std::isfinite(contribution) || k < 2) return;
    std::array<double, std::size_t(kMaxEdges) + 2> upTo;  // W w of strategies 1 .. t
    upTo[0] = 0.0;
    for (int t = 1; t <= k + 1; ++t) {
        upTo[std::size_t(t)] = upTo[std::size_t(t) - 1] + worth(t, k) * misWeight(path, counts, t);
    }
    const double all = upTo[std::size_t(k) + 1];
    if (!(all > 0.0)) return;
    contribution = float(double(contribution) / all);
    const auto first = std::uint32_t(steps_.size());
    for (int i = 1; i < k; ++i) {
        const PathVertex& v = *path.vertex[std::size_t(i)];
        if (v.kind != VertexKind::Surface || !v.connectable()) continue;
        const bool delta = path.delta[std::size_t(i)];
        const ScatterEvent event = delta ? v.event : ScatterEvent::Smooth;
        const Vec3 toEye = path.directionOf(i), toLight = -path.directionOf(i - 1);
        const BsdfEvaluation plain = v.bsdf.evaluate(toEye, toLight, event);
        const BsdfEvaluation found = walker.scattering(v, toEye, toLight, event);
        const auto put = [&](Side side, const Vec3& to, double weight, float pdfBsdf,
                             float pdfFound) {
            if (!(weight > kLeastWeight * all) || !(pdfFound > 0.0f)) return;
            steps_.push_back(
                {WalkGuide::placeOf(v), to, float(weight), pdfBsdf, pdfFound, side, delta});
        };
        // Eye walks that came to x_{i-1}, light walks that came to x_{i+1}.
        put(Side::Eye, toLight, all - upTo[std::size_t(k - i) + 1], plain.pdfWToLight,
            found.pdfWToLight);
        put(Side::Light, toEye, upTo[std::size_t(std::max(0, k - 1 - i))], plain.pdfWToEye,
            found.pdfWToEye);
    }
    const auto count = std::uint32_t(steps_.size()) - first;
    if (count > 0) paths_.push_back({pixel, first, count, contribution});
}

void WalkSamples::append(const WalkSamples& other, std::size_t index) {
    const Path& path = other.paths_[index];
    put(path.pixel, path.contribution, other.steps(path));
}

void WalkSamples::put(std::uint32_t pixel, float contribution, std::span<const Step> steps) {
    paths_.push_back(
        {pixel, std::uint32_t(steps_.size()), std::uint32_t(steps.size()), contribution});
    steps_.insert(steps_.end(), steps.begin(), steps.end());
}

void WalkSamples::relate(const PixelScale& scale) {
    for (Path& p : paths_) p.contribution = float(double(p.contribution) / scale.of(p.pixel));
}

float WalkSamples::outlierLimit() const {
    std::vector<float> contributions;
    for (const Path& p : paths_) contributions.push_back(p.contribution);
    return lacuna::outlierLimit(contributions);
}

void WalkSamples::lowerTo(float limit) {
    for (Path& p : paths_) p.contribution = std::min(p.contribution, limit);
}

double momentOf(const WalkSamples::Path& path, const WalkSamples::Step& step) {
    const double g = double(path.contribution);
    return g * g * double(step.weight) * double(step.pdfFound);
}

}  // namespace lacuna
