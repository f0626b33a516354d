#include "render/output.h"

#include <sys/resource.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "libcore/base/atomic_file.h"
#include "libcore/bidir/light_noise.h"

namespace lacuna {
namespace {

using nlohmann::json;

std::uint64_t peakBytes() {
    struct rusage usage {};
    getrusage(RUSAGE_SELF, &usage);
    return std::uint64_t(usage.ru_maxrss) * 1024;  // Linux counts in KiB
}

/// A number, or the text "inf" or "nan", because JSON has no such numbers.
json jsonNumber(double value) {
    return std::isfinite(value) ? json(value) : json(std::isnan(value) ? "nan" : "inf");
}

std::string rectText(const PixelRect& r) {
    return std::to_string(r.x0) + "," + std::to_string(r.x1) + "," + std::to_string(r.y0) + "," +
           std::to_string(r.y1);
}

/// JSON as text. File names need not be UTF-8, but JSON must be.
std::string utf8Text(const json& object, int indent) {
    return object.dump(indent, ' ', false, json::error_handler_t::replace);
}

void setHeader(LayeredImage& image, const RenderReport& r) {
    auto& a = image.attributes;
    a["software"] = std::string("Lacuna");
    a["softwareVersion"] = std::string(LACUNA_VERSION);  // OpenEXR reserves `version`
    a["commandLine"] = r.commandLine;
    a["method"] = r.method->name;
    a["parameters"] = parametersJson(*r.method, r.settings).dump();
    if (r.choice) a["chosen"] = utf8Text(r.choice->json(), -1);
    a["seed"] = integerAttribute(r.seed);
    a["sampler"] = std::string(nameOf(r.sampling));
    a["iterations"] = integerAttribute(r.iterations);
    a["blockIterations"] = integerAttribute(r.blocks.iterations);
    a["renderTimeSeconds"] = r.seconds;
    a["setupTimeSeconds"] = r.setupSeconds;
    a["rays"] = double(r.statistics.totalRays());  // exact up to 2^53
    a["invalidSamples"] = integerAttribute(r.statistics.invalidSamples);
    a["sceneHash"] = r.sceneHash;
    a["cacheHashes"] = json(r.cacheHashes).dump();
    a["stopped"] = r.stopped.empty() ? "no: still rendering" : r.stopped;
    a["maxDepth"] = r.limits.maxDepth;
    a["effects"] = utf8Text(effectsJson(r.effects), -1);
    if (!r.layers.empty()) a["layers"] = utf8Text(json(r.layers), -1);
    if (!r.lightGroups.empty()) a["lightGroups"] = utf8Text(json(r.lightGroups), -1);
    if (r.tolerance > 0.0) a["tolerance"] = r.tolerance;
    if (r.crop != PixelRect{0, r.filmWidth, 0, r.filmHeight}) {
        a["crop"] = rectText(r.crop);
        a["fullSize"] = std::to_string(r.filmWidth) + "x" + std::to_string(r.filmHeight);
    }
    if (r.method->biased) a["biased"] = std::string("yes: the method is an experiment of a paper");
    if (isConsistentOnly(*r.method, r.settings)) {
        a["consistent"] = std::string("not unbiased: what merging blurs goes away with iterations");
    }
}

}  // namespace

json numbersJson(const double (&values)[3]) {
    return json::array({jsonNumber(values[0]), jsonNumber(values[1]), jsonNumber(values[2])});
}

Attribute integerAttribute(std::uint64_t value) {
    if (value <= std::uint64_t(std::numeric_limits<int>::max())) return int(value);
    return std::to_string(value);
}

json parametersJson(const MethodRow& row, const Settings& settings) {
    json object = json::object();
    for (const Option& o : row.options) {
        const std::string& value = settings.at(o.name);
        switch (o.kind) {
            case Option::Kind::Integer:
                object[o.name] = std::int64_t(*parseNumber(value));
                break;
            case Option::Kind::Real:
                object[o.name] = *parseNumber(value);
                break;
            case Option::Kind::Switch:
            case Option::Kind::Choice:
            case Option::Kind::Text:
                object[o.name] = value;
                break;
        }
    }
    return object;
}

void setPicture(LayeredImage& image, const FilmSum& sum, std::span<const std::string> lightGroups) {
    image.setRgb("", sum.image(image.width(), image.height()));
    image.setRgb("variance", sum.variance(image.width(), image.height()));
    for (const auto& [name, plane] : sum.layers) image.channel(name) = plane;
    setTechniqueVariances(image, sum.layers, sum.samples);
    std::vector<std::string> lights;
    for (const std::string& group : lightGroups) lights.push_back(lightLayer(group));
    setLightCovariances(image, lights, sum.samples);
}

void setFeatures(LayeredImage& image, const FeatureLayers& features) {
    image.setRgb("albedo", features.albedo);
    for (const auto& [axis, part, member] : {std::tuple(".X", &Rgb::r, &Vec3::x),
                                             {".Y", &Rgb::g, &Vec3::y},
                                             {".Z", &Rgb::b, &Vec3::z}}) {
        auto &normal = image.channel(std::string("normal") + axis),
             &position = image.channel(std::string("position") + axis);
        for (std::size_t i = 0; i < features.z.size(); ++i) {
            normal[i] = features.normal.pixels[i].*part;
            position[i] = features.position[i].*member;
        }
    }
    image.channel("Z") = features.z;
}

LayeredImage composeImage(const RenderReport& report, const FilmSum& sum,
                          const LayeredImage* still) {
    LayeredImage image(report.crop.width(), report.crop.height());
    setPicture(image, sum, report.lightGroups);
    if (report.techniques) addShareOfFirstConnections(image, report.limits.maxDepth);
    if (still) {
        for (const auto& [name, plane] : still->channels()) image.channel(name) = plane;
        image.attributes = still->attributes;
    }
    setHeader(image, report);
    return image;
}

json effectsJson(const std::vector<Effect>& effects) {
    json simulated = json::array(), leftOut = json::array(), reasons = json::object();
    for (const Effect& e : effects) {
        (e.simulated ? simulated : leftOut).push_back(e.name);
        reasons[e.name] = e.reason;
    }
    return {{"simulated", simulated}, {"left_out", leftOut}, {"reasons", reasons}};
}

std::string reportText(const RenderReport& report) {
    return utf8Text(reportJson(report), 2) + "\n";
}

void writeJson(const std::string& path, const json& object) {
    writeFileAtomically(path, utf8Text(object, 2) + "\n");
}

json reportJson(const RenderReport& r) {
    json rays = json::object();
    for (std::size_t i = 0; i < kRayKinds; ++i) rays[name(RayKind(i))] = r.statistics.rays[i];
    json j{{"method", r.method->name},
           {"parameters", parametersJson(*r.method, r.settings)},
           {"biased", r.method->biased},
           {"consistent", isConsistentOnly(*r.method, r.settings)},
           {"command_line", r.commandLine},
           {"iterations", r.iterations},
           {"seconds", r.seconds},
           {"setup_seconds", r.setupSeconds},
           {"rays", r.statistics.totalRays()},
           {"rays_by_kind", rays},
           {"held", r.statistics.held},
           {"light_paths", r.lightPaths},
           {"invalid_samples", r.statistics.invalidSamples},
           {"invalid_replays", r.statistics.invalidReplays},
           {"peak_bytes", peakBytes()},
           {"mean_rgb", numbersJson(r.mean.mean)},
           {"mean_rgb_stderr", numbersJson(r.mean.standardError)},
           {"width", r.crop.width()},
           {"height", r.crop.height()},
           {"film", {r.filmWidth, r.filmHeight}},
           {"crop", {r.crop.x0, r.crop.x1, r.crop.y0, r.crop.y1}},
           {"max_depth", r.limits.maxDepth},
           {"rr_depth", r.limits.rouletteDepth},
           {"threads", r.threads},
           {"ranks", r.ranks},
           {"seed", r.seed},
           {"sampler", nameOf(r.sampling)},
           {"warmup_iterations", r.warmupIterations},
           {"block_iterations", r.blocks.iterations},
           {"first_block", r.firstBlock},
           {"phases", r.phaseSeconds},
           {"glass_effort",
            {{"refractions", r.glassEffort.refractions},
             {"known_ways", r.glassEffort.knownWays},
             {"chains", r.glassEffort.chains}}},
           {"tolerance", r.tolerance},
           {"effects", effectsJson(r.effects)},
           {"scene_hash", r.sceneHash},
           {"cache_hashes", r.cacheHashes},
           {"warnings", r.warnings},
           {"stopped", r.stopped}};
    if (r.choice) j["chosen"] = r.choice->json();
    if (!r.layers.empty()) j["layers"] = r.layers;
    if (!r.lightGroups.empty()) j["light_groups"] = r.lightGroups;
    if (r.techniques) j["techniques"] = techniqueCostsJson(r.techniqueCosts);
    if (r.ranks > 1) j["received_bytes"] = r.receivedBytes;
    j["estimated_error"] = json::object();
    j["estimate_doubts"] = json::object();
    for (const char* measure : {"mape", "relmse", "rmse"}) {
        const Measured& m = *r.estimate.find(measure);
        j["estimated_error"][measure] = jsonNumber(m.error);
        if (!m.doubt.empty()) j["estimate_doubts"][measure] = m.doubt;
    }
    if (r.exposure) j["exposure"] = *r.exposure;
    if (r.verify) {
        j["verify"] = {{"max_difference", r.verify->maxDifference},
                       {"paths", r.verify->paths},
                       {"not_a_number", r.verify->notNumbers}};
        if (!r.verify->replay.empty()) j["verify"]["replay"] = r.verify->replay;
    }
    if (r.error) {
        j["error"] = {{"mae", jsonNumber(r.error->mae)},
                      {"rmse", jsonNumber(r.error->rmse)},
                      {"mape", jsonNumber(r.error->mape)},
                      {"relmse", jsonNumber(r.error->relmse)}};
    }
    return j;
}

}  // namespace lacuna
