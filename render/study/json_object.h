// Reads JSON objects in which every key must be known: a misspelt key is an error and not a
// default.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <set>
#include <string>
#include <vector>

namespace lacuna {

/// Parses a file. Throws InputError, also for a duplicate key.
nlohmann::json readJsonFile(const std::string& path);

/// One object of the file. Every key that is read counts as known; `finish` refuses all others.
/// Every member throws InputError: `place: KEY: what was expected, what was found`.
class JsonObject {
  public:
    /// `place` begins messages: "door.json: scenes[0]". Both must outlive the reader.
    JsonObject(const nlohmann::json& value, std::string place);

    bool has(const std::string& key);
    std::string text(const std::string& key);
    std::int64_t integer(const std::string& key, std::int64_t low, std::int64_t high);
    /// Positive numbers, in any order.
    std::vector<double> positives(const std::string& key);
    std::vector<std::string> texts(const std::string& key);
    /// The value of `key`, which must exist.
    const nlohmann::json& value(const std::string& key);
    /// The object under `key`; empty if there is none.
    JsonObject object(const std::string& key);
    /// The objects of the array under `key`, at least one.
    std::vector<JsonObject> objects(const std::string& key);
    /// All members; all keys count as known from now on.
    const nlohmann::json& members();
    void finish() const;

    [[noreturn]] void fail(const std::string& key, const std::string& expected) const;
    const std::string& place() const { return place_; }

  private:
    const nlohmann::json* value_;
    std::string place_;
    std::set<std::string> known_;
};

}  // namespace lacuna
