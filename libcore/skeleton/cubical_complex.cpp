#include "libcore/skeleton/cubical_complex.h"

namespace lacuna {

CubicalComplex::CubicalComplex(const VoxelSpace& space) {
    const VoxelIndex& size = space.shape.size;
    // Corners are one more than voxels; a border of one on either side.
    step_ = {1, std::size_t(size[0] + 3), std::size_t(size[0] + 3) * std::size_t(size[1] + 3)};
    cells_.assign(step_[2] * std::size_t(size[2] + 3), 0);
    for (std::size_t i = 0; i < space.state.size(); ++i) {
        if (space.state[i] != VoxelState::Empty) continue;
        const Corner c = corner(space.shape.indexOf(i));
        for (unsigned far = 0; far < 8; ++far) {
            // Cells at this corner of the cube: those that extend along none of the far axes.
            Corner at = c;
            for (int a = 0; a < 3; ++a) at += far >> a & 1u ? step(a) : 0;
            for (CellAxes axes = 0; axes < 8; ++axes) {
                if (!(axes & far)) cells_[at] |= std::uint8_t(1u << axes);
            }
        }
    }
}

std::size_t CubicalComplex::count(int dimension) const {
    std::uint8_t mask = 0;
    for (CellAxes axes = 0; axes < 8; ++axes) {
        if (std::popcount(axes) == dimension) mask |= std::uint8_t(1u << axes);
    }
    std::size_t n = 0;
    for (const std::uint8_t c : cells_) n += std::size_t(std::popcount(std::uint8_t(c & mask)));
    return n;
}

std::int64_t CubicalComplex::euler() const {
    return std::int64_t(count(0)) - std::int64_t(count(1)) + std::int64_t(count(2)) -
           std::int64_t(count(3));
}

}  // namespace lacuna
