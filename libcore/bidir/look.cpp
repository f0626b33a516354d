#include "libcore/bidir/look.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "libcore/bidir/absorption.h"

namespace lacuna {

namespace {

constexpr int kMostEvents = 8;
constexpr float kFaint = 0.04f;  // share of the ray: what one side of a window reflects

Rgb atMostOne(const Rgb& c) {
    return {std::min(c.r, 1.0f), std::min(c.g, 1.0f), std::min(c.b, 1.0f)};
}

/// One of the rays that mirrors and glass split a ray into, followed backwards from the eye.
struct SplitRay {
    Rgb weight;   ///< throughput to the eye, by channel
    float share;  ///< of the first ray; the shares of all rays add up to 1
    int events = 0;
};

/// The direction that a delta event leads to, and the share of the light from there that
/// comes through.
struct Branch {
    Vec3 direction;
    Rgb through;
};

class Looker {
  public:
    Looker(const Scene& scene, RayTally& tally) : scene_(scene), tally_(tally) {}

    void follow(const Vec3& direction, const SurfacePoint& point, const SplitRay& ray) {
        const Bsdf bsdf = scene_.bsdfAt(point);
        const Vec3 normal = dot(bsdf.ns(), direction) > 0.0f ? -bsdf.ns() : bsdf.ns();
        if (bsdf.connectable()) {
            end(ray, atMostOne(bsdf.layerAlbedo()), normal);
            return;
        }
        if (ray.events == kMostEvents || ray.share < kFaint) {
            end(ray, Rgb(1.0f), normal);
            return;
        }
        const std::array<Branch, 2> branches = eventsAt(bsdf, -direction);
        const float whole = mean(branches[0].through) + mean(branches[1].through);
        if (!(whole > 0.0f)) {
            end(ray, Rgb{}, normal);
            return;
        }
        for (const Branch& b : branches) {
            const float share = ray.share * (mean(b.through) / whole);
            if (share > 0.0f) goOn(point, b, {ray.weight * b.through, share, ray.events + 1});
        }
    }

    Look look() const { return {atMostOne(sum_.albedo), sum_.normal}; }

  private:
    void end(const SplitRay& ray, const Rgb& albedo, const Vec3& normal) {
        sum_.albedo += ray.weight * albedo;
        sum_.normal += normal * ray.share;
    }

    void goOn(const SurfacePoint& from, const Branch& branch, SplitRay ray) {
        const Sight sight{from.position, from.ng, branch.direction, RayKind::EyeWalk};
        const auto next = firstSeen(scene_, sight, tally_);
        if (!next) return;
        ray.weight *= transmittance(from, branch.direction, *next);
        follow(branch.direction, *next, ray);
    }

    /// The delta reflection and, where light passes, the delta transmission. The two ends of the range of uLobe, the
    /// number that draws the lobe, give them. `through` of a missing branch is black.
    static std::array<Branch, 2> eventsAt(const Bsdf& bsdf, const Vec3& toEye) {
        std::array<Branch, 2> branches;
        bool transmits = false;
        for (std::size_t i = 0; i < 2; ++i) {
            const float uLobe = i == 0 ? 0.0f : 0x1.fffffep-1f;
            const auto sample = bsdf.sample(Side::Eye, toEye, uLobe, 0.5f, 0.5f);
            if (!sample) continue;
            const bool passes = sample->event == ScatterEvent::DeltaTransmission;
            if (i == 1 && passes == transmits && !isBlack(branches[0].through))
                break;  // the same event
            transmits = passes;
            branches[i] = {sample->to, through(bsdf, *sample, toEye)};
        }
        return branches;
    }

    /// Reflectance or transmittance: the generalised f (bsdf.h) without cosines and indices.
    static Rgb through(const Bsdf& bsdf, const BsdfSample& sample, const Vec3& toEye) {
        const Rgb& f = sample.evaluation.f;
        const bool passes = sample.event == ScatterEvent::DeltaTransmission;
        if (passes && !bsdf.bends()) return atMostOne(f);
        const float cosine = std::fabs(dot(sample.to, bsdf.ns()));
        const float index = passes ? bsdf.indexOn(dot(toEye, bsdf.ng()) > 0.0f) : 1.0f;
        const float scale = std::fabs(dot(sample.to, bsdf.ng())) / std::max(kMinCosine, cosine);
        return atMostOne(f * (scale / (index * index)));
    }

    Rgb transmittance(const SurfacePoint& from, const Vec3& direction,
                      const SurfacePoint& to) const {
        if (scene_.absorption().empty()) return Rgb(1.0f);
        const auto end = [](const SurfacePoint& p) {
            return EdgeEnd{p.position, p.ng, p.material};
        };
        return transmittanceInside(scene_.absorption(), end(from), direction, end(to));
    }

    const Scene& scene_;
    RayTally& tally_;
    Look sum_;
};

}  // namespace

Look lookFrom(const Scene& scene, const Sight& sight, const SurfacePoint& point, RayTally& tally) {
    Looker looker(scene, tally);
    looker.follow(sight.direction, point, {Rgb(1.0f), 1.0f});
    return looker.look();
}

}  // namespace lacuna
