#include "render/study/provenance.h"

#include <ctime>
#include <set>

#include "libcore/base/text_list.h"
#include "render/study/spread.h"

namespace lacuna {
namespace {

std::string today() {
    const std::time_t now = std::time(nullptr);
    char text[16];
    std::strftime(text, sizeof text, "%Y-%m-%d", std::gmtime(&now));
    return text;
}

std::string code(const std::string& text) {
    return text.empty() ? "" : "`" + text + "`";
}

std::string threadsText(const Results& results) {
    std::set<int> counts;
    for (const RunResult& run : results.runs) counts.insert(run.report.at("threads").get<int>());
    std::vector<std::string> texts;
    for (const int count : counts) texts.push_back(std::to_string(count));
    return joined(texts, " or ") + " of them used";
}

std::string sceneRow(const Results& results, std::size_t s) {
    const SceneFacts& facts = results.facts[s];
    int runs = 0;
    double seconds = 0.0, setup = 0.0;
    for (const RunResult& run : results.runs) {
        if (run.run.scene != s) continue;
        ++runs;
        seconds += run.report.at("seconds").get<double>();
        setup += run.report.at("setup_seconds").get<double>();
    }
    return "| " + results.study.scenes[s].name + " | " + std::to_string(facts.crop.width()) +
           " x " + std::to_string(facts.crop.height()) + " | " + std::to_string(runs) + " | " +
           shortNumber(seconds) + " | " + shortNumber(setup) + " |\n";
}

std::string settingRow(const StudyMethod& method) {
    return "| " + method.name + " | " + method.method + " | " +
           code(joined(method.assignments, " ")) + " | " + code(joined(method.options, " ")) +
           " |\n";
}

}  // namespace

std::string provenance(const Results& results, const std::string& command) {
    const Study& study = results.study;
    std::string text = "| | |\n|---|---|\n| date | " + today() + " |\n| commit | " +
                       sourceCommit() + " |\n| machine | " + results.machine + ", " +
                       threadsText(results) + " |\n| command | " + code(command) +
                       " |\n| each run | " + code(joined(study.effort, " ")) + " |\n";
    text +=
        "\n| scene | pixels | runs | seconds of rendering | seconds of setup |\n"
        "|---|---|---|---|---|\n";
    for (std::size_t s = 0; s < study.scenes.size(); ++s) text += sceneRow(results, s);
    text += "\n| setting | method | parameters | options |\n|---|---|---|---|\n";
    for (const StudyMethod& method : study.methods) text += settingRow(method);
    return text;
}

}  // namespace lacuna
