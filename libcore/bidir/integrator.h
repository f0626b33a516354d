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

    /// Goes on with a method that has not seen an iteration yet, and runs those that it wants
    /// thrown away before the first of the block. Returns false if cancelled.
    bool beginBlock(std::uint64_t block, Method& fresh, const std::atomic<bool>& cancel,
                    IterationStatistics& statistics);

    /// Renders one iteration, one eye path per pixel of the crop, into `pixels` (overwritten).
    /// Those of a block must come in order, behind its beginBlock(), where the method learns from
    /// them. Returns false if cancelled: `pixels` then hold the eye paths that were made, or
    /// nothing where light paths were not finished.
    bool render(std::uint32_t iteration, std::span<Rgb> pixels, const std::atomic<bool>& cancel,
                IterationStatistics& statistics);

    /// Runs one sample alone after the light pass of its iteration: eye path through a pixel of the
    /// full film, or one light subpath. Its block must have begun, and the block's iterations
    /// before it must have been run where the method learns from them. Returns the walks' vertices,
    /// valid until the next call of anything.
    struct Replayed {
        Subpath eye, light;
    };
    Replayed replayEyePath(std::uint32_t iteration, int x, int y, const PathObserver& observer);
    Replayed replayLightPath(std::uint32_t iteration, std::uint64_t number,
                             const PathObserver& observer);

    /// Layers to fill as well, observers, recordings.
    Delivery& delivery() { return delivery_; }
    /// Alpha to fill as well, or null.
    void setCoverageFilm(CoverageFilm* film) { coverage_ = film; }

    const Walker& walker() const { return setup_.walker; }
    /// L.
    std::uint64_t lightPaths() const { return setup_.lightPaths; }
    const LightPool& pool() const { return pool_; }

  private:
    Iteration begin(std::uint32_t number, std::span<Rgb> pixels, IterationStatistics& statistics,
                    const std::atomic<bool>& cancel);
    TechniqueCounts freeze(std::uint32_t iteration, double mergeRadius);
    double radiusOf(std::uint32_t iteration);
    std::uint64_t pooledSubpaths() const;
    void findPhotons(const Iteration& iteration);
    IterationContext contextFor(std::uint32_t generation, IterationStatistics& statistics) const;
    std::uint32_t generationOf(std::uint32_t iteration) const;
    LightPass::Purpose poolAlone(StreamKind stream) const;

    RenderSetup setup_;
    Method* method_;  ///< of the block
    Workers workers_;
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
    std::optional<double> footprint_;  // once a radius comes from it
};

}  // namespace lacuna
