#include "libcore/gltf/extras.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <initializer_list>

#include "libcore/base/extent.h"
#include "libcore/gltf/guard.h"

namespace lacuna::gltf {
namespace {

using nlohmann::json;

constexpr const char* kCorrect = "correct scene.extras";
constexpr const char* kCorrectOwn = "correct its extras";

/// Access to the members of an extras object by name; errors name the object's place.
class Members {
  public:
    Members(const Document& document, const json& object, std::string place)
        : document_(document), object_(object), place_(std::move(place)) {}

    std::optional<int> integer(const char* name, int least, int most) const {
        const auto found = object_.find(name);
        if (found == object_.end()) return {};
        if (!found->is_number_integer() || *found < least || *found > most) {
            refuse(document_.file, place_ + "." + name,
                   "an integer from " + std::to_string(least) + " to " + std::to_string(most),
                   printable(found->dump(), 60), kCorrect);
        }
        return found->get<int>();
    }

    std::optional<double> number(const char* name, double least, double most,
                                 const std::string& expected) const {
        const auto found = object_.find(name);
        if (found == object_.end()) return {};
        if (!found->is_number() || !(found->get<double>() >= least) ||
            !(found->get<double>() <= most)) {
            refuse(document_.file, place_ + "." + name, expected, printable(found->dump(), 60),
                   kCorrect);
        }
        return found->get<double>();
    }

    void warnAboutOthers(std::initializer_list<const char*> known, Warnings& warnings) const {
        for (auto member = object_.begin(); member != object_.end(); ++member) {
            const bool isKnown = std::any_of(
                known.begin(), known.end(), [&](const char* name) { return member.key() == name; });
            warnings.add("unknown members of scene.extras are ignored", !isKnown,
                         place_ + "." + member.key());
        }
    }

  private:
    const Document& document_;
    const json& object_;
    std::string place_;
};

/// Parses `text` as JSON. Custom properties that are typed into Blender arrive as strings.
json parseText(const Document& document, const std::string& place, const std::string& text,
               const std::string& expected, const char* remedy = kCorrect) {
    checkJsonDepth(document.file, text);
    try {
        return json::parse(text);
    } catch (const json::exception& error) {
        refuse(document.file, place, expected,
               '"' + printable(text, 60) + "\" (" + error.what() + ")", remedy);
    }
}

void readPicture(const Document& document, const json& extras, SceneDescription& scene,
                 Warnings& warnings) {
    const auto entry = extras.find("lacuna");
    if (entry == extras.end()) return;
    const std::string place = "scene.extras.lacuna";
    const std::string expected = "an object, or one as a text of JSON such as {\"width\": 640}";
    const json lacuna =
        entry->is_string()
            ? parseText(document, place, entry->get_ref<const std::string&>(), expected)
            : *entry;
    if (!lacuna.is_object()) {
        refuse(document.file, place, expected, printable(entry->dump(), 60), kCorrect);
    }
    const Members members(document, lacuna, place);
    scene.width = members.integer("width", 1, 65536);
    scene.height = members.integer("height", 1, 65536);
    scene.maxDepth = members.integer("max_depth", 1, 1000);
    scene.aperture = members.number("aperture", 0.0, kFarthest, "a radius from 0 to 1e17");
    scene.focus =
        members.number("focus", kNearestFocus, kFarthest, "a distance from 1e-15 to 1e17");
    members.warnAboutOthers({"width", "height", "max_depth", "aperture", "focus"}, warnings);
}

/// Whether a string holds an object and not a file's name.
bool looksLikeObject(const json& value) {
    if (!value.is_string()) return false;
    const auto& text = value.get_ref<const std::string&>();
    const std::size_t first = text.find_first_not_of(" \t\r\n");
    return first != std::string::npos && text[first] == '{';
}

void readEnvironment(Document& document, const json& extras, SceneDescription& scene,
                     Warnings& warnings) {
    const auto found = extras.find("environment");
    if (found == extras.end()) return;
    const std::string place = "scene.extras.environment";
    const std::string expected = "a file name, or an object with `file`";
    const json entry =
        looksLikeObject(*found)
            ? parseText(document, place, found->get_ref<const std::string&>(), expected)
            : *found;
    EnvironmentDescription environment;
    const json* name = &entry;
    if (entry.is_object()) {
        const Members members(document, entry, place);
        environment.scale =
            members.number("scale", 0.0, 1e30, "a number from 0 to 1e30").value_or(1.0);
        environment.rotationDegrees =
            members.number("rotation_degrees", -1e6, 1e6, "an angle in degrees").value_or(0.0);
        members.warnAboutOthers({"file", "scale", "rotation_degrees"}, warnings);
        const auto file = entry.find("file");
        if (file == entry.end()) refuse(document.file, place + ".file", "a name", "none", kCorrect);
        name = &*file;
    }
    if (!name->is_string()) {
        refuse(document.file, place, expected, printable(name->dump(), 60), kCorrect);
    }
    const std::filesystem::path path =
        resolveFileName(document.file, place, name->get_ref<const std::string&>());
    std::string ending = path.extension().string();
    std::transform(ending.begin(), ending.end(), ending.begin(),
                   [](unsigned char c) { return char(std::tolower(c)); });
    if (ending != ".exr" && ending != ".hdr") {
        refuse(document.file, place, "a .exr or .hdr file", '"' + path.string() + '"',
               "convert the environment");
    }
    hashFile(path, document.hash, document.file + ", " + place);
    environment.file = path.string();
    scene.environment = std::move(environment);
}

}  // namespace

void readExtras(Document& document, SceneDescription& scene, Warnings& warnings) {
    const auto scenes = document.json.find("scenes");
    if (scenes == document.json.end() || document.scene >= scenes->size()) return;
    const json& source = (*scenes)[document.scene];
    const auto extras = source.find("extras");
    if (extras == source.end() || !extras->is_object()) return;
    readPicture(document, *extras, scene, warnings);
    readEnvironment(document, *extras, scene, warnings);
}

json lacunaExtras(const Document& document, const json& extras, const std::string& place) {
    const auto found = extras.is_object() ? extras.find("lacuna") : extras.end();
    if (found == extras.end()) return json::object();
    const std::string at = place + ".extras.lacuna", expected = "a JSON object, or its text";
    const json lacuna =
        found->is_string()
            ? parseText(document, at, found->get_ref<const std::string&>(), expected, kCorrectOwn)
            : *found;
    if (!lacuna.is_object()) {
        refuse(document.file, at, expected, printable(lacuna.dump(), 60), kCorrectOwn);
    }
    return lacuna;
}

std::string lightGroupOf(const Document& document, const json& lacuna, const std::string& place) {
    const auto group = lacuna.find("light_group");
    if (group == lacuna.end()) return {};
    if (!group->is_string() || group->get_ref<const std::string&>().empty()) {
        refuse(document.file, place + ".extras.lacuna.light_group", "a name",
               printable(group->dump(), 60), kCorrectOwn);
    }
    return group->get<std::string>();
}

std::string nodeGroup(const Document& document, std::size_t node) {
    const json& extras = document.nodes[node].extras;
    if (extras.is_null()) return {};
    const std::string place = "nodes[" + std::to_string(node) + "]";
    return lightGroupOf(document, lacunaExtras(document, extras, place), place);
}

}  // namespace lacuna::gltf
