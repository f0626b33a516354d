// What the passes of an iteration work with: scratch memory by thread, results by task. Results are
// merged in the order of tasks, so that they are the same for any number of threads.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "libcore/base/parallel.h"
#include "libcore/bidir/film.h"
#include "libcore/bidir/full_path.h"
#include "libcore/bidir/method.h"
#include "libcore/bidir/path_layers.h"
#include "libcore/bidir/technique_clock.h"
#include "libcore/bidir/technique_film.h"
#include "libcore/bidir/walk.h"

namespace lacuna {

/// Subpaths that a thread has under way at once; also the side of a tile of pixels.
inline constexpr int kTile = 16;

/// A splat's share of a layer.
struct LayerSplat {
    std::uint32_t pixel;
    PathLayers::Share share;
};

/// What one task leaves behind.
struct TaskResult {
    std::vector<Splat> splats;
    std::vector<std::uint64_t> splatPaths;         // by splat: its light subpath
    std::vector<LayerSplat> layerSplats;           // where layers of paths are asked for
    PathLayers::Scratch layerScratch;              // likewise
    std::vector<TechniqueSample> techniqueSplats;  // where --techniques asks for them
    TechniqueClock clock;                          // likewise
    std::vector<PathVertex> pooled;                // vertices of the subpaths that go into the pool
    std::vector<std::uint8_t> pooledLengths;       // of each subpath, where pixels look for theirs
    RayTally tally;
    std::vector<RecordedRay> rays;
    std::uint64_t invalidSamples = 0;
    std::vector<std::string> invalidReplays;
};

/// Scratch memory of one thread: the subpaths of a tile's row of pixels, or of a batch.
struct Worker {
    explicit Worker(int maxDepth) {
        for (auto* side : {&eye, &light}) {
            for (auto& path : *side) path.reserve(std::size_t(maxDepth) + 1);
        }
        rngs.reserve(kTile);  // walks point to them
    }

    std::array<std::vector<PathVertex>, kTile> eye, light;
    std::vector<Rng> rngs;  // by subpath
    std::vector<Walk> walks;
    ProposalSink proposals;                 // for all vertices of an eye path
    std::vector<std::size_t> proposalEnds;  // by t: how many there are up to z_{t-1}
    std::vector<OpenConnection> open;       // of the proposals, those that are seen
    std::vector<const Proposal*> openedBy;  // by open connection
    std::vector<std::uint32_t> photons;     // around an eye vertex: vertices of the pool
    std::vector<PathVertex> chain;          // from a light to an eye vertex
    FullPath fullPath;
};

/// One per thread of a pool.
class Workers {
  public:
    Workers(const ThreadPool& threads, int maxDepth) : threads_(threads) {
        for (int i = 0; i < threads.threads(); ++i) {
            all_.push_back(std::make_unique<Worker>(maxDepth));
        }
    }
    /// That of the calling thread; the first one outside of the pool.
    Worker& own() const { return *all_[std::size_t(threads_.workerIndex())]; }

  private:
    const ThreadPool& threads_;
    std::vector<std::unique_ptr<Worker>> all_;
};

}  // namespace lacuna
