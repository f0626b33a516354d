// Where walks go on to, learned from paths that reach the picture: by place, the directions towards the
// light for eye walks, and towards the camera for light walks. Frozen. (theory.md, "Guided walks")
//
// A tree halves the surfaces by place and normal down to regions. In each, both walks have a density of
// directions, and a share: so often a walk takes its direction from there, and otherwise from the BSDF,
//
//     p(to) = (1 - share) p_bsdf(to) + share p_region(to),
//
// a delta event only from the latter. Share and density depend on the vertex alone, so either walk knows
// what the other one would do.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "libcore/base/sampling.h"
#include "libcore/base/square_density.h"
#include "libcore/bidir/path.h"

namespace lacuna {

/// The directions of a region as points of the unit square, about an axis: evenly spread points are
/// cosine-distributed directions. First coordinate: the sine squared; where light passes the surfaces, the
/// lower half of the square is one side of them, the upper half the other. Second: turns about the axis.
class DirectionSquare {
  public:
    DirectionSquare() = default;
    DirectionSquare(const Vec3& axis, bool bothSides) : frame_(axis), bothSides_(bothSides) {}

    Vec3 axis() const { return frame_.n; }
    bool bothSides() const { return bothSides_; }
    /// Density per solid angle of a direction whose point has density one; zero where it has no point.
    float pdfW(const Vec3& direction) const {
        const float cosine = dot(direction, frame_.n);
        return bothSides_ ? 0.5f * kInvPi * std::abs(cosine) : kInvPi * std::max(0.0f, cosine);
    }
    SquarePoint pointOf(const Vec3& direction) const;
    Vec3 directionAt(SquarePoint point) const;

  private:
    Frame frame_;
    bool bothSides_ = false;
};

class WalkGuide {
  public:
    /// What one walk finds in a region.
    struct Field {
        float share = 0.0f;  ///< in [0, kMostShare]
        SquareDensity directions;
    };
    struct Region {
        DirectionSquare square;
        std::array<Field, 2> fields;  ///< by Side: of the walk that goes on

        const Field& of(Side side) const { return fields[std::size_t(side)]; }
        /// Density per solid angle.
        float pdfW(Side side, const Vec3& to) const {
            const float even = square.pdfW(to);
            return even > 0.0f ? even * float(of(side).directions.at(square.pointOf(to)).pdf)
                               : 0.0f;
        }
        Vec3 sample(Side side, float u1, float u2) const {
            return square.directionAt(of(side).directions.warp({double(u1), double(u2)}));
        }
    };
    /// A node of the tree compares one of the place's six numbers.
    struct Node {
        float threshold = 0.0f;  ///< smaller ones go to the first child
        std::uint32_t code =
            0;  ///< region: its number; else kInner, which number, first child's index
        friend bool operator==(const Node&, const Node&) = default;
    };
    static constexpr std::uint32_t kInner = 0x80000000u;
    static constexpr int kNumberShift = 28;
    static constexpr std::uint32_t kChildMask = (1u << kNumberShift) - 1;
    static constexpr float kMostShare = 0.9f;

    /// What a surface point is found by: its kind, its position, and its normal on the side that light
    /// leaves to (either side, where it passes).
    struct Place {
        std::uint32_t kind;
        std::array<float, 6> numbers;
    };
    /// Surfaces that let light pass are regions of their own, and those whose every lobe is narrow.
    static constexpr std::uint32_t kPasses = 1, kNarrow = 2, kKinds = 4;
    static Place placeOf(const PathVertex& surface);

    WalkGuide() = default;
    /// Nodes 0 .. kKinds - 1 are the roots; the two children of a node stand side by side, behind it.
    /// Throws std::invalid_argument for anything else.
    WalkGuide(std::vector<Node> nodes, std::vector<Region> regions);

    std::span<const Node> nodes() const { return nodes_; }
    std::span<const Region> regions() const { return regions_; }
    const Region& region(std::uint32_t number) const { return regions_[number]; }
    /// The same for the walks of one side alone.
    WalkGuide of(Side side) const;
    /// Adds to both densities of the BSDF what the guide does to them. `event`: of the pair.
    void mix(std::uint32_t region, const Vec3& toEye, const Vec3& toLight, ScatterEvent event,
             BsdfEvaluation& e) const;
    std::uint32_t regionAt(const Place& place) const {
        const Node* node = &nodes_[place.kind];
        while (node->code & kInner) {
            const float number = place.numbers[(node->code >> kNumberShift) & 7u];
            node = &nodes_[(node->code & kChildMask) + (number < node->threshold ? 0u : 1u)];
        }
        return node->code;
    }
    /// Of everything above, as hexadecimal digits.
    std::string contentHash() const;

  private:
    std::vector<Node> nodes_;
    std::vector<Region> regions_;
};

}  // namespace lacuna
