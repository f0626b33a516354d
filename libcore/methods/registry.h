// The table of methods. Adding one = one file in this folder, one row in registry.cpp, one
// reference.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "libcore/base/options.h"
#include "libcore/bidir/method.h"
#include "libcore/bidir/sampler.h"
#include "libcore/guide/emission_settings.h"
#include "libcore/guide/walk_settings.h"

namespace lacuna {

/// Something that has to be made of the scene before a row renders.
struct AssetNeed {
    std::string name;             ///< of the asset: "skeleton"
    std::string prefix;           ///< of its options among the row's: "voxels."
    std::vector<Option> options;  ///< of how it is made
    /// Whether a render with these settings of the row needs it; empty: all do.
    std::function<bool(const Settings&)> wanted = {};
};

/// The description of a method for the integrator, the command line, the documentation
/// and the tests.
struct MethodRow {
    std::string name = {};
    std::string reference = {};  ///< key in REFERENCES.md
    std::string summary = {};    ///< one line
    Techniques techniques = {};
    Emission emission = Emission::Plain;           ///< the default, where there are light subpaths
    Walks walks = Walks::Plain;                    ///< likewise
    Sampling sampling = Sampling::Independent;     ///< likewise
    std::vector<AssetNeed> needs = {};             ///< in the order in which they are made
    std::vector<std::string> proposalLabels = {};  ///< names of Proposal::label, for layers
    bool biased = false;  ///< an experiment of a paper: skipped by tests of unbiasedness
    /// The values that `preset=paper` sets, where the paper's value is not our
    /// default: "name=value".
    std::vector<std::string> paper = {};
    std::vector<Option> options = {};
    std::function<std::unique_ptr<Method>(const Settings&)> create = {};
};

/// Adds the options and needs that follow from the rest of a row, and the row's `own` options. All rows have `walks`.
/// Rows that splat trace light subpaths, so they have `light_paths` and `emission`. Rows that need assets have the
/// options of their making, and rows with a paper's values have `preset`.
void complete(MethodRow& row, std::vector<Option> own);
/// The assets that a render with these settings needs.
std::vector<AssetNeed> needsOf(const MethodRow& row, const Settings& settings);

/// Completes a row with its options, and with how a method is made of them.
template <class Options, class Make>
MethodRow methodRow(MethodRow row, const OptionTable<Options>& table, Make make) {
    complete(row, table.options());
    row.create = [table, make](const Settings& settings) -> std::unique_ptr<Method> {
        return make(table.read(settings));
    };
    return row;
}

/// All rows, in the order of --list-methods.
std::span<const MethodRow> methods();
/// The row of this name. Throws UsageError, which begins with `title` and lists the names.
const MethodRow& findMethod(const std::string& name, const std::string& title = "method");
/// Defaults overridden by "name=value" texts, the preset's values first. Throws UsageError naming
/// the option, its range and what was found; `title` ("--set ") stands before names.
Settings resolve(const MethodRow& row, std::span<const std::string> assignments,
                 const std::string& title = {});
/// Whether pictures with these settings are consistent but not unbiased, because they merge.
bool isConsistentOnly(const MethodRow& row, const Settings& settings);
/// The row with the techniques that it has with these settings: where it merges, it has no specular
/// chains and no known ways.
MethodRow asSet(MethodRow row, const Settings& settings);
/// L, the light subpaths per iteration that splat; 0: one per pixel, or none splat.
std::uint64_t lightPathsOf(const Settings& settings);

}  // namespace lacuna
