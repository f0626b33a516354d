// The labels that a density sees at the ends of a connection. Whichever strategy closed the path,
// they are those that walks along this very path would have.
#include <gtest/gtest.h>

#include <array>
#include <bit>

#include "libcore/bidir/close.h"
#include "libcore/bidir/mis.h"
#include "tests/bidir/room.h"

namespace lacuna::test {
namespace {

/// Labels a vertex by its place and its predecessor's, and counts what it is asked about.
class LabelsOfPlaces final : public ConnectionDensity {
  public:
    bool keepsLabels() const override { return true; }
    void labelWalk(std::span<PathVertex> walk) const override {
        const bool eye = walk[0].kind == VertexKind::Lens;
        for (std::size_t i = 0; i < walk.size(); ++i) {
            const PathVertex* before = i > 0 ? &walk[i - 1] : nullptr;
            const PathVertex* behind = i + 1 < walk.size() ? &walk[i + 1] : nullptr;
            (eye ? walk[i].asEye : walk[i].asLight) = labelOf(walk[i], before);
            if (behind) (eye ? walk[i].asLight : walk[i].asEye) = labelOf(walk[i], behind);
        }
    }
    void labelEnds(std::span<OpenConnection> connections) const override {
        for (OpenConnection& c : connections) {
            c.lightAsEye = labelOf(c.light.back(), &c.eye.back());
            c.eyeAsLight = labelOf(c.eye.back(), &c.light.back());
        }
    }
    double effectiveSamples(const Connection& c) const override {
        note(c.eye, c.eye.count == 2);
        note(c.light, c.light.count == 1);
        return 1.0;
    }

    struct Asked {
        int known = 0, wrong = 0;
        int unknown = 0;       ///< except z_1 and y_0
        int unknownFirst = 0;  ///< z_1 or y_0
    };
    mutable Asked asked;

  private:
    static Label labelOf(const PathVertex& v, const PathVertex* predecessor) {
        std::uint32_t hash = 2166136261u;
        const auto mix = [&](const Vec3& p) {
            for (const float x : {p.x, p.y, p.z}) {
                hash = (hash ^ std::bit_cast<std::uint32_t>(x)) * 16777619u;
            }
        };
        mix(v.position);
        if (predecessor) mix(predecessor->position);
        return hash >> 1;  // never kNone
    }
    void note(const ConnectionEnd& end, bool first) const {
        if (end.label == kNone) {
            ++(first ? asked.unknownFirst : asked.unknown);
        } else {
            ++(end.label == labelOf(*end.vertex, end.predecessor) ? asked.known : asked.wrong);
        }
    }
};

TEST(Labels, areThoseOfAWalkThatCameThisWay) {
    const auto scene = room(4);
    const Camera camera = scene->makeCamera("", {64, 48}, {});
    const Walker walker(*scene, camera, {8, 2});
    enum { kHit, kSplat, kConnection };
    std::array<LabelsOfPlaces, 3> densities;
    std::array<TechniqueCounts, 3> counts;
    for (std::size_t i = 0; i < 3; ++i) {
        counts[i].hit = true;
        counts[i].splats = 5.0;
        counts[i].rouletteDepth = 2;
        counts[i].connectThrough(densities[i], walker);
    }
    std::vector<PathVertex> lightPath, eyePath;
    FullPath path;
    RayTally tally;
    for (std::uint64_t n = 0; n < 400; ++n) {
        Rng rng(61, 0, StreamKind::User, n);
        walker.traceLight(rng, tally, lightPath);
        // Every other eye walk goes by way of the lamp, from where it may go on.
        walker.traceEye({0.16f * float(n), n % 2 == 0 ? 10.0f : 24.0f}, rng, tally, eyePath);
        counts[kHit].labelWalk(lightPath);
        counts[kHit].labelWalk(eyePath);
        const std::span<const PathVertex> lights(lightPath), eyes(eyePath);
        for (std::size_t t = 2; t <= eyes.size(); ++t) {
            if (closeHit(walker, eyes.first(t), path)) misWeight(path, counts[kHit], int(t));
        }
        const PathVertex z0 = walker.sampleLens(rng);
        for (std::size_t s = 1; s <= lights.size(); ++s) {
            const Subpath light = lights.first(s);
            const auto open = lensEdge(walker, light.back(), z0, {0, 64, 0, 48}, tally);
            if (open && closeSplat(walker, light, z0, *open, path)) {
                misWeight(path, counts[kSplat], 1);
            }
            for (std::size_t t = 2; t <= eyes.size() && s + t - 1 <= 8; ++t) {
                const Subpath eye = eyes.first(t);
                const auto edge = connectingEdge(walker, light.back(), eye.back(), tally);
                if (!edge) continue;
                OpenConnection connection{light, eye, *edge};
                counts[kConnection].labelEnds({&connection, 1});
                if (closeConnection(walker, connection, path)) {
                    misWeight(path, counts[kConnection], int(t));
                }
            }
        }
    }
    for (const int kind : {kHit, kSplat, kConnection}) {
        SCOPED_TRACE(kind);
        const LabelsOfPlaces::Asked& asked = densities[std::size_t(kind)].asked;
        EXPECT_EQ(asked.wrong, 0);
        EXPECT_GT(asked.known, 20);
        EXPECT_EQ(asked.unknown, 0);
        // If only a walk of the other side came to an end of the connection, that end has no
        // predecessor in this role: y_0 of a hit, z_1 of a splat. labelEnds() looks the ends of
        // connections up.
        EXPECT_EQ(asked.unknownFirst > 0, kind != kConnection);
    }
}

}  // namespace
}  // namespace lacuna::test
