// A method from outside: path tracing that joins each eye vertex with several fresh light points.
// Argument: a scene. Its picture must be that of Lacuna's own path tracing.
#include <lacuna/lacuna.h>
#include <lacuna/method.h>

#include <cmath>
#include <cstdio>

#include "libcore/resampling/picks.h"

namespace {

struct Options {
    int points = 4;
};

class ManyPoints final : public lacuna::Method {
  public:
    explicit ManyPoints(const Options& options)
        : points_(options.points), density_(options.points, 0.0, lacuna::Lamps::Power) {}
    const lacuna::ConnectionDensity& freeze(std::uint32_t) override { return density_; }
    void select(const lacuna::EyeContext& context, lacuna::Rng& rng,
                lacuna::ProposalSink& sink) const override {
        for (int i = 0; i < points_; ++i) {
            lacuna::PathVertex& point = sink.newVertex();
            if (context.lights.sampleLight(rng, point)) {
                sink.add({lacuna::Subpath(&point, 1), 1.0 / points_, 0});
            }
        }
    }

  private:
    int points_;
    lacuna::ConstantDensity density_;
};

lacuna::MethodRow manyPoints() {
    lacuna::OptionTable<Options> table;
    table.integer("points", &Options::points, 1, 64, "light points", "per eye vertex");
    return lacuna::methodRow({.name = "many-points",
                              .reference = "Veach97",
                              .summary = "path tracing with several light points per vertex",
                              .techniques = {.hits = true, .connects = true}},
                             table,
                             [](const Options& o) { return std::make_unique<ManyPoints>(o); });
}

double mean(const lacuna::Picture& picture) {
    double sum = 0.0;
    for (const float value : picture.rgb()) sum += value;
    return sum / double(picture.rgb().size());
}

}  // namespace

int main(int, char** argv) {
    const auto render = [&](const char* method) {
        lacuna::Render render(argv[1]);
        render.add(manyPoints());
        render.option("method", method).option("width", 48).option("height", 48);
        render.option("iterations", 64).option("max-depth", 3);
        return render.run();
    };
    const double own = mean(render("many-points")), known = mean(render("pt"));
    std::printf("%g, %g\n", own, known);
    return std::abs(own / known - 1.0) < 0.03 ? 0 : 1;
}
