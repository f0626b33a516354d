// Runs lacuna-compare itself: output, files, exit codes.
#include <sys/wait.h>

#include <cstdlib>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>

#include "libcore/image/error_metrics.h"
#include "libcore/image/image_io.h"
#include "tests/image/test_files.h"

namespace lacuna {
namespace {

struct Outcome {
    int exitCode = -1;  // -1: killed by a signal
    std::string out, err;
};

class CompareTool : public test::FileTest {
  protected:
    void SetUp() override {
        FileTest::SetUp();
        writeImage(path("a.exr"), test::layered(test::randomImage(32, 16, 1)));
        writeImage(path("b.exr"), test::layered(test::randomImage(32, 16, 2)));
    }

    /// `arguments` go through the shell; @ stands for the test's directory.
    Outcome run(std::string arguments) {
        for (std::size_t at; (at = arguments.find('@')) != std::string::npos;) {
            arguments.replace(at, 1, path(""));
        }
        const std::string out = path("stdout.txt"), err = path("stderr.txt");
        const int status = std::system(
            (std::string(LACUNA_COMPARE) + " 2>" + err + " >" + out + " " + arguments).c_str());
        const auto text = [](const std::string& file) {
            const test::Bytes bytes = test::slurp(file);
            return std::string(bytes.begin(), bytes.end());
        };
        return {WIFEXITED(status) && WEXITSTATUS(status) < 128 ? WEXITSTATUS(status) : -1,
                text(out), text(err)};
    }

