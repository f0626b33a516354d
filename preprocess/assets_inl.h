// Included by assets.h.
#pragma once

#include <filesystem>
#include <optional>

#include "libcore/base/error.h"

namespace lacuna {

/// Text for a message about the file of another stamp that differs in the fewest inputs; empty if
/// there is none.
template <class ReadFile>
std::string mostSimilarCache(const std::string& directory, const CacheStamp& stamp,
                             const std::string& kind, const ReadFile& readFile) {
    std::string text;
    std::size_t fewest = stamp.inputs.size();
    for (const std::string& path : cachesIn(directory, kind)) {
        try {
            const CacheStamp found = readFile(path, CacheStamp{}, "").stamp;
            const std::size_t count = differences(stamp, found).size();
            if (count == 0 || count >= fewest) continue;
            fewest = count;
            text = path + " was made of another " + differencesText(stamp, found);
        } catch (const InputError&) {
            // Damaged or of another version: not comparable.
        }
    }
    return text;
}

template <class File, class ReadFile>
std::optional<File> readCache(const AssetRequest& request, const CacheStamp& stamp,
                              const std::string& kind, const std::string& remedy,
                              const ReadFile& readFile) {
    const std::string path = request.file(stamp, kind);
    std::optional<File> file;
    try {
        request.pool.run([&] {
            const bool missing = !std::filesystem::exists(path);
            const std::string similar =
                missing && !request.build
                    ? mostSimilarCache(request.directory(), stamp, kind, readFile)
                    : "";
            file = readFile(path, stamp, similar.empty() ? remedy : similar + "; " + remedy);
        });
    } catch (const InputError&) {
        if (!request.build) throw;
    }
    return file;
}

template <class File, class ReadFile, class WriteFile, class Make>
File readOrMake(const AssetRequest& request, const CacheStamp& stamp, const std::string& kind,
                const std::string& remedy, const ReadFile& readFile, const WriteFile& write,
                const Make& make) {
    std::optional<File> file;
    request.phases.run("read " + kind,
                       [&] { file = readCache<File>(request, stamp, kind, remedy, readFile); });
    if (file) return std::move(*file);
    const std::string path = request.file(stamp, kind);
    makeCacheDirectory(path);
    file = make();
    write(path, *file);
    request.built(path);
    return std::move(*file);
}

}  // namespace lacuna
