#include "libcore/bidir/lent_walk.h"

#include <algorithm>

#include "libcore/bidir/absorption.h"
#include "libcore/bidir/close.h"

namespace lacuna {

namespace {

/// edgeBetween for an edge that a walk made, in the direction that the walk drew. Two positions in float give
/// it less exactly.
Edge edgeOfWalk(const PathVertex& from, const PathVertex& to) {
    const double cosine = measureCosine(to, to.toPrevious);
    const double distance2 =
        to.infinite() ? 1.0 : lengthSquared(Vec3d(to.position) - Vec3d(from.position));
    return {-to.toPrevious, float(cosine / distance2), to.toPreviousFactor,
            float(cosine * double(to.toPreviousFactor))};
}

/// The factor by which a walk's step from `from` to `to` changes its throughput. It is computed from the vertices and
/// not as a quotient of throughputs, which are zero in colours that the walk itself has lost.
Rgb carriedOn(const Walker& walker, const PathVertex& from, const PathVertex& to) {
    const double pdf = double(to.pdfA) * double(walker.survivalAt(from));
    if (!(pdf > 0.0)) return {};
    return from.scatter * float(double(edgeOfWalk(from, to).geometry) / pdf) *
           transmittance(walker.scene().absorption(), from, -to.toPrevious, to);
}

}  // namespace

bool LentWalk::forksAt(Subpath walk, std::size_t h) {
    return walk.size() > h && forks(walk[h]) &&
           std::ranges::all_of(walk.subspan(1, h - 1),
                               [](const PathVertex& v) { return isDelta(v.event); });
}

std::size_t LentWalk::begin(Subpath walk) {
    std::size_t h = 1;
    while (h + 1 < walk.size() && isDelta(walk[h].event)) ++h;
    return h + 1 < walk.size() && forks(walk[h]) && mayBeShared(walk[h + 1]) ? h : 0;
}

void LentWalk::add(Subpath borrower, RayTally& tally) {
    From& from = from_[count_++];
    from.walk = borrower;
    from.pdfA = 0.0;
    const bool own = borrower.data() == walk_.data();
    const PathVertex& z = borrower[h_];
    const PathVertex& next = walk_[h_ + 1];
    // An opaque surface sends a walk on to the side that it came from.
    if (!own && leadsBehind(next, z.position - next.position)) return;
    from.edge = own ? edgeOfWalk(z, next) : edgeBetween(z, next);
    if (!(from.edge.geometry > 0.0f)) return;
    from.at = walker_->scattering(z, z.toPrevious, from.edge.direction);
    if (!(from.at.pdfWToLight > 0.0f)) return;
    if (!own && !connected(walker_->scene(), z, next, RayKind::Connection, tally)) return;

    from.pdfA =
        double(walker_->survivalAt(z)) * double(from.at.pdfWToLight) * double(from.edge.toSecond);
    sum_ += from.pdfA;
    from.arrives = z.throughput * from.at.f *
                   transmittance(walker_->scene().absorption(), z, from.edge.direction, next) *
                   from.edge.geometry;
    if (!goesOn()) return;
    from.next = walker_->scattering(next, -from.edge.direction, -walk_[h_ + 2].toPrevious);
    sumNext_ += from.pdfA * double(from.next.pdfWToLight);
}

double LentWalk::brightness(std::size_t i, std::size_t k) const {
    const auto other = double(mean(from_[k].arrives));
    return other > 0.0 ? double(mean(from_[i].arrives)) / other : 0.0;
}

void LentWalk::take(std::size_t i, std::size_t t, std::vector<PathVertex>& out) const {
    const From& from = from_[i];
    out.assign(from.walk.begin(), from.walk.begin() + std::ptrdiff_t(h_) + 1);
    out.insert(out.end(), walk_.begin() + std::ptrdiff_t(h_) + 1,
               walk_.begin() + std::ptrdiff_t(t));
    PathVertex& z = out[h_];
    PathVertex& next = out[h_ + 1];
    z.scatter = from.at.f;
    z.event = ScatterEvent::Smooth;
    z.asLight = kNone;
    out[h_ - 1].pdfReverseA = from.at.pdfWToEye * z.toPreviousFactor;
    next.toPrevious = -from.edge.direction;
    next.toPreviousFactor = from.edge.toFirst;
    next.pdfA = from.at.pdfWToLight * from.edge.toSecond;
    next.throughput = from.arrives * float(1.0 / sum_);
    if (from.walk.data() != walk_.data()) next.asEye = kNone;  // labelled for another predecessor
    if (t <= h_ + 2) return;

    PathVertex& behind = out[h_ + 2];
    next.scatter = from.next.f;
    z.pdfReverseA = from.next.pdfWToEye * next.toPreviousFactor;
    const Vec3 direction = -behind.toPrevious;
    const double cosine = measureCosine(next, direction);
    behind.throughput =
        from.next.pdfWToLight > 0.0f
            ? from.arrives * from.next.f *
                  transmittance(walker_->scene().absorption(), next, direction, behind) *
                  float(cosine / (sumNext_ * double(walker_->survivalAt(next))))
            : Rgb{};
    behind.pdfA = from.next.pdfWToLight * edgeOfWalk(next, behind).toSecond;
    for (std::size_t n = h_ + 3; n < t; ++n) {
        out[n].throughput = out[n - 1].throughput * carriedOn(*walker_, out[n - 1], out[n]);
    }
}

}  // namespace lacuna
