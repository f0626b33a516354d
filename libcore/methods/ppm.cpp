// Progressive photon mapping [Hachisuka08], in its form without statistics per pixel [Knaus11], one
// radius for all pixels: eye vertices are merged with the photons around them, up to the first one that
// is neither mirror nor smooth glass, nor nearly so. Eye paths that run into a light count as well, combined
// by the balance heuristic, so that lamps and their mirror images are in the picture. (theory.md, "ppm")
#include "libcore/methods/registry.h"
#include "libcore/resampling/merge_options.h"
#include "libcore/resampling/picks.h"

namespace lacuna {

namespace {

struct Options {
    std::uint64_t photons = 0;  ///< light subpaths; 0: one per pixel
    double radius = 0;
};

class PhotonMapping final : public Method {
  public:
    explicit PhotonMapping(const Options& options) : options_(options) {}
    PoolRequest pool() const override {
        return {.subpaths = options_.photons, .perPixel = options_.photons == 0};
    }
    Merging merging() const override { return {Merges::FirstFromEye, options_.radius}; }
    const ConnectionDensity& freeze(std::uint32_t) override { return density_; }
    void select(const EyeContext&, Rng&, ProposalSink&) const override {}

  private:
    Options options_;
    ConstantDensity density_{0.0, 0.0};
};

}  // namespace

MethodRow ppmRow() {
    OptionTable<Options> table;
    table
        .integer(
            "photons", &Options::photons, 0, 1e8, "light subpaths",
            "traced in each iteration, whose vertices are photons; 0: one per pixel of the full "
            "image")
        .standardText("width x height");
    addMergeRadius(table, &Options::radius);
    return methodRow({.name = "ppm",
                      .reference = "Hachisuka08",
                      .summary = "photon mapping: merges eye vertices, up to the first that "
                                 "scatters widely, with photons around them",
                      .techniques = {.hits = true}},
                     table, [](const Options& o) { return std::make_unique<PhotonMapping>(o); });
}

}  // namespace lacuna
