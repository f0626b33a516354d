// lacuna-study from its file to its tables: which runs are rendered again, and which files are
// refused.
#include <signal.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>

#include "libcore/image/exr.h"
#include "tests/study/study_tool.h"

namespace lacuna::test {
namespace {

class StudyRun : public StudyTool {};

std::size_t lines(const std::string& text) {
    return std::size_t(std::count(text.begin(), text.end(), '\n'));
}

TEST_F(StudyRun, WritesTablesAndGoesOnWhereItStopped) {
    writeStudy();
    const Outcome first = study("--json @page.json");
    ASSERT_EQ(first.exitCode, 0) << first.err;
    EXPECT_NE(first.out.find("6 runs, 6 of them rendered now"), std::string::npos) << first.out;
    for (const char* name : {"raw.csv", "runs.csv", "tables.md", "index.html", "time-to-error.csv",
                             "error-at-iterations.csv", "references.csv"}) {
        EXPECT_TRUE(exists(std::string("out/") + name)) << name;
    }
    EXPECT_EQ(lines(read("out/runs.csv")), 7u);
    EXPECT_EQ(read("out/raw.csv").substr(0, 40), "scene,name,method,seed,run,iteration,sec");
    EXPECT_NE(read("out/tables.md").find("not reached"), std::string::npos);
    // A reference of 64 iterations cannot judge 6 iterations of the same method.
    EXPECT_NE(read("out/tables.md").find("too noisy"), std::string::npos);
    EXPECT_EQ(json("page.json").at("runs").size(), 6u);

    const std::string before = read("out/raw.csv");
    const Outcome again = study();
    EXPECT_NE(again.out.find("6 runs, 0 of them rendered now"), std::string::npos) << again.out;
    EXPECT_EQ(read("out/raw.csv"), before);

    // One method changes: only it is rendered again.
    writeStudy(R"({"methods": [{"method": "pt"},
                                {"method": "lvcbpt", "vary": {"candidates": [50, 100]}}]})");
    const Outcome changed = study();
    EXPECT_NE(changed.out.find("6 runs, 2 of them rendered now"), std::string::npos)
        << changed.out << changed.err;

    // A larger reference continues the existing one, and every error is measured again.
    writeStudy(R"({"seeds": [1],
        "scenes": [{"file": "room.gltf",
                    "options": {"width": 24, "height": 16, "max-depth": 5},
                    "reference": {"method": "bpt", "iterations": 32, "parts": 3}}]})");
    const Outcome grown = study();
    EXPECT_NE(grown.out.find("3 runs, 3 of them rendered now"), std::string::npos) << grown.out;
    EXPECT_NE(read("out/references.csv").find("bpt, 96 iterations"), std::string::npos);
}

TEST_F(StudyRun, SaysWhatAutoChoseAndWhatThatCost) {
    if (LACUNA_SANITIZED) GTEST_SKIP() << "a sanitizer is too slow for it";
    writeStudy(R"({"iterations": null, "time": "1s", "equal_iterations": null, "seeds": [1],
                   "measures": ["mape", "relmse"],
                   "methods": [{"method": "auto"}, {"method": "pt"}, {"method": "lvcbpt"}],
                   "baseline": "pt"})");
    const Outcome done = study();
    ASSERT_EQ(done.exitCode, 0) << done.err;
    const std::string table = read("out/choices.csv");
    EXPECT_EQ(lines(table), 1u + 2u) << table;  // mape and relmse of the one scene
    EXPECT_TRUE(std::regex_search(
        table, std::regex("\nroom,mape,auto,(pt|bpt|risbpt|\"spcbpt, [0-9]+ paths\"),[0-9.e-]+,.*"
                          " s,(pt|lvcbpt),[0-9.e-]+")))
        << table;
    EXPECT_NE(read("out/tables.md").find("medians of regret"), std::string::npos);

    writeStudy();
    ASSERT_EQ(study().exitCode, 0);
    EXPECT_EQ(read("out/tables.md").find("medians of regret"), std::string::npos);
}

