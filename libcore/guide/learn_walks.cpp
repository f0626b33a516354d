// (theory.md, "Guided walks")
#include "libcore/guide/learn_walks.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "libcore/base/parallel.h"
#include "libcore/guide/grow_square.h"

namespace lacuna {

namespace {

using Index = std::uint32_t;
using Step = WalkSamples::Step;

constexpr std::size_t kSides = 2;
constexpr double kFewestOfDirections = 8.0;  // effective samples from which a part is halved
constexpr int kMostDirectionLevels = 12;
constexpr int kMostRegionLevels = 20;
constexpr double kNormalsApart = 0.25;  // standard deviation from which normals halve a region
constexpr std::array<float, 5> kShares = {0.0f, 0.25f, 0.5f, 0.75f, WalkGuide::kMostShare};
constexpr double kKindSamples = 8.0;  // virtual ones, for the share that is best for the whole kind
constexpr Index kOnePathIn = 4;       // chooses shares, the others directions

/// A step with the data that learning needs of it.
struct Record {
    const Step* step;
    double moment;  ///< to be divided by the pdfW of its direction
    bool chooses;   ///< whether it chooses shares, not directions
};

std::vector<Record> recordsOf(const WalkSamples& samples) {
    std::vector<Record> records;
    Index path = 0;
    for (const WalkSamples::Path& p : samples.paths()) {
        const bool chooses = path++ % kOnePathIn == 0;
        for (const Step& s : samples.steps(p)) records.push_back({&s, momentOf(p, s), chooses});
    }
    return records;
}

/// Sums of values, and of their squares.
struct Sums {
    double sum = 0.0, squares = 0.0;
    void add(double value) {
        sum += value;
        squares += value * value;
    }
    double effective() const { return effectiveSamples(sum, squares); }
};

/// Whether the share matters to a step: not where the BSDF cannot go.
bool countsBySharing(const Record& r) {
    return r.step->pdfBsdf > 0.0f;
}
/// The step's second moment if the guide's density has this share.
double sharedMoment(const Record& r, double share, double guidePdf) {
    return r.moment / ((1.0 - share) * double(r.step->pdfBsdf) + share * guidePdf);
}
double plainMoment(const Record& r) {
    return countsBySharing(r) ? r.moment / double(r.step->pdfBsdf) : 0.0;
}

/// Steps of one side in one region, as points on its square.
class Directions {
  public:
    explicit Directions(const DirectionSquare& square) : square_(square) {}

    /// Adds a step. Steps that have no point on the square are left to BSDFs.
    void add(const Record& r) {
        const float even = square_.pdfW(r.step->to);
        if (!(even > 0.0f) || r.step->delta) return;
        all_.push_back(Index(points_.size()));
        points_.push_back(square_.pointOf(r.step->to));
        moments_.push_back(r.moment / double(even));
    }
    std::span<Index> all() { return all_; }

    // For SquareGrower.
    SquarePoint pointOf(Index i) const { return points_[i]; }
    double effective(std::span<const Index> of) const { return sumsOf(of).effective(); }
    double leafMass(std::span<const Index> of, double size) const {
        return std::sqrt(sumsOf(of).sum * size);
    }

  private:
    Sums sumsOf(std::span<const Index> of) const {
        Sums sums;
        for (const Index i : of) sums.add(moments_[i]);
        return sums;
    }

    const DirectionSquare& square_;
    std::vector<Index> all_;
    std::vector<SquarePoint> points_;
    std::vector<double> moments_;  // to be divided by the density on the square
};

struct Shape {
    double virtualSamples, samplesPerRegion;
};

/// Second moment by share, of some steps.
struct ShareCurve {
    std::array<double, kShares.size()> moment{};
    Sums plain;

    void add(const Record& r, double guidePdf) {
        if (!countsBySharing(r)) return;
        for (std::size_t c = 0; c < kShares.size(); ++c) {
            moment[c] += sharedMoment(r, double(kShares[c]), guidePdf);
        }
        plain.add(plainMoment(r));
    }
    /// Second moment with share number c, relative to no guide.
    double at(std::size_t c) const { return moment[0] > 0.0 ? moment[c] / moment[0] : 1.0; }
};

double guidePdf(const WalkGuide::Region& region, const Step& s) {
    return s.delta ? 0.0 : double(region.pdfW(s.side, s.to));
}

class Learner {
  public:
    Learner(std::span<const Record> records, const Shape& shape)
        : records_(records), shape_(shape) {}

