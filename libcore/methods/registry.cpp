#include "libcore/methods/registry.h"

#include <algorithm>

#include "libcore/base/error.h"
#include "libcore/base/text_list.h"

namespace lacuna {

// Each row is defined in the file that bears the method's name.
MethodRow ptRow(), ltRow(), bptRow(), lvcbptRow(), pcbptRow(), risbptRow(), risbptCurrentRow(),
    tsrbptRow(), icbptRow(), skelbptRow(), spcbptRow(), spcbptFifoRow(), sharebptRow(), vcmRow(),
    ppmRow();

std::span<const MethodRow> methods() {
    static const std::vector<MethodRow> rows = {ptRow(),
                                                ltRow(),
                                                bptRow(),
                                                lvcbptRow(),
                                                pcbptRow(),
                                                risbptRow(),
                                                risbptCurrentRow(),
                                                tsrbptRow(),
                                                icbptRow(),
                                                skelbptRow(),
                                                spcbptRow(),
                                                spcbptFifoRow(),
                                                sharebptRow(),
                                                vcmRow(),
                                                ppmRow()};
    return rows;
}

const MethodRow& findMethod(const std::string& name, const std::string& title) {
    for (const MethodRow& row : methods()) {
        if (row.name == name) return row;
    }
    throw UsageError(title + ": expected one of " + joined(methods(), ", ", &MethodRow::name) +
                     ", found '" + name + "'");
}

namespace {

const char* const kPreset = "preset";
const char* const kPaper = "preset=paper";

/// The options of every row that splats; read by lightPathsOf.
struct SplatOptions {
    std::uint64_t lightPaths = 0;
};
const OptionTable<SplatOptions>& splatOptions() {
    static const auto table =
        OptionTable<SplatOptions>()
            .integer("light_paths", &SplatOptions::lightPaths, 0, 1e9, "light subpaths",
                     "traced in each iteration for the lens to see (t = 1); 0: one per pixel of "
                     "the full image")
            .standardText("width x height");
    return table;
}

}  // namespace

void complete(MethodRow& row, std::vector<Option> own) {
    std::vector<Option>& all = row.options;
    const auto areGuided = [](const Settings& settings) {
        return walkOptions({}).read(settings).walks == Walks::Guided;
    };
    row.needs.insert(row.needs.begin(),
                     AssetNeed{"walks", "", walkOptions(row.walks).options(), areGuided});
    if (row.techniques.splats) {
        all = splatOptions().options();
        const auto isLearned = [](const Settings& settings) {
            return emissionOptions({}).read(settings).emission == Emission::Learned;
        };
        // It comes first: everything else is learned from light subpaths that begin as it says.
        row.needs.insert(
            row.needs.begin(),
            AssetNeed{"emission", "", emissionOptions(row.emission).options(), isLearned});
    }
    for (Option& option : own) all.push_back(std::move(option));
    for (const AssetNeed& need : row.needs) {
        for (Option option : need.options) {
            option.name = need.prefix + option.name;
            all.push_back(std::move(option));
        }
    }
    if (!row.paper.empty()) {
        Option preset{kPreset, Option::Kind::Choice,
                      "our defaults, which measured best, or the paper's values; parameters that "
                      "you set override both"};
        preset.choices = {"measured", "paper"};
        preset.standard = "measured";
        all.push_back(std::move(preset));
    }
}

std::vector<AssetNeed> needsOf(const MethodRow& row, const Settings& settings) {
    std::vector<AssetNeed> needs;
    for (const AssetNeed& need : row.needs) {
        if (!need.wanted || need.wanted(settings)) needs.push_back(need);
    }
    return needs;
}

Settings resolve(const MethodRow& row, std::span<const std::string> assignments,
                 const std::string& title) {
    std::vector<std::string> all;
    if (std::find(assignments.begin(), assignments.end(), kPaper) != assignments.end()) {
        all = row.paper;
    }
    all.insert(all.end(), assignments.begin(), assignments.end());
    return resolveOptions(row.options, all, "method " + row.name, title);
}

bool isConsistentOnly(const MethodRow& row, const Settings& settings) {
    return row.create(settings)->merging().where != Merges::Nowhere;
}

MethodRow asSet(MethodRow row, const Settings& settings) {
    if (isConsistentOnly(row, settings)) row.techniques.chains = row.techniques.knownWays = false;
    return row;
}

std::uint64_t lightPathsOf(const Settings& settings) {
    if (!settings.contains(splatOptions().bindings()[0].option.name)) return 0;
    return splatOptions().read(settings).lightPaths;
}

}  // namespace lacuna
