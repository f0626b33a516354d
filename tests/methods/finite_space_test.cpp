// Acceptance 0: every row of the tool, and rows of tests that use more of the interfaces, reproduce the completely
// enumerated truth.
#include <gtest/gtest.h>

#include <cctype>
#include <cmath>

#include "tests/fixtures/estimate.h"
#include "tests/fixtures/test_rows.h"
#include "tests/stability.h"

namespace lacuna::test {
namespace {

/// Two-sided 4.5 standard errors: a false alarm in 7e-6 of the comparisons, of which there are fewer than 250 here.
constexpr double kStandardErrors = 4.5;
/// The relative standard error of the mean. A bias of 0.65 % fails in 98 of 100 cases, or one of 1.3 % if coarse.
constexpr double kError = 1e-3, kCoarseError = 2e-3;

std::vector<std::string> settingsOf(const MethodRow& row, int candidates) {
    std::vector<std::string> settings = smallSettings(row, candidates);
    for (const Option& p : row.options) {
        if (p.name == "light_paths") settings.push_back("light_paths=2");
    }
    return settings;
}

/// Rows that merge only between deltas need some deltas to merge at, and rows that look through polished metal need
/// polished metal.
FiniteSpace spaceFor(const MethodRow& row, const std::vector<std::string>& settings) {
    const Merging merging = row.create(resolve(row, settings))->merging();
    if (merging.where == Merges::BetweenDeltas) return FiniteSpace::ofMirrors();
    if (merging.where == Merges::FirstFromEye) return FiniteSpace::ofPolishedMetal();
    return FiniteSpace(3);
}

void expectTruth(const MethodRow& row, const std::vector<std::string>& settings,
                 double relativeError) {
    const FiniteSpace space = spaceFor(row, settings);
    const FiniteEstimate e = estimate(space, row, settings, 11, relativeError);
    ASSERT_GT(e.truth, 0.0) << row.name;
    EXPECT_LT(e.standardError, 1.01 * relativeError * e.truth)
        << row.name << ": too noisy to judge";
    EXPECT_NEAR(e.mean / e.truth, 1.0, kStandardErrors * e.standardError / e.truth)
        << row.name << ": mean " << e.mean << ", truth " << e.truth << ", standard error "
        << e.standardError << ", " << e.iterations << " iterations";
    // A photon count n_m that is wrong everywhere leaves every mean right. The squares of merges show it.
    if (e.trueMergeSquares == 0.0) return;
    EXPECT_LT(e.mergeSquaresError, 0.0201 * e.trueMergeSquares)
        << row.name << ": too noisy to judge";
    EXPECT_NEAR(e.mergeSquares, e.trueMergeSquares, kStandardErrors * e.mergeSquaresError)
        << row.name << ": squares of merges";
}

/// A row and the settings under which it must meet the truth. Each case is one test, so that they run in parallel.
struct Case {
    MethodRow row;
    std::vector<std::string> settings;
    double relativeError = kError;
};
void PrintTo(const Case& c, std::ostream* out) {
    *out << c.row.name;
    for (const std::string& s : c.settings) *out << ' ' << s;
}

class FiniteSpaceRow : public testing::TestWithParam<Case> {};
class FiniteSpacePoolsSlow : public testing::TestWithParam<Case> {};

TEST_P(FiniteSpaceRow, meetsTheEnumeratedTruth) {
    expectTruth(GetParam().row, GetParam().settings, GetParam().relativeError);
}

TEST_P(FiniteSpacePoolsSlow, meetsTheEnumeratedTruth) {
    expectTruth(GetParam().row, GetParam().settings, GetParam().relativeError);
}

/// Every row with its default settings.
std::vector<Case> everyRow() {
    std::vector<Case> cases;
    for (const MethodRow& row : allRows()) cases.push_back({row, settingsOf(row, 4)});
    return cases;
}

/// Every row with next event switched if possible, and with every other choice of its options. Rows with cache points
/// also run with more points than the space has states. Where points may be weighted, several surround an eye vertex,
/// with and without a reserve. Guides are left out: they guide a scene's walks, and the space has its own.
std::vector<Case> everyChoice(Rows rows, double relativeError) {
    std::vector<Case> cases;
    for (const MethodRow& row : rowsOf(rows)) {
        const auto add = [&](const std::string& setting) {
            cases.push_back({row, settingsOf(row, 4), relativeError});
            cases.back().settings.push_back(setting);
        };
        bool nextEvent = true;
        for (const Option& p : row.options) {
            if (p.name == "emission" || p.name == "walks") continue;
            if (p.name == "next_event") {
                nextEvent = p.standard == "on";
                add(nextEvent ? "next_event=off" : "next_event=on");
            }
            for (const std::string& choice : p.choices) {
                if (choice == p.standard) continue;
                add(p.name + "=" + choice);
                // Without next event, a lamp is never picked by its contribution at a vertex.
                if (p.name == "lamps" && !nextEvent) {
                    cases.back().settings.push_back("next_event=on");
                }
            }
            if (p.name == "connections") add("connections=2");
            if (p.name == "merge") add("merge=on");
            if (p.name == "cache_density") add("cache_density=2");
            if (p.name == "cache_points") add("cache_points=1");
            if (p.name == "second_candidates") add("second_candidates=3");
            if (p.name != "points") continue;
            // Without next event and with r = 1, picks carry so much light that a missing share shows.
            for (const char* defensive : {"defensive=0", "defensive=0.5"}) {
                add("points=weighted");
                for (const char* more : {"cache_points=3", "cache_density=2", "next_event=off",
                                         "weights=plain", defensive}) {
                    cases.back().settings.push_back(more);
                }
            }
        }
    }
    return cases;
}

/// Every row with its default settings, and with merging where it is an option.
std::vector<Case> withMerging() {
    std::vector<Case> cases = everyRow();
    for (const MethodRow& row : allRows()) {
        for (const Option& p : row.options) {
            if (p.name != "merge") continue;
            cases.push_back({row, settingsOf(row, 4)});
            cases.back().settings.push_back("merge=on");
        }
    }
    return cases;
}

/// Pools of one and two subpaths: a density that reads the pool it weighs is wrong by several percent there.
std::vector<Case> tinyPools(Rows rows) {
    std::vector<Case> cases;
    for (const MethodRow& row : rowsOf(rows)) {
        if (smallSettings(row, 1).empty()) continue;
        for (const int candidates : {1, 2}) cases.push_back({row, settingsOf(row, candidates)});
    }
    return cases;
}

std::string nameOf(const testing::TestParamInfo<Case>& info) {
    std::string name = testing::PrintToString(info.param);
    for (char& c : name) {
        if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
    }
    return name;
}

INSTANTIATE_TEST_SUITE_P(All, FiniteSpaceRow, testing::ValuesIn(everyRow()), nameOf);
INSTANTIATE_TEST_SUITE_P(Coarse, FiniteSpaceRow,
                         testing::ValuesIn(everyChoice(Rows::OfTheTool, kCoarseError)), nameOf);
INSTANTIATE_TEST_SUITE_P(Night, FiniteSpaceRow,
                         testing::ValuesIn(everyChoice(Rows::OfTheTool, kError)), nameOf);
INSTANTIATE_TEST_SUITE_P(NightOfTests, FiniteSpaceRow,
                         testing::ValuesIn(everyChoice(Rows::OfTests, kError)), nameOf);
INSTANTIATE_TEST_SUITE_P(All, FiniteSpacePoolsSlow, testing::ValuesIn(tinyPools(Rows::OfTheTool)),
                         nameOf);
INSTANTIATE_TEST_SUITE_P(NightOfTests, FiniteSpacePoolsSlow,
                         testing::ValuesIn(tinyPools(Rows::OfTests)), nameOf);

/// The counterexample of [Nabata20a Fig. 3]. With Q from the pool that is weighed, two subpaths lose 1.2 % of the
/// picture; Q of earlier pools loses nothing. At the requested error this is eight standard errors, and the bound of
/// 4.5 is a false alarm in 7e-6.
TEST(FiniteSpaceBiased, qOfTheCurrentPoolIsSeen) {
    const MethodRow current = findMethod("risbpt-current");
    EXPECT_TRUE(current.biased);
    for (const MethodRow& row : allRows()) EXPECT_NE(row.name, current.name);
    const FiniteSpace space(3);
    constexpr double kEnough = 1.5e-3;
    const std::vector<std::string> settings = {"candidates=2", "preset=paper"};
    const FiniteEstimate e = estimate(space, current, settings, 11, kEnough);
    EXPECT_LT(e.standardError, 1.01 * kEnough * e.truth) << "too noisy to judge";
    EXPECT_LT(e.mean, e.truth - kStandardErrors * e.standardError) << e.mean / e.truth;
    EXPECT_GT(e.mean, 0.97 * e.truth) << "a defect, not the correlation";
    expectTruth(findMethod("risbpt"), settings, kEnough);
}

/// The method's density before the first iteration, on random paths of the space.
TEST(FiniteSpace, weightsSumToOneAndMeetFullProducts) {
    double worst = 0.0;
    for (const Case& c : withMerging()) {
        const MethodRow& row = c.row;
        const FiniteSpace space = spaceFor(row, c.settings);
        const auto method = row.create(resolve(row, c.settings));
        TechniqueCounts counts;
        counts.hit = row.techniques.hits;
        counts.splats = row.techniques.splats ? 5.0 : 0.0;
        if (row.techniques.connects) counts.connectThrough(method->freeze(0), space);
        counts.merges = method->merging().where;
        counts.mergeSamples = 7.0;
        counts.rouletteDepth = FiniteSpace::kRouletteDepth;

        Rng rng(5, 0, StreamKind::User, 0);
        FullPath path;
        int judged = 0;
        for (int n = 0; n < 20000; ++n) {
            const int k = 1 + int(rng.below(FiniteSpace::kMaxEdges));
            std::vector<int> x;
            for (int i = 0; i < k; ++i) {
                x.push_back(int(rng.below(i == 0 ? FiniteSpace::kEmitters : FiniteSpace::kLens)));
            }
            x.push_back(FiniteSpace::kLens);
            bool valid = true;
            for (int i = 0; i < k; ++i) valid &= space.visible(x[i], x[i + 1]) && x[i] != x[i + 1];
            if (!valid) continue;
            space.fill(x, path);
            path.fillLightThroughputs(counts.rouletteDepth);

            // (n p r)^b of every strategy, as full products.
            bool squares = counts.squared == SquaredLights::All ||
                           (counts.squared == SquaredLights::Hittable && path.hittable);
            for (int i = 2; i < k; ++i) {
                squares &= path.delta[i] || !path.vertex[i]->scattersWidely();
            }
            const double power = squares ? 2.0 : 1.0;
            std::vector<double> product(std::size_t(k) + 2, 0.0);
            double sum = 0.0;
            for (int t = 1; t <= k + 1; ++t) {
                double p = effectiveCount(path, counts, t);
                for (int i = 0; i <= k - t; ++i) {
                    p *= double(path.lightPdfA[i]) * path.lightRoulette(i, counts.rouletteDepth);
                }
                for (int i = k - t + 1; i <= k; ++i) {
                    p *= double(path.eyePdfA[i]) * path.eyeRoulette(i, counts.rouletteDepth);
                }
                sum += product[t] = std::pow(p, power);
            }
            std::vector<double> merged(std::size_t(k) + 1, 0.0);
            for (int i = 1; i < k; ++i) {
                double p = mergedSamples(path, counts, i);
                for (int j = 0; j <= i; ++j) {
                    p *= double(path.lightPdfA[j]) * path.lightRoulette(j, counts.rouletteDepth);
                }
                for (int j = i; j <= k; ++j) {
                    p *= double(path.eyePdfA[j]) * path.eyeRoulette(j, counts.rouletteDepth);
                }
                sum += merged[i] = std::pow(p, power);
            }
            if (sum <= 0.0) continue;
            ++judged;
            double weights = 0.0;
            for (int t = 1; t <= k + 1; ++t) {
                if (product[t] <= 0.0) continue;
                const double w = misWeight(path, counts, t);
                EXPECT_NEAR(w, product[t] / sum, 1e-9) << row.name << " k " << k << " t " << t;
                weights += w;
            }
            for (int i = 1; i < k; ++i) {
                if (merged[i] <= 0.0) continue;
                const double w = misWeight(path, counts, {k + 1 - i, Technique::By::Merge});
                EXPECT_NEAR(w, merged[i] / sum, 1e-9) << row.name << " k " << k << " x_" << i;
                weights += w;
            }
            EXPECT_NEAR(weights, 1.0, 1e-9) << row.name;
            worst = std::max(worst, std::fabs(weights - 1.0));
        }
        EXPECT_GT(judged, 500) << row.name;
    }
    stabilityCase("zero-densities", worst, "off a sum of one, at most");
}

}  // namespace
}  // namespace lacuna::test
