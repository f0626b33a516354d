// What weights believe of a pick, beside what the selector does: the two agree where every
// iteration has the same pool, so that what is frozen is true.
#pragma once

#include <vector>

#include "libcore/bidir/method.h"
#include "tests/bidir/finite_space.h"

namespace lacuna::test {

/// Light subpaths of y_0 and y_1, both as describe(i, vertex) makes those of subpath i.
template <class Describe>
LightPool poolOfPairs(int subpaths, const Describe& describe) {
    LightPool pool;
    pool.reset(std::uint64_t(subpaths));
    for (int i = 0; i < subpaths; ++i) {
        PathVertex y;
        y.kind = VertexKind::LightSource;
        describe(i, y);
        std::vector<PathVertex> path(2, y);
        path[1].index = 1;
        pool.add(path, 12);
    }
    return pool;
}

/// Runs `iterations` with the same pool and prepares one more, whose density it returns.
inline const ConnectionDensity& settle(Method& method, const LightPool& pool,
                                       IterationContext& context, std::uint32_t iterations) {
    for (std::uint32_t i = 0; i < iterations; ++i) {
        method.freeze(i);
        method.prepare(pool, context);
        method.observe(pool, context);
    }
    const ConnectionDensity& density = method.freeze(iterations);
    method.prepare(pool, context);
    return density;
}

struct Belief {
    double believed = 0;  ///< n r
    double picked = 0;    ///< 1 / (1/M + (1 - 1/M) w), w the weight of the proposal; 0: never
};

/// For the light vertices y_1 of `subpaths` light subpaths and the last vertex of `eye`, which are
/// connected with this G: from many calls of select(). `indexOf` tells the subpath of a vertex.
template <class IndexOf>
std::vector<Belief> beliefs(const Method& method, const ConnectionDensity& density, Subpath eye,
                            int subpaths, double geometry, const IndexOf& indexOf) {
    constexpr int kDraws = 4000;
    const FiniteSpace lights(3);
    const double perSubpath = 1.0 / double(subpaths);
    std::vector<Belief> result(static_cast<std::size_t>(subpaths));
    Rng rng(42, 0, StreamKind::EyePath, 0);
    ProposalSink sink;
    for (int draw = 0; draw < kDraws; ++draw) {
        sink.clear();
        method.select({eye.back(), eye, {}, 0, 0, lights}, rng, sink);
        for (const Proposal& p : sink.proposals()) {
            if (p.light.size() != 2) continue;
            const PathVertex& y = p.light.back();
            Connection c{};
            c.eye = {&eye.back(), &eye[eye.size() - 2], int(eye.size()), {}};
            c.order = connectionOrder(eye);
            c.light = {&y, &p.light[0], 2, Rgb(1.0f)};
            c.beta = y.throughput;
            c.geometry = geometry;
            result[indexOf(y)] = {density.effectiveSamples(c),
                                  1.0 / (perSubpath + (1.0 - perSubpath) * p.weight)};
        }
    }
    return result;
}

}  // namespace lacuna::test
