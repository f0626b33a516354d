#include "libcore/subspace/subspace_labels.h"

#include <algorithm>
#include <array>

namespace lacuna {

namespace {

constexpr std::size_t kEntriesPerTask = 4096;
constexpr std::size_t kTogether = 8;  // vertices or connections: two descents each

/// Look-ups that are taken in turn, and where their labels go.
class Searches {
  public:
    void add(const DecisionTree& tree, const SubpathEnd& end, Label& label) {
        descents_[count_] = {tree, end};
        labels_[count_++] = &label;
    }
    void finish() {
        const auto descents = std::span(descents_).first(count_);
        lacuna::finish(descents);
        for (std::size_t i = 0; i < count_; ++i) *labels_[i] = descents[i].label();
    }

  private:
    std::array<DecisionTree::Descent, 2 * kTogether> descents_;
    std::array<Label*, 2 * kTogether> labels_;
    std::size_t count_ = 0;
};

}  // namespace

std::vector<std::uint32_t> SubspaceLabels::lightOf(const LightPool& pool,
                                                   const ThreadPool& threads) const {
    const auto entries = pool.connectable();
    std::vector<std::uint32_t> labels(entries.size());
    threads.forEach(
        (entries.size() + kEntriesPerTask - 1) / kEntriesPerTask, [&](std::size_t task) {
            const std::size_t begin = task * kEntriesPerTask;
            for (std::size_t n = begin; n < std::min(entries.size(), begin + kEntriesPerTask);
                 ++n) {
                const Subpath y = pool.prefix(entries[n]);
                const PathVertex* predecessor = y.size() > 1 ? &y[y.size() - 2] : nullptr;
                labels[n] = lightOf(y.back(), predecessor, y.back().asLight);
            }
        });
    return labels;
}

void SubspaceLabels::labelWalk(std::span<PathVertex> walk) const {
    if (!walk.empty() && walk[0].kind != VertexKind::Lens) {
        walk[0].asLight = subspaces_->lightSubspace(walk[0], nullptr);
    }
    for (std::size_t first = 1; first < walk.size(); first += kTogether) {
        labelTogether(walk, first, std::min(walk.size(), first + kTogether));
    }
}

void SubspaceLabels::labelEnds(std::span<OpenConnection> connections) const {
    for (std::size_t first = 0; first < connections.size(); first += kTogether) {
        labelEndsTogether(
            connections.subspan(first, std::min(kTogether, connections.size() - first)));
    }
}

/// Sets both labels of the vertices [begin, end) of a walk. The walk's last vertex gets its label
/// in the other role when it is connected.
void SubspaceLabels::labelTogether(std::span<PathVertex> walk, std::size_t begin,
                                   std::size_t end) const {
    const bool eye = walk.front().kind == VertexKind::Lens;
    const DecisionTree& own = eye ? subspaces_->eyeTree : subspaces_->lightTree;
    const DecisionTree& other = eye ? subspaces_->lightTree : subspaces_->eyeTree;
    Searches searches;
    for (std::size_t i = begin; i < end; ++i) {
        PathVertex& v = walk[i];
        if (v.kind != VertexKind::Surface || !v.connectable()) continue;
        searches.add(own, subpathEnd(v, walk[i - 1]), eye ? v.asEye : v.asLight);
        if (i + 1 == walk.size()) continue;
        searches.add(other, subpathEnd(v, walk[i + 1]), eye ? v.asLight : v.asEye);
    }
    searches.finish();
}

/// Ends that no strategy has in their other role are left out: y_0, and the vertex that
/// the lens sees.
void SubspaceLabels::labelEndsTogether(std::span<OpenConnection> connections) const {
    Searches searches;
    for (OpenConnection& c : connections) {
        const PathVertex &y = c.light.back(), &z = c.eye.back();
        if (c.light.size() > 1) searches.add(subspaces_->eyeTree, subpathEnd(y, z), c.lightAsEye);
        if (c.eye.size() > 2) searches.add(subspaces_->lightTree, subpathEnd(z, y), c.eyeAsLight);
    }
    searches.finish();
}

}  // namespace lacuna
