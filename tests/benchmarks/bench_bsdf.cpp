// What one call of the BSDF costs, per kind of material; arguments cycle through a small table of
// random directions so that branches are predicted as in a render, not by heart.
#include <benchmark/benchmark.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <random>
#include <string>
#include <vector>

#include "libcore/base/sampling.h"
#include "libcore/material/albedo_tables.h"
#include "libcore/material/bsdf.h"

namespace lacuna {
namespace {

struct Named {
    const char* name;
    Bsdf::Parameters parameters;
};

Bsdf::Parameters parameters(float roughness, float metallic, float transmission, float specular,
                            bool thin) {
    Bsdf::Parameters p;
    p.baseColor = {0.8f, 0.5f, 0.2f};
    p.roughness = roughness;
    p.metallic = metallic;
    p.transmission = transmission;
    p.specular = specular;
    p.thin = thin;
    return p;
}

const std::array<Named, 9> kMaterials{{
    {"lambert", parameters(1, 0, 0, 0, true)},
    {"smooth_coat", parameters(0, 0, 0, 1, true)},
    {"rough_plastic", parameters(0.4f, 0, 0, 1, true)},
    {"rough_metal", parameters(0.4f, 1, 0, 1, true)},
    {"mirror", parameters(0, 1, 0, 1, true)},
    {"smooth_glass", parameters(0, 0, 1, 1, false)},
    {"rough_glass", parameters(0.4f, 0, 1, 1, false)},
    {"rough_thin_glass", parameters(0.4f, 0, 1, 1, true)},
    {"rough_everything", parameters(0.4f, 0.3f, 0.5f, 1, false)},
}};

constexpr std::size_t kCount = 1024;

struct Inputs {
    std::vector<Vec3> upper, any;
    std::vector<Vec3> u;
    Inputs() {
        std::mt19937 engine(1);
        std::uniform_real_distribution<float> uniform(0.0f, 0.999999f);
        for (std::size_t i = 0; i < kCount; ++i) {
            const Vec3 a = cosineHemisphere(uniform(engine), uniform(engine));
            Vec3 b = cosineHemisphere(uniform(engine), uniform(engine));
            upper.push_back(a);
            b.z = uniform(engine) < 0.5f ? b.z : -b.z;
            any.push_back(b);
            u.push_back({uniform(engine), uniform(engine), uniform(engine)});
        }
    }
};

void evaluate(benchmark::State& state, Bsdf::Parameters p, bool through) {
    const std::array<float, 1> iors{p.ior};
    const AlbedoTables tables(iors);
    const Bsdf bsdf(p, Vec3{0, 0, 1}, Vec3{0, 0, 1}, tables);
    const Inputs in;
    std::size_t i = 0;
    for (auto _ : state) {
        i = (i + 1) % kCount;
        const BsdfEvaluation e =
            bsdf.evaluate(in.upper[i], through ? in.any[i] : in.upper[(i * 7) % kCount]);
        benchmark::DoNotOptimize(e);
    }
}

void sample(benchmark::State& state, Bsdf::Parameters p) {
    const std::array<float, 1> iors{p.ior};
    const AlbedoTables tables(iors);
    const Bsdf bsdf(p, Vec3{0, 0, 1}, Vec3{0, 0, 1}, tables);
    const Inputs in;
    std::size_t i = 0;
    for (auto _ : state) {
        i = (i + 1) % kCount;
        const auto s = bsdf.sample(Side::Eye, in.upper[i], in.u[i].x, in.u[i].y, in.u[i].z);
        benchmark::DoNotOptimize(s);
    }
}

void construct(benchmark::State& state, Bsdf::Parameters p) {
    const std::array<float, 1> iors{p.ior};
    const AlbedoTables tables(iors);
    for (auto _ : state) {
        benchmark::DoNotOptimize(p);
        const Bsdf bsdf(p, Vec3{0, 0, 1}, Vec3{0, 0, 1}, tables);
        benchmark::DoNotOptimize(bsdf);
    }
}

void tables(benchmark::State& state) {
    for (auto _ : state) {
        const AlbedoTable table(1.5f);
        benchmark::DoNotOptimize(table);
    }
}

}  // namespace
}  // namespace lacuna

int main(int argc, char** argv) {
    using namespace lacuna;
    for (const Named& m : kMaterials) {
        const std::string name = m.name;
        const Bsdf::Parameters p = m.parameters;
        const bool through = p.transmission > 0;
        benchmark::RegisterBenchmark(("evaluate/" + name).c_str(), evaluate, p, through);
        benchmark::RegisterBenchmark(("sample/" + name).c_str(), sample, p);
        benchmark::RegisterBenchmark(("construct/" + name).c_str(), construct, p);
    }
    benchmark::RegisterBenchmark("albedo_table", tables)
        ->Unit(benchmark::kMillisecond)
        ->UseRealTime();
    benchmark::Initialize(&argc, argv);
    benchmark::RunSpecifiedBenchmarks();
    return 0;
}
