#include "render/part.h"

#include <bit>
#include <cstdio>
#include <cstdlib>
#include <new>
#include <nlohmann/json.hpp>
#include <utility>

#include "libcore/base/content_hash.h"
#include "libcore/base/error.h"

namespace lacuna {
namespace {

using nlohmann::json;

constexpr int kFormat = 4;
constexpr const char* kAttributes[] = {"partInputs", "partSums", "partTotals"};
constexpr const char* kHash = "partHash";
const std::string kLayer = "sum.";

/// A double as hexadecimal text, which is exact and can be infinite.
json exactText(double value) {
    char text[40];
    std::snprintf(text, sizeof text, "%a", value);
    return text;
}
double numberOf(const json& text) {
    return std::strtod(text.get<std::string>().c_str(), nullptr);
}

/// A count in JSON. Throws std::invalid_argument for other values, which json would silently cast.
std::uint64_t countOf(const json& number) {
    if (!number.is_number_unsigned()) throw std::invalid_argument("no count");
    return number.get<std::uint64_t>();
}

json numbersText(const std::array<double, 3>& values) {
    return {exactText(values[0]), exactText(values[1]), exactText(values[2])};
}
std::array<double, 3> numbersOf(const json& texts) {
    return {numberOf(texts.at(0)), numberOf(texts.at(1)), numberOf(texts.at(2))};
}

constexpr const char* kChannels[] = {".R", ".G", ".B"};
constexpr float Rgb::*kMembers[] = {&Rgb::r, &Rgb::g, &Rgb::b};

void setPlanes(LayeredImage& image, const std::string& layer, const std::vector<Rgb>& pixels) {
    for (std::size_t c = 0; c < 3; ++c) {
        std::vector<float>& plane = image.channel(layer + kChannels[c]);
        for (std::size_t i = 0; i < pixels.size(); ++i) plane[i] = pixels[i].*kMembers[c];
    }
}

std::vector<Rgb> takePlanes(LayeredImage& image, const std::string& layer) {
    std::vector<Rgb> pixels(std::size_t(image.width()) * std::size_t(image.height()));
    for (std::size_t c = 0; c < 3; ++c) {
        const std::vector<float> plane = image.take(layer + kChannels[c]);
        for (std::size_t i = 0; i < pixels.size(); ++i) pixels[i].*kMembers[c] = plane[i];
    }
    return pixels;
}

json halvesText(const std::vector<HalfDifference>& differences) {
    json list = json::array();
    for (const HalfDifference& d : differences) {
        list.push_back({d.iterations, d.nodes, exactText(d.sum), exactText(d.squares),
                        exactText(d.unevenness)});
    }
    return list;
}
std::vector<HalfDifference> halvesOf(const json& list) {
    std::vector<HalfDifference> differences;
    for (const json& d : list) {
        differences.push_back({countOf(d.at(0)), countOf(d.at(1)), numberOf(d.at(2)),
                               numberOf(d.at(3)), numberOf(d.at(4))});
    }
    return differences;
}

/// Adds a node's channels and returns its description. `layer`: the prefix of names, "sum.0."
json addNode(LayeredImage& image, const std::string& layer, const SumTree::Node& node) {
    const FilmSum& sum = *node.sum;
    setPlanes(image, layer + "mean", sum.mean);
    if (!sum.spread.empty()) setPlanes(image, layer + "spread", sum.spread);
    json names = json::array();
    for (const auto& [name, plane] : sum.layers) {
        image.channel(layer + name) = plane;
        names.push_back(name);
    }
    return {{"begin", node.begin},
            {"size", node.size},
            {"iterations", sum.iterations},
            {"samples", sum.samples},
            {"spreads", !sum.spread.empty()},
            {"whole_mean", numbersText(sum.wholeMean)},
            {"whole_squares", numbersText(sum.wholeSquares)},
            {"differences", halvesText(sum.differences)},
            {"layers", names}};
}

SumTree::Node takeNode(LayeredImage& image, const std::string& layer, const json& text) {
    auto sum = std::make_shared<FilmSum>();
    sum->iterations = countOf(text.at("iterations"));
    sum->samples = countOf(text.at("samples"));
    sum->mean = takePlanes(image, layer + "mean");
    if (text.at("spreads").get<bool>()) sum->spread = takePlanes(image, layer + "spread");
    sum->wholeMean = numbersOf(text.at("whole_mean"));
    sum->wholeSquares = numbersOf(text.at("whole_squares"));
    sum->differences = halvesOf(text.at("differences"));
    for (const std::string name : text.at("layers")) sum->layers[name] = image.take(layer + name);
    const SumTree::Node node{countOf(text.at("begin")), countOf(text.at("size")), std::move(sum)};
    if (!std::has_single_bit(node.size) || node.begin % node.size != 0) {
        throw std::invalid_argument("a node that is in no tree");
    }
    return node;
}

json totalsText(const Part& part) {
    const IterationStatistics& s = part.statistics;
    return {{"seconds", part.seconds},
            {"rays", s.rays},
            {"invalid_samples", s.invalidSamples},
            {"invalid_replays", s.invalidReplays},
            {"phases", s.phaseSeconds},
            {"technique_seconds", s.techniqueSeconds},
            {"held", s.held}};
}

void readTotals(const json& text, Part& part) {
    part.seconds = text.at("seconds");
    IterationStatistics& s = part.statistics;
    for (std::size_t kind = 0; kind < s.rays.size(); ++kind) {
        s.rays[kind] = countOf(text.at("rays").at(kind));
    }
    s.invalidSamples = countOf(text.at("invalid_samples"));
    s.invalidReplays = text.at("invalid_replays").get<std::vector<std::string>>();
    s.phaseSeconds = text.at("phases").get<std::map<std::string, double>>();
    s.techniqueSeconds = text.at("technique_seconds").get<TechniqueSeconds>();
    for (const auto& [what, bytes] : text.at("held").items()) s.held[what] = countOf(bytes);
}

Part readPart(LayeredImage& image) {
    const auto text = [&](const char* name) {
        return std::get<std::string>(image.attributes.at(name));
    };
    if (text(kHash) != partHash(image)) throw std::invalid_argument("another hash");
    Part part;
    part.inputs = CacheStamp::parse(text("partInputs"));
    part.width = image.width();
    part.height = image.height();
    const json sums = json::parse(text("partSums"));
    if (sums.at("format") != kFormat) throw std::invalid_argument("another format");
    part.plan = {countOf(sums.at("block_iterations")), sums.at("blocks_are_samples"),
                 countOf(sums.at("group_iterations"))};
    part.firstBlock = countOf(sums.at("first_block"));
    part.sums.openBlock = countOf(sums.at("open_block"));
    std::size_t number = 0;
    const auto read = [&](const char* list, std::vector<SumTree::Node>& nodes) {
        for (const json& node : sums.at(list)) {
            nodes.push_back(takeNode(image, kLayer + std::to_string(number++) + ".", node));
        }
    };
    read("blocks", part.sums.blocks);
    read("open", part.sums.open);
    readTotals(json::parse(text("partTotals")), part);
    for (const char* name : kAttributes) image.attributes.erase(name);
    image.attributes.erase(kHash);
    return part;
}

}  // namespace

std::uint64_t Part::iterations() const {
    std::uint64_t n = 0;
    for (const auto* nodes : {&sums.blocks, &sums.open}) {
        for (const SumTree::Node& node : *nodes) n += node.sum->iterations;
    }
    return n;
}

std::string partHash(const LayeredImage& image) {
    ContentHash hash;
    const auto addText = [&](const std::string& text) {
        hash.addValue(std::uint64_t(text.size()));
        hash.addValues(std::span(text.data(), text.size()));
    };
    for (const char* name : kAttributes) addText(std::get<std::string>(image.attributes.at(name)));
    for (const auto& [name, plane] : image.channels()) {
        if (!name.starts_with(kLayer)) continue;
        addText(name);
        hash.addValues(std::span(plane.data(), plane.size()));
    }
    return hash.hex();
}

void addPart(LayeredImage& image, const Part& part) {
    json sums{{"format", kFormat},
              {"block_iterations", part.plan.iterations},
              {"blocks_are_samples", part.plan.areSamples},
              {"group_iterations", part.plan.groupIterations},
              {"first_block", part.firstBlock},
              {"open_block", part.sums.openBlock}};
    std::size_t number = 0;
    const auto add = [&](const char* list, const std::vector<SumTree::Node>& nodes) {
        json& texts = sums[list] = json::array();
        for (const SumTree::Node& node : nodes) {
            texts.push_back(addNode(image, kLayer + std::to_string(number++) + ".", node));
        }
    };
    add("blocks", part.sums.blocks);
    add("open", part.sums.open);
    image.attributes["partInputs"] = part.inputs.text();
    image.attributes["partSums"] = sums.dump();
    image.attributes["partTotals"] =
        totalsText(part).dump(-1, ' ', false, json::error_handler_t::replace);
    image.attributes[kHash] = partHash(image);
}

Part takePart(LayeredImage& image, const std::string& path) {
    if (!image.attributes.contains(kHash)) {
        throw InputError(path +
                         ": expected a part of a picture (made with --blocks or --checkpoint), "
                         "found an image without its sums; name another file");
    }
    try {
        return readPart(image);
    } catch (const std::bad_alloc&) {
        throw;  // not the file's fault
    } catch (const std::exception& e) {
        throw InputError(path + ": expected a part of a picture as it was written, found " +
                         "a damaged one (" + e.what() + "); delete it, or name another file");
    }
}

}  // namespace lacuna
