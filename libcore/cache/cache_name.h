// Where a scene's caches lie, and what they belong to: NAME.cache/KEY.KIND beside the scene, or in
// another directory (files.md, "Names and keys").
#pragma once

#include <string>
#include <vector>

#include "libcore/base/options.h"

namespace lacuna {

/// Everything that a cache's content depends on: each input by name, with its value in words or the
/// hash of its content. One of them is "scene", the content hash of the scene's files.
struct CacheStamp {
    Settings inputs;

    /// A line "name=value" for each, in the order of names: what files hold and what is hashed.
    std::string text() const;
    /// Of such a text. Lines without = are left out.
    static CacheStamp parse(const std::string& text);

    friend bool operator==(const CacheStamp&, const CacheStamp&) = default;
};

/// The inputs of `expected` that `found` has another value of, or none, in words for a message:
/// "camera (there 'Cam', here 'Hall')". Empty where all agree.
std::vector<std::string> differences(const CacheStamp& expected, const CacheStamp& found);
/// The same as one text.
std::string differencesText(const CacheStamp& expected, const CacheStamp& found);

/// `directory`, or NAME.cache beside the scene where that is empty.
std::string cacheDirectory(const std::string& scene, const std::string& directory);

/// DIRECTORY/KEY.kind, KEY = 16 hex digits of the stamp's hash: caches of different settings lie
/// side by side.
std::string cacheFile(const std::string& directory, const CacheStamp& stamp,
                      const std::string& kind);

/// All files DIRECTORY/*.kind, by name; none where there is no such directory.
std::vector<std::string> cachesIn(const std::string& directory, const std::string& kind);

/// Makes the directory that `file` is to lie in. Throws RunError that asks for another one.
void makeCacheDirectory(const std::string& file);

}  // namespace lacuna
