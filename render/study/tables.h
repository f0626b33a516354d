// The tables of a study: time to an error, error at equal time and at equal iterations, knobs.
#pragma once

#include <string>
#include <variant>
#include <vector>

#include "render/study/results.h"
#include "render/study/spread.h"

namespace lacuna {

/// A column of spreads becomes five columns in CSV: median, low, high, the number of seeds that
/// reached it, and the number of seeds.
struct Table {
    using Cell = std::variant<std::string, Spread>;

    std::string id;  ///< name of its CSV
    std::string title;
    std::vector<std::string> columns;
    std::vector<std::vector<Cell>> rows;
    std::vector<std::string> notes;
};

/// Factor by which a reference's own error must be below an error that it judges: ten; a hundred
/// for relmse, which is a square.
double referenceMargin(Measure measure);

/// All tables of the study that have rows.
std::vector<Table> makeTables(const Results& results);

std::string cellText(const Table::Cell& cell);
/// All tables as Markdown; `provenance`: text of provenance.h.
std::string markdown(const Study& study, const std::string& provenance,
                     const std::vector<Table>& tables);
std::string csv(const Table& table);

}  // namespace lacuna
