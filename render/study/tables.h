// What a study says in numbers: time to an error, error at equal time and at equal iterations,
// knobs.
#pragma once

#include <string>
#include <variant>
#include <vector>

#include "render/study/results.h"
#include "render/study/spread.h"

namespace lacuna {

/// Columns that hold spreads become five in CSV: median, low, high, and how many of how many seeds
/// reached it.
struct Table {
    using Cell = std::variant<std::string, Spread>;

    std::string id;  ///< name of its CSV
    std::string title;
    std::vector<std::string> columns;
    std::vector<std::vector<Cell>> rows;
    std::vector<std::string> notes;
};

/// By how much a reference's own error has to be below an error that it judges: ten times; relmse
/// is a square, there it is a hundred times.
double referenceMargin(Measure measure);

/// All tables of the study that have rows.
std::vector<Table> makeTables(const Results& results);

std::string cellText(const Table::Cell& cell);
/// The whole page; `provenance` says how the results were made (provenance.h).
std::string markdown(const Study& study, const std::string& provenance,
                     const std::vector<Table>& tables);
std::string csv(const Table& table);

}  // namespace lacuna