TEST_F(StudyRun, SummarySaysHowItWasMade) {
    writeStudy();
    ASSERT_EQ(study("--threads 1 --summary @results.md").exitCode, 0);
    const std::string page = read("results.md");
    EXPECT_EQ(page, read("out/tables.md"));
    EXPECT_TRUE(
        page.starts_with("# A study <of> tests\n\npt is <what> lvcbpt is not.\n\nTwice.\n"));
    const auto row = [&](const std::string& name) {
        const std::size_t begin = page.find("\n| " + name + " | ") + name.size() + 6;
        return page.substr(begin, page.find(" |\n", begin) - begin);
    };
    EXPECT_TRUE(std::regex_match(row("date"), std::regex("20[0-9]{2}-[01][0-9]-[0-3][0-9]")));
    EXPECT_TRUE(std::regex_match(row("commit"), std::regex("unknown|[0-9a-f]{7,40}([+]changes)?")));
    EXPECT_NE(row("machine").find(", 1 of them used"), std::string::npos) << row("machine");
    EXPECT_NE(row("command").find("--threads 1 --summary " + path("results.md")), std::string::npos)
        << row("command");
    EXPECT_EQ(row("each run"), "`--iterations 6`");
    EXPECT_EQ(row("lvcbpt candidates=50"), "lvcbpt | `candidates=50` | ");

    // The scene's row has the sum of its runs' seconds.
    double seconds = 0.0;
    for (const auto& run : std::filesystem::directory_iterator(path("out/runs"))) {
        seconds += json("out/runs/" + run.path().filename().string() + "/run.json")
                       .at("seconds")
                       .get<double>();
    }
    const std::string scene = row("room");
    EXPECT_EQ(scene.substr(0, 14), "24 x 16 | 6 | ");
    EXPECT_NEAR(std::stod(scene.substr(14)) / seconds, 1.0, 0.01) << "three digits";
}

TEST_F(StudyRun, AReferenceIsKeptWhereTheStudyWantsIt) {
    const auto withReference = [](const std::string& recipe) {
        return R"({"seeds": [1], "methods": [{"method": "pt"}], "scenes": [{"file": "room.gltf",
                   "options": {"width": 24, "height": 16, "max-depth": 5},
                   "reference": {"file": "kept.exr", "iterations": 4, "parts": 2, )" +
               recipe + "}}]}";
    };
    const std::string spcbpt = R"("method": "spcbpt", "set": {"candidates": 50, "train.paths": 500,
                                  "train.subspaces": 4, "train.light_paths": 500})";
    writeStudy(withReference(spcbpt));
    const Outcome made = study();
    ASSERT_EQ(made.exitCode, 0) << made.err;
    EXPECT_NE(read("out/references.csv").find("spcbpt, 8 iterations"), std::string::npos);
    const std::string kept = read("kept.exr");

    // The reference exists, so nothing is rendered for it, whatever the folder of results holds.
    std::filesystem::remove_all(path("out"));
    ASSERT_EQ(study().exitCode, 0);
    EXPECT_FALSE(exists("out/references"));
    EXPECT_EQ(read("kept.exr"), kept);

    writeStudy(withReference(R"("method": "risbpt-current")"));
    expectFailure("@study.json -o @out --quiet", 3, "without bias");
    writeStudy(withReference(R"("method": "bpt", "set": {"candidates": 7})"));
    expectFailure("@study.json -o @out --quiet", 2, "candidates");
}

TEST_F(StudyRun, MethodsFollowEachOtherWithinASeed) {
    writeStudy();
    ASSERT_EQ(study().exitCode, 0);
    std::istringstream in(read("out/runs.csv"));
    std::vector<std::string> order;
    for (std::string line; std::getline(in, line);) {
        const std::size_t name = line.find(',') + 1;
        const std::size_t end = line.find(',', name);
        order.push_back(line.substr(name, end - name));
    }
    EXPECT_EQ(order, (std::vector<std::string>{"name", "pt", "lvcbpt candidates=50",
                                               "lvcbpt candidates=200", "lvcbpt candidates=50",
                                               "lvcbpt candidates=200", "pt"}));
}

