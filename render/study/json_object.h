// Reading a JSON object of which every key has to be known: a misspelt key is an error, not a
// default.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <set>
#include <string>
#include <vector>

namespace lacuna {

/// Parses a file; a key that is there twice is an error too. Throws InputError.
nlohmann::json readJsonFile(const std::string& path);

/// One object of the file. Every key that is asked for counts as known; `finish` refuses the rest.
/// Every member throws InputError: `place: KEY: what was expected, what was found`.
class JsonObject {
  public:
    /// `place` begins messages: "door.json: scenes[0]". Both must outlive the reader.
    JsonObject(const nlohmann::json& value, std::string place);

    bool has(const std::string& key);
    std::string text(const std::string& key);
    std::int64_t integer(const std::string& key, std::int64_t low, std::int64_t high);
    /// Above zero, rising or falling as they come.
    std::vector<double> positives(const std::string& key);
    std::vector<std::string> texts(const std::string& key);
    /// The value itself; it has to be there.
    const nlohmann::json& value(const std::string& key);
    /// The object under `key`, empty where there is none.
    JsonObject object(const std::string& key);
    /// The objects of the array under `key`, at least one.
    std::vector<JsonObject> objects(const std::string& key);
    /// All members, each known from now on.
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
