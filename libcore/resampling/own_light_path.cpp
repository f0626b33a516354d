#include "libcore/resampling/own_light_path.h"

#include "libcore/resampling/picks.h"

namespace lacuna {

namespace {

class OwnLightPath final : public Method {
  public:
    explicit OwnLightPath(const OwnLightPathOptions& options)
        : nextEvent_(options.nextEvent),
          merging_(options.merging),
          density_(1.0, 1.0, lampsOf(options.nextEvent, options.lamps)) {}

    PoolRequest pool() const override { return {.perPixel = merging_.where != Merges::Nowhere}; }
    Merging merging() const override { return merging_; }
    const ConnectionDensity& freeze(std::uint32_t) override { return density_; }
    void select(const EyeContext& context, Rng& rng, ProposalSink& sink) const override {
        if (nextEvent_) proposeFreshLight(context, density_.lamps(), rng, sink);
        for (std::size_t s = nextEvent_ ? 2 : 1; s <= context.ownLightPath.size(); ++s) {
            const Subpath prefix = context.ownLightPath.first(s);
            if (prefix.back().connectable()) sink.add({prefix, 1.0, 0});
        }
    }

  private:
    bool nextEvent_;
    Merging merging_;
    ConstantDensity density_;
};

}  // namespace

std::unique_ptr<Method> makeOwnLightPath(const OwnLightPathOptions& options) {
    return std::make_unique<OwnLightPath>(options);
}

}  // namespace lacuna
