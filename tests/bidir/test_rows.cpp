#include "tests/bidir/test_rows.h"

#include <cmath>
#include <limits>

#include "libcore/methods/methods.h"
#include "libcore/skeleton/node_map.h"
#include "libcore/subspace/subspaces.h"

namespace lacuna::test {

namespace {

class Potpourri final : public Method {
  public:
    explicit Potpourri(std::uint64_t subpaths) : subpaths_(subpaths) {}
    int warmupIterations() const override { return 1; }
    PoolRequest pool() const override { return {subpaths_}; }
    const ConnectionDensity& freeze(std::uint32_t) override { return density_; }

    void prepare(const LightPool& pool, IterationContext&) override {
        pool_ = &pool;
        current_ = byLength(pool);
    }

    void select(const EyeContext& context, Rng& rng, ProposalSink& sink) const override {
        for (int i = 0; i < kFresh; ++i) {
            PathVertex& y0 = sink.newVertex();
            if (context.lights.sampleLight(rng, y0)) sink.add({Subpath(&y0, 1), 1.0 / kFresh, 7});
        }
        for (std::size_t s = 2; s < kMaxLength; ++s) {
            const bool kept = s % 2 == 0;
            const std::vector<LightPool::Entry>& candidates = kept ? kept_[s] : current_[s];
            const LightPool& pool = kept ? keptPool_ : *pool_;
            for (int i = 0; i < kPicks; ++i) {
                // An empty pick counts among the picks.
                if (rng.uniform() < kEmpty || candidates.empty()) continue;
                const auto n = std::uint32_t(candidates.size());
                sink.add({pool.prefix(candidates[rng.below(n)]),
                          double(n) / (double(subpaths_) * kPicks * (1.0 - double(kEmpty))), 0});
            }
        }
    }

    void observe(const LightPool& pool, IterationContext&) override {
        keptPool_ = pool;
        kept_ = byLength(keptPool_);
    }

  private:
    static constexpr int kFresh = 2, kPicks = 2;
    static constexpr float kEmpty = 0.25f;
    static constexpr std::size_t kMaxLength = 32;
    using ByLength = std::vector<std::vector<LightPool::Entry>>;

    static ByLength byLength(const LightPool& pool) {
        ByLength lists(kMaxLength);
        for (const LightPool::Entry& e : pool.connectable()) {
            if (e.count < kMaxLength) lists[e.count].push_back(e);
        }
        return lists;
    }

    std::uint64_t subpaths_;
    ConstantDensity density_{3.0, 0.5};
    const LightPool* pool_ = nullptr;
    LightPool keptPool_;
    ByLength current_, kept_;
};

class HashedDensity final : public ConnectionDensity {
  public:
    double effectiveSamples(const Connection& c) const override {
        const std::uint32_t hash =
            cell(*c.eye.vertex) * 73856093u ^ cell(*c.light.vertex) * 19349663u;
        return double(hash % 1000u + 1u) / 1000.0 * std::pow(double(mean(c.beta)), 0.7);
    }

  private:
    static std::uint32_t cell(const PathVertex& v) {
        const auto c = [](float x) { return std::uint32_t(std::int32_t(std::floor(x * 3.0f))); };
        return c(v.position.x) * 31u + c(v.position.y) * 17u + c(v.position.z);
    }
};

class UniformUnderHash final : public Method {
  public:
    explicit UniformUnderHash(std::uint64_t subpaths) : subpaths_(subpaths) {}
    PoolRequest pool() const override { return {subpaths_}; }
    const ConnectionDensity& freeze(std::uint32_t) override { return density_; }
    void prepare(const LightPool& pool, IterationContext&) override { pool_ = &pool; }
    void select(const EyeContext&, Rng& rng, ProposalSink& sink) const override {
        const auto n = std::uint32_t(pool_->connectable().size());
        if (n == 0) return;
        sink.add(
            {pool_->prefix(pool_->connectable()[rng.below(n)]), double(n) / double(subpaths_), 0});
    }

