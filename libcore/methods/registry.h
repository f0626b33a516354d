// The table of methods. Adding one = one file in this folder, one row in registry.cpp, one
// reference.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "libcore/bidir/method.h"

namespace lacuna {

/// A `--set` parameter of a method.
struct Parameter {
    enum class Kind { Integer, Real, Switch, Choice };

    std::string name;
    Kind kind;
    double defaultValue;  ///< Switch: 0 or 1; Choice: index
    double low, high;     ///< inclusive
    std::string help;
    std::vector<std::string> choices = {};
    std::string defaultText = {};  ///< shown instead of the number, if it says more
};

/// The values of one run, complete and in range.
class Settings {
  public:
    double real(const std::string& name) const { return values_.at(name); }
    std::uint64_t integer(const std::string& name) const { return std::uint64_t(real(name)); }
    bool on(const std::string& name) const { return real(name) != 0.0; }
    const std::map<std::string, double>& values() const { return values_; }

  private:
    friend Settings resolve(const struct MethodRow&, std::span<const std::string>);
    std::map<std::string, double> values_;
};

/// What a method is, for the integrator, the command line, the documentation and the tests.
struct MethodRow {
    std::string name;
    std::string reference;  ///< key in REFERENCES.md
    std::string summary;    ///< one line
    TechniqueSet techniques;
    bool needsSkeleton = false;   ///< of the empty space (Method::useSkeleton)
    bool needsSubspaces = false;  ///< of light and eye subpaths (Method::useSubspaces)
    bool needsCaches() const { return needsSkeleton || needsSubspaces; }
    std::vector<std::string> parts = {};  ///< names of proposals' labels, for layers
    bool biased = false;  ///< an experiment of a paper: skipped by tests of unbiasedness
    std::vector<Parameter> parameters;
    /// What `preset=paper` sets, where the paper's value is not our default. A row that has any
    /// lists presetParameter().
    std::map<std::string, double> paper;
    std::function<std::unique_ptr<Method>(const Settings&)> create;
};

/// All rows, in the order of --list-methods.
std::span<const MethodRow> methods();
/// Throws UsageError that lists the names.
const MethodRow& findMethod(const std::string& name);
/// Defaults overridden by `key=value` strings, the preset's values first. Throws UsageError naming
/// the key, its range and what was found.
Settings resolve(const MethodRow& row, std::span<const std::string> assignments);

}  // namespace lacuna
