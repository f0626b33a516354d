#include "libcore/tool/scene_options.h"

#include <CLI/CLI.hpp>
#include <cmath>

#include "libcore/base/error.h"
#include "libcore/base/extent.h"
#include "libcore/base/number_text.h"
#include "libcore/base/text_list.h"
#include "libcore/bidir/full_path.h"
#include "libcore/image/image_io.h"
#include "libcore/tool/tolerance.h"

namespace lacuna {

void addSceneOptions(CLI::App& app, SceneOptions& o) {
    const std::string scene = "Scene";
    app.add_option("--env", o.environment,
                   "Latitude-longitude map, .exr or .hdr, instead of the scene's")
        ->type_name("FILE")
        ->group(scene);
    app.add_option("--env-colour", o.environmentColourText,
                   "The same radiance from everywhere, instead of the scene's environment")
        ->type_name("R,G,B")
        ->group(scene);
    app.add_option("--env-rotate", o.environmentRotation, "Turn the environment about +Y")
        ->type_name("DEG")
        ->group(scene);
    app.add_option("--env-scale", o.environmentScale, "Multiply the environment")
        ->type_name("S")
        ->group(scene);
    app.add_option("--units", o.unitsText,
                   "Unit of points, spots and suns: W/sr and W/m^2 (radiometric, the default), or "
                   "candela and lux (photometric: 683 lumens per watt)")
        ->type_name("radiometric|photometric")
        ->group(scene);
    app.add_option("--effect", o.effectTexts,
                   "Force an effect on or off; lacuna-render --effects lists them; may be repeated")
        ->type_name("NAME=on|off")
        ->allow_extra_args(false)
        ->group(scene);
    app.add_option(
           "--tolerance", o.tolerance,
           "Leave out layers and lamps that hold no more than this share of the energy, and\n"
           "say so (default: 0, nothing)")
        ->type_name("E")
        ->group(scene);
}

void addViewOptions(CLI::App& app, SceneOptions& o) {
    const std::string view = "Picture and camera";
    app.add_option("--width", o.width,
                   "Pixels (default: by --height, else extras.lacuna, else 1280)")
        ->type_name("N")
        ->group(view);
    app.add_option("--height", o.height,
                   "Pixels (default: by --width, else extras.lacuna, else by the aspect)")
        ->type_name("N")
        ->group(view);
    app.add_option("--scale,--size", o.scaleText,
                   "Share of the picture's sides: 50%; or both sides: 640x360")
        ->type_name("P%")
        ->group(view);
    app.add_option("--camera", o.camera, "Camera of the scene (default: the first)")
        ->type_name("NAME")
        ->group(view);
    app.add_option("--shift", o.shiftText,
                   "Move the picture to the right and up beside the viewing axis, by this part of "
                   "its larger side")
        ->type_name("X,Y")
        ->group(view);
    app.add_option("--aperture", o.aperture, "Radius of the thin lens, scene units; 0: pinhole")
        ->type_name("R")
        ->group(view);
    app.add_option("--focus", o.focus, "Distance in focus along the viewing axis, scene units")
        ->type_name("D")
        ->group(view);
    app.add_option("--max-depth", o.maxDepth, "Longest path in edges, 1 to 254 (default: 12)")
        ->type_name("N")
        ->group(view);
    app.add_option("--rr-depth", o.rouletteDepth,
                   "First vertex of a subpath at which Russian roulette is played (default: 3)")
        ->type_name("N")
        ->group(view);
}

void requireRange(const char* option, const std::optional<std::int64_t>& value, std::int64_t low,
                  std::int64_t high) {
    if (value && (*value < low || *value > high)) {
        throw UsageError(std::string(option) + ": expected an integer from " + std::to_string(low) +
                         " to " + std::to_string(high) + ", found " + std::to_string(*value));
    }
}

void requireReal(const char* option, const std::optional<double>& value, double low, double high,
                 const char* expected) {
    if (value && !(*value >= low && *value <= high)) {
        throw UsageError(std::string(option) + ": expected " + expected + ", found " +
                         numberText(*value));
    }
}

void requireSaneFilm(std::int64_t width, std::int64_t height) {
    requireRange("--width", width, 1, kMaxImageSide);
    requireRange("--height", height, 1, kMaxImageSide);
    if (std::uint64_t(width) * std::uint64_t(height) > kMaxImagePixels) {
        throw UsageError("--width, --height: expected at most " + std::to_string(kMaxImagePixels) +
                         " pixels, found " + std::to_string(width) + " x " +
                         std::to_string(height));
    }
}

namespace {

/// Checked before the scene is loaded. readImage would also accept pictures of eight bits, in which
/// lamps are clipped to white.
void requireEnvironmentEnding(const std::string& file) {
    const std::string ending = endingOf(file);
    if (ending == ".exr" || ending == ".hdr") return;
    throw InputError(file + ": expected an environment .exr or .hdr, found the ending '" + ending +
                     "'; convert the image");
}

/// Options as text for a shell, in the order of their declaration.
class Arguments {
  public:
    void add(const char* option, const std::string& value) {
        if (!value.empty()) text_ += std::string(" ") + option + " " + shellQuoted(value);
    }
    void add(const char* option, const std::optional<double>& value) {
        if (value) add(option, numberText(*value));
    }
    void add(const char* option, const std::optional<std::int64_t>& value) {
        if (value) add(option, std::to_string(*value));
    }
    std::string text() const { return text_; }

