#include "render/render_inputs.h"

#include <set>
#include <string>

#include "libcore/base/content_hash.h"
#include "libcore/base/text_list.h"
#include "render/code_file.h"

namespace lacuna {
namespace {

/// The names are glibc's. A package contains the library for several instruction sets, and the
/// processor selects one.
constexpr const char* kInstructionSet =
#if defined(__AVX512F__)
    "x86-64-v4";
#elif defined(__AVX2__)
    "x86-64-v3";
#else
    "baseline";
#endif

}  // namespace

CacheStamp renderInputs(const RenderOptions& options, const MethodRow& row,
                        const Settings& settings, const Stage& stage, const Caches& caches,
                        const BlockPlan& plan) {
    CacheStamp stamp{sceneInputs(stage)};
    const auto add = [&](const std::string& name, const std::string& value) {
        stamp.inputs[name] = value;
    };
    for (const auto& [name, value] : stage.viewInputs) add(name, value);
    for (const Effect& e : stage.effects) {
        if (e.forced && !e.ofScene) add("effect " + e.name, e.simulated ? "on" : "off");
    }
    for (const auto& [name, value] : settings) add(name, value);
    for (const auto& [name, hash] : caches.hashes) add("cache " + name, hash);
    const Camera::Film film = stage.camera->film();
    const PixelRect& crop = stage.settings.crop;
    add("version", LACUNA_VERSION);
    // Another build may round differently, as may one with fused multiply-add.
    add("program", hashOfFile(codeFile()));
    add("instruction set", kInstructionSet);
    add("method", row.name);
    add("seed", std::to_string(options.common.seed));
    add("sampler", nameOf(options.sampling));
    add("film", std::to_string(film.width) + " x " + std::to_string(film.height));
    add("crop", std::to_string(crop.x0) + "," + std::to_string(crop.x1) + "," +
                    std::to_string(crop.y0) + "," + std::to_string(crop.y1));
    add("technique layers", options.techniques ? "yes" : "no");
    add("layers of light groups", options.lightNoise    ? "yes, with their noise"
                                  : options.lightGroups ? "yes"
                                                        : "no");
    add("background", options.transparentBackground ? "transparent" : "shown");
    std::set<std::string> layers;  // sorted: their order does not matter
    for (const LayerExpression& layer : options.layers) {
        layers.insert(layer.name);
        add("layer " + layer.name, layer.text);
    }
    add("layers of expressions", joined(layers, " "));
    add("iterations of a block", std::to_string(plan.iterations));
    return stamp;
}

}  // namespace lacuna
