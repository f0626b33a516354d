#include "libcore/resampling/two_stages.h"

#include <array>
#include <cassert>

#include "libcore/resampling/picks.h"

namespace lacuna {

void LightCell::makeTable() {
    std::vector<double> weights;
    for (const Subpath& y : members) weights.push_back(double(mean(y.back().throughput)));
    within = AliasTable(weights);
}

void pickInTwoStages(std::span<const double> numbers, const AliasTable& column,
                     std::span<const LightCell> cells, double picksTimesPaths, ProposalSink& sink) {
    // In a pick every access to memory waits for the one before, so the picks are
    // made side by side.
    struct Pick {
        double u, subspacePmf, pmf;
        const LightCell* cell;
        const Subpath* light;
    };
    assert(numbers.size() <= std::size_t(Picks::kMost));
    std::array<Pick, Picks::kMost> storage;  // not initialised: few of them are used
    const auto picks = std::span(storage).first(numbers.size());
    for (std::size_t i = 0; i < picks.size(); ++i) {
        picks[i].u = numbers[i];
        column.prefetch(picks[i].u);
    }
    for (Pick& p : picks) {
        const AliasTable::Pick subspace = column.sample(p.u);
        p.cell = &cells[subspace.index];
        p.subspacePmf = subspace.pmf;
        p.u = subspace.remapped;
        p.cell->within.prefetch(p.u);
    }
    for (Pick& p : picks) {
        p.light = nullptr;
        if (p.cell->within.empty()) continue;
        const AliasTable::Pick within = p.cell->within.sample(p.u);
        p.pmf = p.subspacePmf * within.pmf;
        p.light = &p.cell->members[within.index];
        __builtin_prefetch(p.light);
    }
    for (const Pick& p : picks) {
        if (!p.light) continue;
        prefetch(p.light->back());
        sink.add({*p.light, 1.0 / (picksTimesPaths * p.cell->iterations * p.pmf), 0});
    }
}

}  // namespace lacuna
