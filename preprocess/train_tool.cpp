// lacuna-train: subspaces of light and eye subpaths, Q and Gamma, for the method spcbpt.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "libcore/base/error.h"
#include "libcore/base/parallel.h"
#include "libcore/tool/interrupt.h"
#include "libcore/tool/progress.h"
#include "libcore/tool/scene_stage.h"
#include "libcore/tool/table_options.h"
#include "preprocess/emission_asset.h"
#include "preprocess/tool_stage.h"
#include "preprocess/train.h"
#include "preprocess/walk_asset.h"

namespace lacuna {
namespace {

nlohmann::json treeJson(const TreeReport& r) {
    return {{"held_out_accuracy", r.heldOutAccuracy},
            {"accuracy", r.accuracy},
            {"depth", r.depth},
            {"leaves", r.leaves},
            {"centroids", r.centroids},
            {"samples", r.samples},
            {"lookup_nanoseconds", r.nanoseconds}};
}

void printTree(const char* name, const TreeReport& r) {
    std::printf(
        "%s tree: %zu centroids, held-out accuracy %.4f (grown on %zu: %.4f), depth %d, %zu "
        "leaves, %.0f ns per look-up\n",
        name, r.centroids, r.heldOutAccuracy, r.samples, r.accuracy, r.depth, r.leaves,
        r.nanoseconds);
}

nlohmann::json emissionJson(const EmissionTraining& t, const std::string& file) {
    const LearnedEmission& l = t.learned;
    const bool learned = l.guide != nullptr;
    return {{"file", file},
            {"learned", learned},
            {"paths", t.trainPaths + t.heldOutPaths},
            {"held_out_loss", l.heldOutLoss},
            {"train_loss", l.trainLoss},
            {"plain_share", l.plainShare},
            {"virtual_samples", l.virtualSamples},
            {"point_trees", learned ? l.guide->points.size() : 0},
            {"ray_trees", learned ? l.guide->rays.size() : 0}};
}

void printEmission(const EmissionTraining& t) {
    const LearnedEmission& l = t.learned;
    std::printf(
        "emission: second moment of light subpaths %.3g of plain emission's (held out; %.3g ",
        l.heldOutLoss, l.trainLoss);
    std::printf("on the paths learned from), by %zu paths%s\n", t.trainPaths + t.heldOutPaths,
                l.guide ? "" : ": plain emission is kept");
}

nlohmann::json walksJson(const WalkTraining& t, const std::string& file) {
    const LearnedWalks& l = t.learned;
    return {{"file", file},
            {"guided", l.guide != nullptr},
            {"paths", t.trainPaths + t.heldOutPaths},
            {"held_out_loss",
             {{"light", l.heldOutLoss[std::size_t(Side::Light)]},
              {"eye", l.heldOutLoss[std::size_t(Side::Eye)]}}},
            {"virtual_samples", l.virtualSamples},
            {"regions", l.guide ? l.guide->regions().size() : 0}};
}

void printWalks(const WalkTraining& t) {
    const LearnedWalks& l = t.learned;
    std::printf(
        "walks: second moment of light walks %.3g and of eye walks %.3g of those by BSDFs (held "
        "out), "
        "by %zu paths%s\n",
        l.heldOutLoss[std::size_t(Side::Light)], l.heldOutLoss[std::size_t(Side::Eye)],
        t.trainPaths + t.heldOutPaths, l.guide ? "" : ": walks by BSDFs are kept");
}

void print(const std::string& path, const Trained& t, const Phases& phases, double seconds) {
    const Subspaces& s = t.file.subspaces;
    std::printf("%s: %u light subspaces, %u of them on the lights, %u eye subspaces, %.3g s\n",
                path.c_str(), s.lightCount, s.cells.count(), s.eyeCount, seconds);
    std::printf(
        "paths: %zu to train with, %zu held out, of %llu traced; %llu outliers lowered; %.0f MB\n",
        t.trainPaths, t.heldOutPaths, (unsigned long long)t.traced, (unsigned long long)t.outliers,
        double(t.pathBytes) * 1e-6);
    printTree("light", t.lightTree);
    printTree("eye", t.eyeTree);
    std::printf("empty subspaces: light %.1f %% (no light subpath), eye %.1f %% (no path)\n",
                100.0 * t.emptyLight, 100.0 * t.emptyEye);
    std::printf("loss of full contributions: training %.6g, held out %.6g\n", t.gamma.fullTrainLoss,
                t.gamma.fullHeldOutLoss);
    for (std::size_t n = 0; n < t.gamma.trainLoss.size(); ++n) {
        std::printf("loss after epoch %zu: training %.6g, held out %.6g", n, t.gamma.trainLoss[n],
                    t.gamma.heldOutLoss[n]);
        if (n == 0) std::printf(" (%g virtual paths)", t.gamma.virtualPaths);
        std::puts(n == t.gamma.kept ? " (kept)" : "");
    }
    for (const auto& [name, time] : phases.seconds()) {
        const auto peak = t.peakBytes.find(name);
        if (peak == t.peakBytes.end()) continue;
        std::printf("%s: %.3g s, up to %.0f MB\n", name.c_str(), time, double(peak->second) * 1e-6);
    }
}

}  // namespace

int trainTool(int argc, char** argv) {
    CLI::App app("Learns where light paths begin, and trains the subspaces of a scene's paths",
                 "lacuna-train");
    BuildOptions options;
    addBuildOptions(app, options);
    addViewOptions(app, options);
    const TableOptions<EmissionSettings> emissionTable(app, emissionOptions(Emission::Learned));
    const TableOptions<WalkSettings> walkTable(app, walkOptions(Walks::Plain));
    const TableOptions<TrainingSettings> training(app, trainingOptions());
    app.footer(
        "Writes KEY.emission, KEY.walks and KEY.subspaces into the scene's cache. spcbpt and\n"
        "sharebpt of lacuna-render use them with the same options of scene, picture and camera,\n"
        "because what is learned depends on these. Other methods use KEY.emission with\n"
        "--set emission=learned.\n"
        "Examples:\n"
        "  lacuna-train door.glb --paths 200000\n"
        "  lacuna-render door.glb -o door.exr --method spcbpt --set train.paths=200000\n"
        "Exit codes: 0 done, 1 failed while running, 2 usage, 3 the scene cannot be used, 130\n"
        "interrupted (nothing is written then).");
    if (const auto done = parseCommandLine(app, argc, argv)) return *done;
    const EmissionSettings emission = emissionTable.read();
    const TrainSettings settings{training.read(), options.common.seed};
    const WalkSettings walks = walkTable.read();
    const std::uint64_t pathsOfWalks = guidePaths(walks.paths, settings.paths);
    const std::uint64_t pathsOfEmission = guidePaths(emission.paths, settings.paths);
    checkBuildOptions(options);

    const ThreadPool pool = threadsOf(options.common);
    const InterruptGuard interrupt;
    TerminalProgress progress(options.common.quiet, interrupt.requested(), kNothingWritten);
    Phases phases([&](const std::string& name) { progress.phase(name); });
    Phases total;
    SceneStage stage;
    EmissionTraining emissionTraining;
    Trained result;
    WalkTraining walkTraining;
    std::string path, emissionPath, walkPath;
    total.run("all", [&] {
        phases.run("load", [&] { stage = loadScene(options, LooksAt::Camera, pool, progress); });
        TrainingView view = trainingView(*stage.camera, stage.aspect, stage.limits, settings.paths);
        std::string emissionHash = kPlainEmission;
        EmissionFile learned;
        if (emission.emission == Emission::Learned) {
            const CacheStamp stamp =
                emissionStamp(sceneInputs(stage), stage.viewInputs, pathsOfEmission);
            emissionPath = cacheFile(cacheDirectory(options.scene, options.common.cacheDirectory),
                                     stamp, "emission");
            makeCacheDirectory(emissionPath);
            phases.run("emission", [&] {
                emissionTraining =
                    trainEmission(*stage.scene, *stage.camera, stage.aspect, stage.limits,
                                  pathsOfEmission, settings.seed, pool, interrupt.requested());
            });
            learned = emissionFile(stamp, emissionTraining);
            emissionHash = learned.contentHash;
            if (learned.guide) {
                view.guides.lights =
                    std::make_shared<const Lights>(stage.scene->lights().guidedBy(learned.guide));
            }
        }
        std::string walkHash = kPlainWalks;
        WalkFile learnedWalks;
        if (walks.walks == Walks::Guided) {
            const Techniques& techniques = findMethod("spcbpt").techniques;
            const CacheStamp stamp = walkStamp(sceneInputs(stage), stage.viewInputs, pathsOfWalks,
                                               techniques, emissionHash);
            walkPath = cacheFile(cacheDirectory(options.scene, options.common.cacheDirectory),
                                 stamp, "walks");
            makeCacheDirectory(walkPath);
            phases.run("walks", [&] {
                walkTraining = trainWalks(*stage.scene, *stage.camera, stage.aspect, stage.limits,
                                          view.guides.lights, techniques, pathsOfWalks,
                                          settings.seed, pool, interrupt.requested());
            });
            learnedWalks = walkFile(stamp, walkTraining);
            walkHash = learnedWalks.contentHash;
            view.guides.walks = learnedWalks.guide;
        }
        const CacheStamp stamp =
            subspaceStamp(sceneInputs(stage), stage.viewInputs, settings, emissionHash, walkHash);
        path = resultFile(options, stamp, "subspaces");
        result = train(*stage.scene, view, settings, stamp, pool, interrupt.requested(), phases);
        phases.run("write", [&] {
            if (!emissionPath.empty()) writeEmissionFile(emissionPath, learned);
            if (!walkPath.empty()) writeWalkFile(walkPath, learnedWalks);
            writeSubspaceFile(path, result.file);
        });
    });
    if (result.trainPaths == 0) {
        progress.warning("warning: " + options.scene +
                         ": no path was found that a connection can make: nothing was learned");
    }

    const double seconds = total.seconds().at("all");
    if (emission.emission == Emission::Learned) printEmission(emissionTraining);
    if (walks.walks == Walks::Guided) printWalks(walkTraining);
    print(path, result, phases, seconds);
    const GammaResult& g = result.gamma;
    writeReport(options.common,
                {{"file", path},
                 {"emission", emissionPath.empty() ? nlohmann::json()
                                                   : emissionJson(emissionTraining, emissionPath)},
                 {"walks", walkPath.empty() ? nlohmann::json() : walksJson(walkTraining, walkPath)},
                 {"light_tree", treeJson(result.lightTree)},
                 {"eye_tree", treeJson(result.eyeTree)},
                 {"gamma",
                  {{"train_loss_full", g.fullTrainLoss},
                   {"train_loss", g.trainLoss[g.kept]},
                   {"held_out_loss_full", g.fullHeldOutLoss},
                   {"virtual_paths", g.virtualPaths},
                   {"held_out_loss", g.heldOutLoss[g.kept]},
                   {"kept_epoch", g.kept},
                   {"train_loss_by_epoch", g.trainLoss},
                   {"held_out_loss_by_epoch", g.heldOutLoss}}},
                 {"subspaces", settings.subspaces},
                 {"light_subspaces", result.file.subspaces.lightCount},
                 {"light_source_cells", result.file.subspaces.cells.count()},
                 {"eye_subspaces", result.file.subspaces.eyeCount},
                 {"empty_light_subspaces", result.emptyLight},
                 {"empty_eye_subspaces", result.emptyEye},
                 {"paths", result.trainPaths + result.heldOutPaths},
                 {"held_out_paths", result.heldOutPaths},
                 {"traced_paths", result.traced},
                 {"outliers_lowered", result.outliers},
                 {"path_bytes", result.pathBytes},
                 {"content_hash", result.file.contentHash},
                 {"scene_hash", stage.scene->description().contentHash},
                 {"phases", phases.seconds()},
                 {"phase_peak_bytes", result.peakBytes},
                 {"seconds", seconds},
                 {"peak_bytes", peakBytes()}});
    return 0;
}

}  // namespace lacuna
