// What lacuna-voxelize does, for it and for lacuna-render --prepare.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>

#include "libcore/cache/voxel_file.h"
#include "libcore/voxel/reach.h"
#include "libcore/voxel/voxel_settings.h"

namespace lacuna {

/// "x0,y0,z0,x1,y1,z1" with x0 < x1, .. Throws UsageError.
VoxelBox parseDomain(const std::string& text);

/// Names of what is being done, and how long it took.
class Phases {
  public:
    /// `announce` is called with each phase's name when it begins; may be empty.
    explicit Phases(std::function<void(const std::string&)> announce = {})
        : announce_(std::move(announce)) {}
    /// Runs `work` as the phase `name`.
    void run(const std::string& name, const std::function<void()>& work);
    const std::map<std::string, double>& seconds() const { return seconds_; }

  private:
    std::function<void(const std::string&)> announce_;
    std::map<std::string, double> seconds_;
};

struct Voxelized {
    VoxelFile file;
    Parts parts;
};

/// Throws UsageError for a domain that holds nothing of the scene, InputError for a scene without
/// geometry, Error 130 once `cancel` is set.
Voxelized voxelizeScene(const Scene& scene, const VoxelSettings& settings, const ThreadPool& pool,
                        const std::atomic<bool>& cancel, Phases& phases);

}  // namespace lacuna
