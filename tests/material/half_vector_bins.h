// Bins over all directions, and integrals over them, in the coordinates of the half vector about a
// normal, which resolve narrow and wide lobes alike. The Jacobian from half vectors to directions
// is computed numerically, so that it is independent of the formulas under test.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <optional>
#include <vector>

#include "tests/material/materials.h"

namespace lacuna::test {

class HalfVectorBins {
  public:
    static constexpr int kSectors = 8;
    static constexpr int kSteps = 14;  ///< midpoints per bin and axis

    /// Bins about `normal`. `from` must be on the same side of it as of ng.
    HalfVectorBins(const Case& c, Vec3 normal) : case_(c) {
        const Vec3d v = Vec3d(c.from);
        n_ = c.front ? Vec3d(normal) : -Vec3d(normal);
        Vec3d tangent = v - n_ * dot(v, n_);
        if (length(tangent) < 1e-6) {
            tangent = Vec3d(Frame(Vec3(n_)).s);
        }
        s_ = normalize(tangent - n_ * dot(tangent, n_));
        t_ = cross(n_, s_);
        v_ = {dot(v, s_), dot(v, t_), dot(v, n_)};
        double alpha = std::max(1e-4, std::pow(double(c.parameters.roughness), 2));
        if (c.parameters.anisotropy > 0) {
            alpha = std::max(1e-3, alpha);
            const Vec3d along(c.parameters.tangent);
            const Vec3d flat{dot(along, s_), dot(along, t_), 0};
            along_ = normalize(flat);
            stretch_ = 1 + (1 / alpha - 1) * std::pow(double(c.parameters.anisotropy), 2);
        }
        // GGX falls off with the fourth power of the slope: for small alpha, the rings' radii grow
        // by factors.
        for (double k : {0.3, 0.6, 1.0, 1.6, 3.0, 8.0, 24.0, 72.0, 216.0, 648.0}) {
            if (k <= 8 || alpha * k < 0.1) {
                edges_.push_back(std::atan(alpha * k));
            }
        }
        for (int degrees = 10; degrees <= 90; degrees += 10) {
            edges_.push_back(degrees * std::numbers::pi / 180);
        }
        edges_.push_back(0);
        std::sort(edges_.begin(), edges_.end());
        for (const double edge : edges_) tangents_.push_back(std::tan(edge));
        tangents_.back() = kInfinity;
        // Rounding to float destroys the half vector of grazing directions v and w, because v + w
        // is short. Then the core of a narrow lobe is one bin.
        const double core = 1e-7 / v_.z > 0.02 * alpha ? std::atan(8 * alpha) * 0.999 : 0;
        unresolved_ =
            std::size_t(std::upper_bound(edges_.begin(), edges_.end(), core) - edges_.begin() - 1);
        unresolved_ += core > 0 ? 1 : 0;
        const bool passes = c.parameters.transmission > 0 || c.parameters.diffuseTransmission > 0 ||
                            length(Vec3d(c.parameters.clearcoatNormal)) > 0;
        kinds_ = passes ? 2 : 1;
        eta_ = c.indexOn(!c.front) / c.indexOn(c.front);
        // ior 1 transmits straight: a delta, without half vectors
        if (!c.parameters.thin && eta_ == 1.0) {
            kinds_ = 1;
        }
    }

    std::size_t size() const { return std::size_t(kinds_) * (edges_.size() - 1) * kSectors; }

    /// Bin of a direction, or size() if it has no half vector here.
    std::size_t binOf(Vec3 toWorld) const {
        const Vec3d w = normalize(Vec3d(toWorld));
        Vec3d to{dot(w, s_), dot(w, t_), dot(w, n_)};
        const bool transmits = to.z < 0;
        Vec3d h;
        if (!transmits || case_.parameters.thin) {
            to.z = std::abs(to.z);
            h = v_ + to;
        } else {
            h = v_ + to * eta_;
            h = h.z < 0 ? -h : h;
        }
        if (transmits && kinds_ == 1) {
            return size();
        }
        h = stretched(h, 1 / stretch_);
        const double tangent = h.z > 0 ? std::sqrt(h.x * h.x + h.y * h.y) / h.z : kInfinity;
        const auto at = std::upper_bound(tangents_.begin(), tangents_.end(), tangent);
        const std::size_t ring = std::clamp<std::ptrdiff_t>(at - tangents_.begin() - 1, 0,
                                                            std::ptrdiff_t(edges_.size()) - 2);
        return index(transmits ? 1 : 0, ring, sectorOf(h.x, h.y));
    }

