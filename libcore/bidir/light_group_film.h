// What each group of lights adds to the picture: --light-groups.
#pragma once

#include <cstdint>
#include <vector>

#include "libcore/bidir/film.h"
#include "libcore/scene/light_groups.h"

namespace lacuna {

class ThreadPool;

/// Contributions by the group of the path's light, x_0, summed over a block's iterations. Whatever
/// technique made a path, its light is known, so that the groups add up to the picture. Layers
/// light.GROUP, of all groups.
class LightGroupFilm final : public BlockLayers {
  public:
    LightGroupFilm(LightGroups groups, int width, int height);

    static std::string layerName(const std::string& group) { return "light." + group; }
    /// An index into the groups.
    std::uint32_t groupOf(std::uint32_t light) const { return groups_.group[light]; }
    /// Different pixels may be added to at the same time.
    void add(std::uint32_t group, std::uint32_t pixel, const Rgb& value) {
        now_[group][pixel] += value;
    }
    void countIteration(const ThreadPool& threads);
    Layers means() const override;
    void clear() override;

  private:
    LightGroups groups_;
    int width_, height_;
    // By group: of the iteration under way, and over those before. One sum of all would round what a
    // splat adds to a pixel by what the brightest one has left there.
    std::vector<std::vector<Rgb>> now_, sums_;
    std::uint64_t iterations_ = 0;
};

}  // namespace lacuna
