#include "render/study/json_object.h"

#include <cmath>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "libcore/base/error.h"
#include "libcore/base/text_list.h"

namespace lacuna {

using nlohmann::json;

json readJsonFile(const std::string& path) {
    std::ifstream in(path, std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
    if (!in || text.empty()) {
        throw InputError(path + ": expected a study in JSON, found " +
                         (in ? "an empty file" : "no file that can be read"));
    }
    std::vector<std::set<std::string>> keys;
    const auto watch = [&](int, json::parse_event_t event, json& parsed) {
        if (event == json::parse_event_t::object_start) keys.emplace_back();
        if (event == json::parse_event_t::object_end) keys.pop_back();
        if (event == json::parse_event_t::key && !keys.back().insert(parsed).second) {
            throw InputError(path + ": expected every key once, found " + parsed.dump() +
                             " twice in one object");
        }
        return true;
    };
    try {
        return json::parse(text, watch, true, true);  // allows comments
    } catch (const json::parse_error& e) {
        throw InputError(path + ": expected JSON, found an error at byte " +
                         std::to_string(e.byte) + ": " + e.what());
    } catch (const json::out_of_range& e) {
        throw InputError(path +
                         ": expected numbers of double precision, found others: " + e.what());
    }
}

JsonObject::JsonObject(const json& value, std::string place)
    : value_(&value), place_(std::move(place)) {
    if (!value.is_object()) {
        throw InputError(place_ + ": expected an object {...}, found " + value.dump());
    }
}

void JsonObject::fail(const std::string& key, const std::string& expected) const {
    const auto found = value_->find(key);
    throw InputError(place_ + ": " + key + ": expected " + expected + ", found " +
                     (found == value_->end() ? "none" : found->dump()));
}

bool JsonObject::has(const std::string& key) {
    known_.insert(key);
    return value_->contains(key);
}

const json& JsonObject::value(const std::string& key) {
    if (!has(key)) fail(key, "a value");
    return (*value_)[key];
}

std::string JsonObject::text(const std::string& key) {
    if (!has(key) || !value(key).is_string() || value(key).get<std::string>().empty()) {
        fail(key, "a text");
    }
    return value(key);
}

std::int64_t JsonObject::integer(const std::string& key, std::int64_t low, std::int64_t high) {
    if (!has(key) || !value(key).is_number_integer() || value(key) < low || value(key) > high) {
        fail(key, "an integer from " + std::to_string(low) + " to " + std::to_string(high));
    }
    return value(key);
}

std::vector<double> JsonObject::positives(const std::string& key) {
    const char* expected = "an array of numbers above 0";
    if (!has(key) || !value(key).is_array() || value(key).empty()) fail(key, expected);
    std::vector<double> numbers;
    for (const json& n : value(key)) {
        if (!n.is_number() || !(n.get<double>() > 0.0)) fail(key, expected);
        numbers.push_back(n);
    }
    return numbers;
}

std::vector<std::string> JsonObject::texts(const std::string& key) {
    if (!has(key) || !value(key).is_array() || value(key).empty()) fail(key, "an array of texts");
    std::vector<std::string> texts;
    for (const json& t : value(key)) {
        if (!t.is_string()) fail(key, "an array of texts");
        texts.push_back(t);
    }
    return texts;
}

JsonObject JsonObject::object(const std::string& key) {
    static const json kEmpty = json::object();
    return {has(key) ? value(key) : kEmpty, place_ + ": " + key};
}

std::vector<JsonObject> JsonObject::objects(const std::string& key) {
    if (!has(key) || !value(key).is_array() || value(key).empty()) {
        fail(key, "an array of objects, at least one");
    }
    std::vector<JsonObject> all;
    for (std::size_t i = 0; i < value(key).size(); ++i) {
        all.emplace_back(value(key)[i], place_ + ": " + key + "[" + std::to_string(i) + "]");
    }
    return all;
}

const json& JsonObject::members() {
    for (const auto& member : value_->items()) known_.insert(member.key());
    return *value_;
}

void JsonObject::finish() const {
    for (const auto& member : value_->items()) {
        if (known_.contains(member.key())) continue;
        throw InputError(place_ + ": " + member.key() + ": expected one of " +
                         joined(known_, ", ") + ", found a key that is not known");
    }
}

}  // namespace lacuna
