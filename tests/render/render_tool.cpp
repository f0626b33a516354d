#include "tests/render/render_tool.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "libcore/image/exr.h"
#include "libcore/methods/registry.h"

namespace lacuna::test {

void RenderTool::SetUp() {
    std::string name = (std::filesystem::temp_directory_path() / "lacuna-render-XXXXXX").string();
    ASSERT_NE(mkdtemp(name.data()), nullptr);
    directory_ = name;
    write("room.gltf", TinyScene{}.text());
}

void RenderTool::TearDown() {
    std::error_code ignored;
    std::filesystem::remove_all(directory_, ignored);
}

std::string RenderTool::write(const std::string& name, const std::string& text) const {
    std::ofstream(path(name), std::ios::binary) << text;
    return path(name);
}

std::string RenderTool::read(const std::string& name) const {
    std::ifstream in(path(name), std::ios::binary);
    return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

std::vector<std::string> RenderTool::temporaries() const {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(directory_)) {
        if (entry.path().extension() == ".tmp") names.push_back(entry.path().string());
    }
    return names;
}

namespace {
std::string withDirectory(std::string arguments, const std::string& directory) {
    for (std::size_t at; (at = arguments.find('@')) != std::string::npos;) {
        arguments.replace(at, 1, directory);
    }
    return arguments;
}
}  // namespace

Outcome RenderTool::run(const std::string& arguments, const char* tool) const {
    return runAndSignal(arguments, {}, {}, tool);
}

pid_t RenderTool::start(const std::string& arguments, const char* tool) const {
    // The shell is replaced by the tool, so that the signals reach it.
    const std::string command =
        "exec " + (tool ? tool : ownTool()) + " " + withDirectory(arguments, path(""));
    const std::string out = path("stdout.txt"), err = path("stderr.txt");
    const pid_t child = fork();
    if (child == 0) {
        const int outFile = open(out.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0666);
        const int errFile = open(err.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0666);
        dup2(outFile, STDOUT_FILENO);
        dup2(errFile, STDERR_FILENO);
        signal(SIGHUP, SIG_DFL);  // nohup would have it ignored
        execl("/bin/sh", "sh", "-c", command.c_str(), static_cast<char*>(nullptr));
        _exit(127);
    }
    return child;
}

Outcome RenderTool::end(pid_t child) const {
    int status = 0;
    waitpid(child, &status, 0);
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read("stdout.txt"), read("stderr.txt")};
}

Outcome RenderTool::runAndSignal(const std::string& arguments, const std::vector<int>& signals,
                                 std::chrono::milliseconds delay, const char* tool) const {
    const pid_t child = start(arguments, tool);
    for (const int signal : signals) {
        std::this_thread::sleep_for(delay);
        kill(child, signal);
    }
    return end(child);
}

void RenderTool::expectFailure(const std::string& arguments, int exitCode, const std::string& part,
                               const char* tool) const {
    const Outcome o = run(arguments, tool);
    EXPECT_EQ(o.exitCode, exitCode) << arguments << "\n" << o.err;
    EXPECT_EQ(std::count(o.err.begin(), o.err.end(), '\n'), 1) << arguments << "\n" << o.err;
    EXPECT_NE(o.err.find(part), std::string::npos) << arguments << "\n" << o.err;
    EXPECT_EQ(o.out, "") << arguments;
    EXPECT_TRUE(temporaries().empty()) << arguments;
}

nlohmann::json RenderTool::json(const std::string& name) const {
    return nlohmann::json::parse(read(name));
}

void RenderTool::expectSamePicture(const std::string& a, const std::string& b) const {
    LayeredImage one = readExrLayers(path(a)), other = readExrLayers(path(b));
    for (LayeredImage* image : {&one, &other}) {
        for (const char* name : {"commandLine", "renderTimeSeconds", "setupTimeSeconds"}) {
            EXPECT_EQ(image->attributes.erase(name), 1u) << name;
        }
    }
    EXPECT_EQ(one.attributes, other.attributes);
    EXPECT_TRUE(one.channels() == other.channels()) << a << " and " << b;
}

std::string RenderTool::quick(const std::string& method, const std::string& more) const {
    std::string text = "@room.gltf -o @out.exr --method " + method + cheap(method) + " " + more;
    const std::pair<const char*, const char*> defaults[] = {
        {" --width", " 24"}, {" --height", " 16"}, {" --iterations", " 2"}, {" --max-depth", " 6"}};
    for (const auto& [option, value] : defaults) {
        if (text.find(option) == std::string::npos) text += std::string(option) + value;
    }
    return text;
}

std::string cheap(const std::string& method) {
    std::string text;
    const MethodRow& row = findMethod(method);
    for (const Option& p : row.options) {
        if (p.name == "candidates") text += " --set candidates=100";
    }
    const std::vector<AssetNeed> needs = needsOf(row, resolve(row, {}));
    if (!needs.empty()) text += " --prepare --cache @cache";
    for (const AssetNeed& need : needs) {
        if (need.name == "skeleton") text += " --set voxels.resolution=32";
        if (need.name == "subspaces") {
            text += " --set train.paths=2000 --set train.subspaces=20 --set train.light_paths=2000";
        }
    }
    return text;
}

}  // namespace lacuna::test
