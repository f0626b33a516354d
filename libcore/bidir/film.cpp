#include "libcore/bidir/film.h"

#include <algorithm>
#include <numeric>

#include "libcore/base/parallel.h"

namespace lacuna {

std::uint64_t addSplats(std::span<const std::vector<Splat>> chunks, std::span<Rgb> pixels,
                        const ThreadPool& pool) {
    // Each band of pixels walks all lists in order: which band a pixel is in changes nothing.
    const std::size_t bands = std::size_t(pool.threads());
    std::vector<std::uint64_t> leftOut(bands, 0);
    pool.forEach(bands, [&](std::size_t band) {
        const auto low = std::uint32_t(pixels.size() * band / bands);
        const auto high = std::uint32_t(pixels.size() * (band + 1) / bands);
        for (const std::vector<Splat>& chunk : chunks) {
            for (const Splat& s : chunk) {
                if (s.pixel < low || s.pixel >= high) continue;
                const Rgb sum = pixels[s.pixel] + s.value;
                if (isFinite(sum)) {
                    pixels[s.pixel] = sum;
                } else {
                    ++leftOut[band];
                }
            }
        }
    });
    return std::accumulate(leftOut.begin(), leftOut.end(), std::uint64_t(0));
}

Image meanOfSum(std::span<const Rgb> sum, std::uint64_t iterations, int width, int height) {
    Image image(width, height);
    const float scale = iterations > 0 ? 1.0f / float(iterations) : 0.0f;
    for (std::size_t i = 0; i < sum.size(); ++i) image.pixels[i] = sum[i] * scale;
    return image;
}

Film::Film(int width, int height, BlockPlan plan, std::uint64_t first)
    : width_(width),
      height_(height),
      plan_(plan),
      open_(plan.sampleIterations(), plan.relationInSample()),
      block_(first) {}

FilmSum sumOfBlock(const SumTree& open, std::span<BlockLayers* const> layers,
                   const ThreadPool* threads) {
    FilmSum sum;
    open.addTo(sum, threads);
    for (const BlockLayers* of : layers) sum.layers.merge(of->means());
    return sum;
}

void Film::measure(const ErrorMeter& meter) {
    meter_ = &meter;
    blocks_.measure(meter_, 0, plan_.iterations);
    measureOpen();
}

/// Tells the open block's tree which iterations its items are: that decides which
/// nodes are compared.
void Film::measureOpen() {
    open_.measure(plan_.areSamples ? nullptr : meter_, block_ * plan_.iterations, 1);
}

void Film::add(std::span<const Rgb> pixels, const ThreadPool& threads) {
    auto one = std::make_shared<FilmSum>(FilmSum::ofIteration(pixels, width_, threads));
    add({inBlock_, 1, std::move(one)}, &threads);
}

void Film::add(SumTree::Node node, const ThreadPool* threads) {
    const std::uint64_t added = node.sum->iterations;
    open_.add(std::move(node), threads);
    iterations_ += added;
    inBlock_ += added;
    if (inBlock_ < plan_.iterations) return;
    blocks_.add({block_, 1, std::make_shared<FilmSum>(openSum(threads))}, threads);
    open_.clear();
    for (BlockLayers* layers : layers_) layers->clear();
    ++block_;
    inBlock_ = 0;
    measureOpen();
}

FilmSum Film::openSum(const ThreadPool* threads, Layered layered) const {
    using All = std::span<BlockLayers* const>;
    return sumOfBlock(open_, layered == Layered::Yes ? All(layers_) : All(), threads);
}

FilmSum Film::sum(const ThreadPool* threads, Layered layered) const {
    FilmSum sum;
    blocks_.addTo(sum, threads, layered);
    if (!open_.empty())
        join(sum, openSum(threads, layered), SumRelation::Samples, threads, layered);
    return sum;
}

Film::State Film::state(bool withOpen) const {
    State state{blocks_.nodes(), block_, {}};
    if (withOpen) state.open = open_.nodes();
    return state;
}

Film::State Film::finalState(const ThreadPool& threads) const {
    State state = Film::state(false);
    if (!open_.empty()) {
        state.open.push_back({0, 1, std::make_shared<FilmSum>(openSum(&threads))});
    }
    return state;
}

void Film::restore(State state, const ThreadPool& threads) {
    block_ = state.openBlock;
    measureOpen();
    for (SumTree::Node& node : state.blocks) {
        iterations_ += node.sum->iterations;
        blocks_.add(std::move(node), &threads);
    }
    for (SumTree::Node& node : state.open) {
        inBlock_ += node.sum->iterations;
        open_.add(std::move(node), &threads);
    }
    iterations_ += inBlock_;
}

}  // namespace lacuna
