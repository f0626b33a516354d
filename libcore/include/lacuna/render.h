// One render: what is asked for, who is told about it, and the picture.
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

/// What a render does right now.
struct RenderProgress {
    std::string phase;             ///< "loading", "preparing: paths", "rendering", "saving", ..
    std::uint64_t iterations = 0;  ///< done
    std::uint64_t limit = 0;       ///< of them; 0: none
    double seconds = 0.0;          ///< of iterations
    double timeLimit = 0.0;        ///< seconds; 0: none
    std::string accuracy;          ///< "mape 4.1 %, 2 % in 3 min"; empty while it is not known

    /// The picture as it is now: height rows of width pixels of R, G, B, in radiance.
    struct Preview {
        int width = 0, height = 0;
        std::vector<float> rgb;
    };
    /// Makes it. Empty (no function) where there is none yet. Valid while the callback runs.
    std::function<Preview()> preview;
};

class Render {
  public:
    /// A .glb or .gltf file. Caches lie beside it, unless the option `cache` says where.
    explicit Render(std::string sceneFile);
    /// What the builder holds now. Caches lie in the user's cache folder ($XDG_CACHE_HOME, else
    /// ~/.cache), unless the option `cache` says where.
    explicit Render(const SceneBuilder& scene);
    ~Render();
    Render(Render&&) noexcept;
    Render& operator=(Render&&) noexcept;

    /// An option of `lacuna-render --help` by its name without dashes, "max-depth" or "max_depth",
    /// with its value as on the command line. The output is optional here. Names and values are
    /// checked by run(). Options that print something instead of rendering are not taken.
    Render& option(const std::string& name, const std::string& value);
    Render& option(const std::string& name, const char* value);
    Render& option(const std::string& name, double value);
    Render& option(const std::string& name, std::int64_t value);
    Render& option(const std::string& name, int value);
    /// Options without a value ("prepare", "verify"): true sets it, false leaves it out.
    Render& option(const std::string& name, bool value);
    /// A parameter of the method, as `--set key=value`.
    Render& set(const std::string& key, const std::string& value);

    /// A method of one's own (method.h), which the option `method` may then name.
    Render& add(const MethodRow& method);

    /// Called in the thread of run(): where a phase begins, and after each iteration. What it
    /// throws ends the render and comes out of run().
    Render& onProgress(std::function<void(const RenderProgress&)> callback);
    /// One sentence each: the picture may not be what was meant. Without a callback they are in
    /// the statistics alone. Called in the thread of run().
    Render& onWarning(std::function<void(const std::string&)> callback);

    /// Renders, and writes what options ask for (output, json, log, ..). Asked to stop, it returns
    /// what there is, with "stopped": "interrupt" in the statistics; the first iteration has three
    /// seconds to end. May be called again. Throws UsageError, InputError, RunError;
    /// InterruptedError where there is nothing yet.
    Picture run(std::stop_token stop = {});

  private:
    struct Request;
    std::unique_ptr<Request> request_;
};

}  // namespace lacuna
