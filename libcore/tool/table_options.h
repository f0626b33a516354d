// Command-line options from a table of options (options.h): `light_paths` becomes --light-paths.
#pragma once

#include <deque>
#include <string>
#include <vector>

#include "libcore/base/options.h"

namespace CLI {
class App;
}

namespace lacuna {

/// The texts that a command line gives for options; declared on construction. It must be there
/// while `app` parses.
class OptionTexts {
  public:
    OptionTexts(CLI::App& app, std::vector<Option> options);

    /// Complete and checked. Throws UsageError that names the option with its dashes.
    Settings settings() const;

  private:
    std::vector<Option> options_;
    std::deque<std::string> texts_;  // by option; where CLI11 writes
};

/// "--light-paths"
std::string optionName(const std::string& name);

/// A record's values that are not the defaults.
template <class Record>
Settings changedValues(const OptionTable<Record>& table, const Record& record) {
    Settings changed;
    for (const auto& row : table.rows()) {
        const std::string value = row.get(record);
        if (value != row.option.standard) changed[row.option.name] = value;
    }
    return changed;
}
/// Settings as a shell takes them: " --light-paths 1000", or nothing.
std::string optionArguments(const Settings& settings);

/// The same for a table: its record, read.
template <class Record>
class TableOptions {
  public:
    TableOptions(CLI::App& app, OptionTable<Record> table)
        : table_(std::move(table)), texts_(app, table_.options()) {}
    /// Throws UsageError.
    Record read() const { return table_.read(texts_.settings()); }

  private:
    OptionTable<Record> table_;
    OptionTexts texts_;
};

}  // namespace lacuna