    WalkGuide learn() {
        std::vector<Index> all(records_.size());
        std::iota(all.begin(), all.end(), 0u);
        std::stable_sort(all.begin(), all.end(), [&](Index a, Index b) {
            return records_[a].step->place.kind < records_[b].step->place.kind;
        });
        nodes_.resize(WalkGuide::kKinds);
        auto begin = all.begin();
        for (std::uint32_t kind = 0; kind < WalkGuide::kKinds; ++kind) {
            const auto end = std::find_if(
                begin, all.end(), [&](Index i) { return records_[i].step->place.kind != kind; });
            const std::size_t first = regions_.size();
            split(kind, std::span(begin, end), (kind & WalkGuide::kPasses) != 0, 0);
            setShares(first);
            begin = end;
        }
        return WalkGuide(std::move(nodes_), std::move(regions_));
    }

  private:
    /// Effective samples of both sides.
    double effective(std::span<const Index> of) const {
        Sums sums[kSides];
        for (const Index i : of) {
            sums[std::size_t(records_[i].step->side)].add(plainMoment(records_[i]));
        }
        return sums[0].effective() + sums[1].effective();
    }

    void split(std::size_t node, std::span<Index> of, bool bothSides, int level) {
        const Cut cut = level < kMostRegionLevels && effective(of) >= 2.0 * shape_.samplesPerRegion
                            ? cutOf(of)
                            : Cut{};
        std::size_t lower = 0;
        if (cut.number < 6) {
            lower = std::size_t(
                std::partition(of.begin(), of.end(),
                               [&](Index i) { return numberOf(i, cut.number) < cut.threshold; }) -
                of.begin());
        }
        if (lower == 0 || lower == of.size()) {
            nodes_[node] = {0.0f, std::uint32_t(regions_.size())};
            addRegion(of, bothSides);
            return;
        }
        const std::size_t child = nodes_.size();
        nodes_.resize(child + 2);
        nodes_[node] = {cut.threshold, WalkGuide::kInner | (cut.number << WalkGuide::kNumberShift) |
                                           std::uint32_t(child)};
        split(child, of.first(lower), bothSides, level + 1);
        split(child + 1, of.subspan(lower), bothSides, level + 1);
    }

    struct Cut {
        std::uint32_t number = 6;  // none
        float threshold = 0.0f;
    };
    float numberOf(Index i, std::uint32_t number) const {
        return records_[i].step->place.numbers[number];
    }
    /// Cuts by normal first, which tells walls apart. Otherwise it cuts the axis along which
    /// positions deviate most, at their median.
    Cut cutOf(std::span<const Index> of) const {
        std::array<Sums, 6> sums;
        for (const Index i : of) {
            for (std::uint32_t a = 0; a < 6; ++a) sums[a].add(double(numberOf(i, a)));
        }
        const auto n = double(of.size());
        const auto deviation = [&](std::uint32_t a) {
            const double mean = sums[a].sum / n;
            return std::sqrt(std::max(0.0, sums[a].squares / n - mean * mean));
        };
        const auto widest = [&](std::uint32_t first) {
            std::uint32_t best = first;
            for (std::uint32_t a = first + 1; a < first + 3; ++a) {
                if (deviation(a) > deviation(best)) best = a;
            }
            return best;
        };
        const std::uint32_t normal = widest(3);
        if (deviation(normal) > kNormalsApart) return {normal, float(sums[normal].sum / n)};
        const std::uint32_t place = widest(0);
        std::vector<float> values;
        for (const Index i : of) values.push_back(numberOf(i, place));
        const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
        std::nth_element(values.begin(), middle, values.end());
        return {place, *middle};
    }

