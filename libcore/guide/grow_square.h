// Trees on the unit square that are grown from samples, for learned emission and guided walks. A part is halved as long
// as it has enough samples. Its probability is proportional to the root of its second moment times its size: then the
// sum of moment / probability is least. (theory.md, "Learned emission")
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "libcore/base/square_density.h"

namespace lacuna {

/// How many equal samples would know as much as samples with these sums of values and squares.
inline double effectiveSamples(double sum, double squares) {
    return squares > 0.0 ? sum * sum / squares : 0.0;
}

struct SquareShape {
    double fewest;  ///< effective samples from which a part is halved
    int mostLevels;
    double virtualSamples;  ///< for an even split, added to every split
    double evenShare;       ///< of the even density in a mixture with what was learned
};

struct GrownSquare {
    SquareDensity density;
    double mass;  ///< the root of the second moment that is left, all parts together
};

/// Grows a tree over the samples `of`, which are put in another order. It asks of samples, by index:
///
///     SquarePoint pointOf(Index)
///     double effective(std::span<const Index>)                 effective samples
///     double leafMass(std::span<Index>, double size)           sqrt(second moment * size); called in the
///                                                              order of the leaves' numbers
template <class Samples>
class SquareGrower {
  public:
    using Index = std::uint32_t;

    SquareGrower(Samples& samples, const SquareShape& shape) : samples_(samples), shape_(shape) {}

    GrownSquare grow(std::span<Index> of) {
        growing_.assign(1, {});
        leaves_ = 0;
        split(0, of, {0.0, 0.0}, {1.0, 1.0}, 0);
        std::vector<SquareDensity::Node> nodes(growing_.size());
        finish(0, 1.0, 1.0, nodes);
        return {SquareDensity(std::move(nodes)), growing_[0].mass};
    }

  private:
    static constexpr double kLeastProbability = 1e-6;  // of a half: rounding must not make it zero

    /// A node with its mass, which is not made a probability yet.
    struct GrowingNode {
        double mass = 0.0, effective = 0.0;
        std::uint32_t code = 0;
    };

    void split(std::size_t node, std::span<Index> of, SquarePoint low, SquarePoint size,
               int level) {
        const double effective = samples_.effective(std::span<const Index>(of));
        growing_[node].effective = effective;
        if (level == shape_.mostLevels || effective < shape_.fewest) {
            growing_[node].code = leaves_++;
            growing_[node].mass = samples_.leafMass(of, size[0] * size[1]);
            return;
        }
        const std::size_t axis = std::size_t(level) % 2;
        size[axis] *= 0.5;
        const double middle = low[axis] + size[axis];
        const auto upper = std::partition(
            of.begin(), of.end(), [&](Index i) { return samples_.pointOf(i)[axis] < middle; });
        const auto count = std::size_t(upper - of.begin());
        const std::size_t child = growing_.size();
        growing_.resize(child + 2);
        split(child, of.first(count), low, size, level + 1);
        low[axis] = middle;
        split(child + 1, of.subspan(count), low, size, level + 1);
        growing_[node].code = std::uint32_t(child) | SquareDensity::kInner |
                              (axis == 1 ? SquareDensity::kSecondAxis : 0);
        growing_[node].mass = growing_[child].mass + growing_[child + 1].mass;
    }

    /// Sets the probabilities below a node. `learned` is the learned probability of its part,
    /// `size` that of the even density.
    void finish(std::size_t node, double learned, double size,
                std::vector<SquareDensity::Node>& nodes) const {
        const GrowingNode& growing = growing_[node];
        nodes[node].code = growing.code;
        if (!(growing.code & SquareDensity::kInner)) return;
        const std::size_t child =
            growing.code & ~(SquareDensity::kInner | SquareDensity::kSecondAxis);
        const double lower = growing_[child].mass, upper = growing_[child + 1].mass;
        const double share = lower + upper > 0.0 ? lower / (lower + upper) : 0.5;
        const double n = growing.effective, v = shape_.virtualSamples;
        const double learnedLower = learned * (n * share + v * 0.5) / (n + v);
        const double even = shape_.evenShare;
        const double mixed = even * 0.5 * size + (1.0 - even) * learnedLower;
        const double all = even * size + (1.0 - even) * learned;
        nodes[node].lower =
            float(std::clamp(mixed / all, kLeastProbability, 1.0 - kLeastProbability));
        finish(child, learnedLower, 0.5 * size, nodes);
        finish(child + 1, learned - learnedLower, 0.5 * size, nodes);
    }

    Samples& samples_;
    SquareShape shape_;
    std::vector<GrowingNode> growing_;
    std::uint32_t leaves_ = 0;
};

}  // namespace lacuna
