// lacuna-render: a picture of a glTF scene by any row of the registry of methods.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "libcore/base/atomic_file.h"
#include "libcore/base/parallel.h"
#include "libcore/tool/scene_stage.h"
#include "render/method_help.h"
#include "render/options.h"
#include "render/replay.h"
#include "render/session.h"

namespace lacuna {
namespace {

int printEffects(const RenderOptions& options) {
    // Here the method is optional, but not arbitrary.
    const MethodRow* row =
        options.method.empty() ? nullptr : &findMethod(options.method, "--method");
    if (row) resolve(*row, options.assignments, "--set ");
    if (!options.common.json.empty()) const AtomicFile probe(options.common.json);
    const ThreadPool pool(options.common.threads);
    SceneDescription scene;
    pool.run([&] { scene = describeScene(options); });
    double radius = lensRadius(options, scene);
    const SceneEffects effects = chooseEffects(options, scene, radius, row);
    for (const std::string& text : effects.warnings) {
        std::fprintf(stderr, "warning: %s: %s\n", options.scene.c_str(), text.c_str());
    }
    if (!options.common.json.empty()) {
        writeJson(options.common.json, {{"effects", effectsJson(effects.rows)}});
    }
    std::fputs(effectsText(effects.rows).c_str(), stdout);
    return 0;
}

int render(int argc, const char* const* argv) {
    CLI::App app("Renders a glTF scene by bidirectional methods", "lacuna-render");
    RenderOptions options;
    declareOptions(app, options);
    if (const auto done = parseCommandLine(app, argc, argv)) return *done;
    options.commandLine = commandLineText(argc, argv);

    if (options.listMethods) {
        std::fputs(listMethods().c_str(), stdout);
        return 0;
    }
    if (!options.helpMethod.empty()) {
        std::fputs(methodHelp(findMethod(options.helpMethod, "--help-method")).c_str(), stdout);
        return 0;
    }
    checkOptions(options);
    if (options.effects) return printEffects(options);

    const MethodRow& row = findMethod(options.method, "--method");
    const Settings settings = resolve(row, options.assignments, "--set ");
    const ThreadPool pool(options.common.threads);
    if (options.replay) return replay(options, row, settings, pool);

    checkOutputs(options);
    const InterruptGuard interrupt;
    Progress progress(options.common.quiet, interrupt.requested());
    return Session(options, row, settings, pool, interrupt, progress).run();
}

}  // namespace
}  // namespace lacuna

int main(int argc, char** argv) {
    return lacuna::runTool([&] { return lacuna::render(argc, argv); });
}
