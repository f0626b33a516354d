// Which light and eye subspaces the vertices of paths lie in, looked up many at once. (theory.md,
// "Subspaces", "spcbpt")
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "libcore/base/parallel.h"
#include "libcore/bidir/density.h"
#include "libcore/bidir/pool.h"
#include "libcore/subspace/subspaces.h"

namespace lacuna {

class SubspaceLabels {
  public:
    explicit SubspaceLabels(std::shared_ptr<const Subspaces> subspaces)
        : subspaces_(std::move(subspaces)) {}

    /// The subspace of a light vertex, and that of an eye vertex. `label` is the vertex's in that
    /// role, or kNone where it is not known.
    std::uint32_t lightOf(const PathVertex& y, const PathVertex* predecessor, Label label) const {
        return label != kNone ? label : subspaces_->lightSubspace(y, predecessor);
    }
    std::uint32_t eyeOf(const PathVertex& z, const PathVertex& predecessor, Label label) const {
        return label != kNone ? label : subspaces_->eyeSubspace(z, predecessor);
    }
    /// Light subspaces by entry of LightPool::connectable().
    std::vector<std::uint32_t> lightOf(const LightPool& pool, const ThreadPool& threads) const;

    /// ConnectionDensity::labelWalk and labelEnds of all densities that keep these labels.
    void labelWalk(std::span<PathVertex> walk) const;
    void labelEnds(std::span<OpenConnection> connections) const;

  private:
    void labelTogether(std::span<PathVertex> walk, std::size_t begin, std::size_t end) const;
    void labelEndsTogether(std::span<OpenConnection> connections) const;

    std::shared_ptr<const Subspaces> subspaces_;
};

}  // namespace lacuna
