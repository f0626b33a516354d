#include "libcore/cache/cache_name.h"

#include <xxhash.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <sstream>

#include "libcore/base/text_list.h"

namespace lacuna {
namespace {

/// Whether the value is a hash, which messages do not show.
bool isHash(const std::string& value) {
    constexpr std::size_t kDigits = 32;
    return value.size() >= kDigits && value.find_first_not_of("0123456789abcdef") >= kDigits;
}

}  // namespace

std::string CacheStamp::text() const {
    std::string text;
    for (const auto& [name, value] : inputs) {
        std::string line = value;
        std::replace(line.begin(), line.end(), '\n', ' ');  // a camera's name may contain a newline
        text += name + "=" + line + "\n";
    }
    return text;
}

CacheStamp CacheStamp::parse(const std::string& text) {
    CacheStamp stamp;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
        const std::size_t equals = line.find('=');
        if (equals != std::string::npos) {
            stamp.inputs[line.substr(0, equals)] = line.substr(equals + 1);
        }
    }
    return stamp;
}

std::vector<std::string> differences(const CacheStamp& expected, const CacheStamp& found) {
    std::vector<std::string> result;
    for (const auto& [name, value] : expected.inputs) {
        const auto there = found.inputs.find(name);
        if (there == found.inputs.end()) {
            result.push_back(name + " (not said there)");
        } else if (there->second == value) {
            continue;
        } else if (isHash(value) && isHash(there->second)) {
            result.push_back(name + " (of another content)");
        } else {
            const auto shown = [](const std::string& v) {
                return isHash(v) ? std::string("one") : "'" + v + "'";
            };
            result.push_back(name + " (there " + shown(there->second) + ", here " + shown(value) +
                             ")");
        }
    }
    return result;
}

std::string differencesText(const CacheStamp& expected, const CacheStamp& found) {
    return joined(differences(expected, found), ", ");
}

std::string cacheDirectory(const std::string& scene, const std::string& directory) {
    if (!directory.empty()) return directory;
    std::filesystem::path path(scene);
    path.replace_extension(".cache");
    return path.string();
}

std::string cacheFile(const std::string& directory, const CacheStamp& stamp,
                      const std::string& kind) {
    const std::string text = stamp.text();
    char key[17];
    std::snprintf(key, sizeof(key), "%016llx",
                  (unsigned long long)(XXH3_64bits(text.data(), text.size())));
    return (std::filesystem::path(directory) / (std::string(key) + "." + kind)).string();
}

std::vector<std::string> cachesIn(const std::string& directory, const std::string& kind) {
    std::vector<std::string> files;
    std::error_code error;
    for (std::filesystem::directory_iterator it(directory, error), end; !error && it != end;
         it.increment(error)) {
        if (it->path().string().ends_with("." + kind)) files.push_back(it->path().string());
    }
    std::sort(files.begin(), files.end());
    return files;
}

}  // namespace lacuna
