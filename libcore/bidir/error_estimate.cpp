// (theory.md, "The error without a reference")
#include "libcore/bidir/error_estimate.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdio>
#include <limits>

#include "libcore/base/parallel.h"
#include "libcore/bidir/half_models.h"
#include "libcore/image/channels.h"

namespace lacuna {
namespace {

constexpr std::size_t kPlaces = 1 << 16;  // of the lattice, about
constexpr std::size_t kPlacesPerTask = 1 << 10;
constexpr int kRadius = 3;  // of the window: 49 pixels, one bit each
constexpr int kSide = 2 * kRadius + 1;
constexpr std::uint64_t kRow = (std::uint64_t(1) << kSide) - 1;
constexpr double kAlike = 0.05;  // largest difference of albedo per channel, of normals squared

/// e of the error measures is 0.01 of the mean.
constexpr double kEpsilon = 0.01;

/// Sizes of nodes that are looked at: the largest, its half, quarter and eighth.
constexpr std::uint64_t kSizes = 4;
/// An eighth of the iterations has to be more than one.
constexpr std::uint64_t kFewestIterations = 16;
/// Fewest samples from which a variance is trusted.
constexpr std::uint64_t kFewestSamples = 16;
/// Fewest paths, pixels times iterations. Rarer events may not have been seen.
constexpr double kFewestPaths = 1 << 17;
/// Standard deviations of the picture's own error that are added to the estimate. It then holds for
/// 19 of 20 pictures.
constexpr double kCaution = 1.645;
/// Largest unevenness at which an estimate is trusted: as good as 25 pixels carry the error.
constexpr double kMostUneven = 0.2;
/// Share of the error that is added for spikes that no path has met yet, times the unevenness of
/// relmse. Where the largest few spikes carry relmse, larger ones are likely to come. This number
/// and kSafety were chosen on half of the scenes of tests/results/until-2026-11-24.md.
constexpr double kUnseenShare = 0.7;
/// Factor for what the model leaves out.
constexpr double kSafety = 1.05;

std::array<double, 3> channels(const Rgb& c) {
    return {double(c.r), double(c.g), double(c.b)};
}

double epsilonOf(const FilmSum& left, const FilmSum& right) {
    double sum = 0.0;
    for (std::size_t c = 0; c < 3; ++c) sum += left.wholeMean[c] + right.wholeMean[c];
    return kEpsilon * sum / 6.0;
}

/// The channels of the pixels of one row of the window.
using Strip = std::array<float, std::size_t(3 * kSide)>;

/// The channels of the pixels from `first` on, which lie one behind the other in memory.
const float* stripAt(std::span<const Rgb> pixels, std::size_t first) {
    static_assert(sizeof(Strip) == sizeof(Rgb) * std::size_t(kSide));
    return channelsOf(pixels).data() + 3 * first;
}

/// Masks, indexed by the bits of a row: 1 for the channels of pixels whose bit is
/// set, 0 for others.
constexpr auto kChosen = [] {
    std::array<Strip, std::size_t(kRow) + 1> chosen{};
    for (std::size_t row = 0; row < chosen.size(); ++row) {
        for (std::size_t i = 0; i < chosen[row].size(); ++i) {
            chosen[row][i] = float(row >> (i / 3) & 1);
        }
    }
    return chosen;
}();

bool alike(const FeatureLayers& f, std::size_t a, std::size_t b) {
    const auto albedo = channels(f.albedo.pixels[a] - f.albedo.pixels[b]);
    const auto normal = channels(f.normal.pixels[a] - f.normal.pixels[b]);
    double squared = 0.0;
    for (std::size_t c = 0; c < 3; ++c) {
        if (std::fabs(albedo[c]) > kAlike) return false;
        squared += normal[c] * normal[c];
    }
    return squared <= kAlike;
}

}  // namespace

ErrorMeter::ErrorMeter(const FeatureLayers& features) : width_(features.albedo.width) {
    const int width = width_, height = features.albedo.height;
    const double pixels = double(width) * double(height);
    const int step = std::max(1, int(std::ceil(std::sqrt(pixels / double(kPlaces)))));
    for (int y = std::min(step / 2, height - 1); y < height; y += step) {
        for (int x = std::min(step / 2, width - 1); x < width; x += step) {
            Place place{std::uint32_t(y) * std::uint32_t(width) + std::uint32_t(x), 0};
            int bit = 0;
            for (int dy = -kRadius; dy <= kRadius; ++dy) {
                for (int dx = -kRadius; dx <= kRadius; ++dx, ++bit) {
                    const int nx = x + dx, ny = y + dy;
                    const bool inside = nx >= 0 && ny >= 0 && nx < width && ny < height;
                    if (!inside || (dx == 0 && dy == 0)) continue;
                    const auto other = std::size_t(ny) * std::size_t(width) + std::size_t(nx);
                    if (alike(features, place.pixel, other)) place.alike |= std::uint64_t(1) << bit;
                }
            }
            places_.push_back(place);
        }
    }
}

/// The mean of both pictures over the pixels around that show the same. The pixel itself is left
/// out, because its noise would make its own error small. It stands in where there are no others.
Vec3d ErrorMeter::smoothed(std::span<const Rgb> left, std::span<const Rgb> right,
                           const Place& place) const {
    if (place.alike == 0) {
        const auto a = channels(left[place.pixel]), b = channels(right[place.pixel]);
        return Vec3d{a[0] + b[0], a[1] + b[1], a[2] + b[2]} * 0.5;
    }
    // Sum by columns, without a branch per pixel: quick renders spend much of their time here.
    const float share = 0.5f / float(std::popcount(place.alike));
    Strip columns{};
    std::uint64_t bits = place.alike;
    for (int dy = -kRadius; dy <= kRadius; ++dy, bits >>= kSide) {
        std::uint64_t row = bits & kRow;
        if (row == 0) continue;
        const std::int64_t first =
            std::int64_t(place.pixel) + dy * std::int64_t(width_) - std::int64_t(kRadius);
        if (first < 0 || first + kSide > std::int64_t(left.size())) {
            for (; row != 0; row &= row - 1) {
                const auto pixel = std::size_t(first + std::countr_zero(row));
                const Rgb both = left[pixel] * share + right[pixel] * share;
                columns[0] += both.r;
                columns[1] += both.g;
                columns[2] += both.b;
            }
            continue;
        }
        const float *a = stripAt(left, std::size_t(first)), *b = stripAt(right, std::size_t(first));
        const Strip& chosen = kChosen[row];
        for (std::size_t i = 0; i < columns.size(); ++i) {
            columns[i] += (a[i] * share + b[i] * share) * chosen[i];
        }
    }
    Vec3d sum;
    for (std::size_t i = 0; i < columns.size(); i += 3) {
        sum += Vec3d{columns[i], columns[i + 1], columns[i + 2]};
    }
    return sum;
}

/// The mean of term(place) over all places, in a fixed order.
template <class Term>
ErrorMeter::Mean ErrorMeter::mean(const ThreadPool* threads, const Term& term) const {
    struct Sums {
        double terms = 0.0, squares = 0.0;
    };
    std::vector<Sums> sums((places_.size() + kPlacesPerTask - 1) / kPlacesPerTask);
    const auto task = [&](std::size_t t) {
        const std::size_t end = std::min(places_.size(), (t + 1) * kPlacesPerTask);
        for (std::size_t i = t * kPlacesPerTask; i < end; ++i) {
            const double value = term(places_[i]);
            sums[t].terms += value;
            sums[t].squares += value * value;
        }
    };
    if (threads && sums.size() > 1) {
        threads->forEach(sums.size(), task);
    } else {
        for (std::size_t t = 0; t < sums.size(); ++t) task(t);
    }
    Sums all;
    for (const Sums& s : sums) {
        all.terms += s.terms;
        all.squares += s.squares;
    }
    return {all.terms / double(places_.size()),
            all.terms > 0.0 ? std::sqrt(all.squares) / all.terms : 0.0};
}

HalfDifference ErrorMeter::difference(const FilmSum& left, const FilmSum& right,
                                      const ThreadPool* threads) const {
    const double e = epsilonOf(left, right);
    const Mean m = mean(threads, [&](const Place& place) {
        const Vec3d around = smoothed(left.mean, right.mean, place);
        const auto a = channels(left.mean[place.pixel]), b = channels(right.mean[place.pixel]);
        double sum = 0.0;
        for (std::size_t c = 0; c < 3; ++c) {
            const double d = std::fabs(a[c] - b[c]);
            if (d > 0.0) sum += d / (2.0 * (around[c] + e));
        }
        return sum / 3.0;
    });
    return {left.iterations + right.iterations, 1, m.value, m.value * m.value, m.unevenness};
}

ErrorMeter::Squares ErrorMeter::squares(const FilmSum& sum, const ThreadPool* threads) const {
    const double divisor = sum.varianceDivisor();
    if (divisor == 0.0 || sum.spread.empty()) return {};
    const double e = epsilonOf(sum, sum);
    const double scale = 1.0 / divisor;
    const auto term = [&](bool relative) {
        return [this, &sum, e, scale, relative](const Place& place) {
            const auto s = channels(sum.spread[place.pixel]);
            const Vec3d r = relative ? smoothed(sum.mean, sum.mean, place) : Vec3d{};
            double total = 0.0;
            for (std::size_t c = 0; c < 3; ++c) {
                const double v = s[c] * s[c] * scale;
                if (v > 0.0) total += relative ? v / (r[c] * r[c] + e * e) : v;
            }
            return total / 3.0;
        };
    };
    return {mean(threads, term(false)), mean(threads, term(true))};
}

double ErrorMeter::overSquare(const FilmSum& sum, std::span<const float> values,
                              const ThreadPool* threads) const {
    const double e = epsilonOf(sum, sum);
    const Mean over = mean(threads, [&](const Place& place) {
        const double value = double(values[place.pixel]);
        if (value == 0.0) return 0.0;
        const Vec3d around = smoothed(sum.mean, sum.mean, place);
        const double r = (around[0] + around[1] + around[2]) / 3.0;
        return value / (r * r + e * e);
    });
    return over.value;
}

namespace {

/// Relative standard deviation of h among nodes of one size. It is larger than the pixels' noise
/// explains where they share light paths.
double scatter(std::span<const HalfDifference> sizes) {
    double squares = 0.0, freedom = 0.0;
    for (const HalfDifference& d : sizes) {
        if (d.nodes < 2 || !(d.sum > 0.0)) continue;
        const double mean = d.mean();
        squares += std::max(0.0, d.squares / (mean * mean) - double(d.nodes));
        freedom += double(d.nodes - 1);
    }
    return freedom > 0.0 ? std::sqrt(squares / freedom) : 0.0;
}

std::string doubtOf(double unevenness, std::size_t places) {
    if (!(unevenness > kMostUneven)) return {};
    char text[120];
    std::snprintf(text, sizeof text, "as good as %.0f of %zu pixels carry the error",
                  std::ceil(1.0 / (unevenness * unevenness)), places);
    return text;
}

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
const char* const kBlack = "a black picture";
const char* const kTooFew = "too few iterations";
const char* const kUnseen = "too few paths to have met rare bright ones";
const char* const kNotFinite = "pixels that are not finite";

/// `error` plus a margin for its relative `uncertainty`, and the doubt where few places carry it.
Measured measured(double error, double uncertainty, double unevenness, std::size_t places) {
    if (!std::isfinite(error)) return {error, kNotFinite};
    return {error * kSafety * (1.0 + kCaution * uncertainty), doubtOf(unevenness, places)};
}

bool seesLittle(const FilmSum& sum) {
    return double(sum.iterations) * double(sum.mean.size()) < kFewestPaths;
}

/// `squares` is the mean that gives relmse.
Measured mapeOf(const FilmSum& sum, const ErrorMeter::Mean& squares, std::size_t places) {
    if (sum.differences.empty()) return {kUnknown, kTooFew};
    const std::uint64_t largest = sum.differences.back().iterations;
    const auto begin = std::ranges::lower_bound(sum.differences, largest >> (kSizes - 1), {},
                                                &HalfDifference::iterations);
    const std::span<const HalfDifference> sizes(begin, sum.differences.end());
    double nodes = 0.0, unevenness = 0.0;
    for (const HalfDifference& d : sizes) {
        nodes += double(d.nodes);
        unevenness = d.unevenness / double(d.nodes);  // of the largest
    }
    const double s = std::max(scatter(sizes), unevenness);
    const SpikeModel model(sizes);
    const EvenModel even(sizes, kCaution * s);
    const double noise = model.c() == 0.0 && even.holds()
                             ? even.noise(sum.iterations)
                             : model.g() / std::sqrt(double(sum.iterations));
    const double half = noise + model.c();
    // Where pixels have met no spike or one, halves show half of the error. Where pixels have met
    // several, h also falls more slowly than noise, but shows nearly all of the error.
    const double seen = half > 0.0 ? model.c() * model.c() / half : 0.0;
    const double error = half + std::max(seen, kUnseenShare * squares.unevenness * half);
    Measured m = measured(error, s * std::sqrt(1.0 + 1.0 / nodes), unevenness, places);
    if (sizes.size() < kSizes || sum.iterations < kFewestIterations) m.doubt = kTooFew;
    if (m.doubt.empty() && seesLittle(sum)) m.doubt = kUnseen;
    return m;
}

}  // namespace

const Measured* ErrorEstimate::find(std::string_view measure) const {
    return measure == "mape"     ? &mape
           : measure == "relmse" ? &relmse
           : measure == "rmse"   ? &rmse
                                 : nullptr;
}

ErrorEstimate estimateError(const FilmSum& sum, const ErrorMeter& meter,
                            const ThreadPool* threads) {
    const bool black = sum.wholeMean == std::array<double, 3>{};
    if (sum.iterations == 0 || black) {
        const Measured none{sum.iterations == 0 ? kUnknown : 0.0, kBlack};
        return {none, none, none};
    }
    const ErrorMeter::Squares squares = meter.squares(sum, threads);
    const auto ofMean = [&](const ErrorMeter::Mean& m, bool root) {
        const double value = root ? std::sqrt(m.value) : m.value;
        Measured result =
            measured(value, (root ? 0.5 : 1.0) * m.unevenness, m.unevenness, meter.places());
        if (sum.varianceDivisor() == 0.0) result.error = kUnknown;
        if (sum.samples < kFewestSamples) result.doubt = kTooFew;
        if (result.doubt.empty() && seesLittle(sum)) result.doubt = kUnseen;
        return result;
    };
    return {mapeOf(sum, squares.relative, meter.places()), ofMean(squares.relative, false),
            ofMean(squares.absolute, true)};
}

bool isMeasured(std::uint64_t iterations) {
    if (iterations < 4) return false;
    return (iterations & ((std::uint64_t(1) << (std::bit_width(iterations) - 3)) - 1)) == 0;
}

}  // namespace lacuna
