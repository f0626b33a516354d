#include "render/replay.h"

#include <cstdio>

#include "libcore/base/error.h"
#include "libcore/bidir/verify.h"
#include "libcore/tool/interrupt.h"
#include "preprocess/emission_asset.h"
#include "render/block_plan.h"
#include "render/caches.h"
#include "render/stage.h"

namespace lacuna {
namespace {

const char* nameOf(VertexKind kind) {
    switch (kind) {
        case VertexKind::Lens:
            return "lens";
        case VertexKind::Surface:
            return "surface";
        case VertexKind::LightSource:
            return "light";
        case VertexKind::Infinite:
            return "infinite";
    }
    return "?";
}

const char* nameOf(ScatterEvent event) {
    switch (event) {
        case ScatterEvent::Smooth:
            return "smooth";
        case ScatterEvent::DeltaReflection:
            return "delta-reflection";
        case ScatterEvent::DeltaTransmission:
            return "delta-transmission";
    }
    return "?";
}

class Printer {
  public:
    Printer(const Walker& walker) : walker_(walker) {}

    /// Prints the vertices z_0 .. or y_0 .. of a walk.
    void subpath(const char* title, char letter, Subpath path) const {
        std::printf("%s: %zu vertices\n", title, path.size());
        for (const PathVertex& v : path) vertex(letter, v);
    }

    void contribution(const PathEvent& e) {
        const int k = e.path.edges, t = e.technique.t;
        const char* const made = e.technique.merges()     ? "merged at i"
                                 : e.technique.chains()   ? "chain to i"
                                 : e.technique.refracts() ? "refracted at i"
                                                          : "s";
        double sum = e.technique.chains() ? 1.0 : 0.0;
        for (int i = 1; i <= k + 1; ++i) sum += misWeight(e.path, e.counts, i);
        for (int i = 1; i < k; ++i)
            sum += misWeight(e.path, e.counts, {k + 1 - i, Technique::By::Merge});
        sum += misWeight(e.path, e.counts, {t, Technique::By::Refraction});
        std::printf(
            "contribution %d: %s = %d, t = %d, value %.9g %.9g %.9g, weight %.9g (by products "
            "%.9g, "
            "sum over strategies %.9g)",
            ++contributions_, made, e.technique.firstOfEye(k), t, double(e.contribution.r),
            double(e.contribution.g), double(e.contribution.b), e.weight,
            misWeightByProducts(walker_, e.path, e.counts, e.technique), sum);
        if (e.proposal) {
            std::printf(", selector weight %.9g, label %u", e.proposal->weight, e.proposal->label);
        }
        std::printf("\n");
        for (int i = 0; i <= k; ++i) pathVertex(e, i);
        total_ += e.contribution;
    }

    void finish() const {
        std::printf("total: %d contributions, %.9g %.9g %.9g\n", contributions_, double(total_.r),
                    double(total_.g), double(total_.b));
    }

  private:
    /// Position in the file's coordinates; directions at infinity are unchanged.
    Vec3d placeOf(const PathVertex& v) const {
        return v.infinite() ? Vec3d(v.position) : Vec3d(v.position) + walker_.scene().centre();
    }

    void vertex(char letter, const PathVertex& v) const {
        const Vec3d p = placeOf(v);
        std::printf("  %c%u %s %s %.9g %.9g %.9g, normal %.6g %.6g %.6g, %s", letter,
                    unsigned(v.index), nameOf(v.kind), v.infinite() ? "towards" : "at", p.x, p.y,
                    p.z, double(v.ng.x), double(v.ng.y), double(v.ng.z), nameOf(v.event));
        if (v.light != kNone) std::printf(", light %u", v.light);
        const Rgb throughput =
            letter == 'y' ? walker_.lights().inFileUnits(v.throughput) : v.throughput;
        std::printf(", pdfA %.9g, reverse pdfA %.9g, survival %.6g, throughput %.9g %.9g %.9g\n",
                    double(v.pdfA), double(v.pdfReverseA), double(v.survival), double(throughput.r),
                    double(throughput.g), double(throughput.b));
    }

    /// Prints a vertex of a complete path with the densities that determine its weight.
    void pathVertex(const PathEvent& e, int i) const {
        const auto n = std::size_t(i);
        const PathVertex& v = *e.path.vertex[n];
        const Vec3d p = placeOf(v);
        std::printf(
            "  x%d %s %s %.9g %.9g %.9g, %s, light pdfA %.9g, eye pdfA %.9g, n r %.9g", i,
            nameOf(v.kind), v.infinite() ? "towards" : "at", p.x, p.y, p.z,
            e.path.delta[n] ? "delta" : "smooth", double(e.path.lightPdfA[n]),
            double(e.path.eyePdfA[n]),
            i <= e.path.edges ? effectiveCount(e.path, e.counts, e.path.edges + 1 - i) : 0.0);
        if (e.counts.merges != Merges::Nowhere && i > 0 && i < e.path.edges) {
            std::printf(", merged n %.9g", mergedSamples(e.path, e.counts, i));
        }
        std::printf("\n");
    }