/// `options` of the study are defaults for its scenes and methods, which may have their own.
TEST_F(StudyRun, OptionsOfTheStudyAreDefaults) {
    writeStudy(R"({"options": {"width": 20, "height": 10, "max-depth": 3}, "seeds": [1],
        "scenes": [{"file": "room.gltf", "name": "plain",
                    "reference": {"method": "bpt", "iterations": 4, "parts": 1}},
                   {"file": "room.gltf", "name": "own", "options": {"max-depth": 4},
                    "reference": {"method": "bpt", "iterations": 4, "parts": 1}}],
        "methods": [{"method": "pt"},
                    {"method": "pt", "name": "deep", "options": {"max-depth": 5}}]})");
    const Outcome made = study();
    ASSERT_EQ(made.exitCode, 0) << made.err;
    std::map<std::string, std::string> commands;  // by scene and method
    std::istringstream in(read("out/runs.csv"));
    for (std::string line; std::getline(in, line);) {
        const std::size_t second = line.find(',', line.find(',') + 1);
        commands[line.substr(0, second)] = line;
    }
    ASSERT_EQ(commands.size(), 5u) << read("out/runs.csv");
    for (const auto& [run, depth] : std::map<std::string, std::string>{
             {"plain,pt", "3"}, {"own,pt", "4"}, {"plain,deep", "5"}, {"own,deep", "5"}}) {
        const std::string& line = commands[run];
        EXPECT_NE(line.find("--max-depth " + depth), std::string::npos) << line;
        EXPECT_EQ(line.find("--max-depth"), line.rfind("--max-depth")) << line;
        EXPECT_NE(line.find("--width 20"), std::string::npos) << line;
        EXPECT_NE(line.find("--height 10"), std::string::npos) << line;
    }
    writeStudy(R"({"options": {"widht": 20}})");
    expectFailure("@study.json -o @out --quiet", 3, "options: widht");
    writeStudy(R"({"options": {"env": "sky.png"}})");
    expectFailure("@study.json -o @out --quiet", 3, ".exr or .hdr");
}

TEST_F(StudyRun, AnOptionThatMayBeRepeatedIsAnArray) {
    writeStudy(R"({"options": {"effect": ["refractions=off", "chains=off"]}, "seeds": [1],
        "methods": [{"method": "pt"},
                    {"method": "pt", "name": "own", "options": {"effect": "hits=off"}}]})");
    const Outcome made = study();
    ASSERT_EQ(made.exitCode, 0) << made.err;
    const std::string runs = read("out/runs.csv");
    const std::size_t own = runs.find("\nroom,own,");
    ASSERT_NE(own, std::string::npos) << runs;
    const std::string ofStudy = runs.substr(0, own), ofMethod = runs.substr(own);
    EXPECT_NE(ofStudy.find("--effect refractions=off --effect chains=off"), std::string::npos)
        << ofStudy;
    EXPECT_NE(ofMethod.find("--effect hits=off"), std::string::npos) << ofMethod;
    EXPECT_EQ(ofMethod.find("--effect"), ofMethod.rfind("--effect")) << ofMethod;
    writeStudy(R"({"options": {"effect": []}})");
    expectFailure("@study.json -o @out --quiet", 3, "effect: expected an array of texts");
    writeStudy(R"({"options": {"width": [20]}})");
    expectFailure("@study.json -o @out --quiet", 3, "width: expected a number");
}

TEST_F(StudyRun, ATimeMayBeANumberOfSeconds) {
    for (const char* time : {"0.01", "\"0.01\"", "\"0.01s\""}) {
        writeStudy(std::string(R"({"iterations": null, "equal_iterations": null, "seeds": [1],
                                   "time": )") +
                   time + "}");
        const Outcome made = study();
        EXPECT_EQ(made.exitCode, 0) << time << "\n" << made.err;
    }
    for (const char* time : {"0", "-1", "\"\"", "\"soon\"", "[1]", "null"}) {
        writeStudy(std::string(R"({"iterations": null, "equal_iterations": null, "time": )") +
                   time + "}");
        const Outcome refused = study();
        EXPECT_TRUE(refused.exitCode == 2 || refused.exitCode == 3) << time << refused.err;
        EXPECT_NE(refused.err.find("time"), std::string::npos) << time << refused.err;
    }
}

TEST_F(StudyRun, AnInterruptKeepsWhatIsFinished) {
    writeStudy(R"({"iterations": 100000})");
    const Outcome stopped =
        runAndSignal("@study.json -o @out --quiet", {SIGTERM}, std::chrono::milliseconds(1500));
    EXPECT_EQ(stopped.exitCode, 130) << stopped.err;
    EXPECT_NE(stopped.err.find("goes on from there"), std::string::npos) << stopped.err;
    EXPECT_FALSE(exists("out/index.html"));
    writeStudy();
    EXPECT_EQ(study().exitCode, 0);
}

