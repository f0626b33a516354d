// A guide for where walks go on to, learned from paths that reach the picture. By place, it has the directions towards
// the light for eye walks, and towards the camera for light walks. It is frozen. (theory.md, "Guided walks")
//
// A tree splits the surfaces by place and normal into regions. For each of the two walks a region has a density of
// directions and a share. The share is the probability that a walk takes its direction from that density, and not
// from the BSDF:
//
//     p(to) = (1 - share) p_bsdf(to) + share p_region(to),
//
// where a delta event has the first term alone. Share and density depend on the vertex alone, so either walk knows what
// the other one would do.
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

/// Maps the directions of a region, about an axis, to points of the unit square. Evenly spread points are
/// cosine-distributed directions. The first coordinate is the squared sine of the angle to the axis. Where light passes
/// the surfaces, its lower half is for one side of them and its upper half for the other. The second coordinate is the
/// angle about the axis, in turns.
class DirectionSquare {
  public:
    DirectionSquare() = default;
    DirectionSquare(const Vec3& axis, bool bothSides) : frame_(axis), bothSides_(bothSides) {}

    Vec3 axis() const { return frame_.n; }
    bool bothSides() const { return bothSides_; }
    /// Density (pdfW) of a direction whose point has density one. Zero where the direction has no point.
    float pdfW(const Vec3& direction) const {
        const float cosine = dot(direction, frame_.n);
        return bothSides_ ? 0.5f * kInvPi * std::abs(cosine) : kInvPi * std::max(0.0f, cosine);
    }
    /// The point of a unit direction that has one.
    SquarePoint pointOf(const Vec3& direction) const;
    /// The unit direction of a point.
    Vec3 directionAt(SquarePoint point) const;

  private:
    Frame frame_;
    bool bothSides_ = false;
};

class WalkGuide {
  public:
    /// The data of a region for one of the two walks.
    struct Field {
        float share = 0.0f;  ///< in [0, kMostShare]
        SquareDensity directions;
    };
    struct Region {
        DirectionSquare square;
        std::array<Field, 2> fields;  ///< by Side: of the walk that goes on

        const Field& of(Side side) const { return fields[std::size_t(side)]; }
        /// Density (pdfW) of the direction `to` by the region's field.
        float pdfW(Side side, const Vec3& to) const {
            const float even = square.pdfW(to);
            return even > 0.0f ? even * float(of(side).directions.at(square.pointOf(to)).pdf)
                               : 0.0f;
        }
        /// Draws a unit direction with the density pdfW(side, .); u1, u2 in [0, 1).
        Vec3 sample(Side side, float u1, float u2) const {
            return square.directionAt(of(side).directions.warp({double(u1), double(u2)}));
        }
    };
    /// A node of the tree compares one of the place's six numbers.
    struct Node {
        float threshold = 0.0f;  ///< smaller ones go to the first child
        std::uint32_t code = 0;  ///< a region, or kInner, the number compared, the first child
        friend bool operator==(const Node&, const Node&) = default;
    };
    static constexpr std::uint32_t kInner = 0x80000000u;
    static constexpr int kNumberShift = 28;
    static constexpr std::uint32_t kChildMask = (1u << kNumberShift) - 1;
    static constexpr float kMostShare = 0.9f;

    /// The key that a surface point is found by: its kind, its position, and its normal on the side that light leaves
    /// to (on either side, where light passes).
    struct Place {
        std::uint32_t kind;
        std::array<float, 6> numbers;
    };
    /// Surfaces that let light pass have regions of their own, and so have surfaces whose lobes
    /// are all narrow.
    static constexpr std::uint32_t kPasses = 1, kNarrow = 2, kKinds = 4;
    /// The place of a surface vertex, the same for either walk's vertex.
    static Place placeOf(const PathVertex& surface);

    WalkGuide() = default;
    /// Nodes 0 .. kKinds - 1 are the roots; the two children of a node stand side by side, behind it.
    /// Throws std::invalid_argument for anything else.
    WalkGuide(std::vector<Node> nodes, std::vector<Region> regions);

    std::span<const Node> nodes() const { return nodes_; }
    std::span<const Region> regions() const { return regions_; }
    const Region& region(std::uint32_t number) const { return regions_[number]; }
    /// The guide for the walks of one side alone.
    WalkGuide of(Side side) const;
    /// Mixes the guide into both densities (pdfW) of the BSDF. `event` is that of the pair
    /// of directions.
    void mix(std::uint32_t region, const Vec3& toEye, const Vec3& toLight, ScatterEvent event,
             BsdfEvaluation& e) const;
    /// The index of the region of a place.
    std::uint32_t regionAt(const Place& place) const {
        const Node* node = &nodes_[place.kind];
        while (node->code & kInner) {
            const float number = place.numbers[(node->code >> kNumberShift) & 7u];
            node = &nodes_[(node->code & kChildMask) + (number < node->threshold ? 0u : 1u)];
        }
        return node->code;
    }
    /// Hash of all nodes and regions, as hexadecimal digits.
    std::string contentHash() const;

  private:
    std::vector<Node> nodes_;
    std::vector<Region> regions_;
};

}  // namespace lacuna