    /// Calls visit(bin, to, solid angle) for the midpoints of all bins.
    template <class Visit>
    void integrate(const Visit& visit) const {
        const double dPhi = 2 * std::numbers::pi / kSectors / kSteps;
        std::vector<Angle> phis;
        for (int b = 0; b < kSectors * kSteps; ++b) {
            phis.emplace_back((b + 0.5) * dPhi - std::numbers::pi, dPhi);
        }
        for (int kind = 0; kind < kinds_; ++kind) {
            for (std::size_t ring = 0; ring + 1 < edges_.size(); ++ring) {
                const double dTheta = (edges_[ring + 1] - edges_[ring]) / kSteps;
                for (int a = 0; a < kSteps; ++a) {
                    const Angle theta(edges_[ring] + (a + 0.5) * dTheta, dTheta);
                    for (int b = 0; b < kSectors * kSteps; ++b) {
                        const Angle& phi = phis[std::size_t(b)];
                        Vec3d to;
                        if (!direction(kind, theta.at, phi.at, to)) {
                            continue;
                        }
                        const double solidAngle =
                            jacobian(kind, theta, phi, to) * theta.width * phi.width;
                        const std::size_t bin =
                            index(std::size_t(kind), ring, std::size_t(b / kSteps));
                        visit(bin, Vec3(s_ * to.x + t_ * to.y + n_ * to.z), solidAngle);
                    }
                }
            }
        }
    }

  private:
    static constexpr double kInfinity = std::numeric_limits<double>::infinity();

    /// The octant of the circle, counted from -pi.
    static std::size_t sectorOf(double x, double y) {
        static_assert(kSectors == 8);
        const bool steep = std::abs(y) > std::abs(x);
        if (y < 0) return x < 0 ? (steep ? 1 : 0) : (steep ? 2 : 3);
        return x < 0 ? (steep ? 6 : 7) : (steep ? 5 : 4);
    }
    std::size_t index(std::size_t kind, std::size_t ring, std::size_t sector) const {
        const bool merged = ring < unresolved_;
        return (kind * (edges_.size() - 1) + (merged ? 0 : ring)) * kSectors +
               (merged ? 0 : sector);
    }
    struct SineCosine {
        explicit SineCosine(double angle) : sine(std::sin(angle)), cosine(std::cos(angle)) {}
        double sine, cosine;
    };
    /// The centre of an interval and two points beside it, for a numerical derivative.
    struct Angle {
        static constexpr double kStep = 1e-4;  ///< share of the width
        Angle(double middle, double wide)
            : width(wide), at(middle), less(middle - wide * kStep), more(middle + wide * kStep) {}
        double width;
        SineCosine at, less, more;
    };

    /// Bins are in the half vectors of a surface that is as rough along its grain as across it.
    Vec3d stretched(Vec3d h, double by) const { return h + along_ * ((by - 1) * dot(h, along_)); }

    /// The direction for a half vector, given by its angles; false if there is none.
    bool direction(int kind, const SineCosine& theta, const SineCosine& phi, Vec3d& to) const {
        const Vec3d h = normalize(
            stretched({theta.sine * phi.cosine, theta.sine * phi.sine, theta.cosine}, stretch_));
        const double vh = dot(v_, h);
        if (vh <= 0) {
            return false;
        }
        if (kind == 0 || case_.parameters.thin) {
            to = h * (2 * vh) - v_;
            const bool above = to.z > 0;
            to.z = kind == 0 ? to.z : -to.z;
            return above;
        }
        const double sine2 = (1 - vh * vh) / (eta_ * eta_);
        if (sine2 >= 1) {
            return false;
        }
        to = h * (vh / eta_ - std::sqrt(1 - sine2)) - v_ * (1 / eta_);
        return to.z < 0;
    }
    double jacobian(int kind, const Angle& theta, const Angle& phi, const Vec3d& at) const {
        const auto difference = [&](const SineCosine& moreTheta, const SineCosine& morePhi,
                                    const SineCosine& lessTheta, const SineCosine& lessPhi) {
            Vec3d plus, minus;
            const bool hasPlus = direction(kind, moreTheta, morePhi, plus);
            const bool hasMinus = direction(kind, lessTheta, lessPhi, minus);
            // `direction` sets its result also for a reflection beyond the horizon, but not in
            // other failures.
            if (hasPlus && hasMinus) {
                return (plus - minus) * 0.5;
            }
            return hasPlus ? plus - at : hasMinus ? at - minus : Vec3d{};
        };
        const Vec3d a = difference(theta.more, phi.at, theta.less, phi.at);
        const Vec3d b = difference(theta.at, phi.more, theta.at, phi.less);
        return length(cross(a, b)) / (theta.width * phi.width * Angle::kStep * Angle::kStep);
    }