TEST_F(StudyRun, RefusesWhatDoesNotFit) {
    writeStudy(R"({"tittle": "x"})");
    expectFailure("@study.json -o @out --quiet", 3, "tittle");
    writeStudy(R"({"methods": [{"method": "nonsense"}]})");
    expectFailure("@study.json -o @out --quiet", 2, "nonsense");
    writeStudy(R"({"seeds": [1, 1]})");
    expectFailure("@study.json -o @out --quiet", 3, "every seed once");
    writeStudy(R"({"seeds": [18446744073709551616]})");
    expectFailure("@study.json -o @out --quiet", 3, "integers below a million");
    writeStudy(R"({"baseline": "bpt"})");
    expectFailure("@study.json -o @out --quiet", 3, "baseline");
    write("study.json", "{\"title\": \"a\", \"title\": \"b\"}");
    expectFailure("@study.json -o @out --quiet", 3, "twice");
    expectFailure("@none.json -o @out --quiet", 3, "none.json");
    writeStudy(R"({"scenes": [{"file": "none.gltf", "reference": "reference.exr"}]})");
    expectFailure("@study.json -o @out --quiet", 3, "none.gltf");
    writeStudy(R"({"scenes": [{"file": "$LACUNA_SHARED_SCENES/x.glb", "reference": "r.exr"}]})");
    unsetenv("LACUNA_SHARED_SCENES");
    expectFailure("@study.json -o @out --quiet", 3, "LACUNA_SHARED_SCENES");
}

/// The scene of the tests with these crops.
std::string withCrops(const std::string& crops) {
    return R"({"scenes": [{"file": "room.gltf",
                           "options": {"width": 24, "height": 16, "max-depth": 5},
                           "reference": {"method": "bpt", "iterations": 32, "parts": 2},
                           "crops": )" +
           crops + "}]}";
}

TEST_F(StudyRun, CropsHaveErrorsOfTheirOwn) {
    writeStudy(withCrops(R"([{"name": "all", "x": 0, "y": 0, "width": 24, "height": 16},
                             {"name": "floor", "x": 4, "y": 10, "width": 6, "height": 5}])"));
    const Outcome made = study("--json @page.json");
    ASSERT_EQ(made.exitCode, 0) << made.err;
    const nlohmann::json page = json("page.json");
    std::map<std::string, std::vector<std::string>> columns;  // by crop, mape of pt
    std::istringstream in(read("out/error-in-crops.csv"));
    for (std::string line; std::getline(in, line);) {
        std::istringstream fields(line);
        std::vector<std::string> row;
        for (std::string field; std::getline(fields, field, ',');) row.push_back(field);
        ASSERT_GE(row.size(), 8u) << line;
        if (row[1] == "mape" && row[3] == "pt") columns[row[2]] = row;
    }
    ASSERT_EQ(columns.size(), 2u);
    // The crop that is the whole picture has the run's own errors: the lowest and the highest over
    // seeds.
    std::vector<double> errors;
    for (const nlohmann::json& run : page.at("runs")) {
        if (run.at("method") == 0) errors.push_back(run.at("error").at("mape"));
    }
    ASSERT_EQ(errors.size(), 2u);
    std::sort(errors.begin(), errors.end());
    EXPECT_NEAR(std::stod(columns["all"][5]) / errors[0], 1.0, 1e-6);
    EXPECT_NEAR(std::stod(columns["all"][6]) / errors[1], 1.0, 1e-6);
    EXPECT_NE(columns["floor"][5], columns["all"][5]);
    EXPECT_NE(read("out/tables.md").find("| floor | pt |"), std::string::npos);
}

TEST_F(StudyRun, RefusesCropsThatDoNotFit) {
    const auto refused = [&](const std::string& crops, const std::string& part) {
        writeStudy(withCrops(crops));
        expectFailure("@study.json -o @out --quiet", 3, part);
        EXPECT_FALSE(exists("out/references")) << "refused before anything is rendered";
    };
    refused(R"([{"name": "a", "x": 20, "y": 0, "width": 5, "height": 4}])", "crop 'a'");
    refused(R"([{"name": "a", "x": 0, "y": 13, "width": 5, "height": 4}])", "y 13 to 17");
    refused(R"([{"name": "a", "x": -1, "y": 0, "width": 5, "height": 4}])", "crops[0]: x");
    refused(R"([{"name": "a", "x": 0, "y": 0, "width": 0, "height": 4}])", "crops[0]: width");
    refused(R"([{"x": 0, "y": 0, "width": 5, "height": 4}])", "crops[0]: name");
    refused(R"([{"name": "a", "x": 0, "y": 0, "width": 5, "height": 4, "depth": 3}])", "depth");
    refused(R"([{"name": "a", "x": 0, "y": 0, "width": 5, "height": 4},
                {"name": "a", "x": 1, "y": 0, "width": 5, "height": 4}])",
            "'a' is there twice");
    refused("[]", "at least one");
}

