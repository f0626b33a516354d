// The time to read a cache of lacuna-train: a thousand subspaces on either side, 4 MB.
#include <benchmark/benchmark.h>

#include <filesystem>

#include "tests/cache/example_subspaces.h"

namespace lacuna {
namespace {

void readSubspaces(benchmark::State& state) {
    const std::filesystem::path file =
        std::filesystem::temp_directory_path() / "lacuna-bench.subspaces";
    writeSubspaceFile(file.string(), test::example(1000, 1000));
    for (auto _ : state) {
        benchmark::DoNotOptimize(readSubspaceFile(file.string(), test::kStamp, "train again"));
    }
    std::filesystem::remove(file);
}
BENCHMARK(readSubspaces)->Name("read/subspaces")->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace lacuna

BENCHMARK_MAIN();
