// (theory.md, "Learned emission")
#include "libcore/guide/learn_emission.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "libcore/base/parallel.h"
#include "libcore/guide/grow_square.h"

namespace lacuna {

namespace {

using Sample = EmissionSamples::Sample;
using Index = std::uint32_t;

constexpr double kFewestOfLight = 64.0;     // effective samples from which a light has a tree
constexpr double kFewestOfPoints = 2000.0;  // from which a part of a light is halved
constexpr double kFewestOfRays = 8.0;       // and a part of its rays
constexpr int kMostPointLevels = 8, kMostRayLevels = 14;

struct Shape {
    double plainShare, virtualSamples;
};

/// Sums of second moments under plain emission.
struct Moments {
    double withRay = 0.0, alone = 0.0, squares = 0.0;

    void add(const Sample& s) {
        const PlainMoments m = plainMoments(s);
        withRay += m.withRay;
        alone += m.alone;
        squares += (m.withRay + m.alone) * (m.withRay + m.alone);
    }
    /// How many equal samples would know as much.
    double effective() const { return effectiveSamples(withRay + alone, squares); }
};

/// The answers to SquareGrower that are common to rays and points.
class Samples {
  public:
    explicit Samples(std::span<const Sample> samples) : samples_(samples) {}
    Moments momentsOf(std::span<const Index> of) const {
        Moments m;
        for (const Index i : of) m.add(samples_[i]);
        return m;
    }
    double effective(std::span<const Index> of) const { return momentsOf(of).effective(); }

  protected:
    std::span<const Sample> samples_;
};

class Rays : public Samples {
  public:
    using Samples::Samples;
    SquarePoint pointOf(Index i) const { return samples_[i].ray; }
    double leafMass(std::span<const Index> of, double size) const {
        return std::sqrt(momentsOf(of).withRay * size);
    }
    GrownSquare grow(std::span<Index> of, const Shape& shape) {
        return SquareGrower(*this,
                            {kFewestOfRays, kMostRayLevels, shape.virtualSamples, shape.plainShare})
            .grow(of);
    }
};

/// Points on a light. Every leaf with enough samples gets a tree of rays.
class Points : public Samples {
  public:
    Points(std::span<const Sample> samples, const Shape& shape,
           std::vector<SquareDensity>& rayTrees)
        : Samples(samples), shape_(shape), rays_(samples), rayTrees_(rayTrees) {}

    SquarePoint pointOf(Index i) const { return samples_[i].point; }
    double leafMass(std::span<Index> of, double size) {
        const Moments m = momentsOf(of);
        double ofRays = std::sqrt(m.withRay);
        Index tree = kNone;
        if (m.effective() >= kFewestOfLight) {
            GrownSquare grown = rays_.grow(of, shape_);
            ofRays = grown.mass;
            tree = Index(rayTrees_.size());
            rayTrees_.push_back(std::move(grown.density));
        }
        rayTree_.push_back(tree);
        return std::sqrt((m.alone + ofRays * ofRays) * size);
    }
    /// `levels` is zero for a light without an extent.
    GrownSquare grow(std::span<Index> of, int levels) {
        rayTree_.clear();
        return SquareGrower(*this,
                            {kFewestOfPoints, levels, shape_.virtualSamples, shape_.plainShare})
            .grow(of);
    }
    /// The tree of rays, or kNone, by leaf of the tree that was grown last.
    std::span<const Index> rayTree() const { return rayTree_; }

