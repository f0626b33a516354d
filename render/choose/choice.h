// The choice of `--method auto`, and its representations as text.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <utility>
#include <vector>

#include "libcore/bidir/sampler.h"
#include "libcore/cache/cache_name.h"
#include "libcore/methods/registry.h"

namespace lacuna {

/// The name that stands for no row: a row is chosen for the scene.
inline constexpr const char* kAuto = "auto";

struct RowChoice {
    std::string method;                    ///< a row's name
    std::vector<std::string> assignments;  ///< "name=value", in the form of --set
    Sampling sampling = Sampling::Independent;
    std::string why;  ///< the reason, a sentence
    /// Estimated speeds of the rows that were tried, relative to bpt, setup included; by name.
    std::vector<std::pair<std::string, double>> speeds;

    /// The options that request the same choice: "--method spcbpt --prepare --set
    /// train.paths=20000".
    std::string byName() const;
    /// {"method", "parameters": {name: value}, "sampler", "why", "by_name", "speeds": {row: times bpt}}
    nlohmann::json json() const;

    /// The choice as text for other ranks.
    std::string text() const;
    static RowChoice ofText(const std::string& text);
    /// The choice of a checkpoint's render: its inputs name the row and its settings.
    static RowChoice ofInputs(const CacheStamp& inputs);
};

}  // namespace lacuna
