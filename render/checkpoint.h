// --checkpoint: what there is of a picture goes to a file now and then, and a later run of the same
// command goes on from it.
#pragma once

#include <optional>
#include <string>

#include "render/background_job.h"
#include "render/part.h"

namespace lacuna {

/// What the checkpoint `path` is of; empty if there is no file. Throws InputError if it is damaged or
/// another file.
std::optional<CacheStamp> checkpointInputs(const std::string& path);

class Checkpoint {
  public:
    /// `seconds` between two saves.
    Checkpoint(std::string path, double seconds);

    /// What the file holds; empty if there is none. Throws InputError if it is no checkpoint, is
    /// damaged, of another render than `inputs` or begins with another block: the message says what
    /// differs.
    std::optional<Part> load(const CacheStamp& inputs, std::uint64_t firstBlock) const;

    /// Whether it is time to save and the last save is done.
    bool due() const { return saving_.due(); }
    /// Writes in the background: whole or not at all. Rendering may go on meanwhile, the part's
    /// sums are not changed.
    void save(Part part);
    /// Writes and waits. Throws RunError.
    void finish(Part part);
    /// Why the last save in the background failed; told once (background_job.h).
    std::optional<std::string> failure() { return saving_.failure(); }

  private:
    std::string path_;
    BackgroundJob saving_;
};

}  // namespace lacuna
