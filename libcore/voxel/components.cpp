#include "libcore/voxel/components.h"

#include <algorithm>

namespace lacuna {

Components::Components(const VoxelShape& shape, std::span<const VoxelState> state, Which which,
                       Connectivity connectivity)
    : pad_(which.outside ? 1 : 0),
      size_{shape.size[0] + 2 * pad_, shape.size[1] + 2 * pad_, shape.size[2] + 2 * pad_} {
    const auto wanted = [&](int x, int y, int z) {
        const VoxelIndex v{x - pad_, y - pad_, z - pad_};
        if (!shape.contains(v)) return which.outside;
        const VoxelState s = state[shape.at(v)];
        const bool solid =
            s == VoxelState::Solid || (which.unreachedIsSolid && s == VoxelState::Unreached);
        return solid == which.solid;
    };
    for (int z = 0; z < size_[2]; ++z) {
        for (int y = 0; y < size_[1]; ++y) {
            row_.push_back(std::uint32_t(runs_.size()));
            for (int x = 0; x < size_[0]; ++x) {
                if (!wanted(x, y, z)) continue;
                const int begin = x;
                while (x < size_[0] && wanted(x, y, z)) ++x;
                runs_.push_back({begin, x, std::uint32_t(runs_.size())});
            }
        }
    }
    row_.push_back(std::uint32_t(runs_.size()));

    const bool corners = connectivity == Connectivity::Corners;
    const auto ny = std::size_t(size_[1]);
    for (int z = 0; z < size_[2]; ++z) {
        for (int y = 0; y < size_[1]; ++y) {
            const std::size_t row = std::size_t(z) * ny + std::size_t(y);
            if (y > 0) join(row, row - 1, corners ? 1 : 0);
            if (z == 0) continue;
            join(row, row - ny, corners ? 1 : 0);
            if (corners && y > 0) join(row, row - ny - 1, 1);
            if (corners && y + 1 < size_[1]) join(row, row - ny + 1, 1);
        }
    }
    number_.resize(runs_.size());
    for (std::uint32_t r = 0; r < runs_.size(); ++r) {
        const std::uint32_t root = find(r);
        number_[r] = root == r ? std::uint32_t(count_++) : number_[root];
    }
}

std::uint32_t Components::find(std::uint32_t run) const {
    while (runs_[run].parent != run) run = runs_[run].parent;
    return run;
}

/// Joins the runs of two rows that overlap, or that would overlap if moved by `reach`.
void Components::join(std::size_t rowA, std::size_t rowB, int reach) {
    std::uint32_t a = row_[rowA], b = row_[rowB];
    while (a < row_[rowA + 1] && b < row_[rowB + 1]) {
        if (runs_[a].begin < runs_[b].end + reach && runs_[b].begin < runs_[a].end + reach) {
            std::uint32_t rootA = find(a), rootB = find(b);
            // The first run stays the root: components are numbered by their first voxels.
            if (rootA > rootB) std::swap(rootA, rootB);
            runs_[rootB].parent = rootA;
            runs_[a].parent = runs_[b].parent = rootA;
        }
        (runs_[a].end < runs_[b].end ? a : b) += 1;
    }
}

std::int64_t Components::at(const VoxelIndex& v) const {
    const int x = v[0] + pad_;
    const std::size_t row =
        std::size_t(v[2] + pad_) * std::size_t(size_[1]) + std::size_t(v[1] + pad_);
    const auto first = runs_.begin() + row_[row], last = runs_.begin() + row_[row + 1];
    const auto after =
        std::upper_bound(first, last, x, [](int value, const Run& r) { return value < r.begin; });
    if (after == first || x >= (after - 1)->end) return -1;
    return number_[std::size_t(after - 1 - runs_.begin())];
}

}  // namespace lacuna
