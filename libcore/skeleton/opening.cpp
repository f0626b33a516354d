#include <algorithm>
#include <span>

#include "libcore/base/parallel.h"
#include "libcore/skeleton/thinning.h"

namespace lacuna {

namespace {

/// Chebyshev distance to the nearest voxel that is not Empty; the outside counts as such. One
/// forward and one backward pass over all voxels use one half of the 26 neighbours each. For each
/// row, the minimum over the four neighbouring rows of that half is computed first.
std::vector<std::uint16_t> chebyshevDistance(const VoxelSpace& space) {
    const VoxelShape& shape = space.shape;
    const auto width = std::size_t(shape.size[0]);
    // Each row has a zero at either end, and rows of zeros surround the grid.
    const std::size_t row = width + 2, layer = row * std::size_t(shape.size[1] + 2);
    std::vector<std::uint16_t> d(layer * std::size_t(shape.size[2] + 2), 0), rows(row);
    const std::size_t lines = std::size_t(shape.size[1]) * std::size_t(shape.size[2]);
    const auto rowOf = [&](std::size_t line) {
        const auto y = line % std::size_t(shape.size[1]), z = line / std::size_t(shape.size[1]);
        return d.data() + (z + 1) * layer + (y + 1) * row;
    };
    const auto nearest = [&](const std::uint16_t* own, std::ptrdiff_t sign) {
        const std::ptrdiff_t up = sign * std::ptrdiff_t(layer), along = sign * std::ptrdiff_t(row);
        for (std::size_t x = 0; x < row; ++x) {
            const std::uint16_t* at = own + x;
            rows[x] =
                std::min(std::min(at[along], at[up]), std::min(at[up - along], at[up + along]));
        }
    };
    for (std::size_t line = 0; line < lines; ++line) {
        std::uint16_t* own = rowOf(line);
        const VoxelState* state = space.state.data() + line * width;
        nearest(own, -1);
        for (std::size_t x = 1; x <= width; ++x) {
            const int least = std::min({rows[x - 1], rows[x], rows[x + 1], own[x - 1]});
            const bool empty = state[x - 1] == VoxelState::Empty;
            own[x] = std::uint16_t(empty ? std::min(least, 65534) + 1 : 0);
        }
    }
    std::vector<std::uint16_t> result(shape.count());
    for (std::size_t line = lines; line-- > 0;) {
        std::uint16_t* own = rowOf(line);
        nearest(own, 1);
        for (std::size_t x = width; x > 0; --x) {
            const int least = std::min({rows[x - 1], rows[x], rows[x + 1], own[x + 1]});
            own[x] = std::uint16_t(std::min(int(own[x]), least + 1));
        }
        std::copy_n(own + 1, width, result.data() + line * width);
    }
    return result;
}

/// Dilation along lines: entry i becomes the largest value[u] with |i - u| < value[u].
class LineDilation {
  public:
    void operator()(std::span<std::uint16_t> line) {
        value_.assign(line.begin(), line.end());
        const std::size_t n = line.size();
        pass(
            n, [&](std::size_t i) { return i; }, line);
        pass(
            n, [&](std::size_t i) { return n - 1 - i; }, line);
    }

  private:
    struct Candidate {
        std::uint16_t value;
        std::size_t end;  // end of the entries that it covers
    };

    /// Candidates wait in a queue of decreasing values: a later and larger one covers every further
    /// entry that an earlier and smaller one does.
    template <class At>
    void pass(std::size_t n, const At& at, std::span<std::uint16_t> line) {
        queue_.resize(n);
        std::size_t first = 0, last = 0;
        for (std::size_t i = 0; i < n; ++i) {
            const std::uint16_t value = value_[at(i)];
            while (last > first && queue_[last - 1].value <= value) --last;
            queue_[last++] = {value, i + value};
            while (first < last && queue_[first].end <= i) ++first;
            if (first < last) line[at(i)] = std::max(line[at(i)], queue_[first].value);
        }
    }

    std::vector<std::uint16_t> value_;
    std::vector<Candidate> queue_;
};

}  // namespace

std::vector<std::uint16_t> openingMap(const VoxelSpace& space, const ThreadPool& pool) {
    const VoxelShape& shape = space.shape;
    std::vector<std::uint16_t> map = chebyshevDistance(space);
    const auto x = std::size_t(shape.size[0]), y = std::size_t(shape.size[1]);
    const auto z = std::size_t(shape.size[2]);
    // Each voxel's value is dilated by a cube of that size, axis by axis. Where two values meet,
    // the larger one also reaches farther, so that it suffices to keep it alone. A cube of Empty
    // voxels covers Empty voxels alone.
    pool.forEach(z, [&](std::size_t k) {
        LineDilation dilate;
        for (std::size_t j = 0; j < y; ++j) dilate(std::span(map).subspan((k * y + j) * x, x));
    });
    // Lines along y and z are treated in groups of kLines neighbours, which share cache lines.
    const auto dilateAcross = [&](std::size_t begin, std::size_t length, std::size_t step) {
        constexpr std::size_t kLines = 32;
        std::vector<std::uint16_t> lines(kLines * length);
        LineDilation dilate;
        for (std::size_t i = 0; i < x; i += kLines) {
            const std::size_t count = std::min(kLines, x - i);
            for (std::size_t n = 0; n < length; ++n) {
                for (std::size_t l = 0; l < count; ++l) {
                    lines[l * length + n] = map[begin + n * step + i + l];
                }
            }
            for (std::size_t l = 0; l < count; ++l) {
                dilate(std::span(lines).subspan(l * length, length));
            }
            for (std::size_t n = 0; n < length; ++n) {
                for (std::size_t l = 0; l < count; ++l) {
                    map[begin + n * step + i + l] = lines[l * length + n];
                }
            }
        }
    };
    pool.forEach(z, [&](std::size_t k) { dilateAcross(k * x * y, y, x); });
    pool.forEach(y, [&](std::size_t j) { dilateAcross(j * x, z, x * y); });
    return map;
}

}  // namespace lacuna
