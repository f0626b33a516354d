#include "libcore/bidir/technique_film.h"

#include <algorithm>
#include <cstdio>

namespace lacuna {

namespace {

const std::string kWeighted = "weighted.", kUnweighted = "unweighted.", kSquare = "square.",
                  kVariance = "variance.";

bool isZero(float value) {
    return value == 0.0f;
}

/// Calls visit(s, t, merged) for all techniques of paths of up to `maxDepth` edges.
template <class Visit>
void forEachTechnique(int maxDepth, const Visit& visit) {
    for (int k = 1; k <= maxDepth; ++k) {
        for (int s = 0; s <= k; ++s) visit(s, k + 1 - s, false);
        for (int i = 1; i < k; ++i) visit(i, k + 1 - i, true);
    }
}

}  // namespace

bool TechniqueFilm::Moments::isZero() const {
    return std::ranges::all_of(now, lacuna::isZero) && std::ranges::all_of(sum, lacuna::isZero);
}

TechniqueFilm::TechniqueFilm(int width, int height, int maxDepth, std::uint64_t sampleIterations,
                             bool merges)
    : width_(width), height_(height), maxDepth_(maxDepth), sampleIterations_(sampleIterations) {
    const std::size_t pixels = std::size_t(width) * std::size_t(height);
    techniques_.assign(indexOf(0, maxDepth + 1) + std::size_t(maxDepth) + 1, Technique(pixels));
    if (merges) merges_ = techniques_;
    groups_.assign(TechniqueGroup::kCount, Moments(pixels));
}

std::string TechniqueFilm::layerName(int s, int t, bool merged) {
    char name[32];
    std::snprintf(name, sizeof name, "%c%02dt%02d", merged ? 'm' : 's', s, t);
    return name;
}

std::vector<std::string> TechniqueFilm::channelNames(int maxDepth) {
    std::vector<std::string> names;
    forEachTechnique(maxDepth, [&](int s, int t, bool merged) {
        const std::string name = layerName(s, t, merged);
        for (const char* channel : {".R", ".G", ".B"}) {
            names.push_back(kWeighted + name + channel);
            names.push_back(kUnweighted + name + channel);
        }
        names.push_back(kVariance + name);
    });
    for (std::size_t i = 0; i < TechniqueGroup::kCount; ++i) {
        const std::string name = TechniqueGroup::at(i).name();
        names.push_back(kWeighted + name);
        names.push_back(kVariance + name);
    }
    names.push_back("share.t02");
    return names;
}

std::size_t TechniqueFilm::indexOf(int s, int t) const {
    // Paths of k = s + t - 1 edges have k + 1 techniques, s = 0 .. k.
    const int k = s + t - 1;
    return std::size_t(k - 1) * std::size_t(k + 2) / 2 + std::size_t(s);
}

void TechniqueFilm::add(const TechniqueSample& sample) {
    const bool merged = sample.group.kind == TechniqueKind::Merges;
    Technique& technique = (merged ? merges_ : techniques_)[indexOf(sample.s, sample.t)];
    technique.weighted[sample.pixel] += sample.weighted;
    technique.unweighted[sample.pixel] += sample.unweighted;
    const float value = lacuna::mean(sample.weighted);
    technique.moments.now[sample.pixel] += value;
    groups_[sample.group.index()].now[sample.pixel] += value;
}

template <class Visit>
void TechniqueFilm::forEachMoments(const Visit& visit) {
    for (auto* all : {&techniques_, &merges_}) {
        for (Technique& technique : *all) visit(technique.moments);
    }
    for (Moments& group : groups_) visit(group);
}

void TechniqueFilm::countIteration() {
    ++iterations_;
    if (++inSample_ < sampleIterations_) return;
    const float count = float(inSample_);
    forEachMoments([&](Moments& m) {
        if (std::ranges::all_of(m.now, lacuna::isZero)) return;
        for (std::size_t i = 0; i < m.now.size(); ++i) {
            m.sum[i] += m.now[i];
            m.squares[i] += m.now[i] * m.now[i] / count;
        }
        std::ranges::fill(m.now, 0.0f);
    });
    inSample_ = 0;
}

Image TechniqueFilm::mean(const std::vector<Rgb>& sum) const {
    return meanOfSum(sum, iterations_, width_, height_);
}

std::vector<float> TechniqueFilm::meanOf(const Moments& moments) const {
    std::vector<float> mean = moments.sum;
    const float scale = iterations_ ? 1.0f / float(iterations_) : 0.0f;
    for (std::size_t i = 0; i < mean.size(); ++i) mean[i] = (mean[i] + moments.now[i]) * scale;
    return mean;
}

/// The current sample counts by its iterations.
std::vector<float> TechniqueFilm::meanSquareOf(const Moments& moments) const {
    std::vector<float> squares = moments.squares;
    const float scale = iterations_ ? 1.0f / float(iterations_) : 0.0f;
    const float count = inSample_ ? float(inSample_) : 1.0f;
    for (std::size_t i = 0; i < squares.size(); ++i) {
        squares[i] = (squares[i] + moments.now[i] * moments.now[i] / count) * scale;
    }
    return squares;
}

Layers TechniqueFilm::means() const {
    LayeredImage image(width_, height_);
    forEachTechnique(maxDepth_, [&](int s, int t, bool merged) {
        if (merged && merges_.empty()) return;
        const Technique& technique = of(s, t, merged);
        if (std::ranges::all_of(technique.unweighted, isBlack)) return;
        const std::string name = layerName(s, t, merged);
        image.setRgb(kWeighted + name, mean(technique.weighted));
        image.setRgb(kUnweighted + name, mean(technique.unweighted));
        image.channel(kSquare + name) = meanSquareOf(technique.moments);
    });
    for (std::size_t i = 0; i < groups_.size(); ++i) {
        if (groups_[i].isZero()) continue;
        const std::string name = TechniqueGroup::at(i).name();
        image.channel(kWeighted + name) = meanOf(groups_[i]);
        image.channel(kSquare + name) = meanSquareOf(groups_[i]);
    }
    return image.channels();
}

void TechniqueFilm::clear() {
    for (auto* all : {&techniques_, &merges_}) {
        for (Technique& technique : *all) {
            std::ranges::fill(technique.weighted, Rgb{});
            std::ranges::fill(technique.unweighted, Rgb{});
        }
    }
    forEachMoments([](Moments& m) {
        for (auto* plane : {&m.now, &m.sum, &m.squares}) std::ranges::fill(*plane, 0.0f);
    });
    iterations_ = inSample_ = 0;
}

std::vector<float> techniqueVariance(const Layers& layers, const std::string& name,
                                     std::uint64_t samples) {
    const auto squares = layers.find(kSquare + name);
    if (squares == layers.end()) return {};
    std::vector<float> variance = squares->second;
    const auto subtract = [&](const auto& meanAt) {
        for (std::size_t i = 0; i < variance.size(); ++i) {
            const double mean = meanAt(i);
            const double ofOne = double(variance[i]) - mean * mean;
            variance[i] = samples > 1 ? float(std::max(0.0, ofOne) / double(samples - 1)) : 0.0f;
        }
    };
    if (const auto found = layers.find(kWeighted + name); found != layers.end()) {
        subtract([&](std::size_t i) { return double(found->second[i]); });
    } else {
        const auto channel = [&](const char* c) -> const std::vector<float>& {
            return layers.at(kWeighted + name + c);
        };
        const auto &r = channel(".R"), &g = channel(".G"), &b = channel(".B");
        subtract([&](std::size_t i) { return (double(r[i]) + double(g[i]) + double(b[i])) / 3.0; });
    }
    return variance;
}

void setTechniqueVariances(LayeredImage& image, const Layers& layers, std::uint64_t samples) {
    for (const auto& [name, plane] : layers) {
        if (!name.starts_with(kSquare)) continue;
        const std::string of = name.substr(kSquare.size());
        image.channel(kVariance + of) = techniqueVariance(layers, of, samples);
        image.take(name);
    }
}

void addShareOfFirstConnections(LayeredImage& image, int maxDepth) {
    const std::size_t pixels = std::size_t(image.width()) * std::size_t(image.height());
    std::vector<double> total(pixels, 0.0), first(pixels, 0.0);  // over channels and layers
    for (int k = 1; k <= maxDepth; ++k) {
        for (int s = 0; s <= k; ++s) {
            const int t = k + 1 - s;
            const std::string layer = "weighted." + TechniqueFilm::layerName(s, t);
            if (!image.hasRgb(layer)) continue;
            for (const char* channel : {".R", ".G", ".B"}) {
                const std::vector<float>& plane = *image.find(layer + channel);
                for (std::size_t i = 0; i < pixels; ++i) {
                    total[i] += double(plane[i]);
                    if (t == 2 && s > 0) first[i] += double(plane[i]);
                }
            }
        }
    }
    std::vector<float>& share = image.channel("share.t02");
    for (std::size_t i = 0; i < pixels; ++i) {
        share[i] = total[i] > 0.0 ? float(first[i] / total[i]) : 0.0f;
    }
}

}  // namespace lacuna
