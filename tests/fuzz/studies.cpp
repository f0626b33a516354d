#include <algorithm>

#include "libcore/methods/registry.h"
#include "render/study/curve.h"
#include "render/study/study_file.h"
#include "tests/fuzz/attempt.h"

namespace lacuna::test {

bool acceptsStudy(Bytes bytes) {
    const std::string path = fileOf("study.json", bytes);
    const bool whole = attempt([&] { readStudy(path, false); });
    const bool quick = attempt([&] { readStudy(path, true); });
    return whole || quick;
}

bool acceptsCurve(Bytes bytes) {
    return attempt([&] {
        const Curve curve = readCurve(fileOf("curve.csv", bytes));
        for (const Axis axis : {Axis::Seconds, Axis::SecondsWithSetup, Axis::Iterations}) {
            timeToError(curve.points, Measure::Mape, 0.5, axis);
            errorAt(curve.points, Measure::Relmse, 2.0, axis);
        }
    });
}

bool acceptsArguments(Bytes bytes) {
    std::vector<std::string> arguments{"scene.glb", "-o", "out.exr"};
    const char* at = reinterpret_cast<const char*>(bytes.data());
    const char* end = at + bytes.size();
    while (at < end) {
        const char* newline = std::find(at, end, '\n');
        std::string argument(at, newline);
        std::erase(argument, '\0');  // no command line can hold one
        // They print and end the process.
        if (argument.starts_with("--help") || argument.starts_with("--version")) return false;
        if (argument == "-h") return false;
        arguments.push_back(std::move(argument));
        at = newline + (newline < end);
    }
    return attempt([&] {
        const RenderOptions options = parseRenderArguments(arguments);
        if (options.method.empty() || options.method == "auto") return;
        resolve(namedRow(options), options.assignments, "--set ");
    });
}

}  // namespace lacuna::test