    const Walker& walker_;
    int contributions_ = 0;
    Rgb total_;
};

void requireSample(const ReplayRequest& sample, const Camera::Film& film,
                   std::uint64_t lightPaths) {
    if (sample.light ? sample.path >= lightPaths
                     : sample.x >= film.width || sample.y >= film.height) {
        throw UsageError(sample.light
                             ? "--replay: expected one of " + std::to_string(lightPaths) +
                                   " light subpaths, found " + std::to_string(sample.path)
                             : "--replay: expected a pixel of " + std::to_string(film.width) +
                                   " x " + std::to_string(film.height) + ", found " +
                                   std::to_string(sample.x) + "," + std::to_string(sample.y));
    }
}

}  // namespace

int replay(const RenderOptions& options, const MethodRow& row, const Settings& settings,
           const ThreadPool& pool) {
    const ReplayRequest sample = *options.replay;
    const InterruptGuard interrupt;
    TerminalProgress progress(options.common.quiet, interrupt.requested());
    const Stage stage = loadStage(options, row, settings, pool, progress);
    const Camera::Film film = stage.camera->film();
    RenderSettings whole = stage.settings;
    whole.crop = {0, film.width, 0, film.height};  // a sample does not depend on the crop

    const std::unique_ptr<Method> method = row.create(settings);
    const std::uint64_t blockIterations = planOf(options, *method).iterations;
    whole.blockIterations = blockIterations;
    const Caches caches =
        loadCaches(options, row, settings, stage, pool, interrupt.requested(), progress);
    const AssetSet assets = caches.all();
    method->use(assets);
    whole.guides = guidesOf(*stage.scene, assets);
    BidirIntegrator integrator(*stage.scene, *stage.camera, stage.techniques, *method, whole, pool);
    requireSample(sample, film, std::max(integrator.lightPaths(), method->pool().subpaths));

    // Streams are addressed, so that a sample depends on earlier iterations only through what the
    // method learned in its block. The warm-up always runs, because every method begins with it.
    // The block's earlier iterations run only for methods that learn from them, because they cost
    // as much as rendering.
    IterationStatistics ignored;
    progress.phase("warm-up");
    const std::uint64_t block = sample.iteration / blockIterations;
    bool complete = integrator.beginBlock(block, *method, interrupt.requested(), ignored);
    if (complete && method->learns()) {
        progress.phase("iterations before it");
        std::vector<Rgb> pixels(std::size_t(film.width) * std::size_t(film.height));
        for (std::uint64_t i = block * blockIterations; complete && i < sample.iteration; ++i) {
            complete = integrator.render(std::uint32_t(i), pixels, interrupt.requested(), ignored);
        }
    }
    if (!complete) return kInterruptedExit;

    std::printf(
        "positions in the file's coordinates; y: light subpath, z: eye subpath, x: full path from "
        "the light to the lens; densities per area (at infinity: per solid angle), roulette left "
        "out; `n r`: samples of the strategy whose eye part begins at that vertex\n");
    progress.phase("replaying");
    const Walker& walker = integrator.walker();
    Printer printer(walker);
    const PathObserver print = [&](const PathEvent& event) { printer.contribution(event); };
    if (sample.light) {
        std::printf("%s, light subpath %llu of iteration %u, seed %llu\n", row.name.c_str(),
                    static_cast<unsigned long long>(sample.path), sample.iteration,
                    static_cast<unsigned long long>(whole.seed));
        const auto replayed = integrator.replayLightPath(sample.iteration, sample.path, print);
        printer.subpath("light subpath", 'y', replayed.light);
    } else {
        std::printf("%s, pixel %d, %d of iteration %u, seed %llu\n", row.name.c_str(), sample.x,
                    sample.y, sample.iteration, static_cast<unsigned long long>(whole.seed));
        const auto replayed = integrator.replayEyePath(sample.iteration, sample.x, sample.y, print);
        printer.subpath("eye subpath", 'z', replayed.eye);
        if (row.techniques.ownLightPath) printer.subpath("own light subpath", 'y', replayed.light);
    }
    printer.finish();
    return 0;
}

}  // namespace lacuna
