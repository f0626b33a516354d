#include "render/study/run_directory.h"

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "libcore/base/error.h"
#include "libcore/tool/interrupt.h"
#include "render/study/child.h"

namespace lacuna {
namespace {

namespace fs = std::filesystem;

std::string lastLine(const std::string& path) {
    std::ifstream in(path);
    std::string last;
    for (std::string line; std::getline(in, line);) {
        if (!line.empty()) last = line;
    }
    return last;
}

}  // namespace

bool RunDirectory::complete() const {
    if (!fs::exists(json()) || !fs::exists(curve()) || !fs::exists(image())) return false;
    try {
        return report().at("stopped") != "interrupt";
    } catch (const nlohmann::json::exception&) {
        return false;
    }
}

nlohmann::json RunDirectory::report() const {
    std::ifstream in(json());
    return nlohmann::json::parse(in);
}

void RunDirectory::render(const std::string& renderer, const std::string& scene,
                          const std::vector<std::string>& arguments,
                          const std::atomic<bool>& cancel) const {
    std::error_code error;
    fs::remove(json(), error);  // the run is incomplete until it exists again
    fs::create_directories(path_, error);
    if (error) {
        throw RunError(path_ + ": expected to make this folder, found " + error.message());
    }
    std::vector<std::string> all{renderer, scene,  "-o",      image(),        "--log",     curve(),
                                 "--json", json(), "--quiet", "--checkpoint", checkpoint()};
    all.insert(all.end(), arguments.begin(), arguments.end());
    const int exitCode = runChild(all, log(), cancel);
    fs::remove_all(cache(), error);
    if (cancel) {
        fs::remove(json(), error);
        throw InterruptedError(
            "interrupted: what was finished is kept; the same command goes on from there");
    }
    if (exitCode != 0) {
        throw Error(exitCode < 4 ? exitCode : 1, path_ + ": lacuna-render failed with " +
                                                     std::to_string(exitCode) + ": " +
                                                     lastLine(log()));
    }
    fs::remove(checkpoint(), error);
}

}  // namespace lacuna
