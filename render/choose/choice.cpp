#include "render/choose/choice.h"

#include <nlohmann/json.hpp>

#include "libcore/tool/tool.h"
#include "render/options.h"

namespace lacuna {

std::string RowChoice::byName() const {
    std::string text = "--method " + method;
    const MethodRow& row = findMethod(method);
    if (!needsOf(row, resolve(row, assignments)).empty()) text += " --prepare";
    for (const std::string& a : assignments) text += " --set " + shellQuoted(a);
    return text + " --sampler " + nameOf(sampling);
}

nlohmann::json RowChoice::json() const {
    nlohmann::json parameters = nlohmann::json::object();
    for (const std::string& a : assignments) {
        const std::size_t equals = a.find('=');
        parameters[a.substr(0, equals)] = a.substr(equals + 1);
    }
    nlohmann::json j{
        {"method", method}, {"parameters", parameters}, {"why", why}, {"by_name", byName()}};
    for (const auto& [name, speed] : speeds) j["speeds"][name] = speed;
    return j;
}

std::string RowChoice::text() const {
    return nlohmann::json{{"method", method},
                          {"set", assignments},
                          {"sampler", nameOf(sampling)},
                          {"why", why},
                          {"speeds", speeds}}
        .dump();
}

RowChoice RowChoice::ofText(const std::string& text) {
    const nlohmann::json j = nlohmann::json::parse(text);
    return {j.at("method"), j.at("set"), parseSampler(j.at("sampler")), j.at("why"),
            j.at("speeds")};
}

RowChoice RowChoice::ofInputs(const CacheStamp& inputs) {
    const auto value = [&](const std::string& name) {
        const auto found = inputs.inputs.find(name);
        return found == inputs.inputs.end() ? std::string{} : found->second;
    };
    RowChoice choice{
        value("method"), {}, parseSampler(value("sampler")), "as the checkpoint has it", {}};
    const MethodRow& row = findMethod(choice.method, "the checkpoint's method");
    for (const Option& option : row.options) {
        const std::string text = value(option.name);
        if (!text.empty() && text != option.standard) {
            choice.assignments.push_back(option.name + "=" + text);
        }
    }
    return choice;
}

}  // namespace lacuna
