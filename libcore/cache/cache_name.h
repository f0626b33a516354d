// Names and keys of a scene's caches: NAME.cache/KEY.KIND beside the scene, or in another directory
// (files.md, "Names and keys").
#pragma once

#include <string>
#include <vector>

#include "libcore/base/options.h"

namespace lacuna {

/// Everything that a cache's content depends on: each input's name, with its value as text or the
/// hash of its content. One input is "scene", the content hash of the scene's files.
struct CacheStamp {
    Settings inputs;

    /// One line "name=value" for each input, sorted by name. Files hold this text, and the key is
    /// its hash.
    std::string text() const;
    /// Parses such a text. Lines without = are ignored.
    static CacheStamp parse(const std::string& text);

    friend bool operator==(const CacheStamp&, const CacheStamp&) = default;
};

/// The inputs of `expected` for which `found` has another value or none, as texts for a message:
/// "camera (there 'Cam', here 'Hall')". Empty where all agree.
std::vector<std::string> differences(const CacheStamp& expected, const CacheStamp& found);
/// The same as one text.
std::string differencesText(const CacheStamp& expected, const CacheStamp& found);

/// `directory`, or NAME.cache beside the scene if `directory` is empty.
std::string cacheDirectory(const std::string& scene, const std::string& directory);

/// DIRECTORY/KEY.kind, where KEY is the stamp's hash in 16 hex digits. Caches of different settings
/// lie side by side.
std::string cacheFile(const std::string& directory, const CacheStamp& stamp,
                      const std::string& kind);

/// All files DIRECTORY/*.kind, sorted by name; none where there is no such directory.
std::vector<std::string> cachesIn(const std::string& directory, const std::string& kind);

}  // namespace lacuna
