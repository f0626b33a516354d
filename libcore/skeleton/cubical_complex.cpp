#include "libcore/skeleton/cubical_complex.h"

namespace lacuna {

CubicalComplex::CubicalComplex(const VoxelSpace& space) {
    const VoxelIndex& size = space.shape.size;
    // Along each axis there is one corner more than voxels, and a border of one on either side.
    const std::size_t row = (std::size_t(size[0] + 3) + 63) / 64 * 64;
    step_ = {1, row, row * std::size_t(size[1] + 3)};
    cells_.resize(step_[2] * std::size_t(size[2] + 3) / 64 + 1);
    std::size_t voxel = 0;
    for (int z = 0; z < size[2]; ++z) {
        for (int y = 0; y < size[1]; ++y) {
            const Corner begin = corner({0, y, z});
            for (Corner c = begin; c < begin + std::size_t(size[0]); ++c) {
                const bool empty = space.state[voxel++] == VoxelState::Empty;
                cells_[c / 64 + 1].of[7] |= Word(empty) << c % 64;
            }
        }
    }
    // A cell is present if one of the cubes around it is. Only the border precedes the first
    // corner's word.
    for (std::size_t w = corner({0, 0, 0}) / 64; w < words(); ++w) {
        for (CellAxes axes = 0; axes < 7; ++axes) {
            Word any = 0;
            for (CellAxes back = 0; back < 8; ++back) {
                if (back & axes) continue;
                Shift to;
                for (int a = 0; a < 3; ++a) to = back >> a & 1u ? to + shift(a, -1) : to;
                any |= word(w, 7, to);
            }
            cells_[w + 1].of[axes] = any;
        }
    }
}

std::size_t CubicalComplex::count(int dimension) const {
    std::size_t n = 0;
    for (CellAxes axes = 0; axes < 8; ++axes) {
        if (std::popcount(axes) != dimension) continue;
        for (std::size_t w = 0; w < words(); ++w) n += std::size_t(std::popcount(word(w, axes)));
    }
    return n;
}

std::int64_t CubicalComplex::euler() const {
    return std::int64_t(count(0)) - std::int64_t(count(1)) + std::int64_t(count(2)) -
           std::int64_t(count(3));
}

}  // namespace lacuna
