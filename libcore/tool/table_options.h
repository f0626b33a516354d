// Command-line options made from a table of options (options.h): `light_paths` becomes
// --light-paths.
#pragma once

#include <deque>
#include <string>
#include <vector>

#include "libcore/base/options.h"

namespace CLI {
class App;
}

namespace lacuna {

/// The texts that a command line gives for options. The constructor declares the options. The
/// object must exist while `app` parses.
class OptionTexts {
  public:
    OptionTexts(CLI::App& app, std::vector<Option> options);

    /// The values of all options, checked. Throws UsageError, which names the option with its
    /// dashes.
    Settings settings() const;

  private:
    std::vector<Option> options_;
    std::deque<std::string> texts_;  // by option; CLI11 writes to them
};

/// "--light-paths"
std::string optionName(const std::string& name);

/// A record's values that differ from the defaults.
template <class Record>
Settings changedValues(const OptionTable<Record>& table, const Record& record) {
    Settings changed;
    for (const auto& binding : table.bindings()) {
        const std::string value = binding.get(record);
        if (value != binding.option.standard) changed[binding.option.name] = value;
    }
    return changed;
}
/// Settings as text for a shell: " --light-paths 1000", or nothing.
std::string optionArguments(const Settings& settings);

/// OptionTexts for a table; read() returns its record.
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
