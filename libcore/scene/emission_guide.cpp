#include "libcore/scene/emission_guide.h"

#include <cmath>
#include <span>
#include <stdexcept>

#include "libcore/base/content_hash.h"

namespace lacuna {

void EmissionGuide::check(std::size_t lights) const {
    const auto require = [](bool good, const char* what) {
        if (!good) throw std::invalid_argument(std::string("emission guide: ") + what);
    };
    require(pmf.size() == lights && pointTree.size() == lights, "as many lights as there are");
    double sum = 0.0;
    for (const double p : pmf) {
        require(p >= 0.0 && p <= 1.0, "probabilities of lights");
        sum += p;
    }
    require(std::abs(sum - 1.0) < 1e-6, "probabilities that sum to one");
    require(firstLeaf.size() == points.size(), "leaves of every tree of points");
    std::uint64_t leaves = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        require(firstLeaf[i] == leaves, "leaves in the order of trees");
        leaves += points[i].leafCount();
    }
    require(rayTree.size() == leaves, "a tree of rays for every leaf, or none");
    for (const std::uint32_t t : pointTree)
        require(t == kNone || t < points.size(), "trees of points");
    for (const std::uint32_t t : rayTree) require(t == kNone || t < rays.size(), "trees of rays");
}

std::string EmissionGuide::contentHash() const {
    ContentHash hash;
    const auto add = [&](const auto& values) {
        hash.addValue(std::uint64_t(values.size()));
        hash.addValues(std::span(values));
    };
    add(pmf);
    add(pointTree);
    add(firstLeaf);
    add(rayTree);
    for (const SquareDensity& d : points) add(d.nodes());
    for (const SquareDensity& d : rays) add(d.nodes());
    return hash.hex();
}

}  // namespace lacuna
