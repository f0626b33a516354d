// The reader's messages to the user: errors and warnings.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "libcore/base/printable.h"

namespace lacuna::gltf {

/// Throws InputError `file: expected E, found F; todo`. `place` (may be empty) is a JSON path such
/// as `accessors[3].count`.
[[noreturn]] void refuse(const std::string& file, const std::string& place,
                         const std::string& expected, const std::string& found,
                         const std::string& todo = "export the scene again");

/// Warnings, one per kind however often it occurs, in order of first occurrence. Their advice names
/// options (--env, --units) as command lines spell them: every tool that loads a scene has these options,
/// and the user would have to look for them otherwise.
class Warnings {
  public:
    /// Notes `count` occurrences of `kind` (nothing if 0); `where` is remembered for the first.
    void add(const std::string& kind, std::size_t count, const std::string& where = "");
    /// `KIND (3 times, first WHERE)`.
    std::vector<std::string> lines() const;

  private:
    struct Entry {
        std::string kind;
        std::size_t count;
        std::string where;
    };
    std::vector<Entry> entries_;
};

}  // namespace lacuna::gltf