TEST_F(StudyRun, TechniquesAreRenderedApartAndOnce) {
    writeStudy(R"({"techniques": {"iterations": 2}, "seeds": [3]})");
    const Outcome made = study();
    ASSERT_EQ(made.exitCode, 0) << made.err;
    EXPECT_NE(made.out.find("3 runs, 3 of them rendered now"), std::string::npos) << made.out;
    EXPECT_EQ(read("out/runs.csv").find("--techniques"), std::string::npos)
        << "layers cost time, which no measured run may pay";
    const auto images = [&] {
        std::vector<std::filesystem::file_time_type> times;
        for (const auto& run : std::filesystem::directory_iterator(path("out/techniques"))) {
            times.push_back(std::filesystem::last_write_time(run.path() / "image.exr"));
        }
        return times;
    };
    const auto first = images();
    EXPECT_EQ(first.size(), 3u);
    ASSERT_EQ(study().exitCode, 0);
    EXPECT_EQ(images(), first);

    writeStudy(R"({"techniques": {"edges": 3}})");
    expectFailure("@study.json -o @out --quiet", 3, "techniques: iterations");
    writeStudy(R"({"techniques": {"iterations": 2, "edges": 0}})");
    expectFailure("@study.json -o @out --quiet", 3, "techniques: edges");
    writeStudy(R"({"techniques": {"iterations": 2, "depth": 3}})");
    expectFailure("@study.json -o @out --quiet", 3, "depth");
}

TEST_F(StudyRun, RefusesReferencesOfOtherScenesSizesAndDepths) {
    const std::string scene = TinyScene{}.text();
    TinyScene other;
    other.pointLight = true;
    writeStudy(R"({"scenes": [{"file": "room.gltf",
                               "options": {"width": 24, "height": 16, "max-depth": 5},
                               "reference": "reference.exr"}]})");
    const auto refused = [&](const std::string& rendered, const std::string& arguments,
                             const std::string& part) {
        write("room.gltf", rendered);
        const std::string command = std::string(LACUNA_RENDER) + " " + path("room.gltf") + " -o " +
                                    path("reference.exr") + " --method pt --iterations 2 --quiet " +
                                    arguments + " > " + path("ignored.txt");
        ASSERT_EQ(std::system(command.c_str()), 0) << command;
        write("room.gltf", scene);
        expectFailure("@study.json -o @out --quiet", 3, "reference.exr: expected " + part);
    };
    refused(scene, "--width 20 --height 16 --max-depth 5", "24 x 16");
    refused(scene, "--width 24 --height 16 --max-depth 4", "paths of up to 5");
    refused(other.text(), "--width 24 --height 16 --max-depth 5", "a picture of the scene");
}

using StudyRunNight = StudyRun;

TEST_F(StudyRunNight, InterruptedTenTimesItIsTheSame) {
    writeStudy(R"({"iterations": 60, "scenes": [{"file": "room.gltf",
        "options": {"width": 96, "height": 64, "max-depth": 5},
        "reference": {"method": "bpt", "iterations": 60, "parts": 2, "file": "reference.exr"}}]})");
    ASSERT_EQ(run("@study.json -o @whole --quiet").exitCode, 0);
    int interrupted = 0, goneOn = 0;
    for (int i = 0; i < 10; ++i) {
        const Outcome o = runAndSignal("@study.json -o @pieces --quiet", {SIGINT},
                                       std::chrono::milliseconds(350));
        interrupted += o.exitCode == 130;
        for (const auto& entry : std::filesystem::recursive_directory_iterator(path("pieces"))) {
            goneOn += entry.path().filename() == "checkpoint";
        }
    }
    EXPECT_GT(interrupted, 2);
    EXPECT_GT(goneOn, 0);
    ASSERT_EQ(run("@study.json -o @pieces --quiet").exitCode, 0);
    int pictures = 0;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(path("whole"))) {
        EXPECT_NE(entry.path().filename(), "checkpoint");
        if (entry.path().filename() != "image.exr" ||
            entry.path().string().find("references") != std::string::npos) {
            continue;
        }
        const std::string other =
            path("pieces/" + std::filesystem::relative(entry.path(), path("whole")).string());
        ASSERT_TRUE(std::filesystem::exists(other)) << other;
        EXPECT_TRUE(readExrLayers(entry.path()).channels() == readExrLayers(other).channels())
            << other;
        ++pictures;
    }
    EXPECT_EQ(pictures, 6);
}

}  // namespace
}  // namespace lacuna::test
