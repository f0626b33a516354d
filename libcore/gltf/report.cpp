#include "libcore/gltf/report.h"

#include <algorithm>

#include "libcore/base/error.h"

namespace lacuna::gltf {

void refuse(const std::string& file, const std::string& place, const std::string& expected,
            const std::string& found, const std::string& todo) {
    constexpr std::size_t kLongest = 600;
    const std::string at = place.empty() ? "" : place + ": ";
    const std::string line = at + "expected " + expected + ", found " + found + "; " + todo;
    throw InputError(printable(file, kLongest) + ": " + printable(line, kLongest));
}

void Warnings::add(const std::string& kind, std::size_t count, const std::string& where) {
    if (count == 0) return;
    const auto known = std::find_if(entries_.begin(), entries_.end(),
                                    [&](const Entry& entry) { return entry.kind == kind; });
    if (known != entries_.end()) {
        known->count += count;
    } else {
        entries_.push_back({kind, count, printable(where)});
    }
}

std::vector<std::string> Warnings::lines() const {
    std::vector<std::string> result;
    for (const Entry& entry : entries_) {
        std::string line = entry.kind;
        if (entry.count > 1) {
            line += " (" + std::to_string(entry.count) + " times";
            line += entry.where.empty() ? ")" : ", first " + entry.where + ")";
        } else if (!entry.where.empty()) {
            line += " (" + entry.where + ")";
        }
        result.push_back(std::move(line));
    }
    return result;
}

}  // namespace lacuna::gltf
