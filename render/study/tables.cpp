#include "render/study/tables.h"

#include <algorithm>
#include <cmath>

#include "render/study/band.h"
#include "render/study/choices.h"

namespace lacuna {
namespace {

using Values = std::vector<std::optional<double>>;

double valueOf(const ErrorMeasures& e, Measure measure) {
    const double values[] = {e.mae, e.rmse, e.mape, e.relmse};
    return values[std::size_t(measure)];
}

/// Why a reference with this error of its own cannot judge an error of this size; "" if it can.
std::string referenceFlag(const std::optional<ErrorMeasures>& own, Measure measure, double error) {
    if (!own) return "its error is not known";
    const double value = valueOf(*own, measure);
    return value * referenceMargin(measure) <= error ? "" : "too noisy: " + shortNumber(value);
}

/// Calls `visit` for every scene and measure.
template <class Visit>
void forEachMeasure(const Results& results, const Visit& visit) {
    for (std::size_t s = 0; s < results.study.scenes.size(); ++s) {
        for (const std::string& measure : results.study.measures) visit(s, measure);
    }
}

Values timesTo(const Results& results, std::size_t scene, std::size_t method, Measure measure,
               double bound, Axis axis) {
    Values values;
    for (const RunResult* r : results.of(scene, method)) {
        values.push_back(timeToError(r->curve.points, measure, bound, axis));
    }
    return values;
}

std::size_t baselineOf(const Study& study) {
    std::size_t m = 0;
    while (study.methods[m].name != study.baseline) ++m;
    return m;
}

Table timeTable(const Results& results) {
    const Study& study = results.study;
    Table table;
    table.id = "time-to-error";
    table.title = "Time to an error";
    table.columns = {"scene",    "measure",    "bound",   "method",
                     "seconds",  "with setup", "speedup", "speedup with setup",
                     "reference"};
    const std::size_t baseline = baselineOf(study);
    forEachMeasure(results, [&](std::size_t s, const std::string& name) {
        const auto bounds = study.scenes[s].bounds.find(name);
        if (bounds == study.scenes[s].bounds.end()) return;
        const Measure measure = measureOf(name);
        for (const double bound : bounds->second) {
            for (std::size_t m = 0; m < study.methods.size(); ++m) {
                std::vector<Table::Cell> row{study.scenes[s].name, name, shortNumber(bound),
                                             study.methods[m].name};
                std::vector<Table::Cell> speedups;
                for (const Axis axis : {Axis::Seconds, Axis::SecondsWithSetup}) {
                    const Values own = timesTo(results, s, m, measure, bound, axis);
                    row.push_back(spread(own));
                    speedups.push_back(
                        spread(ratios(timesTo(results, s, baseline, measure, bound, axis), own)));
                }
                row.insert(row.end(), speedups.begin(), speedups.end());
                row.push_back(referenceFlag(results.references[s].ownError, measure, bound));
                table.rows.push_back(std::move(row));
            }
        }
    });
    table.notes = {"Speedups are relative to " + study.baseline +
                       ": ratios of times of the same seed, then the median over seeds.",
                   "A time is the first after which the error stays below the bound. Where the "
                   "first row of a curve is below already, it is that row's time."};
    return table;
}

/// The references' own errors.
Table referenceTable(const Results& results) {
    Table table;
    table.id = "references";
    table.title = "References and their own errors";
    table.columns = {"scene", "reference", "mae", "rmse", "mape", "relmse"};
    for (std::size_t s = 0; s < results.study.scenes.size(); ++s) {
        const Reference& reference = results.references[s];
        std::vector<Table::Cell> row{results.study.scenes[s].name, reference.origin};
        const ErrorMeasures e = reference.ownError.value_or(ErrorMeasures{});
        for (const double value : {e.mae, e.rmse, e.mape, e.relmse}) {
            row.push_back(reference.ownError ? shortNumber(value) : "not known");
        }
        table.rows.push_back(std::move(row));
    }
    table.notes = {
        "The errors that the variance in the file predicts. A reference should be ten times better "
        "than the error that it judges (relmse, a square: a hundred times); tables say where it is "
        "not."};
    return table;
}

Table errorTable(const Results& results, Axis axis) {
    const Study& study = results.study;
    const bool iterations = axis == Axis::Iterations;
    const bool setup = axis == Axis::SecondsWithSetup;
    const std::vector<double>& asked = iterations ? study.iterations : study.times;
    Table table;
    table.id = iterations ? "error-at-iterations"
               : setup    ? "error-at-time-with-setup"
                          : "error-at-time";
    table.title = std::string("Error at equal ") + (iterations ? "iterations" : "time") +
                  (setup ? ", setup counted" : "");
    table.columns = {"scene",    "measure", iterations ? "iterations" : "seconds",
                     "method",   "error",   "ratio to " + study.baseline,
                     "reference"};
    const std::size_t baseline = baselineOf(study);
    forEachMeasure(results, [&](std::size_t s, const std::string& name) {
        const Measure measure = measureOf(name);
        const std::vector<double> at =
            asked.empty() ? std::vector<double>{commonEnd(results.curvesOf(s), axis)} : asked;
        for (const double x : at) {
            for (std::size_t m = 0; m < study.methods.size(); ++m) {
                const Values own = errorsAt(results.of(s, m), measure, x, axis);
                const Values base = errorsAt(results.of(s, baseline), measure, x, axis);
                const Spread errors = spread(own);
                table.rows.push_back({study.scenes[s].name, name, shortNumber(x),
                                      study.methods[m].name, errors, spread(ratios(own, base)),
                                      errors.low ? referenceFlag(results.references[s].ownError,
                                                                 measure, *errors.low)
                                                 : ""});
            }
        }
    });
    table.notes = {"\"not reached\": some run ended before, or had not completed an iteration."};
    return table;
}

/// Errors inside the crops of the pictures that the page shows: those at the end of the runs.
Table cropTable(const Results& results) {
    const Study& study = results.study;
    Table table;
    table.id = "error-in-crops";
    table.title = "Error inside the crops, at the end of the runs";
    table.columns = {"scene",    "measure", "crop", "method", "error", "ratio to " + study.baseline,
                     "reference"};
    const std::size_t baseline = baselineOf(study);
    forEachMeasure(results, [&](std::size_t s, const std::string& name) {
        const Measure measure = measureOf(name);
        const auto errorsOf = [&](std::size_t method, std::size_t crop) {
            Values values;
            for (const RunResult* r : results.of(s, method)) {
                const double error = valueOf(r->cropErrors[crop], measure);
                values.push_back(std::isfinite(error) ? std::optional(error) : std::nullopt);
            }
            return values;
        };
        for (std::size_t c = 0; c < study.scenes[s].crops.size(); ++c) {
            const Values base = errorsOf(baseline, c);
            for (std::size_t m = 0; m < study.methods.size(); ++m) {
                const Values own = errorsOf(m, c);
                const Spread errors = spread(own);
                const std::optional<ErrorMeasures>& judge = results.references[s].crops[c].ownError;
                table.rows.push_back(
                    {study.scenes[s].name, name, study.scenes[s].crops[c].name,
                     study.methods[m].name, errors, spread(ratios(own, base)),
                     errors.low ? referenceFlag(judge, measure, *errors.low) : ""});
            }
        }
    });
    table.notes = {
        "Each crop is treated as if it were the whole picture: e of mape and relmse is a hundredth "
        "of the crop's own mean. \"not reached\": the crop is black in the reference, but not in "
        "the picture."};
    return table;
}

/// For each varied parameter, the cheapest value that reaches each bound.
Table knobTable(const Results& results) {
    const Study& study = results.study;
    Table table;
    table.id = "knobs";
    table.title = "The cheapest setting that reaches a bound";
    table.columns = {"scene",    "measure", "bound", "method", "setting", "seconds with setup",
                     "reference"};
    std::vector<std::string> groups;
    for (const StudyMethod& m : study.methods) {
        if (!m.knob.empty() && std::count(groups.begin(), groups.end(), m.knobGroup) == 0) {
            groups.push_back(m.knobGroup);
        }
    }
    forEachMeasure(results, [&](std::size_t s, const std::string& name) {
        const auto bounds = study.scenes[s].bounds.find(name);
        if (bounds == study.scenes[s].bounds.end()) return;
        for (const double bound : bounds->second) {
            for (const std::string& group : groups) {
                std::string setting = "none of them";
                Spread best;
                for (std::size_t m = 0; m < study.methods.size(); ++m) {
                    const StudyMethod& method = study.methods[m];
                    if (method.knob.empty() || method.knobGroup != group) continue;
                    const Spread times = spread(
                        timesTo(results, s, m, measureOf(name), bound, Axis::SecondsWithSetup));
                    if (times.median && (!best.median || *times.median < *best.median)) {
                        best = times;
                        setting = method.knob + "=" + method.knobValue;
                    }
                }
                table.rows.push_back(
                    {study.scenes[s].name, name, shortNumber(bound), group, setting, best,
                     referenceFlag(results.references[s].ownError, measureOf(name), bound)});
            }
        }
    });
    return table;
}

}  // namespace

double referenceMargin(Measure measure) {
    constexpr double kTimesBetter = 10.0;
    return measure == Measure::Relmse ? kTimesBetter * kTimesBetter : kTimesBetter;
}

std::vector<Table> makeTables(const Results& results) {
    std::vector<Table> all{choiceTable(results),
                           timeTable(results),
                           errorTable(results, Axis::Seconds),
                           errorTable(results, Axis::SecondsWithSetup),
                           errorTable(results, Axis::Iterations),
                           cropTable(results),
                           knobTable(results),
                           referenceTable(results)};
    std::erase_if(all, [](const Table& table) { return table.rows.empty(); });
    return all;
}

}  // namespace lacuna
