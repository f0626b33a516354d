#include "tests/bidir/finite_space.h"

#include <cmath>

#include "libcore/base/parallel.h"
#include "libcore/material/albedo_tables.h"

namespace lacuna::test {

FiniteSpace::FiniteSpace(std::uint64_t seed) {
    Rng rng(seed, 0, StreamKind::User, 0);
    const auto between = [&](double a, double b) { return a + (b - a) * rng.uniformDouble(); };
    const auto colour = [&](double zero) {
        if (rng.uniformDouble() < zero) return Rgb{};
        return Rgb{float(between(0.5, 1)), float(between(0.5, 1)), float(between(0.5, 1))};
    };
    const AlbedoTables tables;
    for (int i = 0; i < kStates; ++i) {
        // A ring: distances differ, but not by orders of magnitude, which would only cost samples.
        // x tells the state.
        const double angle = i * 2.0 * 3.14159265 / kStates + between(-0.2, 0.2);
        canonical_[i].position = {0.01f * (float(i) + 0.5f), float(4.0 * std::cos(angle)),
                                  float(4.0 * std::sin(angle))};
        survival_[i] = between(0.6, 1.0);
        delta_[i] = i == 5;
        for (int j = 0; j < i; ++j) visible_[i][j] = visible_[j][i] = rng.uniformDouble() > 0.15;
    }
    visible_[0][2] = visible_[2][0] = visible_[kLens][3] = visible_[3][kLens] = true;
    // A row of probabilities to the visible states, some zero, absorbing about 10 %.
    const auto fillRow = [&](int here, std::array<double, kStates>& row) {
        double sum = 0;
        for (int to = 0; to < kLens; ++to) {
            const bool possible = to != here && visible_[here][to] && rng.uniformDouble() > 0.1;
            row[to] = possible ? between(0.4, 1) * geometry(here, to) : 0.0;
            sum += row[to];
        }
        for (double& p : row) p *= sum > 0 ? 0.9 / sum : 0.0;
    };
    for (int here = 0; here < kLens; ++here) {
        for (int from = 0; from < kStates; ++from) {
            fillRow(here, lightPmf_[from][here]);
            fillRow(here, eyePmf_[from][here]);
            for (int to = 0; to < kStates; ++to) scatter_[from][here][to] = colour(0.1);
        }
    }
    fillRow(kLens, lensPmf_);
    for (double& w : importance_) w = between(0.3, 1);
    double sum = 0;
    for (int e = 0; e < kEmitters; ++e) {
        sum += sourcePmf_[e] = between(0.3, 1);
        exitance_[e] = colour(0) * 10.0f;
        fillRow(e, emitPmf_[e]);
        for (int to = 0; to < kStates; ++to) profile_[e][to] = colour(0.1);
    }
    for (double& p : sourcePmf_) p /= sum;

    for (int i = 0; i < kStates; ++i) {
        PathVertex& v = canonical_[i];
        v.kind = VertexKind::Surface;
        v.survival = float(survival_[i]);
        Bsdf::Parameters p;
        p.baseColor = Rgb(0.5f);
        p.specular = 0.0f;
        if (delta_[i]) {
            p.metallic = 1.0f;
            p.roughness = 0.0f;
        }
        v.bsdf = Bsdf(p, {0, 0, 1}, {0, 0, 1}, tables);
        v.event = delta_[i] ? ScatterEvent::DeltaReflection : ScatterEvent::Smooth;
        if (i < kEmitters) v.light = std::uint32_t(i);
    }
    canonical_[kLens].kind = VertexKind::Lens;
}

double FiniteSpace::geometry(int a, int b) const {
    return edgeBetween(canonical_[a], canonical_[b]).geometry;
}

Rgb FiniteSpace::value(const std::vector<int>& x) const {
    const std::size_t k = x.size() - 1;
    Rgb f = exitance_[x[0]] * profile_[x[0]][x[1]];
    for (std::size_t i = 0; i < k; ++i) {
        if (x[i] == x[i + 1] || !visible_[x[i]][x[i + 1]]) return {};
        f *= float(geometry(x[i], x[i + 1]));
        if (i > 0) f *= scatter_[x[i - 1]][x[i]][x[i + 1]];
    }
    return f * float(importance_[x[k - 1]]);
}

Rgb FiniteSpace::exact(const Techniques& techniques) const {
    double sum[3] = {0, 0, 0};
    FullPath path;
    for (int k = 1; k <= kMaxEdges; ++k) {
        std::vector<int> x(std::size_t(k) + 1, 0);
        x[std::size_t(k)] = kLens;
        for (;;) {
            // Paths that no strategy can make (through deltas, or where both walks are blind) are
            // in no method's picture.
            fill(x, path);
            path.fillLightThroughputs(techniques.rouletteDepth);
            bool possible = false;
            for (int t = 1; t <= k + 1 && !possible; ++t) {
                double p = effectiveCount(path, techniques, t);
                for (int i = 0; i <= k - t; ++i) p *= double(path.lightPdfA[std::size_t(i)]);
                for (int i = std::max(0, k - t + 1); i <= k; ++i) {
                    p *= double(path.eyePdfA[std::size_t(i)]);
                }
                possible = p > 0;
            }
            const Rgb f = value(x);
            if (possible) {
                sum[0] += double(f.r);
                sum[1] += double(f.g);
                sum[2] += double(f.b);
            }
            int i = 0;
            for (; i < k; ++i) {
                const int limit = i == 0 ? kEmitters : kLens;
                if (++x[std::size_t(i)] < limit) break;
                x[std::size_t(i)] = 0;
            }
            if (i == k) break;
        }
    }
    return {float(sum[0]), float(sum[1]), float(sum[2])};
}

void FiniteSpace::fill(const std::vector<int>& x, FullPath& path) const {
    const std::size_t k = x.size() - 1;
    path.edges = int(k);
    for (std::size_t i = 0; i <= k; ++i) {
        path.vertex[i] = &canonical_[x[i]];
        path.survival[i] = i == 0 || i == k ? 1.0f : float(survival_[x[i]]);
        path.delta[i] = i != 0 && i != k && delta_[x[i]];
        path.scatter[i] = i == 0  ? profile_[x[0]][x[1]]
                          : i < k ? scatter_[x[i - 1]][x[i]][x[i + 1]]
                                  : Rgb{};
        path.lightPdfA[i] = float(i == 0   ? sourcePmf_[x[0]]
                                  : i == 1 ? emitPmf_[x[0]][x[1]]
                                           : lightPmf_[x[i - 2]][x[i - 1]][x[i]]);
        path.eyePdfA[i] = float(i == k       ? 1.0
                                : i == k - 1 ? lensPmf_[x[i]]
                                             : eyePmf_[x[i + 2]][x[i + 1]][x[i]]);
    }
    path.hittable = true;
    path.splattable = true;
    path.lightEdges = path.eyeEdges = 0;  // geometry is a function of the two states
    path.sourceBeta = exitance_[x[0]] * float(1.0 / sourcePmf_[x[0]]);
}

bool FiniteSpace::sampleLight(Rng& rng, PathVertex& out) const {
    const int e = rng.uniformDouble() < sourcePmf_[0] ? 0 : 1;
    out = canonical_[e];
    out.kind = VertexKind::LightSource;
    out.event = ScatterEvent::Smooth;
    out.pdfA = float(sourcePmf_[e]);
    out.throughput = exitance_[e] * float(1.0 / sourcePmf_[e]);
    return true;
}

void FiniteSpace::traceLight(Rng& rng, std::vector<PathVertex>& out) const {
    out.resize(1);
    sampleLight(rng, out[0]);
    goOn(Side::Light, rng, out);
}

void FiniteSpace::traceEye(Rng& rng, std::vector<PathVertex>& out) const {
    out.assign(1, canonical_[kLens]);
    out[0].throughput = Rgb(1.0f);
    goOn(Side::Eye, rng, out);
}

void FiniteSpace::goOn(Side side, Rng& rng, std::vector<PathVertex>& out) const {
    const std::size_t most = kMaxEdges + (side == Side::Eye ? 1 : 0);
    while (out.size() < most) {
        const std::size_t n = out.size();
        const int here = stateOf(out.back());
        const int from = n >= 2 ? stateOf(out[n - 2]) : here;
        double survival = 1.0;
        if (n >= 2 && int(n) - 1 >= kRouletteDepth) {
            survival = survival_[here];
            if (rng.uniformDouble() >= survival) return;
        }
        const std::array<double, kStates>& row =
            n == 1 ? (side == Side::Light ? emitPmf_[here] : lensPmf_)
                   : (side == Side::Light ? lightPmf_ : eyePmf_)[from][here];
        double u = rng.uniformDouble();
        int to = -1;
        for (int i = 0; i < kLens && to < 0; ++i) {
            if (u < row[i]) to = i;
            u -= row[i];
        }
        if (to < 0) return;
        Rgb f;
        if (n == 1) {
            f = side == Side::Light ? profile_[here][to] : Rgb(float(importance_[to]));
        } else {
            f = side == Side::Light ? scatter_[from][here][to] : scatter_[to][here][from];
        }
        PathVertex v = canonical_[to];
        v.index = std::uint16_t(n);
        v.pdfA = float(row[to]);
        v.throughput = out.back().throughput * f * float(geometry(here, to) / (row[to] * survival));
        out.back().scatter = f;
        if (isBlack(v.throughput)) return;
        out.push_back(v);
    }
}

std::vector<int> FiniteSpace::join(Subpath light, Subpath eye) {
    std::vector<int> x;
    for (const PathVertex& y : light) x.push_back(stateOf(y));
    for (std::size_t j = eye.size(); j-- > 0;) x.push_back(stateOf(eye[j]));
    return x;
}

Rgb FiniteSpace::hit(Subpath eye) const {
    const int e = stateOf(eye.back());
    if (e >= kEmitters) return {};
    return eye.back().throughput * exitance_[e] * profile_[e][stateOf(eye[eye.size() - 2])];
}

Rgb FiniteSpace::splat(Subpath light) const {
    const int here = stateOf(light.back());
    if (!visible_[here][kLens]) return {};
    const Rgb f = light.size() == 1 ? profile_[here][kLens]
                                    : scatter_[stateOf(light[light.size() - 2])][here][kLens];
    return light.back().throughput * f * float(geometry(here, kLens) * importance_[here]);
}

/// f at a light subpath's end towards a state.
Rgb FiniteSpace::towards(Subpath light, int to) const {
    const int here = stateOf(light.back());
    return light.size() == 1 ? profile_[here][to]
                             : scatter_[stateOf(light[light.size() - 2])][here][to];
}

void FiniteSpace::traceEye(Rng& rng, RayTally&, std::vector<PathVertex>& out) const {
    traceEye(rng, out);
}

PathSpace::Arrival FiniteSpace::arrival(Subpath light, Subpath eye, bool throughEye) const {
    const int y = stateOf(light.back()), z = stateOf(eye.back());
    if (y == z) return {};
    const Rgb flow = light.back().throughput * towards(light, z);
    const Rgb atEye = throughEye ? scatter_[y][z][stateOf(eye[eye.size() - 2])] : Rgb{};
    return {flow, flow * atEye, geometry(y, z)};
}

bool FiniteSpace::visible(const PathVertex& light, const PathVertex& eye, RayTally&) const {
    return visible_[stateOf(light)][stateOf(eye)];
}

Rgb FiniteSpace::connect(Subpath light, Subpath eye) const {
    const int y = stateOf(light.back()), z = stateOf(eye.back());
    if (y == z || !visible_[y][z]) return {};
    const Rgb fy = towards(light, z);
    const Rgb fz = scatter_[y][z][stateOf(eye[eye.size() - 2])];
    return light.back().throughput * fy * fz * eye.back().throughput * float(geometry(y, z));
}

FiniteEstimate estimate(const FiniteSpace& space, const MethodRow& row,
                        const std::vector<std::string>& assignments, std::uint64_t seed,
                        double relativeError) {
    constexpr int kPixels = 4;
    const Settings settings = resolve(row, assignments);
    const std::unique_ptr<Method> method = row.create(settings);
    const TechniqueSet& set = row.techniques;
    const std::uint64_t splatPaths =
        row.techniques.ownLightPath
            ? kPixels
            : (settings.values().contains("light_paths") ? settings.integer("light_paths") : 1);
    const ThreadPool threads(1);
    IterationStatistics statistics;
    IterationContext context{space, threads, seed, kPixels, statistics};
    FullPath path;
    std::vector<PathVertex> lightPath, eyePath;
    ProposalSink sink;
    LightPool pool;
    const auto trace = [&](std::uint32_t iteration, StreamKind kind, bool splat,
                           const Techniques& techniques) {
        double sum = 0;
        const std::uint64_t pooled = method->pool().subpaths;
        pool.reset(pooled);
        const std::uint64_t total =
            set.ownLightPath ? 0 : std::max(pooled, splat && set.splats ? splatPaths : 0);
        for (std::uint64_t i = 0; i < total; ++i) {
            Rng rng(seed, iteration, kind, i);
            space.traceLight(rng, lightPath);
            techniques.tag(lightPath);
            if (i < pooled) pool.add(lightPath, FiniteSpace::kMaxEdges);
            if (!splat || !set.splats || i >= splatPaths) continue;
            for (std::size_t s = 1; s <= lightPath.size(); ++s) {
                const Subpath y(lightPath.data(), s);
                if (!y.back().connectable()) continue;
                const Rgb value = space.splat(y);
                if (isBlack(value)) continue;
                std::vector<int> x = FiniteSpace::join(y, {});
                x.push_back(FiniteSpace::kLens);
                space.fill(x, path);
                sum += double(mean(value)) * misWeight(path, techniques, 1) / double(splatPaths);
            }
        }
        return sum;
    };
    const auto techniquesOf = [&](std::uint32_t iteration) {
        Techniques t;
        t.hit = set.hits;
        t.splats = set.splats ? double(splatPaths) : 0.0;
        const ConnectionDensity& density = method->freeze(iteration);
        if (set.connects) t.connectThrough(density);
        t.rouletteDepth = FiniteSpace::kRouletteDepth;
        return t;
    };
    for (int i = 0; i < method->warmupIterations(); ++i) {
        const Techniques t = techniquesOf(std::uint32_t(i));
        trace(std::uint32_t(i), StreamKind::Warmup, false, t);
        method->prepare(pool, context);
        method->observe(pool, context);
    }

    const double truth = mean(space.exact(techniquesOf(0)));
    double sum = 0, squares = 0;
    for (std::uint64_t n = 1;; ++n) {
        const auto iteration = std::uint32_t(n - 1);
        const Techniques techniques = techniquesOf(iteration);
        double value = trace(iteration, StreamKind::LightPath, true, techniques);
        method->prepare(pool, context);
        for (std::uint32_t pixel = 0; pixel < kPixels && (set.hits || set.connects); ++pixel) {
            double pixelValue = 0;
            lightPath.clear();
            if (set.ownLightPath) {
                Rng rng(seed, iteration, StreamKind::LightPath, pixel);
                space.traceLight(rng, lightPath);
                for (std::size_t s = 1; s <= lightPath.size(); ++s) {
                    const Subpath y(lightPath.data(), s);
                    if (!y.back().connectable()) continue;
                    const Rgb splat = space.splat(y);
                    if (isBlack(splat)) continue;
                    std::vector<int> x = FiniteSpace::join(y, {});
                    x.push_back(FiniteSpace::kLens);
                    space.fill(x, path);
                    value += double(mean(splat)) * misWeight(path, techniques, 1) / kPixels;
                }
            }
            Rng rng(seed, iteration, StreamKind::EyePath, pixel);
            space.traceEye(rng, eyePath);
            techniques.tag(eyePath);
            Rng selection(seed, iteration, StreamKind::Connection, pixel);
            for (std::size_t t = 2; t <= eyePath.size(); ++t) {
                const Subpath eye(eyePath.data(), t);
                const Rgb hit = space.hit(eye);
                if (set.hits && !isBlack(hit)) {
                    space.fill(FiniteSpace::join({}, eye), path);
                    pixelValue += double(mean(hit)) * misWeight(path, techniques, int(t));
                }
                if (!set.connects || !eye.back().connectable() || t > FiniteSpace::kMaxEdges) {
                    continue;
                }
                sink.clear();
                method->select({eye.back(), eye, lightPath, pixel, iteration, space}, selection,
                               sink);
                for (const Proposal& p : sink.proposals()) {
                    if (p.light.size() + t - 1 > FiniteSpace::kMaxEdges) continue;
                    const Rgb c = space.connect(p.light, eye);
                    if (isBlack(c)) continue;
                    space.fill(FiniteSpace::join(p.light, eye), path);
                    pixelValue += double(mean(c)) * p.weight * misWeight(path, techniques, int(t));
                }
            }
            value += pixelValue / kPixels;
        }
        method->observe(pool, context);
        sum += value;
        squares += value * value;
        if (n % 1024 == 0) {
            const double m = sum / double(n);
            const double error =
                std::sqrt(std::max(0.0, squares / double(n) - m * m) / double(n - 1));
            if (error < relativeError * truth || n >= 20'000'000) return {truth, m, error, n};
        }
    }
}

}  // namespace lacuna::test
