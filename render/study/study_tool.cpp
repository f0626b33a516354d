// lacuna-study: measures the time that accuracy costs. Runs lacuna-render for every scene, method,
// setting and seed, and makes tables and a page from the logs.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>

#include "libcore/base/error.h"
#include "libcore/base/own_files.h"
#include "libcore/tool/interrupt.h"
#include "render/study/execute.h"
#include "render/study/page.h"
#include "render/study/report.h"

namespace lacuna {
namespace {

struct StudyCommand {
    std::string study, output, summary;
    bool quick = false;
    CommonOptions common;
};

void declare(CLI::App& app, StudyCommand& options) {
    app.add_option("STUDY", options.study, "Study to run: see render/README.md")
        ->type_name("STUDY.json")
        ->required();
    app.add_option("-o,--output", options.output, "Folder for everything that is written")
        ->type_name("DIR")
        ->required();
    app.add_flag("--quick", options.quick, "Run the study as its member \"quick\" changes it");
    app.add_option("--summary", options.summary,
                   "Also write the tables, and how they were made, to this file")
        ->type_name("FILE.md");
    addCommonOptions(app, options.common);
    app.footer(
        "Runs lacuna-render (the one beside this program) for every scene, method, setting and\n"
        "seed. Interrupted or run again, it goes on where it stopped and repeats only what has\n"
        "changed: study, scene, reference or renderer.\n"
        "--cache and --seed are accepted as by every tool and change nothing: caches are built\n"
        "anew for every run, and seeds are the study's.\n"
        "Examples:\n"
        "  lacuna-study door.json -o out/door\n"
        "  lacuna-study door.json -o out/door --quick --summary FILE.md\n"
        "Exit codes: 0 done, 1 failed while running, 2 usage, 3 the study, a scene or an image\n"
        "cannot be used, 130 interrupted.");
}

std::string rendererBesideUs() {
    const std::string path =
        (std::filesystem::read_symlink("/proc/self/exe").parent_path() / "lacuna-render").string();
    if (!std::filesystem::exists(path)) {
        throw RunError(path + ": expected lacuna-render beside lacuna-study, found none; build it");
    }
    return path;
}

}  // namespace

int studyTool(int argc, char** argv) {
    CLI::App app("Measures error against time, for scenes, methods, settings and seeds",
                 "lacuna-study");
    StudyCommand options;
    declare(app, options);
    if (const auto done = parseCommandLine(app, argc, argv)) return *done;

    const NamedFile results[] = {{"--summary", options.summary}, {"--json", options.common.json}};
    const NamedFile inputs[] = {{"the study", options.study}};
    requireOwnFiles(results, inputs);
    Study study = readStudy(options.study, options.quick);
    if (options.common.threads > 0) study.threads = options.common.threads;
    const std::string renderer = rendererBesideUs();
    const std::string chartLibrary =
        readChartLibrary();  // read now: if it is missing, the error comes early
    const InterruptGuard interrupt;
    TerminalProgress progress(options.common.quiet, interrupt.requested(),
                              "interrupted: ending the running render (again: exit at once)");

    const Execution execution =
        execute(study, options.output, renderer, interrupt.requested(), progress);
    progress.phase("tables and page");
    const std::vector<std::string> written =
        writeReport(execution.results, options.output, commandLineText(argc, argv), chartLibrary,
                    {options.summary, options.common.json});
    std::printf("%zu runs, %zu of them rendered now\n", execution.results.runs.size(),
                execution.rendered);
    for (const std::string& path : written) std::printf("%s\n", path.c_str());
    return 0;
}

}  // namespace lacuna
