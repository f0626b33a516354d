#include "render/study/study_file.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>

#include "libcore/base/error.h"
#include "libcore/base/text_list.h"
#include "libcore/methods/registry.h"
#include "render/study/json_object.h"

namespace lacuna {
namespace {

using nlohmann::json;

const std::vector<std::string> kMeasures = {"mae", "rmse", "mape", "relmse"};

/// Options that a study's file may set; the study itself sets the others (outputs, seeds, limits).
const std::set<std::string> kOptions = {"width",  "height",     "crop",      "camera",
                                        "env",    "env-rotate", "env-scale", "aperture",
                                        "focus",  "max-depth",  "rr-depth",  "block-iterations",
                                        "effect", "tolerance",  "sampler",   "units"};

/// Options that a command line may have several times. A study may give them an array of texts.
const std::set<std::string> kRepeated = {"effect"};

/// Resolves a path relative to the study's file, unless it is absolute or in the shared folder of
/// scenes.
std::string resolvePath(const std::string& studyFile, const std::string& path) {
    constexpr std::string_view kSharedFolder = "$LACUNA_SHARED_SCENES/";
    if (path.starts_with(kSharedFolder)) {
        const std::string name = path.substr(kSharedFolder.size());
        const char* folder = std::getenv("LACUNA_SHARED_SCENES");
        if (!folder || !*folder) {
            throw InputError(studyFile + ": " + name +
                             ": expected the environment variable LACUNA_SHARED_SCENES to name the "
                             "folder of this file, which is not part of the project, found it not "
                             "set; set it, or use --quick where the study has a smaller scene");
        }
        return (std::filesystem::path(folder) / name).lexically_normal().string();
    }
    return (std::filesystem::path(studyFile).parent_path() / path).lexically_normal().string();
}

std::string valueText(const json& value) {
    if (value.is_boolean()) return value.get<bool>() ? "on" : "off";
    return value.is_string() ? value.get<std::string>() : value.dump();
}

void requireScalar(const JsonObject& object, const std::string& key, const json& value) {
    if (value.is_structured() || value.is_null()) object.fail(key, "a number, a text or a switch");
}

std::vector<std::string> readOptions(JsonObject object, const std::string& studyFile) {
    std::vector<std::string> arguments;
    const auto add = [&](const std::string& key, const std::string& text) {
        arguments.insert(arguments.end(), {"--" + key, text});
    };
    for (const auto& [key, value] : object.members().items()) {
        if (!kOptions.contains(key)) {
            object.fail(key, "one of the options " + joined(kOptions, ", "));
        }
        if (value.is_array() && kRepeated.contains(key)) {
            for (const std::string& text : object.texts(key)) add(key, text);
            continue;
        }
        requireScalar(object, key, value);
        add(key, key == "env" ? resolvePath(studyFile, valueText(value)) : valueText(value));
    }
    return arguments;
}

/// `options`, and those of `defaults` that they do not override.
std::vector<std::string> withDefaults(std::vector<std::string> options,
                                      const std::vector<std::string>& defaults) {
    const std::size_t own = options.size();
    for (std::size_t i = 0; i < defaults.size(); i += 2) {
        bool overridden = false;
        for (std::size_t j = 0; j < own; j += 2) {
            overridden = overridden || options[j] == defaults[i];
        }
        if (overridden) continue;
        options.insert(options.end(), {defaults[i], defaults[i + 1]});
    }
    return options;
}

void requireUnique(JsonObject& object, std::set<std::string>& names, const std::string& name) {
    if (!names.insert(name).second) {
        object.fail("name", "a name of its own ('" + name + "' is there twice)");
    }
}

std::vector<double> readBounds(JsonObject& object, const std::string& measure) {
    std::vector<double> bounds = object.positives(measure);
    std::sort(bounds.rbegin(), bounds.rend());
    return bounds;
}

std::map<std::string, std::vector<double>> readBounds(JsonObject object) {
    std::map<std::string, std::vector<double>> bounds;
    for (const std::string& measure : kMeasures) {
        if (object.has(measure)) bounds[measure] = readBounds(object, measure);
    }
    object.finish();
    return bounds;
}

std::vector<StudyCrop> readCrops(JsonObject& scene) {
    std::vector<StudyCrop> crops;
    std::set<std::string> names;
    for (JsonObject& object : scene.objects("crops")) {
        const std::string name = object.text("name");
        requireUnique(object, names, name);
        const auto pixels = [&](const char* key, int low) {
            return int(object.integer(key, low, kMaxImageSide));
        };
        const int x = pixels("x", 0), y = pixels("y", 0);
        crops.push_back({name, {x, x + pixels("width", 1), y, y + pixels("height", 1)}});
        object.finish();
    }
    return crops;
}

TechniqueRequest readTechniques(JsonObject object) {
    constexpr int kEdges = 5, kMostEdges = 12;
    TechniqueRequest request{object.integer("iterations", 1, 1'000'000'000), kEdges};
    if (object.has("edges")) request.edges = int(object.integer("edges", 1, kMostEdges));
    object.finish();
    return request;
}

std::vector<std::string> readAssignments(JsonObject set) {
    std::vector<std::string> assignments;
    for (const auto& [key, value] : set.members().items()) {
        requireScalar(set, key, value);
        assignments.push_back(key + "=" + valueText(value));
    }
    return assignments;
}

ReferenceRecipe readRecipe(JsonObject& object) {
    ReferenceRecipe recipe{object.text("method"), readAssignments(object.object("set")),
                           object.integer("iterations", 2, 1'000'000'000),
                           object.integer("parts", 1, 100'000)};
    if (findMethod(recipe.method, "reference: method").biased) {
        object.fail("method", "a method without bias");
    }
    return recipe;
}

StudyScene readScene(JsonObject& object, const Study& study) {
    StudyScene scene;
    scene.file = resolvePath(study.file, object.text("file"));
    scene.name = object.has("name") ? object.text("name")
                                    : std::filesystem::path(scene.file).stem().string();
    scene.options = readOptions(object.object("options"), study.file);
    if (!object.has("reference")) {
        object.fail("reference", "an image, or {method, iterations, parts} to render one");
    }
    if (object.value("reference").is_string()) {
        scene.reference = resolvePath(study.file, object.text("reference"));
    } else {
        JsonObject recipe = object.object("reference");
        if (recipe.has("file")) scene.reference = resolvePath(study.file, recipe.text("file"));
        scene.recipe = readRecipe(recipe);
        recipe.finish();
    }
    if (object.has("bounds")) scene.bounds = readBounds(object.object("bounds"));
    if (object.has("crops")) scene.crops = readCrops(object);
    object.finish();
    return scene;
}

/// Reads a method: one entry, or with `vary` {"KEY": [values]} one entry per value. KEY is a
/// parameter, or an option with its dashes.
std::vector<StudyMethod> readMethod(JsonObject& object, const Study& study) {
    StudyMethod base;
    base.method = object.text("method");
    base.name = object.has("name") ? object.text("name") : base.method;
    base.assignments = readAssignments(object.object("set"));
    base.options = readOptions(object.object("options"), study.file);
    if (!object.has("vary")) {
        object.finish();
        return {base};
    }
    JsonObject vary = object.object("vary");
    object.finish();
    if (vary.members().size() != 1) object.fail("vary", "one key with its values");
    base.knob = vary.members().begin().key();
    base.knobGroup = base.name;
    const json& values = vary.members().begin().value();
    if (!values.is_array() || values.empty()) vary.fail(base.knob, "an array of values");
    std::vector<StudyMethod> all;
    for (const json& value : values) {
        requireScalar(vary, base.knob, value);
        StudyMethod method = base;
        method.knobValue = valueText(value);
        if (base.knob.starts_with("--")) {
            if (std::count(base.options.begin(), base.options.end(), base.knob) > 0) {
                vary.fail(base.knob, "an option that `options` does not set");
            }
            const json option{{base.knob.substr(2), value}};
            const JsonObject reader(option, vary.place());
            for (const std::string& argument : readOptions(reader, study.file)) {
                method.options.push_back(argument);
            }
        } else {
            method.assignments.push_back(base.knob + "=" + method.knobValue);
        }
        method.name += " " + base.knob + "=" + method.knobValue;
        all.push_back(std::move(method));
    }
    return all;
}

void readEffort(JsonObject& object, Study& study) {
    if (object.has("time")) {
        const json& time = object.value("time");
        study.effort = {"--time", time.is_number() ? time.dump() : object.text("time")};
    }
    if (object.has("iterations")) {
        study.effort.push_back("--iterations");
        study.effort.push_back(std::to_string(object.integer("iterations", 1, 1'000'000'000)));
    }
    if (study.effort.empty()) object.fail("time", "a limit such as \"60s\" (or iterations)");
}

void readSeeds(JsonObject& object, Study& study) {
    for (const double seed : object.positives("seeds")) {
        if (seed >= 1e6 || seed != std::uint64_t(seed)) {
            object.fail("seeds", "integers below a million (references take those above)");
        }
        study.seeds.push_back(std::uint64_t(seed));
    }
    if (std::set(study.seeds.begin(), study.seeds.end()).size() != study.seeds.size()) {
        object.fail("seeds", "every seed once");
    }
}

/// Reports errors that lacuna-render would report before it loads the scene.
void requireRenderable(const Study& study, const StudyScene& scene, const StudyMethod& method) {
    std::vector<std::string> arguments{scene.file, "-o", "x.exr", "--method", method.method};
    const std::vector<std::string> ofScene = mergedOptions(scene, method);
    for (const auto* more : {&ofScene, &study.effort}) {
        arguments.insert(arguments.end(), more->begin(), more->end());
    }
    for (const std::string& assignment : method.assignments) {
        arguments.insert(arguments.end(), {"--set", assignment});
    }
    try {
        const RenderOptions options = parseRenderArguments(arguments);
        resolve(namedRow(options), options.assignments, "--set ");
    } catch (const UsageError& e) {
        throw UsageError(study.file + ": method '" + method.name + "': " + e.what());
    }
}

}  // namespace

std::vector<std::string> mergedOptions(const StudyScene& scene, const StudyMethod& method) {
    return withDefaults(method.options, scene.options);
}

RenderOptions parseRenderArguments(const std::vector<std::string>& arguments) {
    CLI::App app("", "lacuna-render");
    RenderOptions options;
    declareOptions(app, options);
    std::vector<const char*> argv{"lacuna-render"};
    for (const std::string& argument : arguments) argv.push_back(argument.c_str());
    parseCommandLine(app, int(argv.size()), argv.data());
    checkOptions(options);
    return options;
}

Study readStudy(const std::string& path, bool quick) {
    json content = readJsonFile(path);
    if (content.is_object() && content.contains("quick")) {
        const json patch = content["quick"];
        content.erase("quick");
        if (quick) content.merge_patch(patch);
    }
    JsonObject object(content, path);
    Study study;
    study.file = path;
    study.title = object.text("title");
    if (object.has("about")) {
        study.about = object.value("about").is_string() ? std::vector{object.text("about")}
                                                        : object.texts("about");
    }
    readSeeds(object, study);
    readEffort(object, study);
    if (object.has("threads")) study.threads = int(object.integer("threads", 1, 4096));
    study.measures = object.has("measures") ? object.texts("measures") : kMeasures;
    for (const std::string& measure : study.measures) {
        if (std::count(kMeasures.begin(), kMeasures.end(), measure) != 1) {
            object.fail("measures", "names among mae, rmse, mape, relmse");
        }
    }
    if (object.has("times")) study.times = object.positives("times");
    if (object.has("equal_iterations")) study.iterations = object.positives("equal_iterations");
    if (object.has("techniques")) study.techniques = readTechniques(object.object("techniques"));
    const auto bounds = object.has("bounds") ? readBounds(object.object("bounds"))
                                             : std::map<std::string, std::vector<double>>{};

    const std::vector<std::string> options = readOptions(object.object("options"), study.file);

    std::set<std::string> names;
    for (JsonObject& scene : object.objects("scenes")) {
        study.scenes.push_back(readScene(scene, study));
        study.scenes.back().options = withDefaults(study.scenes.back().options, options);
        requireUnique(scene, names, study.scenes.back().name);
        study.scenes.back().bounds.insert(bounds.begin(), bounds.end());
    }
    names.clear();
    for (JsonObject& entry : object.objects("methods")) {
        for (StudyMethod& method : readMethod(entry, study)) {
            requireUnique(entry, names, method.name);
            study.methods.push_back(std::move(method));
        }
    }
    study.baseline = object.has("baseline") ? object.text("baseline") : study.methods[0].name;
    if (!names.contains(study.baseline)) object.fail("baseline", "the name of one of the methods");
    object.finish();
    for (const StudyScene& scene : study.scenes) {
        for (const StudyMethod& method : study.methods) requireRenderable(study, scene, method);
        if (!scene.recipe) continue;
        StudyMethod reference;
        reference.name = "the reference's";
        reference.method = scene.recipe->method;
        reference.assignments = scene.recipe->assignments;
        requireRenderable(study, scene, reference);
    }
    return study;
}

}  // namespace lacuna