    void addRegion(std::span<const Index> of, bool bothSides) {
        Vec3 axis;
        for (const Index i : of) {
            const auto& x = records_[i].step->place.numbers;
            axis += Vec3(x[3], x[4], x[5]);
        }
        const float size = length(axis);
        axis = size > 0.0f ? axis * (1.0f / size) : Vec3(0.0f, 0.0f, 1.0f);
        WalkGuide::Region& region = regions_.emplace_back();
        region.square = DirectionSquare(axis, bothSides);
        auto& curves = curves_.emplace_back();
        for (const Side side : {Side::Light, Side::Eye}) {
            Directions directions(region.square);
            for (const Index i : of) {
                const Record& r = records_[i];
                if (r.step->side == side && !r.chooses) directions.add(r);
            }
            SquareGrower grower(directions, {kFewestOfDirections, kMostDirectionLevels,
                                             shape_.virtualSamples, 0.0});
            region.fields[std::size_t(side)].directions = grower.grow(directions.all()).density;
        }
        for (const Index i : of) {
            const Record& r = records_[i];
            if (r.chooses) curves[std::size_t(r.step->side)].add(r, guidePdf(region, *r.step));
        }
    }

    /// Sets the shares of the regions from `first` on, which are all of one kind.
    void setShares(std::size_t first) {
        for (std::size_t side = 0; side < kSides; ++side) {
            ShareCurve all;
            for (std::size_t i = first; i < regions_.size(); ++i) {
                for (std::size_t c = 0; c < kShares.size(); ++c) {
                    all.moment[c] += curves_[i][side].moment[c];
                }
            }
            for (std::size_t i = first; i < regions_.size(); ++i) {
                const ShareCurve& own = curves_[i][side];
                const double n = own.plain.effective();
                std::size_t best = 0;
                const auto loss = [&](std::size_t c) {
                    return n * own.at(c) + kKindSamples * all.at(c);
                };
                for (std::size_t c = 1; c < kShares.size(); ++c) {
                    if (loss(c) < loss(best)) best = c;
                }
                regions_[i].fields[side].share = kShares[best];
            }
        }
    }

    std::span<const Record> records_;
    Shape shape_;
    std::vector<WalkGuide::Node> nodes_;
    std::vector<WalkGuide::Region> regions_;
    std::vector<std::array<ShareCurve, kSides>> curves_;  // by region
};

std::array<double, kSides> lossOf(const WalkGuide& guide, std::span<const Record> records) {
    double plain[kSides] = {}, guided[kSides] = {};
    for (const Record& r : records) {
        const Step& s = *r.step;
        const auto side = std::size_t(s.side);
        if (!countsBySharing(r)) continue;
        const WalkGuide::Region& region = guide.region(guide.regionAt(s.place));
        plain[side] += plainMoment(r);
        guided[side] += sharedMoment(r, double(region.of(s.side).share), guidePdf(region, s));
    }
    std::array<double, kSides> loss{1.0, 1.0};
    for (std::size_t i = 0; i < kSides; ++i) {
        if (plain[i] > 0.0) loss[i] = guided[i] / plain[i];
    }
    return loss;
}

}  // namespace

LearnedWalks learnWalks(const WalkSamples& train, const WalkSamples& heldOut,
                        const ThreadPool& pool) {
    const std::vector<Record> records = recordsOf(train), judges = recordsOf(heldOut);
    std::vector<Shape> shapes;
    for (const double perRegion : {100.0, 400.0}) {
        for (const double virtualSamples : {4.0, 32.0})
            shapes.push_back({virtualSamples, perRegion});
    }
    std::vector<LearnedWalks> tries(shapes.size());
    pool.forEach(shapes.size(), [&](std::size_t n) {
        auto guide = std::make_shared<WalkGuide>(Learner(records, shapes[n]).learn());
        tries[n].heldOutLoss = lossOf(*guide, judges);
        tries[n].virtualSamples = shapes[n].virtualSamples;
        tries[n].samplesPerRegion = shapes[n].samplesPerRegion;
        tries[n].guide = std::move(guide);
    });
    LearnedWalks best;
    for (LearnedWalks& t : tries) {
        if (t.heldOutLoss[0] + t.heldOutLoss[1] < best.heldOutLoss[0] + best.heldOutLoss[1])
            best = std::move(t);
    }
    return best;
}

}  // namespace lacuna
