#include "render/picture.h"

#include <string>

#include "libcore/base/error.h"
#include "libcore/base/parallel.h"
#include "libcore/base/stopwatch.h"
#include "libcore/image/image_io.h"
#include "render/block_maker.h"
#include "render/checkpoint.h"
#include "render/choose/choose.h"
#include "render/first_look.h"
#include "render/ranks/together.h"
#include "render/render_inputs.h"
#include "render/session.h"
#include "render/stage.h"

namespace lacuna {
namespace {

/// Checks that all ranks have the same program, scene and command.
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

/// With --write-every, writes a first small picture, so that viewers need not wait for training.
void showFirst(const RenderOptions& options, const Image& small) {
    if (!options.writeEverySeconds) return;
    LayeredImage image(small.width, small.height);
    image.setRgb("", small);
    image.attributes["stopped"] = std::string("no: choosing a method");
    writeImage(options.output, image, options.png);
}

/// The choice of `auto` for this picture. Rank 0 chooses, or reads the choice from a checkpoint.
RowChoice choose(const RenderOptions& options, Stage& stage, const Ranks& ranks,
                 const ThreadPool& pool, const std::atomic<bool>& interrupted, Progress& progress) {
    if (!ranks.leads()) return RowChoice::ofText(textOf(ranks.wait()));
    const auto found = [&]() -> RowChoice {
        if (!options.checkpoint.empty()) {
            const auto inputs = checkpointInputs(options.checkpoint);
            if (inputs) return RowChoice::ofInputs(*inputs);
        }
        const Stopwatch watch(stage.setupSeconds), phase(stage.phaseSeconds["choose"]);
        return chooseMethod(options, stage, pool, interrupted, progress,
                            [&](const Image& small) { showFirst(options, small); });
    };
    const RowChoice choice = found();
    progress.remark("auto: " + choice.method + ", " + choice.why +
                    "; the same by name: " + choice.byName());
    return choice;
}

}  // namespace

std::optional<Rendered> renderPicture(RenderOptions& options, const Ranks& ranks,
                                      const std::atomic<bool>& interrupted, Progress& progress) {
    const MethodRow* row = nullptr;
    Settings settings;
    const bool checked = ranks.agree([&] {
        row = &namedRow(options);
        if (options.samplerText.empty()) options.sampling = row->sampling;
        settings = resolve(*row, options.assignments, "--set ");
        if (options.verify && ranks.many()) {
            throw UsageError("--verify: expected one process, found " +
                             std::to_string(ranks.size()) + " ranks; leave it or mpirun out");
        }
        if (ranks.leads()) checkOutputs(options);
    });
    if (!checked) return std::nullopt;

    const ThreadPool pool = threadsOf(options.common);
    std::optional<Stage> stage;
    std::optional<FirstLook> look;
    const bool loaded = ranks.agree([&] {
        stage = loadStage(options, *row, settings, pool, progress);
        // Before the preparation is done, an interrupt saves nothing.
        const bool prepares = options.method == kAuto || !needsOf(*row, settings).empty();
        progress.phase("features", prepares ? kNothingWritten : nullptr);
        look.emplace(*stage, pool, interrupted);
    });
    if (!loaded) return std::nullopt;
    std::optional<RowChoice> choice;
    if (options.method == kAuto) {
        for (const bool leaders : {true, false}) {
            const bool chosen = ranks.agree([&] {
                if (ranks.leads() != leaders) return;
                choice = choose(options, *stage, ranks, pool, interrupted, progress);
                row = &findMethod(choice->method);
                settings = resolve(*row, choice->assignments);
                options.sampling = choice->sampling;
                useMethod(*stage, options, *row, settings);
                for (int i = 1; leaders && i < ranks.size(); ++i) {
                    ranks.send(i, Ranks::Tag::Inputs, choice->text());
                }
            });
            if (!chosen) return std::nullopt;
        }
        options.prepare = !needsOf(*row, settings).empty();
    }
    // Rank 0 makes missing caches; the others read them.
    Caches caches;
    if (!ranks.leads()) options.prepare = false;
    for (const bool leaders : {true, false}) {
        const bool there = ranks.agree([&] {
            if (ranks.leads() != leaders) return;
            caches = loadCaches(options, *row, settings, *stage, pool, interrupted, progress);
        });
        if (!there) return std::nullopt;
    }

    BlockMaker maker(options, *row, settings, *stage, caches, pool);
    if (ranks.many()) {
        const CacheStamp inputs =
            renderInputs(options, *row, settings, *stage, caches, maker.plan());
        if (!ranks.agree([&] { compareInputs(ranks, inputs); })) return std::nullopt;
    }
    std::optional<Session> session;
    const bool ready = ranks.agree([&] {
        if (!ranks.leads()) return;
        session.emplace(options, *row, settings, choice, *stage, caches, *look, maker, ranks, pool,
                        interrupted, progress);
    });
    if (!ready) return std::nullopt;
    if (session) return session->run();
    serve(ranks, maker, look->meter, stage->settings.crop, interrupted, pool);
    return std::nullopt;
}

}  // namespace lacuna
