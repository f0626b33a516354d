// What a study asks for: the .json file, checked as far as it can be without the scenes.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "render/options.h"

namespace lacuna {

/// A reference that the study renders itself: `parts` renders of different seeds, averaged. More
/// parts continue an older reference.
struct ReferenceRecipe {
    std::string method;                    ///< without bias
    std::vector<std::string> assignments;  ///< --set
    std::int64_t iterations = 0;           ///< of each part
    std::int64_t parts = 0;
};

/// A part of a scene's picture that the page shows enlarged.
struct StudyCrop {
    std::string name;
    PixelRect rect;  ///< of what is rendered: (0, 0) is its upper left pixel
};

/// Renders beside the measured ones, with a layer per technique: writing layers costs time, so that
/// no measured run does.
struct TechniqueRequest {
    std::int64_t iterations = 0;
    int edges = 0;  ///< longest paths whose layers the page shows
};

struct StudyScene {
    std::string name;
    std::string file;                  ///< path that can be opened
    std::vector<std::string> options;  ///< of lacuna-render: "--width", "192", ...
    /// Path of the reference; where the recipe is there too, it makes this file when it is missing.
    /// Empty: by recipe, kept among what the study writes.
    std::string reference;
    std::optional<ReferenceRecipe> recipe;
    std::map<std::string, std::vector<double>> bounds;  ///< by measure
    std::vector<StudyCrop> crops;
};

/// One setting of one method: a curve of each plot, a row of each table.
struct StudyMethod {
    std::string name;                      ///< what plots and tables call it
    std::string method;                    ///< row of the registry
    std::vector<std::string> assignments;  ///< --set
    std::vector<std::string> options;
    std::string knob;       ///< the key that `vary` varies; empty: none
    std::string knobGroup;  ///< name before the knob's value was added
    std::string knobValue;
};

struct Study {
    std::string file;
    std::string title;
    std::vector<std::string> about;  ///< which setting stands for which curve; one paragraph each
    std::vector<std::uint64_t> seeds;
    std::vector<std::string> effort;  ///< "--time", "6s", "--iterations", "64"
    int threads = 0;                  ///< 0: all
    std::string baseline;             ///< name of a method: what speedups are against
    std::vector<std::string> measures;
    std::vector<double> times;       ///< seconds; empty: the longest that all runs have
    std::vector<double> iterations;  ///< empty: the most that all runs have
    std::optional<TechniqueRequest> techniques;
    std::vector<StudyScene> scenes;
    std::vector<StudyMethod> methods;
};

/// Reads and checks. `quick`: the file's member "quick" is merged into it first (RFC 7386). Throws
/// InputError naming file and key; UsageError for methods, parameters and options that
/// lacuna-render would refuse.
Study readStudy(const std::string& path, bool quick);

/// The scene's options (the study's among them, where it has none of its own) and the method's; of
/// one that both name, the method's counts.
std::vector<std::string> mergedOptions(const StudyScene& scene, const StudyMethod& method);

/// What lacuna-render would make of these arguments (without its own name). Throws UsageError.
RenderOptions parseRenderArguments(const std::vector<std::string>& arguments);

}  // namespace lacuna
