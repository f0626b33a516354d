#include "lacuna/render.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <atomic>
#include <cstdlib>
#include <filesystem>
#include <system_error>
#include <utility>

#include "lacuna/scene_builder.h"
#include "libcore/base/error.h"
#include "libcore/base/number_text.h"
#include "libcore/tool/progress.h"
#include "render/options.h"
#include "render/picture.h"
#include "render/ranks/ranks.h"

namespace lacuna {
namespace {

/// Options that print something instead of rendering, or that concern a process and its terminal.
constexpr std::array kNotOfAPicture = {"help",        "help-as",  "version", "list-methods",
                                       "help-method", "effects",  "replay",  "quiet",
                                       "verbose",     "estimate", "denoise"};

/// The option's name in the form of the command line. Throws UsageError for options that the
/// library does not support.
std::string ofAPicture(std::string name) {
    std::ranges::replace(name, '_', '-');
    if (std::ranges::find(kNotOfAPicture, name) == kNotOfAPicture.end()) return name;
    throw UsageError(name +
                     ": expected an option of a picture, found one of the program; use "
                     "lacuna-render --" +
                     name);
}

/// The cache folder for scenes in memory.
std::string userCacheDirectory() {
    const auto of = [](const char* variable) {
        const char* value = std::getenv(variable);
        return std::filesystem::path(value ? value : "");
    };
    if (const auto cache = of("XDG_CACHE_HOME"); cache.is_absolute()) return cache / "lacuna";
    if (const auto home = of("HOME"); home.is_absolute()) return home / ".cache" / "lacuna";
    std::error_code missing;  // $TMPDIR may name no folder; most methods need no caches
    const auto temporary = std::filesystem::temp_directory_path(missing);
    return (missing ? "/tmp" : temporary) / "lacuna";
}

class Listener final : public Progress {
  public:
    Listener(std::function<void(const RenderProgress&)> onProgress,
             std::function<void(const std::string&)> onWarning)
        : onProgress_(std::move(onProgress)), onWarning_(std::move(onWarning)) {}

    void phase(const std::string& name, const char*) override {
        if (now_.phase == name) return;
        now_.phase = name;
        tell();
    }
    void iterations(const Iterations& i) override {
        now_.iterations = i.done;
        now_.limit = i.limit;
        now_.seconds = i.seconds;
        now_.timeLimit = i.timeLimit;
        now_.accuracy = i.accuracy;
    }
    void picture(const std::function<Image()>& picture) override {
        now_.preview = [&picture] {
            const Image image = picture();
            RenderProgress::Preview preview{image.width, image.height, {}};
            preview.rgb.reserve(3 * image.pixels.size());
            for (const Rgb& c : image.pixels)
                preview.rgb.insert(preview.rgb.end(), {c.r, c.g, c.b});
            return preview;
        };
        tell();
        now_.preview = nullptr;
    }
    void remark(const std::string&) override {}
    void warning(const std::string& text) override {
        if (onWarning_) onWarning_(text);
    }

  private:
    void tell() {
        if (onProgress_) onProgress_(now_);
    }

    std::function<void(const RenderProgress&)> onProgress_;
    std::function<void(const std::string&)> onWarning_;
    RenderProgress now_;
};

}  // namespace

struct Render::Request {
    std::string scene;
    std::shared_ptr<const std::vector<std::uint8_t>> bytes;  ///< null: `scene` is a file
    std::vector<std::pair<std::string, std::string>> options;
    std::vector<std::string> flags;
    std::vector<MethodRow> methods;
    std::function<void(const RenderProgress&)> onProgress;
    std::function<void(const std::string&)> onWarning;

    /// The equivalent command line.
    std::vector<std::string> arguments() const {
        std::vector<std::string> result{"lacuna-render", scene};
        for (const auto& [name, value] : options) result.push_back("--" + name + "=" + value);
        for (const std::string& name : flags) result.push_back("--" + name);
        return result;
    }

    RenderOptions parsed() const {
        RenderOptions parsed;
        parsed.inMemory = true;
        parsed.ownMethods = methods;
        parsed.sceneBytes = bytes;
        if (bytes) parsed.common.cacheDirectory = userCacheDirectory();
        CLI::App app("", "lacuna-render");
        declareOptions(app, parsed);
        const std::vector<std::string> texts = arguments();
        std::vector<const char*> pointers;
        for (const std::string& text : texts) pointers.push_back(text.c_str());
        parseCommandLine(app, int(pointers.size()), pointers.data());
        parsed.commandLine = commandLineText(int(pointers.size()), pointers.data());
        checkOptions(parsed);
        return parsed;
    }
};

Render::Render(std::string sceneFile) : request_(std::make_unique<Request>()) {
    request_->scene = std::move(sceneFile);
}

Render::Render(const SceneBuilder& scene) : request_(std::make_unique<Request>()) {
    request_->scene = "scene-in-memory.glb";
    request_->bytes = std::make_shared<const std::vector<std::uint8_t>>(scene.glb());
}

Render::~Render() = default;
Render::Render(Render&&) noexcept = default;
Render& Render::operator=(Render&&) noexcept = default;

Render& Render::option(const std::string& name, const std::string& value) {
    request_->options.emplace_back(ofAPicture(name), value);
    return *this;
}

Render& Render::option(const std::string& name, const char* value) {
    return option(name, std::string(value));
}
Render& Render::option(const std::string& name, double value) {
    return option(name, numberText(value));
}
Render& Render::option(const std::string& name, std::int64_t value) {
    return option(name, std::to_string(value));
}
Render& Render::option(const std::string& name, int value) {
    return option(name, std::to_string(value));
}

Render& Render::option(const std::string& name, bool value) {
    const std::string known = ofAPicture(name);
    std::erase(request_->flags, known);
    if (value) request_->flags.push_back(known);
    return *this;
}

Render& Render::set(const std::string& key, const std::string& value) {
    request_->options.emplace_back("set", key + "=" + value);
    return *this;
}

Render& Render::add(const MethodRow& method) {
    const bool taken = std::ranges::any_of(
        methods(), [&](const MethodRow& row) { return row.name == method.name; });
    if (taken || method.name.empty() || method.name == kAuto) {
        throw UsageError("add: expected a name that no method has, found '" + method.name + "'");
    }
    request_->methods.push_back(method);
    return *this;
}

Render& Render::onProgress(std::function<void(const RenderProgress&)> callback) {
    request_->onProgress = std::move(callback);
    return *this;
}

Render& Render::onWarning(std::function<void(const std::string&)> callback) {
    request_->onWarning = std::move(callback);
    return *this;
}

Picture Render::run(std::stop_token stop) {
    RenderOptions options = request_->parsed();
    Listener listener(request_->onProgress, request_->onWarning);
    std::atomic<bool> interrupted{false};
    const std::stop_callback interrupt(stop, [&] { interrupted = true; });
    const Ranks alone{Ranks::Alone{}};
    std::optional<Rendered> rendered = renderPicture(options, alone, interrupted, listener);
    if (!rendered->failure.empty()) throw RunError(rendered->failure);
    std::string statistics = reportText(rendered->report);
    return {std::move(rendered->image), std::move(statistics)};
}

}  // namespace lacuna
