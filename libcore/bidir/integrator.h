// The one integrator: light paths -> pool -> eye paths -> connections, merges, chains -> weights -> film. It knows
// no method by name.
#pragma once

#include <atomic>
#include <memory>
#include <optional>
#include <vector>

#include "libcore/bidir/coverage_film.h"
#include "libcore/bidir/delivery.h"
#include "libcore/bidir/eye_pass.h"
#include "libcore/bidir/light_pass.h"
#include "libcore/bidir/render_setup.h"

namespace lacuna {

class BidirIntegrator {
  public:
    /// All references must outlive the integrator.
    BidirIntegrator(const Scene& scene, const Camera& camera, Techniques techniques, Method& method,
                    const RenderSettings& settings, const ThreadPool& threads);

    /// Begins a block with a method that has not seen an iteration yet, and runs the warm-up
    /// iterations that the method wants. Returns false if cancelled.
    bool beginBlock(std::uint64_t block, Method& fresh, const std::atomic<bool>& cancel,
                    IterationStatistics& statistics);

    /// Renders one iteration, one eye path per pixel of the crop, into `pixels` (overwritten).
    /// Where the method learns from iterations, those of a block must come in order and after its
    /// beginBlock(). Returns false if cancelled: `pixels` then hold the eye paths that were made,
    /// or zeros where the light paths were not finished.
    bool render(std::uint32_t iteration, std::span<Rgb> pixels, const std::atomic<bool>& cancel,
                IterationStatistics& statistics);

    /// Runs one sample alone after the light pass of its iteration: the eye path through a pixel of
    /// the full film, or one light subpath. Its block must have begun. Where the method learns from
    /// iterations, the block's earlier ones must have been run. Returns the walks' vertices, valid
    /// until the next call of any function.
    struct Replayed {
        Subpath eye, light;
    };
    Replayed replayEyePath(std::uint32_t iteration, int x, int y, const PathObserver& observer);
    Replayed replayLightPath(std::uint32_t iteration, std::uint64_t number,
                             const PathObserver& observer);

    /// Takes layers to fill as well, observers and recordings.
    Delivery& delivery() { return delivery_; }
    /// Sets the film of alpha to fill as well, or null.
    void setCoverageFilm(CoverageFilm* film) { coverage_ = film; }

    const Walker& walker() const { return setup_.walker; }
    /// L: light subpaths that splat.
    std::uint64_t lightPaths() const { return setup_.lightPaths; }
    const LightPool& pool() const { return pool_; }

  private:
    Iteration begin(std::uint32_t number, std::span<Rgb> pixels, IterationStatistics& statistics,
                    const std::atomic<bool>& cancel);
    TechniqueCounts freeze(std::uint32_t iteration, double mergeRadius);
    Merging merging() const;
    double radiusOf(std::uint32_t iteration);
    std::uint64_t pooledSubpaths() const;
    void findPhotons(const Iteration& iteration);
    IterationContext contextFor(std::uint32_t generation, IterationStatistics& statistics) const;
    std::uint32_t generationOf(std::uint32_t iteration) const;
    LightPass::Purpose poolAlone(StreamKind stream) const;

    RenderSetup setup_;
    Method* method_;  ///< of the block
    Workers workers_;
    const bool deltas_;  // whether anything scatters as a delta: asks all objects, maybe millions
    Delivery delivery_{setup_};
    LightPass lightPass_{setup_, delivery_, workers_};
    CoverageFilm* coverage_ = nullptr;
    LightPool pool_;
    PhotonGrid photons_;
    std::shared_ptr<const ChainSeeds> ways_;                // null: nothing asks for them
    std::unique_ptr<const SpecularChains> chains_;          // null: the row or the scene has none
    std::unique_ptr<const RefractedLamps> refractedLamps_;  // likewise
    std::unique_ptr<const KnownWays> knownWays_;            // likewise
    EyePass eyePass_;
    std::optional<double> footprint_;  // set once a radius comes from it
};

}  // namespace lacuna
