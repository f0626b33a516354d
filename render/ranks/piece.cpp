#include "render/ranks/piece.h"

#include <cstring>
#include <nlohmann/json.hpp>

#include "libcore/base/error.h"
#include "libcore/image/image.h"

namespace lacuna {
namespace {

using nlohmann::json;

}  // namespace

PieceMaker::PieceMaker(BlockMaker& maker, const ErrorMeter& meter, const PixelRect& crop,
                       const std::atomic<bool>& interrupted, const ThreadPool& pool)
    : maker_(maker),
      meter_(meter),
      width_(crop.width()),
      height_(crop.height()),
      interrupted_(interrupted),
      pool_(pool),
      pixels_(std::size_t(width_) * std::size_t(height_)) {}

Part PieceMaker::make(const Work& work, const std::function<bool()>& stop) {
    const BlockPlan& plan = maker_.plan();
    const std::uint64_t block = work.begin / plan.iterations;
    const std::uint64_t inBlock = work.begin % plan.iterations;
    const std::atomic<bool>& cancel = work.first ? kNeverCancelled : interrupted_;
    Part part;
    part.width = width_;
    part.height = height_;
    part.plan = plan;
    part.firstBlock = part.sums.openBlock = block;
    Totals totals;
    if (maker_.blocksAreWhole() || open_ != block) {
        open_.reset();
        if (!maker_.beginBlock(work.begin, cancel, totals)) return part;
        open_ = block;
    }
    SumTree tree(plan.sampleIterations(), plan.relationInSample());
    tree.measure(plan.areSamples ? nullptr : &meter_, block * plan.iterations, 1);
    for (std::uint64_t i = 0; i < work.count; ++i) {
        const bool must = work.first && i == 0;
        if (!must && stop()) break;
        const bool whole = must || !maker_.layers().empty();
        if (!maker_.render(work.begin + i, pixels_, whole ? kNeverCancelled : interrupted_, totals))
            break;
        auto one = std::make_shared<FilmSum>(FilmSum::ofIteration(pixels_, width_, pool_));
        tree.add({inBlock + i, 1, std::move(one)}, &pool_);
    }
    part.seconds = totals.seconds;
    part.statistics = std::move(totals.statistics);
    if (maker_.blocksAreWhole()) {
        auto sum = std::make_shared<FilmSum>(sumOfBlock(tree, maker_.layers(), &pool_));
        for (BlockLayers* layers : maker_.layers()) layers->clear();
        if (sum->iterations > 0) part.sums.open.push_back({0, 1, std::move(sum)});
    } else {
        part.sums.open = tree.nodes();
    }
    return part;
}

// Format: the length of the JSON, the JSON, and the channels in its order.
std::vector<std::byte> bytesOf(const Part& part) {
    LayeredImage image(part.width, part.height);
    addPart(image, part);
    json head{{"width", image.width()}, {"height", image.height()}};
    for (const auto& [name, value] : image.attributes) {
        head["attributes"][name] = std::get<std::string>(value);
    }
    head["channels"] = json::array();
    for (const auto& [name, plane] : image.channels()) head["channels"].push_back(name);
    const std::string text = head.dump();
    const std::uint64_t length = text.size();
    std::vector<std::byte> bytes(sizeof length + text.size() +
                                 image.channels().size() * sizeof(float) * std::size_t(part.width) *
                                     std::size_t(part.height));
    std::byte* to = bytes.data();
    const auto append = [&](const void* from, std::size_t size) {
        std::memcpy(to, from, size);
        to += size;
    };
    append(&length, sizeof length);
    append(text.data(), text.size());
    for (const auto& [name, plane] : image.channels()) {
        append(plane.data(), plane.size() * sizeof(float));
    }
    return bytes;
}

Part partOf(std::span<const std::byte> bytes) {
    try {
        const auto next = [&](void* to, std::size_t size) {
            if (size > bytes.size()) throw std::length_error("too few bytes");
            std::memcpy(to, bytes.data(), size);
            bytes = bytes.subspan(size);
        };
        std::uint64_t length = 0;
        next(&length, sizeof length);
        if (length > bytes.size()) throw std::length_error("too few bytes");
        std::string text(length, '\0');
        next(text.data(), length);
        const json head = json::parse(text);
        LayeredImage image(head.at("width"), head.at("height"));
        for (const auto& [name, value] : head.at("attributes").items()) {
            image.attributes[name] = value.get<std::string>();
        }
        for (const std::string name : head.at("channels")) {
            std::vector<float>& plane = image.channel(name);
            next(plane.data(), plane.size() * sizeof(float));
        }
        if (!bytes.empty()) throw std::length_error("too many bytes");
        return takePart(image, "piece");
    } catch (const std::exception& e) {
        throw RunError(std::string("a rank's piece: expected it as it was sent, found ") +
                       e.what() + "; look for another version of Lacuna or a network at fault");
    }
}

}  // namespace lacuna
