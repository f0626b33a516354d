// What `--method auto` settles on, and how it is said.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <utility>
#include <vector>

#include "libcore/bidir/sampler.h"
#include "libcore/cache/cache_name.h"
#include "libcore/methods/registry.h"

namespace lacuna {

/// The name that is no row's: a row is chosen for the scene.
inline constexpr const char* kAuto = "auto";

struct RowChoice {
    std::string method;                    ///< a row's name
    std::vector<std::string> assignments;  ///< "name=value", as --set takes them
    Sampling sampling = Sampling::Independent;
    std::string why;  ///< a sentence
    /// How many times as fast as bpt the rows that were tried seem to be, setup counted; by name.
    std::vector<std::pair<std::string, double>> speeds;

    /// How to ask for the same by name: "--method spcbpt --prepare --set train.paths=20000".
    std::string byName() const;
    /// {"method", "parameters": {name: value}, "sampler", "why", "by_name", "speeds": {row: times bpt}}
    nlohmann::json json() const;

    /// As other ranks are told.
    std::string text() const;
    static RowChoice ofText(const std::string& text);
    /// What a checkpoint is of: its inputs name the row and its settings.
    static RowChoice ofInputs(const CacheStamp& inputs);
};

}  // namespace lacuna
