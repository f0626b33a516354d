#include "render/curve_log.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <numeric>
#include <vector>

#include "libcore/base/atomic_file.h"
#include "libcore/base/error.h"
#include "libcore/base/text_list.h"

namespace lacuna {
namespace {

/// The shortest text that reads back as the same double; "inf" as CSV readers know it.
std::string number(double value) {
    char text[40];
    for (int digits = 6; digits <= 17; ++digits) {
        std::snprintf(text, sizeof text, "%.*g", digits, value);
        if (std::strtod(text, nullptr) == value) break;
    }
    return text;
}

}  // namespace

CurveLog::CurveLog(const std::string& path, std::uint64_t iteration) : path_(path) {
    std::string header = "iteration,seconds,setup_seconds,rays,mae,rmse,mape,relmse";
    for (std::size_t i = 0; i < kRayKinds; ++i) header += std::string(",rays_") + name(RayKind(i));
    header += ",phases";
    std::error_code ignored;
    isFile_ =
        std::filesystem::is_regular_file(path, ignored) || !std::filesystem::exists(path, ignored);
    std::vector<std::string> rows;
    std::ifstream before;
    if (isFile_ && iteration > 0) before.open(path);
    for (std::string line; before && std::getline(before, line);) {
        unsigned long long number = 0;
        double seconds = 0.0;
        if (std::sscanf(line.c_str(), "%llu,%lf,", &number, &seconds) != 2) continue;
        if (number == 0 || number > iteration) break;
        rows.push_back(line);
        lastIteration_ = number;
        wants(seconds);
    }
    if (!isFile_) device_.open(path);
    append(header);
    for (const std::string& row : rows) append(row);
    writeAll();
}

/// Appends a line: a device gets it at once, a file with all others by writeAll().
void CurveLog::append(const std::string& line) {
    if (isFile_) {
        text_ += line + '\n';
        return;
    }
    device_ << line << std::endl;
    if (!device_) {
        throw RunError(path_ +
                       ": expected to write the curve, found it not writable or full; choose "
                       "another --log");
    }
}

/// Writes the whole file each time; there are at most ten rows per decade of seconds.
void CurveLog::writeAll() {
    if (isFile_) writeFileAtomically(path_, text_);
}

bool CurveLog::wants(double seconds) {
    const int tenth = int(std::floor(10.0 * std::log10(std::max(seconds, 1e-9))));
    if (lastTenth_ && tenth <= *lastTenth_) return false;
    lastTenth_ = tenth;
    return true;
}

void CurveLog::write(const CurveRow& row) {
    std::string text = std::to_string(row.iteration);
    const auto add = [&](const std::string& column) {
        text += ',';
        text += column;
    };
    add(number(row.seconds));
    add(number(row.setupSeconds));
    add(std::to_string(std::accumulate(row.rays.begin(), row.rays.end(), std::uint64_t(0))));
    const ErrorMeasures e = row.error.value_or(ErrorMeasures{});
    for (const double measure : {e.mae, e.rmse, e.mape, e.relmse}) {
        add(row.error ? number(measure) : "");
    }
    for (const std::uint64_t rays : row.rays) add(std::to_string(rays));
    add(joined(row.phaseSeconds, ";",
               [](const auto& phase) { return phase.first + "=" + number(phase.second); }));
    lastIteration_ = row.iteration;
    append(text);
    writeAll();
}

}  // namespace lacuna
