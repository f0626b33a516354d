// --checkpoint: saves the unfinished picture to a file at intervals. A later run of the same
// command continues from it.
#pragma once

#include <optional>
#include <string>

#include "render/background_job.h"
#include "render/part.h"

namespace lacuna {

/// The inputs of the render of the checkpoint `path`; empty if there is no file. Throws InputError if the file is
/// damaged or no checkpoint.
std::optional<CacheStamp> checkpointInputs(const std::string& path);

class Checkpoint {
  public:
    /// `seconds` between two saves.
    Checkpoint(std::string path, double seconds);

    /// The content of the file; empty if there is none. Throws InputError if it is no checkpoint,
    /// is damaged, belongs to another render than `inputs`, or begins with another block. The
    /// message tells what differs.
    std::optional<Part> load(const CacheStamp& inputs, std::uint64_t firstBlock) const;

    /// Whether it is time to save and the last save is done.
    bool due() const { return saving_.due(); }
    /// Writes the part in the background, whole or not at all. Rendering may go on meanwhile: it
    /// does not change the part's sums.
    void save(Part part);
    /// Writes the part and waits. Throws RunError.
    void finish(Part part);
    /// Why the last save in the background failed; reported once (background_job.h).
    std::optional<std::string> failure() { return saving_.failure(); }

  private:
    std::string path_;
    BackgroundJob saving_;
};

}  // namespace lacuna
