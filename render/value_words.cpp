#include "render/value_words.h"

#include "libcore/bidir/sampler.h"
#include "libcore/methods/registry.h"
#include "libcore/tool/effects.h"
#include "render/choose/choice.h"

namespace lacuna {
namespace {

/// Appends `key=`, or `key=value` for each value if the values are listed.
void append(std::vector<std::string>& words, const Option& option) {
    const bool onOff = option.kind == Option::Kind::Switch;
    std::vector<std::string> values = option.choices;
    if (onOff) values = {"on", "off"};
    if (values.empty()) values = {""};
    for (const std::string& value : values) words.push_back(option.name + "=" + value);
}

}  // namespace

ValueWords renderWords() {
    ValueWords words;
    std::vector<std::string>& names = words.byOption["--method"];
    names = {kAuto};
    for (const MethodRow& row : methods()) {
        names.push_back(row.name);
        std::vector<std::string>& settings = words.byMethod[row.name];
        for (const Option& option : row.options) append(settings, option);
    }
    words.byOption["--help-method"] = names;
    for (const Sampling sampling : {Sampling::Sobol, Sampling::Independent}) {
        words.byOption["--sampler"].push_back(nameOf(sampling));
    }
    for (const LampUnits units : {LampUnits::Radiometric, LampUnits::Photometric}) {
        words.byOption["--units"].push_back(nameOf(units));
    }
    // The first method has all techniques, so that its effects are all effects.
    for (const Effect& e : effectsOf({}, 0.0, &methods().front())) {
        for (const char* state : {"=on", "=off"}) {
            words.byOption["--effect"].push_back(e.name + state);
        }
    }
    words.byOption["--until"] = {"mape=", "relmse=", "rmse="};
    return words;
}

}  // namespace lacuna
