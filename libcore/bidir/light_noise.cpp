#include "libcore/bidir/light_noise.h"

#include <algorithm>
#include <cstdio>

#include "libcore/base/parallel.h"

namespace lacuna {
namespace {

std::string pairName(const char* kind, std::size_t first, std::size_t second) {
    char name[64];
    std::snprintf(name, sizeof name, "%s.g%02zug%02zu", kind, first, second);
    return name;
}

std::string productLayer(std::size_t first, std::size_t second) {
    return pairName("product", first, second);
}

/// Calls visit(pair, first, second) for all pairs with first <= second.
template <class Visit>
void forPairs(std::size_t groups, const Visit& visit) {
    std::size_t pair = 0;
    for (std::size_t first = 0; first < groups; ++first) {
        for (std::size_t second = first; second < groups; ++second) visit(pair++, first, second);
    }
}

}  // namespace

LightProducts::LightProducts(std::size_t groups, std::size_t pixels, std::uint64_t sampleIterations)
    : now_(groups, std::vector<Rgb>(pixels)),
      products_(groups * (groups + 1) / 2, std::vector<Rgb>(pixels)),
      sampleIterations_(sampleIterations) {}

void LightProducts::add(std::span<const std::vector<Rgb>> groups, const ThreadPool& threads) {
    ++iterations_;
    const bool whole = ++inSample_ == sampleIterations_;
    const float scale = 1.0f / float(inSample_);
    constexpr std::size_t kPixels = 1 << 12;  // of a task
    const std::size_t pixels = now_.empty() ? 0 : now_.front().size();
    threads.forEach((pixels + kPixels - 1) / kPixels, [&](std::size_t task) {
        const std::size_t begin = task * kPixels, end = std::min(pixels, begin + kPixels);
        for (std::size_t g = 0; g < now_.size(); ++g) {
            for (std::size_t i = begin; i < end; ++i) now_[g][i] += groups[g][i];
        }
        if (!whole) return;
        forPairs(now_.size(), [&](std::size_t pair, std::size_t a, std::size_t b) {
            for (std::size_t i = begin; i < end; ++i) {
                products_[pair][i] += now_[a][i] * now_[b][i] * scale;
            }
        });
        for (std::vector<Rgb>& plane : now_) {
            std::fill(plane.begin() + std::ptrdiff_t(begin), plane.begin() + std::ptrdiff_t(end),
                      Rgb{});
        }
    });
    if (whole) inSample_ = 0;
}

void LightProducts::setMeans(LayeredImage& image) const {
    const float scale = iterations_ ? 1.0f / float(iterations_) : 0.0f;
    const float ofSample = inSample_ ? 1.0f / float(inSample_) : 0.0f;
    Image mean(image.width(), image.height());
    forPairs(now_.size(), [&](std::size_t pair, std::size_t a, std::size_t b) {
        for (std::size_t i = 0; i < mean.pixels.size(); ++i) {
            mean.pixels[i] = (products_[pair][i] + now_[a][i] * now_[b][i] * ofSample) * scale;
        }
        image.setRgb(productLayer(a, b), mean);
    });
}

void LightProducts::clear() {
    for (auto* planes : {&now_, &products_}) {
        for (std::vector<Rgb>& plane : *planes) std::ranges::fill(plane, Rgb{});
    }
    iterations_ = inSample_ = 0;
}

std::string lightCovarianceLayer(std::size_t first, std::size_t second) {
    return pairName("covariance", first, second);
}

std::vector<std::string> lightCovarianceLayers(std::size_t groups) {
    std::vector<std::string> names;
    forPairs(groups, [&](std::size_t, std::size_t first, std::size_t second) {
        names.push_back(lightCovarianceLayer(first, second));
    });
    return names;
}

void setLightCovariances(LayeredImage& image, std::span<const std::string> means,
                         std::uint64_t samples) {
    const double scale = samples > 1 ? 1.0 / double(samples - 1) : 0.0;
    forPairs(means.size(), [&](std::size_t, std::size_t a, std::size_t b) {
        for (const char* channel : {".R", ".G", ".B"}) {
            const std::string product = productLayer(a, b) + channel;
            if (!image.find(product)) continue;
            std::vector<float> plane = image.take(product);
            const std::vector<float>&ofA = *image.find(means[a] + channel),
                  &ofB = *image.find(means[b] + channel);
            for (std::size_t i = 0; i < plane.size(); ++i) {
                const double each = double(plane[i]) - double(ofA[i]) * double(ofB[i]);
                plane[i] = float(scale * (a == b ? std::max(0.0, each) : each));
            }
            image.channel(lightCovarianceLayer(a, b) + channel) = std::move(plane);
        }
    });
}

}  // namespace lacuna
