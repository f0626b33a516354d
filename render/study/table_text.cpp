// Tables as text: tables.md and the .csv files.
#include "render/study/tables.h"

#include <cstdio>

namespace lacuna {
namespace {

std::string number(const std::optional<double>& value) {
    if (!value) return "";
    char text[40];
    std::snprintf(text, sizeof text, "%.9g", *value);
    return text;
}

}  // namespace

std::string cellText(const Table::Cell& cell) {
    if (const auto* text = std::get_if<std::string>(&cell)) return *text;
    return spreadText(std::get<Spread>(cell));
}

std::string markdown(const Study& study, const std::string& provenance,
                     const std::vector<Table>& tables) {
    std::string text = "# " + study.title + "\n";
    for (const std::string& paragraph : study.about) text.append("\n").append(paragraph + "\n");
    text += "\n" + provenance + "\nMedian (lowest to highest) over " +
            std::to_string(study.seeds.size()) +
            (study.seeds.size() == 1 ? " seed.\n" : " seeds.\n");
    for (const Table& table : tables) {
        text.append("\n## ").append(table.title).append("\n\n|");
        for (const std::string& column : table.columns)
            text.append(" ").append(column).append(" |");
        text += "\n|";
        for (std::size_t i = 0; i < table.columns.size(); ++i) text += "---|";
        text += "\n";
        for (const auto& row : table.rows) {
            text += "|";
            for (const Table::Cell& cell : row)
                text.append(" ").append(cellText(cell)).append(" |");
            text += "\n";
        }
        for (const std::string& note : table.notes) text.append("\n").append(note).append("\n");
    }
    return text;
}

std::string csv(const Table& table) {
    std::string text;
    const auto append = [&](const std::string& field) {
        if (!text.empty() && text.back() != '\n') text += ',';
        text += csvField(field);
    };
    for (std::size_t c = 0; c < table.columns.size(); ++c) {
        append(table.columns[c]);
        if (!std::holds_alternative<Spread>(table.rows.at(0)[c])) continue;
        for (const char* part : {" low", " high", " reached", " of"}) {
            append(table.columns[c] + part);
        }
    }
    text += "\n";
    for (const auto& row : table.rows) {
        for (const Table::Cell& cell : row) {
            if (const auto* plain = std::get_if<std::string>(&cell)) {
                append(*plain);
                continue;
            }
            const Spread& s = std::get<Spread>(cell);
            for (const auto& value : {s.median, s.low, s.high}) append(number(value));
            append(std::to_string(s.reached));
            append(std::to_string(s.of));
        }
        text += "\n";
    }
    return text;
}

}  // namespace lacuna
