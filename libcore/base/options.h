// Each option is defined in one place: a record's field with its name, range, unit and help.
// Command lines, study files, help texts, headers of pictures and the keys of caches all read the
// same table. Code reads typed fields, never names.
// (theory.md, "Picks")
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "libcore/base/number_text.h"

namespace lacuna {

/// A setting that users can change: its name, help, range and default.
struct Option {
    enum class Kind : std::uint8_t { Integer, Real, Switch, Choice, Text };

    std::string name = {};  ///< lower case; words joined by _, groups by a point
    Kind kind = Kind::Text;
    std::string help = {};
    double low = 0.0, high = 0.0;           ///< of numbers, inclusive
    std::string unit = {};                  ///< of numbers: what they count or measure; may be
                                            ///< empty
    std::vector<std::string> choices = {};  ///< of a Choice
    std::string standard = {};              ///< the default, as a user would give it
    std::string standardText = {};          ///< what help shows instead of `standard`, unless empty

    /// "an integer from 1 to 100", "one of ris plain"
    std::string range() const;
    /// Unit and help: "light subpaths in the pool, M"
    std::string meaning() const { return unit.empty() ? help : unit + " " + help; }
    /// The default as help shows it.
    const std::string& shownDefault() const {
        return standardText.empty() ? standard : standardText;
    }
    /// The value in its shortest form. Throws UsageError "`title`: expected .., found ..".
    std::string checked(std::string_view value, const std::string& title) const;
};

/// Values by option name, complete and checked.
using Settings = std::map<std::string, std::string>;

/// The defaults, overridden by "name=value" texts, of which later ones win. `owner` ("method
/// risbpt") is what the options belong to, and `title` ("--set ") stands before names in messages.
/// Throws UsageError naming the option, its range and what was found.
Settings resolveOptions(std::span<const Option> options, std::span<const std::string> assignments,
                        const std::string& owner, const std::string& title);

/// Options bound to the fields of a Record. The fields' initial values are the defaults. A field is
/// a pointer to member, or a function that returns a record's field by reference.
template <class Record>
class OptionTable {
  public:
    explicit OptionTable(Record defaults = {}) : defaults_(std::move(defaults)) {}

    template <class Field>
    OptionTable& integer(std::string name, Field field, double low, double high, std::string unit,
                         std::string help) {
        return number(Option::Kind::Integer, std::move(name), field, low, high, std::move(unit),
                      std::move(help));
    }
    template <class Field>
    OptionTable& real(std::string name, Field field, double low, double high, std::string unit,
                      std::string help) {
        return number(Option::Kind::Real, std::move(name), field, low, high, std::move(unit),
                      std::move(help));
    }
    template <class Field>
    OptionTable& onOff(std::string name, Field field, std::string help) {
        return add(
            {std::move(name), Option::Kind::Switch, std::move(help)},
            [field](Record& r, const std::string& text) { std::invoke(field, r) = text == "on"; },
            [field](const Record& r) { return text(bool(std::invoke(field, r))); });
    }
    /// `names`: the names of the field's values.
    template <class Value, class Field>
    OptionTable& choice(std::string name, Field field,
                        std::vector<std::pair<std::string, Value>> names, std::string help) {
        Option option{std::move(name), Option::Kind::Choice, std::move(help)};
        for (const auto& n : names) option.choices.push_back(n.first);
        return add(
            std::move(option),
            [field, names](Record& r, const std::string& text) {
                for (const auto& [key, value] : names) {
                    if (key == text) std::invoke(field, r) = value;
                }
            },
            [field, names](const Record& r) {
                for (const auto& [key, value] : names) {
                    if (value == std::invoke(field, r)) return key;
                }
                return std::string{};
            });
    }
    template <class Field>
    OptionTable& text(std::string name, Field field, std::string help) {
        return add(
            {std::move(name), Option::Kind::Text, std::move(help)},
            [field](Record& r, const std::string& value) { std::invoke(field, r) = value; },
            [field](const Record& r) { return std::string(std::invoke(field, r)); });
    }
    /// Sets what help shows for the default of the option that was added last.
    OptionTable& standardText(std::string text) {
        bindings_.back().option.standardText = std::move(text);
        return *this;
    }
    /// Adds the options of a record within the record, with `prefix` before their names.
    template <class Field, class Inner>
    OptionTable& include(const std::string& prefix, Field field, const OptionTable<Inner>& inner) {
        for (const auto& binding : inner.bindings()) {
            Option option = binding.option;
            option.name = prefix + option.name;
            add(
                std::move(option),
                [field, set = binding.set](Record& r, const std::string& value) {
                    set(std::invoke(field, r), value);
                },
                [field, get = binding.get](const Record& r) { return get(std::invoke(field, r)); });
        }
        return *this;
    }

    std::vector<Option> options() const {
        std::vector<Option> all;
        for (const Binding& b : bindings_) all.push_back(b.option);
        return all;
    }
    /// The record that complete settings describe. The settings may hold options of other tables
    /// too. `prefix` stands before the names of this table's options in the settings.
    Record read(const Settings& settings, const std::string& prefix = {}) const {
        Record record = defaults_;
        for (const Binding& b : bindings_) b.set(record, settings.at(prefix + b.option.name));
        return record;
    }
    /// Names and values of a record.
    std::vector<std::pair<std::string, std::string>> values(const Record& record) const {
        std::vector<std::pair<std::string, std::string>> all;
        for (const Binding& b : bindings_) all.emplace_back(b.option.name, b.get(record));
        return all;
    }

    /// An option and the field that holds its value.
    struct Binding {
        Option option;
        std::function<void(Record&, const std::string&)> set;  ///< takes a checked value
        std::function<std::string(const Record&)> get;
    };
    const std::vector<Binding>& bindings() const { return bindings_; }

  private:
    static std::string text(bool on) { return on ? "on" : "off"; }

    template <class Field>
    OptionTable& number(Option::Kind kind, std::string name, Field field, double low, double high,
                        std::string unit, std::string help) {
        Option option{std::move(name), kind, std::move(help)};
        option.low = low;
        option.high = high;
        option.unit = std::move(unit);
        return add(
            std::move(option),
            [field](Record& r, const std::string& value) {
                auto& to = std::invoke(field, r);
                to = static_cast<std::remove_reference_t<decltype(to)>>(parseNumber(value).value());
            },
            [field](const Record& r) {
                return numberText(static_cast<double>(std::invoke(field, r)));
            });
    }
    OptionTable& add(Option option, std::function<void(Record&, const std::string&)> set,
                     std::function<std::string(const Record&)> get) {
        option.standard = get(defaults_);
        bindings_.push_back({std::move(option), std::move(set), std::move(get)});
        return *this;
    }

    Record defaults_;
    std::vector<Binding> bindings_;
};

/// The record of a method without options.
struct NoOptions {};

}  // namespace lacuna
