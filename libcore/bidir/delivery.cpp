#include "libcore/bidir/delivery.h"

#include "libcore/bidir/known_ways.h"

namespace lacuna {

namespace {
constexpr std::size_t kReplaysKept = IterationStatistics::kReplaysKept;

TechniqueGroup groupOf(const Contribution& c) {
    const Technique made = c.closed.technique;
    const int s = made.firstOfEye(c.path.edges), order = c.path.orderOf(s);
    switch (made.by) {
        case Technique::By::Merge:
            return TechniqueGroup::ofMerge(order);
        case Technique::By::Chain:
            return TechniqueGroup::ofChain(order);
        case Technique::By::Refraction:
            return TechniqueGroup::ofRefraction(order);
        case Technique::By::Strategy:
            break;
    }
    return TechniqueGroup::of(s, made.t, order);
}

}  // namespace

PathObserver Delivery::setObserver(PathObserver observer) {
    return std::exchange(observer_, std::move(observer));
}

Delivery::Weighed Delivery::weigh(const Contribution& c, const TechniqueCounts& counts,
                                  RayTally& tally) const {
    const Lights& lights = setup_.walker.lights();
    if (!c.closed.technique.refracts()) c.path.refracted = refractedRatioOf(c.path, counts, tally);
    const double weight = misWeight(c.path, counts, c.closed.technique);
    const Rgb scaled = c.closed.contribution * float(c.scale);
    return {weight, lights.inFileUnits(scaled * float(weight)),
            techniqueFilm_ ? lights.inFileUnits(scaled) : Rgb{}};
}

void Delivery::observe(const Contribution& c, const TechniqueCounts& counts,
                       const Weighed& w) const {
    if (!observer_) return;
    observer_(
        {c.path, c.closed.technique, w.weight, w.value, c.pixel, c.proposal, counts, c.sample});
}

void Delivery::countInvalid(const Sample& sample, TaskResult& result) const {
    ++result.invalidSamples;
    if (result.invalidReplays.size() < kReplaysKept) {
        result.invalidReplays.push_back(sample.address(setup_.camera.film().width));
    }
}

Rgb Delivery::toOwnPixel(const Contribution& c, const TechniqueCounts& counts, Rgb* pixel,
                         TaskResult& result) const {
    if (isBackground(c.path)) return {};
    const Weighed w = weigh(c, counts, result.tally);
    // Nothing is lost of a pixel that nobody sees: the value is what a borrower chooses by, and who
    // takes the end weighs it anew.
    if (!pixel) return isFinite(w.value) ? w.value : Rgb{};
    observe(c, counts, w);
    // Values that are finite may add up to more than a float holds.
    const Rgb sum = *pixel + w.value;
    if (!isFinite(sum)) {
        countInvalid(c.sample, result);
        return {};
    }
    *pixel = sum;
    if (layerFilm_) {
        for (const auto& share : sharesOf(c.path, w.value, result)) layerFilm_->add(share, c.pixel);
    }
    if (techniqueFilm_) {
        const int t = c.closed.technique.t, s = c.closed.technique.firstOfEye(c.path.edges);
        techniqueFilm_->add({s, t, groupOf(c), c.pixel, w.value, w.unweighted});
    }
    return w.value;
}

void Delivery::toSplats(const Contribution& c, const TechniqueCounts& counts,
                        TaskResult& result) const {
    if (isBackground(c.path)) return;
    const Weighed w = weigh(c, counts, result.tally);
    observe(c, counts, w);
    if (!isFinite(w.value)) return countInvalid(c.sample, result);
    result.splats.push_back({c.pixel, w.value});
    result.splatPaths.push_back(c.sample.number);
    if (layerFilm_) {
        for (const auto& share : sharesOf(c.path, w.value, result)) {
            result.layerSplats.push_back({c.pixel, share});
        }
    }
    if (techniqueFilm_) {
        result.techniqueSplats.push_back({c.path.edges, 1, {}, c.pixel, w.value, w.unweighted});
    }
}

void Delivery::collect(std::span<TaskResult> results, IterationStatistics& statistics) {
    for (TaskResult& result : results) {
        statistics.add(result.tally);
        statistics.invalidSamples += result.invalidSamples;
        for (std::string& replay : result.invalidReplays) {
            if (statistics.invalidReplays.size() < kReplaysKept) {
                statistics.invalidReplays.push_back(std::move(replay));
            }
        }
        for (const TechniqueSample& t : result.techniqueSplats) techniqueFilm_->add(t);
        for (const LayerSplat& splat : result.layerSplats)
            layerFilm_->add(splat.share, splat.pixel);
        statistics.add(result.clock.seconds());
        recorded_.insert(recorded_.end(), result.rays.begin(), result.rays.end());
    }
}

void Delivery::addSplats(std::span<TaskResult> results, const Iteration& iteration) const {
    std::vector<std::vector<Splat>> splats;
    for (TaskResult& result : results) splats.push_back(std::move(result.splats));
    const std::uint64_t leftOut = lacuna::addSplats(splats, iteration.pixels, setup_.threads);
    IterationStatistics& statistics = iteration.statistics;
    statistics.invalidSamples += leftOut;
    // Name the splats whose sums are too large: they do not fit on top of the pixel's value.
    for (std::size_t r = 0; leftOut > 0 && r < results.size(); ++r) {
        for (std::size_t i = 0; i < splats[r].size(); ++i) {
            if (statistics.invalidReplays.size() == kReplaysKept) return;
            if (isFinite(iteration.pixels[splats[r][i].pixel] + splats[r][i].value)) continue;
            const Sample sample{iteration.number, true, results[r].splatPaths[i]};
            statistics.invalidReplays.push_back(sample.address(setup_.camera.film().width));
        }
    }
}

}  // namespace lacuna
