// Memory of an iteration's passes: scratch memory by thread, results by task. Results are merged in
// the order of tasks, so that they are the same for any number of threads.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "libcore/base/parallel.h"
#include "libcore/bidir/film.h"
#include "libcore/bidir/full_path.h"
#include "libcore/bidir/lent_walk.h"
#include "libcore/bidir/method.h"
#include "libcore/bidir/path_layers.h"
#include "libcore/bidir/sample.h"
#include "libcore/bidir/technique_clock.h"
#include "libcore/bidir/technique_film.h"
#include "libcore/bidir/walk.h"

namespace lacuna {

/// A splat's share of a layer.
struct LayerSplat {
    std::uint32_t pixel;
    PathLayers::Share share;
};

/// The results of one task.
struct TaskResult {
    std::vector<Splat> splats;
    std::vector<std::uint64_t> splatPaths;         // by splat: its light subpath
    std::vector<LayerSplat> layerSplats;           // where layers of paths are asked for
    PathLayers::Scratch layerScratch;              // likewise
    std::vector<TechniqueSample> techniqueSplats;  // where --techniques asks for them
    TechniqueClock clock;                          // likewise
    std::vector<PathVertex> pooled;                // vertices of the subpaths that go into the pool
    std::vector<std::uint8_t> pooledLengths;       // of each subpath, where pixels look theirs up
    RayTally tally;
    std::vector<RecordedRay> rays;
    std::uint64_t invalidSamples = 0;
    std::vector<std::string> invalidReplays;
};

/// How a path ends at a vertex of an eye walk: the vertex lies on a lamp, or a connection is open.
struct Ending {
    std::size_t t;
    const OpenConnection* open;  ///< null: on a lamp
    const Proposal* openedBy;    ///< likewise
    double value = 0.0;          ///< what the walk's own pixel got of it
};

/// A pixel's subpaths, the sample that they are, and where their light goes.
struct PixelPaths {
    Subpath eye, ownLight;
    Sample sample;
    std::uint32_t pixel;  ///< row-major in the crop
    Rgb* value;           ///< null: not in the crop, the pixel only lends its walk
};

/// A walk that pixels of a group borrow from.
struct Lent {
    static constexpr std::uint8_t kNobody = 255;

    LentWalk walk;
    std::vector<Ending> endings = {};
    std::array<std::uint8_t, kTile> numbers = {};  ///< by pixel: number in `walk`, or kNobody
    std::size_t lender = 0;                        ///< the lender's number
    double value = 0.0;                            ///< what the lender's pixel got
};
struct Offer {
    const Lent* lent;
    std::size_t number;  ///< of the borrower in the lent walk
    double worth;        ///< to the borrower, about
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
    /// The light vertices that those of an eye path are joined to.
    struct Joints {
        ProposalSink proposals;                 // for all vertices
        std::vector<std::size_t> proposalEnds;  // by t: how many there are up to z_{t-1}
        std::vector<OpenConnection> open;       // of the proposals, those that are seen
        std::vector<const Proposal*> openedBy;  // by open connection
    };
    std::vector<PixelPaths> paths;       // of a block of pixels
    std::array<Joints, kTile> joints;    // likewise; the first one alone, where no walks are shared
    std::vector<Lent> lent;              // by the pixels of a group
    std::vector<Offer> offers;           // of those, to one of the pixels
    std::vector<std::uint32_t> photons;  // around an eye vertex: vertices of the pool
    std::vector<PathVertex> chain;       // from a light to an eye vertex
    std::vector<PathVertex> borrowed;    // an eye path along another pixel's walk
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
    /// The worker of the calling thread. Outside of the pool it is the first one.
    Worker& own() const { return *all_[std::size_t(threads_.workerIndex())]; }

  private:
    const ThreadPool& threads_;
    std::vector<std::unique_ptr<Worker>> all_;
};

}  // namespace lacuna
