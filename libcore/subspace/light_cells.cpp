// (theory.md, "Subspaces")
#include "libcore/subspace/light_cells.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace lacuna {

namespace {

/// Index of the cell that holds `x` of [0, 1] among `n`.
std::uint32_t slot(double x, std::uint32_t n) {
    return std::uint32_t(std::clamp(x * double(n), 0.0, double(n) - 1.0));
}

}  // namespace

LightCells::LightCells(std::vector<Block> blocks) : blocks_(std::move(blocks)) {
    for (const Block& b : blocks_) {
        if (b.rows == 0 || b.columns == 0) throw std::invalid_argument("light cells: empty block");
        count_ = std::max(count_, b.first + std::uint32_t(b.rows) * b.columns);
    }
}

LightCells::LightCells(const Lights& lights, std::uint32_t cells) {
    std::uint32_t next = 0;
    double shared = 0.0;  // what the open shared cell is worth
    std::uint32_t open = 0;
    for (std::uint32_t i = 0; i < lights.size(); ++i) {
        const double worth = lights.pmf(i) * double(cells);
        if (!isHittable(lights.kind(i)) || worth < 2.0) {
            if (shared == 0.0 || shared >= 1.0) {
                open = next++;
                shared = 0.0;
            }
            // A light that is never picked is looked up all the same: eye paths may hit it.
            shared += std::max(worth, 1e-9);
            blocks_.push_back({open});
            continue;
        }
        // About square in equal-area coordinates; twice as wide for the sphere.
        const double wide = lights.kind(i) == LightKind::Environment ? 2.0 : 1.0;
        const auto rows = std::uint16_t(std::clamp(std::floor(std::sqrt(worth / wide)), 1.0, 4e3));
        const auto columns = std::uint16_t(std::clamp(std::floor(worth / rows), 1.0, 4e3));
        blocks_.push_back({next, rows, columns});
        next += std::uint32_t(rows) * columns;
    }
    count_ = std::max(next, 1u);
}

std::uint32_t LightCells::cellOf(const PathVertex& vertex) const {
    if (vertex.light >= blocks_.size()) return 0;
    const Block& b = blocks_[vertex.light];
    if (b.rows == 1 && b.columns == 1) return b.first;
    double row, column;
    if (vertex.infinite()) {
        // Equal heights on the sphere are equal areas.
        row = 0.5 * (1.0 + double(vertex.position.y));
        const double turn = std::atan2(double(vertex.position.x), double(vertex.position.z));
        column = 0.5 + turn / (2.0 * std::numbers::pi);
    } else {
        // Undoes the map that spreads the unit square evenly over a triangle.
        const double rest = 1.0 - double(vertex.lightUv.x);
        row = rest * rest;
        column = rest > 0.0 ? double(vertex.lightUv.y) / rest : 0.0;
    }
    return b.first + slot(row, b.rows) * b.columns + slot(column, b.columns);
}

}  // namespace lacuna
