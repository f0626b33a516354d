#include <algorithm>
#include <deque>

#include "libcore/base/parallel.h"
#include "libcore/skeleton/thinning.h"

namespace lacuna {

namespace {

/// Chebyshev distance to the nearest voxel that is not Empty, the outside included: forward and
/// backward over all voxels with one half of the 26 neighbours each.
std::vector<std::uint16_t> chebyshevDistance(const VoxelSpace& space) {
    const VoxelShape& shape = space.shape;
    std::vector<std::uint16_t> d(shape.count(), 0);
    const auto relax = [&](std::size_t i, int sign) {
        if (space.state[i] != VoxelState::Empty) return;
        const VoxelIndex v = shape.indexOf(i);
        int best = sign > 0 ? 65534 : d[i] - 1;
        for (int n = 0; n < 13; ++n) {
            // Offsets that come before (0, 0, 0) in the order of the array.
            const int dx = n % 3 - 1, dy = n / 3 % 3 - 1, dz = n / 9 - 1;
            const VoxelIndex u{v[0] + sign * dx, v[1] + sign * dy, v[2] + sign * dz};
            best = std::min(best, shape.contains(u) ? int(d[shape.at(u)]) : 0);
        }
        d[i] = std::uint16_t(best + 1);
    };
    for (std::size_t i = 0; i < d.size(); ++i) relax(i, 1);
    for (std::size_t i = d.size(); i-- > 0;) relax(i, -1);
    return d;
}

/// result[i] = largest value[u] with |i - u| < value[u], along one line. Candidates wait in a queue
/// whose values fall: a later and larger one covers all that an earlier and smaller one does.
void dilateLine(std::vector<std::uint16_t>& value, std::vector<std::uint16_t>& result) {
    const std::size_t n = value.size();
    std::fill(result.begin(), result.end(), std::uint16_t(0));
    std::deque<std::size_t> queue;
    for (const bool forward : {true, false}) {
        queue.clear();
        for (std::size_t step = 0; step < n; ++step) {
            const std::size_t i = forward ? step : n - 1 - step;
            while (!queue.empty() && value[queue.back()] <= value[i]) queue.pop_back();
            queue.push_back(i);
            const auto away = [&](std::size_t u) { return u > i ? u - i : i - u; };
            while (!queue.empty() && away(queue.front()) >= value[queue.front()]) queue.pop_front();
            if (!queue.empty()) result[i] = std::max(result[i], value[queue.front()]);
        }
    }
}

}  // namespace

std::vector<std::uint16_t> openingMap(const VoxelSpace& space, const ThreadPool& pool) {
    const VoxelShape& shape = space.shape;
    std::vector<std::uint16_t> map = chebyshevDistance(space);
    // Dilating by cubes of the voxels' own sizes axis by axis: where values meet, the larger one
    // also reaches farther, so nothing is lost by keeping it alone.
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::size_t b = (axis + 1) % 3, c = (axis + 2) % 3;
        pool.forEach(std::size_t(shape.size[c]), [&](std::size_t k) {
            std::vector<std::uint16_t> line(std::size_t(shape.size[axis])), result(line.size());
            for (int j = 0; j < shape.size[b]; ++j) {
                VoxelIndex v;
                v[b] = j;
                v[c] = int(k);
                for (std::size_t i = 0; i < line.size(); ++i) {
                    v[axis] = int(i);
                    line[i] = map[shape.at(v)];
                }
                dilateLine(line, result);
                for (std::size_t i = 0; i < line.size(); ++i) {
                    v[axis] = int(i);
                    const std::size_t at = shape.at(v);
                    // A cube of Empty voxels covers Empty voxels alone.
                    map[at] = result[i];
                }
            }
        });
    }
    return map;
}

}  // namespace lacuna
