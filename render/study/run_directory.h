// One render of a study on disk: its image, curve, JSON and messages, in a folder of its own.
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
    /// Where an interrupted render goes on; gone once it is complete.
    std::string checkpoint() const { return path_ + "/checkpoint"; }
    /// Scratch of one render: caches are built anew for each, so that every setup is measured.
    std::string cache() const { return path_ + "/cache"; }

    /// The render came to its end: the JSON is written last, and says so.
    bool complete() const;
    nlohmann::json report() const;

    /// Runs `renderer` into this folder. Throws Error with its exit code and the last line it said;
    /// Error 130 if interrupted, the folder then counts as incomplete.
    void render(const std::string& renderer, const std::string& scene,
                const std::vector<std::string>& arguments, const std::atomic<bool>& cancel) const;

  private:
    std::string path_;
};

}  // namespace lacuna