  private:
    const Shape& shape_;
    Rays rays_;
    std::vector<SquareDensity>& rayTrees_;
    std::vector<Index> rayTree_;
};

/// The mass of a light, and the effective samples that it comes from.
struct LightMass {
    double mass = 0.0, effective = 0.0;
};

/// Shares out the probability `whole` among lights, by halving their list again and again. Halves
/// with few samples share by power.
void shareOut(std::span<const LightMass> masses, std::span<const double> power, double whole,
              const Shape& shape, std::span<double> pmf) {
    if (masses.size() == 1) {
        pmf[0] = whole;
        return;
    }
    const std::size_t half = masses.size() / 2;
    double mass[2] = {0.0, 0.0}, watts[2] = {0.0, 0.0}, effective = 0.0;
    for (std::size_t i = 0; i < masses.size(); ++i) {
        mass[i >= half] += masses[i].mass;
        watts[i >= half] += power[i];
        effective += masses[i].effective;
    }
    const double allWatts = watts[0] + watts[1], allMass = mass[0] + mass[1];
    const double byPower = allWatts > 0.0 ? watts[0] / allWatts : 0.5;
    const double byMass = allMass > 0.0 ? mass[0] / allMass : byPower;
    // At most 1, in spite of rounding: a half without power must not get a negative probability.
    const double share =
        (effective * byMass + shape.virtualSamples * byPower) / (effective + shape.virtualSamples);
    const double lower = whole * share;
    shareOut(masses.first(half), power.first(half), lower, shape, pmf.first(half));
    shareOut(masses.subspan(half), power.subspan(half), whole - lower, shape, pmf.subspan(half));
}

EmissionGuide learn(const Lights& lights, std::span<const Sample> samples, const Shape& shape) {
    std::vector<Index> order(samples.size());
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(),
                     [&](Index a, Index b) { return samples[a].light < samples[b].light; });
    EmissionGuide guide;
    guide.pmf.assign(lights.size(), 0.0);
    guide.pointTree.assign(lights.size(), kNone);
    std::vector<LightMass> masses(lights.size());
    std::vector<double> power(lights.size());
    for (std::uint32_t l = 0; l < lights.size(); ++l) power[l] = lights.powerShare(l);
    Points points(samples, shape, guide.rays);
    for (std::size_t begin = 0; begin < order.size();) {
        const std::uint32_t light = samples[order[begin]].light;
        std::size_t end = begin;
        while (end < order.size() && samples[order[end]].light == light) ++end;
        const std::span of = std::span(order).subspan(begin, end - begin);
        begin = end;
        const Moments m = points.momentsOf(of);
        double mass = std::sqrt(m.withRay + m.alone);
        if (m.effective() >= kFewestOfLight) {
            GrownSquare tree =
                points.grow(of, isHittable(lights.kind(light)) ? kMostPointLevels : 0);
            mass = tree.mass;
            guide.pointTree[light] = Index(guide.points.size());
            guide.firstLeaf.push_back(Index(guide.rayTree.size()));
            guide.points.push_back(std::move(tree.density));
            const std::span<const Index> ofLeaves = points.rayTree();
            guide.rayTree.insert(guide.rayTree.end(), ofLeaves.begin(), ofLeaves.end());
        }
        masses[light] = {mass * std::sqrt(power[light]), m.effective()};
    }
    shareOut(masses, power, 1.0, shape, guide.pmf);
    for (std::uint32_t l = 0; l < lights.size(); ++l) {
        guide.pmf[l] = shape.plainShare * power[l] + (1.0 - shape.plainShare) * guide.pmf[l];
    }
    return guide;
}

/// Second moment of the samples under the guide, over that of plain emission.
double loss(const Lights& lights, const EmissionGuide& guide, std::span<const Sample> samples) {
    double plain = 0.0, guided = 0.0;
    for (const Sample& s : samples) {
        const double power = lights.powerShare(s.light);
        if (!(power > 0.0)) continue;
        const PlainMoments m = plainMoments(s);
        const EmissionGuide::Here here = guide.at(s.light, s.point);
        const double point = guide.pmf[s.light] / power * here.pdf;
        const double ray = here.rays ? here.rays->at(s.ray).pdf : 1.0;
        plain += m.withRay + m.alone;
        guided += (m.withRay / ray + m.alone) / point;
    }
    return plain > 0.0 ? guided / plain : 1.0;
}

}  // namespace

LearnedEmission learnEmission(const Lights& lights, const EmissionSamples& train,
                              const EmissionSamples& heldOut, const ThreadPool& pool) {
    if (lights.empty()) return {};  // there is nothing to choose from
    std::vector<Shape> shapes;
    for (const double plain : {0.1, 0.25}) {
        for (const double virtualSamples : {2.0, 8.0, 32.0, 128.0}) {
            shapes.push_back({plain, virtualSamples});
        }
    }
    std::vector<LearnedEmission> tries(shapes.size());
    pool.forEach(shapes.size(), [&](std::size_t n) {
        auto guide = std::make_shared<EmissionGuide>(learn(lights, train.samples(), shapes[n]));
        tries[n].heldOutLoss = loss(lights, *guide, heldOut.samples());
        tries[n].trainLoss = loss(lights, *guide, train.samples());
        tries[n].plainShare = shapes[n].plainShare;
        tries[n].virtualSamples = shapes[n].virtualSamples;
        tries[n].guide = std::move(guide);
    });
    LearnedEmission best;
    for (LearnedEmission& t : tries) {
        if (t.heldOutLoss < best.heldOutLoss) best = std::move(t);
    }
    return best;
}

}  // namespace lacuna