  private:
    std::uint64_t subpaths_;
    HashedDensity density_;
    const LightPool* pool_ = nullptr;
};

/// skelbpt with nodes: the finite space's states lie near x = 0 within 4 of the axis. Three nodes
/// that stand where a state does (that is how FiniteSpace knows who sees them), mapped to by blocks
/// of the plane, and blocks without a node.
std::shared_ptr<const Skeleton> threeNodes() {
    const VoxelShape shape{{1, 5, 5}, {-1, -5, -5}, 2};
    std::vector<std::uint16_t> entries;
    for (std::size_t i = 0; i < shape.count(); ++i) {
        entries.push_back(i % 4 == 3 ? NodeMap::kNone : std::uint16_t(i % 4));
    }
    auto skeleton = std::make_shared<Skeleton>();
    skeleton->nodes = {{{0.025, 1, 0}, 2}, {{0.035, -1, 1}, 1}, {{0.065, 0, -2}, 3}};
    skeleton->map = NodeMap(shape, std::move(entries));
    return skeleton;
}

/// spcbpt with subspaces: a cell per emitter and two of subpaths on the light's side, three on the
/// eye's, by the states' positions on their ring and by incident directions; a Q that is far off,
/// zero for a subspace that is picked, and uneven columns.
std::shared_ptr<const Subspaces> fewSubspaces() {
    auto s = std::make_shared<Subspaces>();
    s->cells = LightCells({{0}, {1}});
    const auto leaf = [](std::uint32_t label) {
        return DecisionTree::Node{0.0f, label << 4 | DecisionTree::kLeaf};
    };
    const auto split = [](std::uint32_t attribute, float threshold, std::uint32_t child) {
        return DecisionTree::Node{threshold, child << 4 | attribute};
    };
    s->lightTree =
        DecisionTree({split(1, 0.5f, 1), split(8, 0.1f, 3), leaf(3), leaf(3), leaf(2)}, 4);
    s->eyeTree =
        DecisionTree({split(2, -0.5f, 1), leaf(0), split(7, 0.0f, 3), leaf(1), leaf(2)}, 3);
    s->lightCount = 4;
    s->eyeCount = 3;
    s->q = {2.0, 9.0, 0.0, 1.0};
    s->population = {0.1, 0.5, 0.0, 0.01};
    s->lightPaths = 100;
    s->gamma = {0.1f, 0.2f, 0.3f, 0.4f, 0.4f, 0.2f, 0.25f, 0.15f, 0.25f, 0.25f, 0.25f, 0.25f};
    s->check();
    return s;
}

Parameter candidatesParameter() {
    return {"candidates", Parameter::Kind::Integer, 1000, 1, 1e6, "light subpaths in the pool"};
}

}  // namespace

MethodRow potpourriRow() {
    MethodRow row;
    row.name = "test-potpourri";
    row.techniques = {.hits = true, .connects = true, .splats = true};
    row.parameters = {lightPathsParameter(), candidatesParameter()};
    row.create = [](const Settings& s) {
        return std::make_unique<Potpourri>(s.integer("candidates"));
    };
    return row;
}

MethodRow hashedDensityRow() {
    MethodRow row;
    row.name = "test-hashed-density";
    row.techniques = {.hits = true, .connects = true, .splats = true};
    row.parameters = {lightPathsParameter(), candidatesParameter()};
    row.create = [](const Settings& s) {
        return std::make_unique<UniformUnderHash>(s.integer("candidates"));
    };
    return row;
}

MethodRow mappedSkeletonRow() {
    MethodRow row = skeletonRow();
    row.name = "test-skelbpt-mapped";
    row.needsSkeleton = false;  // it brings its own
    row.create = [](const Settings& s) {
        auto method = skeletonRow().create(s);
        method->useSkeleton(threeNodes());
        return method;
    };
    // So that no node is turned down.
    for (Parameter& p : row.parameters) {
        if (p.name == "node_acceptance") p.defaultValue = 0;
    }
    return row;
}

MethodRow recordsFirstRow() {
    MethodRow row = mappedSkeletonRow();
    row.name = "test-skelbpt-records-first";
    for (Parameter& p : row.parameters) {
        if (p.name == "record_density") p.defaultValue = 0.1;
    }
    return row;
}

MethodRow mappedSubspaceRow() {
    MethodRow row = subspaceRow();
    row.name = "test-spcbpt-mapped";
    row.needsSubspaces = false;  // it brings its own
    row.create = [](const Settings& s) {
        auto method = subspaceRow().create(s);
        method->useSubspaces(fewSubspaces());
        return method;
    };
    return row;
}

std::vector<MethodRow> allRows() {
    std::vector<MethodRow> rows;
    for (const MethodRow& row : methods()) {
        if (!row.biased) rows.push_back(row);
    }
    rows.push_back(potpourriRow());
    rows.push_back(hashedDensityRow());
    rows.push_back(mappedSkeletonRow());
    rows.push_back(recordsFirstRow());
    rows.push_back(mappedSubspaceRow());
    return rows;
}

std::vector<std::string> smallSettings(const MethodRow& row, int candidates) {
    for (const Parameter& p : row.parameters) {
        if (p.name == "candidates") return {"candidates=" + std::to_string(candidates)};
    }
    return {};
}

}  // namespace lacuna::test
