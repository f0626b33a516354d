// Subspaces of the light sources themselves, s = 1 [Su22 7.2.1]: by UV on the surface or the map.
// (theory.md, "Subspaces")
//
// Cells are shared out by power. A light worth two cells or more is divided evenly: an area light
// into cells of equal area by its barycentrics, the environment into cells of equal solid angle by
// latitude and longitude. Lights worth less (the triangles of a mesh, a lamp among many) follow one
// another in the scene's order and share cells worth about one. Point, spot and directional lights
// have no extent: one cell each, or shared likewise.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libcore/bidir/path.h"

namespace lacuna {

class LightCells {
  public:
    struct Block {
        std::uint32_t first;  ///< its first cell
        std::uint16_t rows = 1, columns = 1;
        friend bool operator==(const Block&, const Block&) = default;
    };

    /// One cell for everything.
    LightCells() = default;
    /// Blocks by light. Throws std::invalid_argument for an empty block.
    explicit LightCells(std::vector<Block> blocks);
    /// About `cells` cells over the scene's lights, at least one.
    LightCells(const Lights& lights, std::uint32_t cells);

    std::uint32_t count() const { return count_; }
    std::span<const Block> blocks() const { return blocks_; }
    /// The cell of a vertex on a light. 0 for lights that are not in the table.
    std::uint32_t cellOf(const PathVertex& vertex) const;

  private:
    std::vector<Block> blocks_;
    std::uint32_t count_ = 1;
};

}  // namespace lacuna