    const Case& case_;
    Vec3d s_, t_, n_, v_;
    Vec3d along_{1, 0, 0};
    double stretch_ = 1;
    double eta_ = 1;
    int kinds_ = 1;
    std::vector<double> edges_, tangents_;
    std::size_t unresolved_ = 0;  ///< number of innermost rings merged to one bin
};

/// Bins for lobes about both normals. Each direction is shared, with smooth weights, by one bin
/// about each normal, so that each lobe lies mainly in the bins about its own normal.
class TwoNormalBins {
  public:
    explicit TwoNormalBins(const Case& c) : case_(c) {
        const Vec3d ng(c.bsdf.ng()), ns(c.bsdf.ns()), from(c.from);
        // An eye may see only the lobes about one normal.
        const double eyeNg = c.side == Side::Eye ? shareOfNg(from, ng, ns) : 0.5;
        if (eyeNg > 0 && c.tilted) ng_.emplace(c, c.bsdf.ng());
        if (eyeNg < 1 && dot(from, ns) * dot(from, ng) > 0) ns_.emplace(c, c.bsdf.ns());
    }

    std::size_t size() const { return ngSize() + (ns_ ? ns_->size() : 0); }

    /// Bin of a direction, or size() if it has no half vector here. `u` selects one of its two
    /// bins.
    std::size_t binOf(Vec3 to, double u) const {
        if (u < shareOfNs(to)) return ngSize() + ns_->binOf(to);
        const std::size_t bin = ng_->binOf(to);
        return bin < ngSize() ? bin : size();
    }

    /// Calls visit(bin, to, solid angle) for the midpoints of all bins.
    template <class Visit>
    void integrate(const Visit& visit) const {
        if (ng_) {
            ng_->integrate([&](std::size_t bin, Vec3 to, double solidAngle) {
                visit(bin, to, (1 - shareOfNs(to)) * solidAngle);
            });
        }
        if (ns_) {
            ns_->integrate([&](std::size_t bin, Vec3 to, double solidAngle) {
                visit(ngSize() + bin, to, shareOfNs(to) * solidAngle);
            });
        }
    }

  private:
    std::size_t ngSize() const { return ng_ ? ng_->size() : 0; }
    double shareOfNs(Vec3 to) const {
        if (!ns_) return 0;
        if (!ng_) return 1;
        const Vec3d ng(case_.bsdf.ng()), ns(case_.bsdf.ns()), v(case_.from);
        const Vec3d w = normalize(Vec3d(to));
        // Bins about a normal do not cover directions that ng and ns put on different sides.
        if (dot(w, ng) * dot(w, ns) <= 0) return 0;
        const bool toFront = dot(w, ng) > 0;
        // The cosine between a normal and the half vector about it.
        const auto cosine = [&](Vec3d n) {
            n = case_.front ? n : -n;
            if (toFront == case_.front) return dot(normalize(v + w), n);
            if (case_.parameters.thin) return dot(normalize(v + w - n * (2 * dot(w, n))), n);
            const double from = case_.indexOn(case_.front), into = case_.indexOn(toFront);
            return dot(normalize(v * from + w * into), n) * (into > from ? -1 : 1);
        };
        const double aboutNs = cosine(ns), aboutNg = cosine(ng);
        // If no microfacet about a normal refracts one direction to the other, only the other
        // normal has a bin.
        if (aboutNs <= 0) return 0;
        if (aboutNg <= 0) return 1;
        const double toNs = std::pow(1 - aboutNs, 2), toNg = std::pow(1 - aboutNg, 2);
        return toNg / (toNs + toNg);
    }

    const Case& case_;
    std::optional<HalfVectorBins> ng_, ns_;
};

}  // namespace lacuna::test