    void expectFailure(const std::string& arguments, int exitCode, const std::string& part) {
        const Outcome o = run(arguments);
        EXPECT_EQ(o.exitCode, exitCode) << arguments << "\n" << o.err;
        EXPECT_EQ(std::count(o.err.begin(), o.err.end(), '\n'), 1) << arguments << "\n" << o.err;
        EXPECT_NE(o.err.find(part), std::string::npos) << arguments << "\n" << o.err;
        EXPECT_EQ(o.out, "") << arguments;
    }
};

TEST_F(CompareTool, PrintsTheMeasuresInFull) {
    const Outcome o = run("@a.exr @b.exr --json @m.json --error-map @m.png");
    ASSERT_EQ(o.exitCode, 0) << o.err;
    const ErrorMeasures m =
        ErrorReference(readImage(path("b.exr"))).compare(readImage(path("a.exr")));
    std::istringstream lines(o.out);
    for (const auto& [name, value] : {std::pair<std::string, double>{"mae", m.mae},
                                      {"rmse", m.rmse},
                                      {"mape", m.mape},
                                      {"relmse", m.relmse},
                                      {"pixels", 512}}) {
        std::string foundName, foundValue;
        lines >> foundName >> foundValue;
        EXPECT_EQ(foundName, name);
        EXPECT_EQ(std::stod(foundValue), value);
    }
    const test::Bytes bytes = test::slurp(path("m.json"));
    const auto json = nlohmann::json::parse(bytes.begin(), bytes.end());
    EXPECT_EQ(json, (nlohmann::json{{"mae", m.mae},
                                    {"rmse", m.rmse},
                                    {"mape", m.mape},
                                    {"relmse", m.relmse},
                                    {"pixels", 512}}));
    EXPECT_EQ(readImage(path("m.png")).width, 32);
    EXPECT_NE(o.err.find("logarithmic"), std::string::npos);
    EXPECT_EQ(run("@a.exr @b.exr --quiet --error-map @m.png").err, "");
    EXPECT_NE(run("@a.exr @b.exr -v").err.find("32 x 16"), std::string::npos);
    EXPECT_EQ(run("@a.exr @b.exr --threads 1 --seed 7 --cache @").exitCode, 0);
}

TEST_F(CompareTool, InfinityInJson) {
    writeImage(path("black.exr"), test::layered(Image(32, 16)));
    const Outcome o = run("@a.exr @black.exr --json @m.json");
    EXPECT_EQ(o.exitCode, 0) << o.err;
    EXPECT_NE(o.out.find("relmse inf\n"), std::string::npos) << o.out;
    const test::Bytes bytes = test::slurp(path("m.json"));
    EXPECT_EQ(nlohmann::json::parse(bytes.begin(), bytes.end())["mape"], "inf");
}

TEST_F(CompareTool, HelpAndVersion) {
    EXPECT_EQ(run("--version").exitCode, 0);
    EXPECT_EQ(run("--version").out.rfind("lacuna-compare 0.", 0), 0u) << run("--version").out;
    const Outcome help = run("--help");
    EXPECT_EQ(help.exitCode, 0);
    EXPECT_EQ(help.err, "");
    for (const char* word : {"--error-map", "--json", "logarithmic", "REFERENCE", "\"inf\""}) {
        EXPECT_NE(help.out.find(word), std::string::npos) << word;
    }
}

TEST_F(CompareTool, UsageErrors) {
    expectFailure("", 2, "IMAGE");
    expectFailure("@a.exr", 2, "REFERENCE");
    expectFailure("@a.exr @b.exr @a.exr", 2, "--help");
    expectFailure("@a.exr @b.exr --frob", 2, "--frob");
    expectFailure("@a.exr @b.exr --threads x", 2, "--threads");
    expectFailure("@a.exr @b.exr --error-map @m.exr", 2, ".png");
    expectFailure("@a.jpg @b.exr", 2, ".jpg");
}

/// Whichever path names them.
TEST_F(CompareTool, ResultsNeverReplaceImages) {
    std::filesystem::copy(path("a.exr"), path("a.png"));  // the ending of an error map
    const test::Bytes before = test::slurp(path("a.png"));
    std::filesystem::create_symlink("a.png", path("link.png"));
    for (const char* more :
         {"--error-map @a.png", "--error-map @./a.png", "--error-map @link.png", "--json @a.png"}) {
        const Outcome o = run(std::string("@a.png @a.png ") + more);
        EXPECT_EQ(o.exitCode, 2) << more << o.err;
        EXPECT_NE(o.err.find("file of its own"), std::string::npos) << o.err;
        EXPECT_EQ(test::slurp(path("a.png")), before);
    }
    EXPECT_EQ(run("@a.exr @b.exr --error-map @m.png --json @./m.png").exitCode, 2);
}

TEST_F(CompareTool, OutputsThatCannotBeWritten) {
    expectFailure("@a.exr @b.exr --error-map @none/m.png", 1, "No such file");
    expectFailure("@a.exr @b.exr --json @none/m.json", 1, "No such file");
    expectFailure("@a.exr @b.exr --json @", 1, "name of a file");
    expectFailure("@a.exr @b.exr --json /dev/full", 1, "No space");
    EXPECT_EQ(run("@a.exr @b.exr >/dev/full").exitCode, 1);
}

TEST_F(CompareTool, InputsThatCannotBeUsed) {
    expectFailure("@none.exr @b.exr", 3, "No such file");
    test::spill(path("empty.exr"), "");
    expectFailure("@empty.exr @b.exr", 3, "empty.exr: ");
    std::filesystem::create_directory(path("d.exr"));
    expectFailure("@a.exr @d.exr", 3, "a directory");
    writeImage(path("small.exr"), test::layered(Image(16, 16, Rgb(1))));
    expectFailure("@a.exr @small.exr", 3, "expected 16 x 16");
    // Sizes are compared by the headers, before pixels are read: pixels may be damaged as well.
    writeImage(path("flat.exr"), test::layered(Image(32, 16, Rgb(1))));
    test::Bytes damaged = test::slurp(path("flat.exr"));
    std::fill(damaged.end() - 16, damaged.end(), '\x55');
    test::spill(path("damaged.exr"), damaged);
    expectFailure("@damaged.exr @small.exr", 3, "expected 16 x 16");
    expectFailure("@damaged.exr @b.exr", 3, "damaged.exr: ");
    Image bad(32, 16, Rgb(1));
    bad.at(5, 6).r = std::numeric_limits<float>::quiet_NaN();
    writeImage(path("nan.exr"), test::layered(bad));
    expectFailure("@nan.exr @b.exr", 3, "R of pixel (5, 6)");
    expectFailure("@a.exr @nan.exr --json @m.json", 3, "nan.exr");
    EXPECT_FALSE(std::filesystem::exists(path("m.json")));
    // A line break in a name must not make two lines of the error.
    expectFailure("'@new\nline.exr' @b.exr", 3, "line.exr");
}

TEST_F(CompareTool, DamagedInputsNeverCrash) {
    const test::Bytes whole = test::slurp(path("a.exr"));
    for (std::size_t i = 0; i < 16; ++i) {
        const auto end = whole.begin() + std::ptrdiff_t(whole.size() * i / 16);
        test::spill(path("c.exr"), test::Bytes(whole.begin(), end));
        expectFailure("@c.exr @b.exr", 3, "c.exr: ");
        test::Bytes flipped = whole;
        flipped[whole.size() * i / 16 / (1 + i % 2 * 10)] ^= 0x10;
        test::spill(path("c.exr"), flipped);
        const int exitCode = run("@c.exr @b.exr").exitCode;
        EXPECT_TRUE(exitCode == 0 || exitCode == 3) << exitCode << " at " << i;
    }
}

}  // namespace
}  // namespace lacuna
