#include "libcore/bidir/mattes.h"

#include <algorithm>

#include "libcore/base/parallel.h"
#include "libcore/base/rng.h"
#include "libcore/bidir/first_seen.h"

namespace lacuna {

namespace {

constexpr int kFewStrata = 4, kManyStrata = 8;  // along each side of a pixel

/// A matte's names, and which of them an object has.
struct Named {
    Named(const std::vector<ObjectNames>& objects, std::string ObjectNames::*member) {
        const auto nameOf = [&](const ObjectNames& object) {
            return (object.*member).empty() ? std::string("unnamed") : object.*member;
        };
        for (const ObjectNames& object : objects) names.push_back(nameOf(object));
        std::ranges::sort(names);
        // clang 14 does not compile ranges::unique with this library.
        names.erase(std::unique(names.begin(), names.end()), names.end());
        for (const ObjectNames& object : objects) {
            const auto at = std::ranges::lower_bound(names, nameOf(object));
            ofObject.push_back(std::uint32_t(at - names.begin()));
        }
    }

    std::vector<std::string> names;       // in order
    std::vector<std::uint32_t> ofObject;  // among the names
};

/// The objects that the rays of a pixel met.
class Met {
  public:
    void clear() {
        objects_.clear();
        rays_ = 0;
    }
    void add(const std::optional<SurfacePoint>& hit) {
        ++rays_;
        if (hit) objects_.push_back(hit->object);
    }
    /// Whether all rays met the same name, or all met nothing.
    bool agreesOn(const Named& named) const {
        if (objects_.empty()) return true;
        const auto nameOf = [&](std::uint32_t object) { return named.ofObject[object]; };
        const std::uint32_t first = nameOf(objects_.front());
        return int(objects_.size()) == rays_ &&
               std::ranges::all_of(objects_, [&](std::uint32_t o) { return nameOf(o) == first; });
    }
    Matte::Pixel covers(const Named& named) const {
        std::vector<Matte::Cover> all;
        for (const std::uint32_t object : objects_) {
            const std::uint32_t name = named.ofObject[object];
            const auto at = std::ranges::find(all, name, &Matte::Cover::name);
            if (at == all.end()) {
                all.push_back({name, 1.0f});
            } else {
                at->share += 1.0f;
            }
        }
        std::ranges::sort(all, [](const Matte::Cover& a, const Matte::Cover& b) {
            return a.share != b.share ? a.share > b.share : a.name < b.name;
        });
        Matte::Pixel pixel;
        for (std::size_t i = 0; i < std::min(all.size(), pixel.size()); ++i) {
            pixel[i] = {all[i].name, all[i].share / float(rays_)};
        }
        return pixel;
    }

  private:
    std::vector<std::uint32_t> objects_;
    int rays_ = 0;
};

}  // namespace

Mattes renderMattes(const Scene& scene, const Camera& camera, const PixelRect& crop,
                    std::uint64_t seed, const ThreadPool& pool) {
    const std::vector<ObjectNames> all = scene.objectNames();
    const Named objects(all, &ObjectNames::node), materials(all, &ObjectNames::material);
    const std::size_t pixels = std::size_t(crop.width()) * std::size_t(crop.height());
    Mattes mattes{{"CryptoObject", objects.names, std::vector<Matte::Pixel>(pixels)},
                  {"CryptoMaterial", materials.names, std::vector<Matte::Pixel>(pixels)}};
    const auto filmWidth = std::uint64_t(camera.film().width);

    pool.forEach(std::size_t(crop.height()), [&](std::size_t row) {
        RayTally tally;  // not part of the render: these rays are counted nowhere
        Met met;
        const int y = crop.y0 + int(row);
        for (int x = crop.x0; x < crop.x1; ++x) {
            Rng rng(seed, 0, StreamKind::Mattes, std::uint64_t(y) * filmWidth + std::uint64_t(x));
            const auto look = [&](int strata) {
                met.clear();
                const float side = 1.0f / float(strata);
                for (int i = 0; i < strata * strata; ++i) {
                    const float jitterX = (float(i % strata) + rng.uniform()) * side;
                    const float jitterY = (float(i / strata) + rng.uniform()) * side;
                    const float u1 = rng.uniform(), u2 = rng.uniform();
                    const Sight sight =
                        sightThrough(camera, {float(x) + jitterX, float(y) + jitterY}, {u1, u2});
                    met.add(firstSeen(scene, sight, tally));
                }
            };
            look(kFewStrata);
            if (!met.agreesOn(objects) || !met.agreesOn(materials)) look(kManyStrata);
            const std::size_t pixel = row * std::size_t(crop.width()) + std::size_t(x - crop.x0);
            mattes.objects.pixels[pixel] = met.covers(objects);
            mattes.materials.pixels[pixel] = met.covers(materials);
        }
    });
    return mattes;
}

}  // namespace lacuna
