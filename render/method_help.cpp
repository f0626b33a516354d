#include "render/method_help.h"

#include <algorithm>

#include "render/choose/choice.h"
#include "render/choose/choose.h"

namespace lacuna {
namespace {

constexpr const char* kAutoSummary =
    "chooses one of these for the scene, and prepares what it needs";

std::string padded(std::string text, std::size_t width) {
    text.resize(std::max(text.size(), width), ' ');
    return text;
}

}  // namespace

std::string listMethods() {
    std::size_t width = 0;
    for (const MethodRow& row : methods()) width = std::max(width, row.name.size());
    std::string text = padded(kAuto, width + 2) + kAutoSummary + " (default)\n";
    for (const MethodRow& row : methods()) {
        text += padded(row.name, width + 2) + row.summary + " [" + row.reference + "]" +
                (row.biased                                ? " (biased: an experiment)"
                 : isConsistentOnly(row, resolve(row, {})) ? " (consistent, not unbiased)"
                                                           : "") +
                "\n";
    }
    return text;
}

std::string autoHelp() {
    return std::string(kAuto) + ": " + kAutoSummary + "\nTries " + triedMethods() +
           " on a small picture, whose samples are thrown away; those that merge only with "
           "--allow-bias.\n"
           "With --time the choice depends on the clock too, else on the command and the scene "
           "alone.\n"
           "stderr, the header (`chosen`) and the JSON say what was chosen and why, and how to ask "
           "for\n"
           "the same by name.\n";
}

std::string methodHelp(const MethodRow& row) {
    std::string text = row.name + ": " + row.summary + "\nreference: " + row.reference +
                       " (REFERENCES.md)\ntechniques:";
    const Techniques& t = row.techniques;
    if (t.hits) text += "\n  s = 0           eye paths that run into a light";
    if (t.connects) text += "\n  s >= 1, t >= 2  eye vertices connected with light vertices";
    if (t.splats) text += "\n  t = 1           light paths seen by the lens";
    if (t.connects && t.chains) {
        text +=
            "\n  chains          mirrors and smooth glass between a light without a size and an "
            "eye vertex, where nothing else joins the path";
    }
    if (t.hits && t.connects && t.refractions) {
        text +=
            "\n  refractions     smooth or nearly smooth glass between a lamp or the sky and an "
            "eye vertex, and mirrors where nothing else joins the path";
    }
    const Merges merges = row.create(resolve(row, {}))->merging().where;
    if (merges != Merges::Nowhere) {
        text += merges == Merges::FirstFromEye
                    ? "\n  merges          eye vertices up to the first that scatters widely, "
                      "merged with photons"
                    : "\n  merges          eye vertices merged with photons around them";
        text += "\nconsistent, not unbiased: merging blurs the picture, less with every iteration";
    }
    if (row.biased) text += "\nbiased: an experiment of a paper, not for pictures";
    text += "\nrandom numbers (--sampler): " + std::string(nameOf(row.sampling)) +
            "\nparameters (--set NAME=VALUE):\n";
    if (row.options.empty()) text += "  none\n";
    std::size_t width = 0;
    for (const Option& o : row.options) width = std::max(width, o.name.size());
    for (const Option& o : row.options) {
        text += "  " + padded(o.name, width + 2) + o.meaning() + "\n" +
                std::string(width + 4, ' ') + o.range() + "; default " + o.shownDefault() + "\n";
    }
    return text;
}

}  // namespace lacuna
