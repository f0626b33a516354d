#include "libcore/guide/learn_emission.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "libcore/base/parallel.h"

namespace lacuna {

namespace {

using Sample = EmissionSamples::Sample;
using Index = std::uint32_t;

constexpr double kFewestOfLight = 64.0;     // effective samples from which a light has a tree
constexpr double kFewestOfPoints = 2000.0;  // from which a part of a light is halved
constexpr double kFewestOfRays = 8.0;       // and a part of its rays
constexpr int kMostPointLevels = 8, kMostRayLevels = 14;
constexpr double kLeastProbability = 1e-6;  // of either half: rounding must not make it zero

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
    /// How many samples of one size would know as much.
    double effective() const {
        const double sum = withRay + alone;
        return squares > 0.0 ? sum * sum / squares : 0.0;
    }
};

/// Grows trees over some samples. A part of a square gets a share in proportion to the root of its
/// second moment times its size: that is where sum of moment / probability is least.
class Grower {
  public:
    Grower(std::span<const Sample> samples, const Shape& shape)
        : samples_(samples), shape_(shape) {}

    struct Tree {
        SquareDensity density;
        double mass;  // the root of the second moment that is left, all parts together
        std::vector<Index> rayTree;  // of points: by leaf
    };
    Tree rays(std::span<Index> of) {
        return grow(of, &Sample::ray, kFewestOfRays, kMostRayLevels, {});
    }
    /// `levels`: none for a light without an extent.
    Tree points(std::span<Index> of, int levels, std::vector<SquareDensity>& rayTrees) {
        return grow(of, &Sample::point, kFewestOfPoints, levels, &rayTrees);
    }
    Moments momentsOf(std::span<const Index> of) const {
        Moments m;
        for (const Index i : of) m.add(samples_[i]);
        return m;
    }

  private:
    /// A tree whose nodes know masses, before they are made probabilities.
    struct Part {
        double mass = 0.0, effective = 0.0;
        std::uint32_t code = 0;
    };
    struct Growth {
        SquarePoint Sample::*where;
        double fewest;
        int mostLevels;
        std::vector<SquareDensity>* rayTrees;  // null: these are rays
        std::vector<Part> parts = {};
        std::vector<Index> rayTree = {};
        std::uint32_t leaves = 0;
    };

    Tree grow(std::span<Index> of, SquarePoint Sample::*where, double fewest, int mostLevels,
              std::vector<SquareDensity>* rayTrees) {
        Growth g{where, fewest, mostLevels, rayTrees};
        g.parts.emplace_back();
        split(g, 0, of, {0.0, 0.0}, {1.0, 1.0}, 0);
        std::vector<SquareDensity::Node> nodes(g.parts.size());
        finish(g, 0, 1.0, 1.0, nodes);
        return {SquareDensity(std::move(nodes)), g.parts[0].mass, std::move(g.rayTree)};
    }

    void split(Growth& g, std::size_t node, std::span<Index> of, SquarePoint low, SquarePoint size,
               int level) {
        const Moments m = momentsOf(of);
        g.parts[node].effective = m.effective();
        if (level == g.mostLevels || m.effective() < g.fewest) {
            g.parts[node].code = g.leaves++;
            g.parts[node].mass = leafMass(g, of, m, size[0] * size[1]);
            return;
        }
        const std::size_t axis = std::size_t(level) % 2;
        size[axis] *= 0.5;
        const double middle = low[axis] + size[axis];
        const auto upper = std::partition(
            of.begin(), of.end(), [&](Index i) { return (samples_[i].*g.where)[axis] < middle; });
        const auto count = std::size_t(upper - of.begin());
        const std::size_t child = g.parts.size();
        g.parts.resize(child + 2);
        split(g, child, of.first(count), low, size, level + 1);
        low[axis] = middle;
        split(g, child + 1, of.subspan(count), low, size, level + 1);
        g.parts[node].code = std::uint32_t(child) | SquareDensity::kInner |
                             (axis == 1 ? SquareDensity::kSecondAxis : 0);
        g.parts[node].mass = g.parts[child].mass + g.parts[child + 1].mass;
    }

    double leafMass(Growth& g, std::span<Index> of, const Moments& m, double size) {
        if (!g.rayTrees) return std::sqrt(m.withRay * size);
        double ofRays = std::sqrt(m.withRay);
        Index tree = kNone;
        if (m.effective() >= kFewestOfLight) {
            Tree rayTree = rays(of);
            ofRays = rayTree.mass;
            tree = Index(g.rayTrees->size());
            g.rayTrees->push_back(std::move(rayTree.density));
        }
        g.rayTree.push_back(tree);
        return std::sqrt((m.alone + ofRays * ofRays) * size);
    }

    /// `learned`, `size`: of the node's part, without and with the share of plain emission to come.
    void finish(const Growth& g, std::size_t node, double learned, double size,
                std::vector<SquareDensity::Node>& nodes) const {
        const Part& part = g.parts[node];
        nodes[node].code = part.code;
        if (!(part.code & SquareDensity::kInner)) return;
        const std::size_t child = part.code & ~(SquareDensity::kInner | SquareDensity::kSecondAxis);
        const double lower = g.parts[child].mass, upper = g.parts[child + 1].mass;
        const double share = lower + upper > 0.0 ? lower / (lower + upper) : 0.5;
        const double n = part.effective, v = shape_.virtualSamples;
        const double learnedLower = learned * (n * share + v * 0.5) / (n + v);
        const double plain = shape_.plainShare;
        const double mixed = plain * 0.5 * size + (1.0 - plain) * learnedLower;
        const double all = plain * size + (1.0 - plain) * learned;
        nodes[node].lower =
            float(std::clamp(mixed / all, kLeastProbability, 1.0 - kLeastProbability));
        finish(g, child, learnedLower, 0.5 * size, nodes);
        finish(g, child + 1, learned - learnedLower, 0.5 * size, nodes);
    }

    std::span<const Sample> samples_;
    Shape shape_;
};

/// By light: what speaks for it.
struct LightMass {
    double mass = 0.0, effective = 0.0;
};

/// Shares out the probability of lights [begin, end): halves by halves, those of few samples as
/// their power says.
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
    const double lower = whole * (effective * byMass + shape.virtualSamples * byPower) /
                         (effective + shape.virtualSamples);
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
    Grower grower(samples, shape);
    for (std::size_t begin = 0; begin < order.size();) {
        const std::uint32_t light = samples[order[begin]].light;
        std::size_t end = begin;
        while (end < order.size() && samples[order[end]].light == light) ++end;
        const std::span of = std::span(order).subspan(begin, end - begin);
        begin = end;
        const Moments m = grower.momentsOf(of);
        double mass = std::sqrt(m.withRay + m.alone);
        if (m.effective() >= kFewestOfLight) {
            Grower::Tree tree = grower.points(
                of, isHittable(lights.kind(light)) ? kMostPointLevels : 0, guide.rays);
            mass = tree.mass;
            guide.pointTree[light] = Index(guide.points.size());
            guide.firstLeaf.push_back(Index(guide.rayTree.size()));
            guide.points.push_back(std::move(tree.density));
            guide.rayTree.insert(guide.rayTree.end(), tree.rayTree.begin(), tree.rayTree.end());
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
