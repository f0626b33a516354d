// The folder of one render of a study: its image, curve, JSON and messages.
#pragma once

#include <atomic>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace lacuna {

class RunDirectory {
  public:
    explicit RunDirectory(std::string path) : path_(std::move(path)) {}

    std::string image() const { return path_ + "/image.exr"; }
    std::string curve() const { return path_ + "/curve.csv"; }
    std::string json() const { return path_ + "/run.json"; }
    std::string log() const { return path_ + "/render.log"; }
    /// From this file an interrupted render continues; it is deleted on completion.
    std::string checkpoint() const { return path_ + "/checkpoint"; }
    /// Temporary caches of one render: each builds its own, so that every setup is measured.
    std::string cache() const { return path_ + "/cache"; }

    /// Whether the render was completed: the JSON is written last and tells so.
    bool complete() const;
    nlohmann::json report() const;

    /// Runs `renderer` with its output in this folder. Throws Error with its exit code and its last
    /// line of output. Throws InterruptedError if interrupted; the folder then counts as
    /// incomplete.
    void render(const std::string& renderer, const std::string& scene,
                const std::vector<std::string>& arguments, const std::atomic<bool>& cancel) const;

  private:
    std::string path_;
};

}  // namespace lacuna
