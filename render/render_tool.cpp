// lacuna-render: a picture of a glTF scene by any row of the registry of methods.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "libcore/base/atomic_file.h"
#include "libcore/base/parallel.h"
#include "libcore/tool/early_interrupt.h"
#include "libcore/tool/interrupt.h"
#include "libcore/tool/scene_stage.h"
#include "render/freed_memory.h"
#include "render/method_help.h"
#include "render/options.h"
#include "render/picture.h"
#include "render/replay.h"
#include "render/value_words.h"

namespace lacuna {
namespace {

int printEffects(const RenderOptions& options) {
    // The method is optional here, but must be valid.
    const bool named = !options.method.empty() && options.method != kAuto;
    const MethodRow* row = named ? &findMethod(options.method, "--method") : nullptr;
    if (row) resolve(*row, options.assignments, "--set ");
    if (!options.common.json.empty()) const AtomicFile probe(options.common.json);
    const ThreadPool pool = threadsOf(options.common);
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

/// Whether the command only prints something and makes no picture.
bool onlyPrints(const RenderOptions& options) {
    return options.listMethods || !options.helpMethod.empty() || options.effects || options.replay;
}

int print(const RenderOptions& options) {
    if (options.listMethods) {
        std::fputs(listMethods().c_str(), stdout);
        return 0;
    }
    if (options.helpMethod == kAuto) {
        std::fputs(autoHelp().c_str(), stdout);
        return 0;
    }
    if (!options.helpMethod.empty()) {
        std::fputs(methodHelp(findMethod(options.helpMethod, "--help-method")).c_str(), stdout);
        return 0;
    }
    if (options.effects) return printEffects(options);
    const MethodRow& row = findMethod(options.method, "--method");
    const Settings settings = resolve(row, options.assignments, "--set ");
    return replay(options, row, settings, ThreadPool(options.common.threads));
}

}  // namespace

int renderTool(int argc, char** argv) {
    keepFreedMemory();
    const Ranks ranks;
    // Only rank 0 prints.
    if (!ranks.leads()) {
        endSilentlyAtInterrupts();
        if (!std::freopen("/dev/null", "w", stdout)) return 1;
    }
    RenderOptions options;
    std::optional<int> done;
    const bool parsed = ranks.agree([&] {
        CLI::App app("Renders a glTF scene by bidirectional methods", "lacuna-render");
        declareOptions(app, options);
        done = parseCommandLine(app, argc, argv, renderWords());
        if (done) return;
        options.commandLine = commandLineText(argc, argv);
        if (!options.listMethods && options.helpMethod.empty()) checkOptions(options);
        if (onlyPrints(options)) done = ranks.leads() ? print(options) : 0;
    });
    if (!parsed) return 0;
    if (done) return *done;
    const InterruptGuard interrupt;
    TerminalProgress progress(options.common.quiet, interrupt.requested());
    if (!ranks.leads()) progress.mute();
    const auto rendered = renderPicture(options, ranks, interrupt.requested(), progress);
    if (!rendered) return 0;
    std::fputs(rendered->text.c_str(), stdout);
    if (!rendered->failure.empty()) throw RunError(rendered->failure);
    return rendered->exitCode();
}

}  // namespace lacuna
