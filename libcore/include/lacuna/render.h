// One render: its options, its callbacks and its picture.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <stop_token>
#include <string>
#include <vector>

#include "lacuna/picture.h"

namespace lacuna {

struct MethodRow;
class SceneBuilder;

/// The current state of a render.
struct RenderProgress {
    std::string phase;             ///< "loading", "preparing: paths", "rendering", "saving", ..
    std::uint64_t iterations = 0;  ///< done
    std::uint64_t limit = 0;       ///< of iterations; 0: none
    double seconds = 0.0;          ///< spent on iterations
    double timeLimit = 0.0;        ///< seconds; 0: none
    std::string accuracy;          ///< "mape 4.1 %, 2 % in 3 min"; empty while it is not known

    /// The picture so far: height rows of width pixels of R, G, B, in radiance.
    struct Preview {
        int width = 0, height = 0;
        std::vector<float> rgb;
    };
    /// Makes the preview. Empty (no function) while there is none. Valid only while the callback
    /// runs.
    std::function<Preview()> preview;
};

class Render {
  public:
    /// Renders a .glb or .gltf file. Caches lie beside it, unless the option `cache` names another
    /// directory.
    explicit Render(std::string sceneFile);
    /// Renders the builder's current scene. Caches lie in the user's cache folder ($XDG_CACHE_HOME,
    /// else ~/.cache, else the temporary folder), unless the option `cache` names another directory.
    explicit Render(const SceneBuilder& scene);
    ~Render();
    Render(Render&&) noexcept;
    Render& operator=(Render&&) noexcept;

    /// Sets an option of `lacuna-render --help` by its name without leading dashes, "max-depth" or
    /// "max_depth", to a value as on the command line. The output is optional here. run() checks
    /// names and values. Options that print something instead of rendering are not accepted.
    Render& option(const std::string& name, const std::string& value);
    Render& option(const std::string& name, const char* value);
    Render& option(const std::string& name, double value);
    Render& option(const std::string& name, std::int64_t value);
    Render& option(const std::string& name, int value);
    /// Options without a value ("prepare", "verify"): true sets it, false leaves it out.
    Render& option(const std::string& name, bool value);
    /// Sets a parameter of the method, like `--set key=value`.
    Render& set(const std::string& key, const std::string& value);

    /// Adds your own method (method.h), which the option `method` may then name.
    Render& add(const MethodRow& method);

    /// Called in the thread of run(), at the beginning of each phase and after each iteration. An
    /// exception that it throws ends the render and leaves run().
    Render& onProgress(std::function<void(const RenderProgress&)> callback);
    /// Called in the thread of run() with each warning, one sentence: the picture may not be what
    /// was meant. Without a callback, warnings are only in the statistics.
    Render& onWarning(std::function<void(const std::string&)> callback);

    /// Renders, and writes the files that options ask for (output, json, log, ..). If asked to
    /// stop, it returns the picture so far, with "stopped": "interrupt" in the statistics; the
    /// first iteration gets three seconds to end. May be called again. Throws UsageError,
    /// InputError, RunError, and InterruptedError if it was stopped before there was a picture.
    Picture run(std::stop_token stop = {});

  private:
    struct Request;
    std::unique_ptr<Request> request_;
};

}  // namespace lacuna
