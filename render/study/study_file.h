// The .json file of a study, checked as far as possible without the scenes.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "render/options.h"

namespace lacuna {

/// A reference that the study renders itself: the average of `parts` renders with different seeds.
/// To increase `parts` continues an older reference.
struct ReferenceRecipe {
    std::string method;                    ///< an unbiased method
    std::vector<std::string> assignments;  ///< --set
    std::int64_t iterations = 0;           ///< per part
    std::int64_t parts = 0;
};

/// A part of a scene's picture that the page shows enlarged.
struct StudyCrop {
    std::string name;
    PixelRect rect;  ///< relative to the rendered part's upper left pixel
};

/// Additional renders with a layer per technique. Measured runs do not write such layers, which
/// cost time.
struct TechniqueRequest {
    std::int64_t iterations = 0;
    int edges = 0;  ///< longest paths whose layers the page shows
};

struct StudyScene {
    std::string name;
    std::string file;                  ///< path of the scene
    std::vector<std::string> options;  ///< of lacuna-render: "--width", "192", ..
    /// Path of the reference. If there is a recipe too, it makes the file when it is missing.
    /// Empty: made by recipe and kept in the study's folder.
    std::string reference;
    std::optional<ReferenceRecipe> recipe;
    std::map<std::string, std::vector<double>> bounds;  ///< by measure
    std::vector<StudyCrop> crops;
};

/// One setting of one method: a curve of each plot, a row of each table.
struct StudyMethod {
    std::string name;                      ///< name in plots and tables
    std::string method;                    ///< row of the registry
    std::vector<std::string> assignments;  ///< --set
    std::vector<std::string> options;
    std::string knob;       ///< the key that `vary` varies; empty: none
    std::string knobGroup;  ///< name without the knob's value
    std::string knobValue;
};

struct Study {
    std::string file;
    std::string title;
    std::vector<std::string> about;  ///< text about the settings, by paragraph
    std::vector<std::uint64_t> seeds;
    std::vector<std::string> effort;  ///< "--time", "6s", "--iterations", "64"
    int threads = 0;                  ///< 0: all
    std::string baseline;             ///< name of the method that speedups refer to
    std::vector<std::string> measures;
    std::vector<double> times;       ///< seconds; empty: the longest common to all runs
    std::vector<double> iterations;  ///< empty: the most common to all runs
    std::optional<TechniqueRequest> techniques;
    std::vector<StudyScene> scenes;
    std::vector<StudyMethod> methods;
};

/// Reads and checks a study. `quick`: first merges the file's member "quick" into it (RFC 7386).
/// Throws InputError naming file and key, and UsageError for methods, parameters and options that
/// lacuna-render would reject.
Study readStudy(const std::string& path, bool quick);

/// The options of the scene (with the study's as defaults) and of the method. If both name an
/// option, the method's counts.
std::vector<std::string> mergedOptions(const StudyScene& scene, const StudyMethod& method);

/// Parses arguments of lacuna-render (without the program's name). Throws UsageError.
RenderOptions parseRenderArguments(const std::vector<std::string>& arguments);

}  // namespace lacuna
