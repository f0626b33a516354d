// lacuna-render: a picture of a glTF scene by any row of the registry of methods.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "libcore/base/atomic_file.h"
#include "libcore/base/parallel.h"
#include "libcore/base/stopwatch.h"
#include "libcore/image/image_io.h"
#include "libcore/tool/early_interrupt.h"
#include "libcore/tool/scene_stage.h"
#include "render/checkpoint.h"
#include "render/choose/choose.h"
#include "render/method_help.h"
#include "render/options.h"
#include "render/ranks/together.h"
#include "render/render_inputs.h"
#include "render/replay.h"
#include "render/session.h"

namespace lacuna {
namespace {

int printEffects(const RenderOptions& options) {
    // Here the method is optional, but not arbitrary.
    const bool named = !options.method.empty() && options.method != kAuto;
    const MethodRow* row = named ? &findMethod(options.method, "--method") : nullptr;
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

/// Whether no picture is to be made.
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

/// The ranks' parts of a picture are of one program, scene and command, or are none.
void compareInputs(const Ranks& ranks, const CacheStamp& own) {
    if (!ranks.leads()) {
        ranks.send(0, Ranks::Tag::Inputs, own.text());
        return;
    }
    for (int i = 1; i < ranks.size(); ++i) {
        const Ranks::Letter letter = ranks.wait();
        const std::string different =
            differencesText(CacheStamp::parse(own.text()), CacheStamp::parse(textOf(letter)));
        if (different.empty()) continue;
        throw InputError(ranks.name(letter.from) + ": expected what " + ranks.name(0) +
                         " renders, found another " + different +
                         "; give all ranks the same program and the same files");
    }
}

/// Whoever looks at the file while it renders need not wait for training.
void showFirst(const RenderOptions& options, const Image& small) {
    if (!options.writeEverySeconds) return;
    LayeredImage image(small.width, small.height);
    image.setRgb("", small);
    image.attributes["stopped"] = std::string("no: choosing a method");
    writeImage(options.output, image, options.png);
}

/// What `auto` means for this picture: rank 0 finds out, or reads what a checkpoint is of.
Choice choose(const RenderOptions& options, Stage& stage, const Ranks& ranks,
              const ThreadPool& pool, const InterruptGuard& interrupt, Progress& progress) {
    if (!ranks.leads()) return Choice::ofText(textOf(ranks.wait()));
    const auto found = [&]() -> Choice {
        if (!options.checkpoint.empty()) {
            const auto inputs = checkpointInputs(options.checkpoint);
            if (inputs) return Choice::ofInputs(*inputs);
        }
        const Stopwatch watch(stage.setupSeconds), phase(stage.phaseSeconds["choose"]);
        return chooseMethod(options, stage, pool, interrupt.requested(), progress,
                            [&](const Image& small) { showFirst(options, small); });
    };
    const Choice choice = found();
    progress.remark("auto: " + choice.method + ", " + choice.why +
                    "; the same by name: " + choice.byName());
    return choice;
}

int renderPicture(RenderOptions& options, const Ranks& ranks) {
    const MethodRow* row = nullptr;
    Settings settings;
    const bool checked = ranks.agree([&] {
        row = &namedRow(options);
        settings = resolve(*row, options.assignments, "--set ");
        if (options.verify && ranks.many()) {
            throw UsageError("--verify: expected one process, found " +
                             std::to_string(ranks.size()) + " ranks; leave it or mpirun out");
        }
        if (ranks.leads()) checkOutputs(options);
    });
    if (!checked) return 0;

    const InterruptGuard interrupt;
    const ThreadPool pool(options.common.threads);
    Progress progress(options.common.quiet, interrupt.requested());
    if (!ranks.leads()) progress.mute();
    std::optional<Stage> stage;
    std::optional<FirstLook> look;
    const bool loaded = ranks.agree([&] {
        stage = loadStage(options, *row, settings, pool, progress);
        progress.phase("features");
        look.emplace(*stage, pool);
    });
    if (!loaded) return 0;
    std::optional<Choice> choice;
    if (options.method == kAuto) {
        for (const bool leaders : {true, false}) {
            const bool chosen = ranks.agree([&] {
                if (ranks.leads() != leaders) return;
                choice = choose(options, *stage, ranks, pool, interrupt, progress);
                row = &findMethod(choice->method);
                settings = resolve(*row, choice->assignments);
                options.sampling = choice->sampling;
                useMethod(*stage, options, *row, settings);
                for (int i = 1; leaders && i < ranks.size(); ++i) {
                    ranks.send(i, Ranks::Tag::Inputs, choice->text());
                }
            });
            if (!chosen) return 0;
        }
        options.prepare = !row->needs.empty();
    }
    // Rank 0 makes the caches that are missing, the others read them.
    Caches caches;
    if (!ranks.leads()) options.prepare = false;
    for (const bool leaders : {true, false}) {
        const bool there = ranks.agree([&] {
            if (ranks.leads() != leaders) return;
            caches =
                loadCaches(options, *row, settings, *stage, pool, interrupt.requested(), progress);
        });
        if (!there) return 0;
    }

    BlockMaker maker(options, *row, settings, *stage, caches, pool);
    if (ranks.many()) {
        const CacheStamp inputs =
            renderInputs(options, *row, settings, *stage, caches, maker.plan());
        if (!ranks.agree([&] { compareInputs(ranks, inputs); })) return 0;
    }
    std::optional<Session> session;
    const bool ready = ranks.agree([&] {
        if (!ranks.leads()) return;
        session.emplace(options, *row, settings, choice, *stage, caches, *look, maker, ranks, pool,
                        interrupt, progress);
    });
    if (!ready) return 0;
    if (session) return session->run();
    serve(ranks, maker, look->meter, stage->settings.crop, interrupt, pool);
    return 0;
}

int render(int argc, char** argv) {
    const Ranks ranks;
    // One voice is enough.
    if (!ranks.leads()) {
        endSilentlyAtInterrupts();
        if (!std::freopen("/dev/null", "w", stdout)) return 1;
    }
    RenderOptions options;
    std::optional<int> done;
    const bool parsed = ranks.agree([&] {
        CLI::App app("Renders a glTF scene by bidirectional methods", "lacuna-render");
        declareOptions(app, options);
        done = parseCommandLine(app, argc, argv);
        if (done) return;
        options.commandLine = commandLineText(argc, argv);
        if (!options.listMethods && options.helpMethod.empty()) checkOptions(options);
        if (onlyPrints(options)) done = ranks.leads() ? print(options) : 0;
    });
    if (!parsed) return 0;
    return done ? *done : renderPicture(options, ranks);
}

}  // namespace
}  // namespace lacuna

int main(int argc, char** argv) {
    return lacuna::runTool([&] { return lacuna::render(argc, argv); });
}