  private:
    std::string text_;
};

}  // namespace

namespace {

/// Parses "50%", or "640x360", which sets --width and --height.
void parseScale(SceneOptions& o) {
    const std::string& text = o.scaleText;
    const auto fail = [&]() -> double {
        throw UsageError(
            "--scale: expected a share such as 50%, or both sides such as 640x360, "
            "found '" +
            text + "'");
    };
    const auto numberIn = [&](const std::string& part) {
        const std::optional<double> value = parseNumber(part);
        return value && *value > 0.0 && std::isfinite(*value) ? *value : fail();
    };
    if (const std::size_t by = text.find('x'); by != std::string::npos) {
        if (o.width || o.height) {
            throw UsageError("--scale: expected a share beside --width or --height, found '" +
                             text + "'; leave one of them out");
        }
        const auto side = [&](const std::string& part) {
            const double pixels = numberIn(part);
            return pixels == std::floor(pixels) && pixels <= 1e9 ? std::int64_t(pixels)
                                                                 : std::int64_t(fail());
        };
        o.width = side(text.substr(0, by));
        o.height = side(text.substr(by + 1));
        return;
    }
    if (!text.ends_with('%')) fail();
    o.scale = numberIn(text.substr(0, text.size() - 1)) / 100.0;
}

/// Parses `count` numbers from `low` to `high`, such as "0.1,-0.25".
template <std::size_t count>
std::array<double, count> parseNumbers(const char* option, const std::string& text, double low,
                                       double high, const char* expected) {
    const std::vector<std::string_view> parts = splitAtCommas(text);
    std::array<double, count> values{};
    bool right = parts.size() == count;
    for (std::size_t i = 0; right && i < count; ++i) {
        const std::optional<double> value = parseNumber(parts[i]);
        right = value && *value >= low && *value <= high;
        values[i] = value.value_or(0.0);
    }
    if (right) return values;
    throw UsageError(std::string(option) + ": expected " + expected + ", found '" + text + "'");
}

LampUnits parseUnits(const std::string& text) {
    for (const LampUnits units : {LampUnits::Radiometric, LampUnits::Photometric}) {
        if (text == nameOf(units)) return units;
    }
    throw UsageError("--units: expected radiometric or photometric, found '" + text + "'");
}

void parseEnvironmentColour(SceneOptions& o) {
    if (!o.environment.empty()) {
        throw UsageError("--env-colour: expected one environment, found --env, " + o.environment +
                         "; leave one of them out");
    }
    const auto c = parseNumbers<3>("--env-colour", o.environmentColourText, 0.0, 1e30,
                                   "three numbers R,G,B from 0 to 1e30");
    o.environmentColour = Rgb(float(c[0]), float(c[1]), float(c[2]));
}

}  // namespace

void checkSceneOptions(SceneOptions& o) {
    if (!o.scaleText.empty()) parseScale(o);
    if (!o.shiftText.empty()) {
        o.shift = parseNumbers<2>("--shift", o.shiftText, -100.0, 100.0,
                                  "two numbers X,Y from -100 to 100");
    }
    if (!o.environmentColourText.empty()) parseEnvironmentColour(o);
    if (!o.unitsText.empty()) o.units = parseUnits(o.unitsText);
    o.effectSwitches = parseEffectSwitches(o.effectTexts);
    requireSaneFilm(o.width.value_or(1), o.height.value_or(1));
    requireRange("--max-depth", o.maxDepth, 1, kMaxEdges);
    requireRange("--rr-depth", o.rouletteDepth, 0, 1'000'000);
    // The bounds are those of the scene's extras: within them, products fit into a float.
    requireReal("--aperture", o.aperture, 0.0, kFarthest, "a radius from 0 to 1e17");
    requireReal("--focus", o.focus, kNearestFocus, kFarthest, "a distance from 1e-15 to 1e17");
    requireReal("--env-rotate", o.environmentRotation, -1e6, 1e6, "an angle in degrees up to 1e6");
    requireReal("--env-scale", o.environmentScale, 0.0, 1e30, "a factor from 0 to 1e30");
    requireReal("--tolerance", o.tolerance, 0.0, kMaxTolerance, "a share from 0 to 0.1");
    if (!o.environment.empty()) requireEnvironmentEnding(o.environment);
}

std::string sceneArguments(const SceneOptions& o) {
    Arguments a;
    a.add("--cache", o.common.cacheDirectory);
    a.add("--env", o.environment);
    a.add("--env-colour", o.environmentColourText);
    a.add("--env-rotate", o.environmentRotation);
    a.add("--env-scale", o.environmentScale);
    a.add("--units", o.unitsText);
    for (const EffectSwitch& s : o.effectSwitches) {
        a.add("--effect", s.name + (s.on ? "=on" : "=off"));
    }
    if (o.tolerance > 0.0) a.add("--tolerance", numberText(o.tolerance));
    return a.text();
}

std::string viewArguments(const SceneOptions& o) {
    Arguments a;
    a.add("--width", o.width);
    a.add("--height", o.height);
    a.add("--camera", o.camera);
    a.add("--shift", o.shiftText);
    a.add("--aperture", o.aperture);
    a.add("--focus", o.focus);
    a.add("--max-depth", o.maxDepth);
    a.add("--rr-depth", o.rouletteDepth);
    return a.text();
}

}  // namespace lacuna
