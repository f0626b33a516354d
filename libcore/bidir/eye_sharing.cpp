// The part of the eye pass in which pixels share walks. (theory.md, "Shared walks")
#include <algorithm>

#include "libcore/bidir/eye_pass.h"

namespace lacuna {

namespace {
/// Most picks that a pixel makes among the walks that others lend.
constexpr std::size_t kMostBorrowed = 4;
/// Share of the picks that are made without regard to worth: what is worth nothing to the lender may be worth something
/// to the borrower.
constexpr double kShareOfAny = 0.1;

/// Pmf of one of `count` choices by its worth. All of them together are worth `sum`.
double pmfOf(double worth, double sum, std::size_t count) {
    const double even = 1.0 / double(count);
    return sum > 0.0 ? kShareOfAny * even + (1.0 - kShareOfAny) * worth / sum : even;
}

struct PickedEnding {
    const Ending* ending;
    double pmf;
};
PickedEnding pickEnding(const Lent& lent, double u) {
    PickedEnding picked{};
    double end = 0.0;
    for (const Ending& ending : lent.endings) {
        picked = {&ending, pmfOf(ending.value, lent.value, lent.endings.size())};
        end += picked.pmf;
        if (u < end) break;
    }
    return picked;
}
}  // namespace

/// Closes the paths of all pixels, in groups that share walks.
void EyePass::closeTogether(std::span<const PixelPaths> all, const Iteration& iteration,
                            Worker& worker, TaskResult& result) const {
    for (std::size_t i = 0; i < all.size(); ++i) {
        select(all[i], worker.joints[i], iteration, result);
        open(all[i], worker.joints[i], iteration, result);
    }
    const auto most = std::size_t(iteration.counts.sharing.pixels);
    for (std::size_t i = 0; i < all.size(); i += most) {
        const std::size_t count = std::min(most, all.size() - i);
        closeGroup(all.subspan(i, count), std::span(worker.joints).subspan(i, count), iteration,
                   worker, result);
    }
}

void EyePass::closeGroup(std::span<const PixelPaths> group, std::span<const Joints> joints,
                         const Iteration& iteration, Worker& worker, TaskResult& result) const {
    worker.lent.clear();
    for (std::size_t i = 0; i < group.size(); ++i) {
        const PixelPaths& paths = group[i];
        result.clock.start();
        Ends kept{2, paths.eye.size()};
        if (const std::size_t h = LentWalk::begin(paths.eye); h > 0) {
            if (paths.value) close(paths, joints[i], {2, h + 1}, iteration, worker, result);
            kept.first = lend(i, h, group, joints[i], iteration, worker, result);
        }
        if (!paths.value) continue;
        close(paths, joints[i], kept, iteration, worker, result);
        searchBehindGlass(paths, iteration, worker, result);
    }
    for (std::size_t i = 0; i < group.size(); ++i) {
        if (group[i].value) borrow(i, group[i], iteration, worker, result);
    }
}

/// Closes the endings that the lender's walk has behind z_h, weighed against all walks of the group that could have
/// gone the same way. Adds them to the lender's pixel, and lists them in worker.lent for the others. Returns the first
/// t whose endings the lender does not share.
std::size_t EyePass::lend(std::size_t lender, std::size_t h, std::span<const PixelPaths> group,
                          const Joints& joints, const Iteration& iteration, Worker& worker,
                          TaskResult& result) const {
    const PixelPaths& paths = group[lender];
    Lent lent{.walk = {setup_.walker, paths.eye, h}};
    LentWalk& walk = lent.walk;
    const Ends ends{walk.firstEnd(), walk.lastEnd()};
    forEachEnding(
        paths, joints, ends, [&](const Ending& ending) { lent.endings.push_back(ending); },
        [&](std::size_t t) {
            if (paths.value) merge(paths, paths.eye.first(t), iteration, worker, result);
        });
    if (lent.endings.empty()) return ends.last + 1;
    lent.numbers.fill(Lent::kNobody);
    std::uint8_t count = 0;
    for (std::size_t i = 0; i < group.size(); ++i) {
        if (!LentWalk::forksAt(group[i].eye, h)) continue;
        walk.add(group[i].eye, result.tally);
        lent.numbers[i] = count++;
    }
    const std::size_t own = lent.lender = lent.numbers[lender];
    walk.take(own, ends.last, worker.borrowed);
    for (Ending& ending : lent.endings) {
        const Subpath eye = Subpath(worker.borrowed).first(ending.t);
        ending.value = double(mean(closeAt(ending, eye, paths, iteration, worker, result)));
        lent.value += ending.value;
    }
    worker.lent.push_back(std::move(lent));
    return ends.last + 1;
}

/// Borrows some of the walks that the others lend. They are picked by what they are worth to their
/// lenders, because the borrower sees much the same.
void EyePass::borrow(std::size_t borrower, const PixelPaths& paths, const Iteration& iteration,
                     Worker& worker, TaskResult& result) const {
    std::vector<Offer>& offers = worker.offers;
    offers.clear();
    double sum = 0.0;
    for (const Lent& lent : worker.lent) {
        const std::size_t i = lent.numbers[borrower];
        if (i == Lent::kNobody || i == lent.lender || !lent.walk.leadsFrom(i)) continue;
        const double worth = lent.value * lent.walk.brightness(i, lent.lender);
        offers.push_back({&lent, i, worth});
        sum += worth;
    }
    if (offers.empty()) return;
    Rng rng = setup_.sampler.stream(iteration.number, StreamKind::Sharing, paths.sample.number);
    const std::size_t picks = std::min(kMostBorrowed, offers.size());
    const double first = rng.uniformDouble();
    double end = 0.0;
    std::size_t next = 0;
    for (const Offer& offer : offers) {
        const double pmf = pmfOf(offer.worth, sum, offers.size());
        end += pmf;
        for (; next < picks && (double(next) + first) / double(picks) < end; ++next) {
            const Lent& lent = *offer.lent;
            const auto [ending, endingPmf] = pickEnding(lent, rng.uniformDouble());
            lent.walk.take(offer.number, ending->t, worker.borrowed);
            closeAt(*ending, worker.borrowed, paths, iteration, worker, result,
                    1.0 / (double(picks) * pmf * endingPmf));
        }
    }
}

}  // namespace lacuna
