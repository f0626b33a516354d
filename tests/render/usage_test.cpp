// Messages and exit codes of lacuna-render for command lines and scenes, good and bad.
#include <sys/stat.h>

#include <nlohmann/json.hpp>
#include <sstream>
#include <utility>

#include "libcore/methods/registry.h"
#include "tests/fixtures/render_tool.h"

namespace lacuna::test {
namespace {

class RenderUsage : public RenderTool {};

TEST_F(RenderUsage, HelpNamesEveryOption) {
    const Outcome o = run("--help");
    EXPECT_EQ(o.exitCode, 0);
    for (const char* option :
         {"--method",         "--set",          "--width",       "--height",     "--iterations",
          "--time",           "--count-setup",  "--max-depth",   "--rr-depth",   "--aperture",
          "--focus",          "--camera",       "--env",         "--env-rotate", "--env-scale",
          "--units",          "--light-noise",  "--crop",        "--reference",  "--log",
          "--prepare",        "--techniques",   "--verify",      "--replay",     "--effects",
          "--exposure",       "--tone",         "--png-bits",    "--sheet",      "--shift",
          "--env-colour",     "--list-methods", "--help-method", "--threads",    "--seed",
          "--json",           "--quiet",        "--cache",       "--version",    "--display-server",
          "--display-layers", "--write-every",  "--until",       "--estimate",   "Exit codes"}) {
        EXPECT_NE(o.out.find(option), std::string::npos) << option;
    }
    EXPECT_EQ(run("--version").exitCode, 0);
    EXPECT_NE(run("--version").out.find("lacuna-render"), std::string::npos);
}

TEST_F(RenderUsage, MethodsAreListedWithTheirParameters) {
    const Outcome list = run("--list-methods");
    EXPECT_EQ(list.exitCode, 0);
    for (const MethodRow& row : methods()) {
        EXPECT_NE(list.out.find(row.name + " "), std::string::npos) << row.name;
        const Outcome help = run("--help-method " + row.name);
        EXPECT_EQ(help.exitCode, 0);
        EXPECT_NE(help.out.find(row.summary), std::string::npos) << row.name;
        EXPECT_EQ(help.out.find("\nbiased") != std::string::npos, row.biased) << row.name;
        for (const Option& p : row.options) {
            EXPECT_NE(help.out.find("  " + p.name + " "), std::string::npos) << p.name;
            EXPECT_NE(help.out.find(p.help), std::string::npos) << p.name;
        }
    }
    expectFailure("--help-method nonsense", 2, "pt, lt, bpt");
}

TEST_F(RenderUsage, CommandLinesThatAreWrongExitWith2) {
    // The scene does not exist: errors of the command line are found before anything is loaded.
    const std::string start = "@none.glb -o @out.exr --method pt ";
    expectFailure("", 2, "SCENE.glb");
    expectFailure("@none.glb -o @out.exr --method fast", 2, "'fast'");
    expectFailure("@none.glb -o @out.jpg --method pt", 2, ".jpg");
    expectFailure(start + "--nonsense", 2, "--nonsense");
    expectFailure(start + "--set candidates=3", 2, "candidates");
    expectFailure("@none.glb -o @out.exr --method lvcbpt --set candidates", 2, "name=value");
    expectFailure("@none.glb -o @out.exr --method lvcbpt --set candidates=0", 2, "found '0'");
    expectFailure("@none.glb -o @out.exr --method lvcbpt --set candidates=1.5", 2, "integer");
    expectFailure("@none.glb -o @out.exr --method lvcbpt --set next_event=yes", 2, "on or off");
    for (const char* size : {"0", "-5", "65537", "99999999999"}) {
        expectFailure(start + "--width " + size, 2, size);
        expectFailure(start + "--height " + size, 2, size);
    }
    expectFailure(start + "--width 65536 --height 65536", 2, "pixels");
    expectFailure(start + "--width 1e99", 2, "--width");
    expectFailure(start + "--width wide", 2, "wide");
    for (const char* time :
         {"0s", "-1s", "0", "-1", "10d", "s", "1e999s", "1e308h", "nans", "nan"}) {
        expectFailure(start + "--time " + time, 2, "--time");
    }
    for (const char* crop : {"1,2,3", "0,0,0,4", "4,0,0,4", "-1,4,0,4", "a,b,c,d", "0,4,0,4,"}) {
        expectFailure(start + "--crop " + crop, 2, "--crop");
    }
    for (const char* replay : {"1,2", "1,2,3,4", "light:1", "light:-1,0", "x,y,z", "-1,0,0"}) {
        expectFailure(start + "--replay " + replay, 2, "--replay");
    }
    for (const char* option :
         {"--iterations 0", "--iterations -1", "--max-depth 0", "--max-depth 255", "--rr-depth -1",
          "--aperture -1", "--aperture nan", "--focus 0", "--env-scale -1", "--threads 0",
          "--seed -1", "--exposure inf", "--focus 1e39", "--aperture 1e39"}) {
        expectFailure(start + option, 2, std::string(option).substr(0, 6));
    }
    expectFailure(start + "--count-setup", 2, "--time");
    expectFailure("@none.glb -o @out.png --method pt --techniques", 2, ".exr");
    for (const char* server : {"localhost:", ":0", ":65536", "::1", "[::1", "[]:1", "http://tev"}) {
        expectFailure(start + "--display-server " + server, 2, "[::1]:14158");
    }
    expectFailure(start + "--display-layers variance", 2, "--display-server");
    for (const char* layers : {",", "variance,", ",Z", "variance,,Z"}) {
        expectFailure(start + "--display-server :1 --display-layers " + layers, 2, "names of");
    }
    for (const char* time : {"0s", "-1", "soon"}) {
        expectFailure(start + "--write-every " + time, 2, "--write-every");
    }
    for (const char* scale :
         {"50", "0%", "-5%", "x", "640x", "x480", "640x480x3", "1e999%", "nan%"}) {
        expectFailure(start + "--scale " + scale, 2, "--scale");
    }
    expectFailure(start + "--size 64x48 --width 64", 2, "--width");
    for (const char* shift : {"0.1", "0.1,0.2,0.3", "x,y", "nan,0", "0,101", "0,"}) {
        expectFailure(start + "--shift " + shift, 2, "--shift");
    }
    for (const char* colour : {"1", "1,2", "-1,0,0", "red", "1,1,inf", "1,1,1,1", "1,,1"}) {
        expectFailure(start + "--env-colour " + colour, 2, "--env-colour");
    }
    expectFailure(start + "--env-colour 1,1,1 --env sky.exr", 2, "one environment");
    expectFailure(start + "--denoise", 2, "albedo");
    expectFailure("@none.glb -o @out.exr --set candidates=3", 2, "--method auto");
    expectFailure("@none.glb -o @out.exr --replay 1,2,3", 2, "--method auto");
    expectFailure("@none.glb --techniques", 2, ".exr");
    expectFailure(start + "--json @out.exr", 2, "file of its own");
}

/// The names of all options with a value. In the lines of --help, a type follows them.
std::vector<std::string> optionsWithValues(const std::string& help) {
    std::vector<std::string> names;
    std::istringstream lines(help);
    for (std::string line; std::getline(lines, line);) {
        const std::size_t name = line.find("--"), space = line.find(' ', 2);
        if (!line.starts_with("  -") || space + 1 >= line.size() || line[space + 1] == ' ')
            continue;
        names.push_back(line.substr(name, line.find_first_of(", ", name) - name));
    }
    return names;
}

/// An unset variable of the shell must not leave an option out.
TEST_F(RenderUsage, EmptyTextsExitWith2) {
    const std::pair<const char*, const char*> tools[] = {
        {LACUNA_RENDER, "@none.glb "},      {LACUNA_COMPARE, "@a.exr @b.exr "},
        {LACUNA_MERGE, "@a.exr "},          {LACUNA_RELIGHT, "@a.exr "},
        {LACUNA_SKELETONIZE, "@none.glb "}, {LACUNA_TRAIN, "@none.glb "}};
    std::size_t number = 0;
    for (const auto& [tool, start] : tools) {
        for (const std::string& option : optionsWithValues(run("--help", tool).out)) {
            const bool lacksOutput = tool == std::string(LACUNA_MERGE) && option != "--output";
            const std::string arguments =
                start + option + " \"\"" + (lacksOutput ? " -o @b.exr" : "");
            const Outcome o = run(arguments, tool);
            EXPECT_EQ(o.exitCode, 2) << arguments;
            for (const std::string& part : {option + ": expected ", std::string(", found ")}) {
                EXPECT_NE(o.err.find(part), std::string::npos) << arguments << "\n" << o.err;
            }
            EXPECT_LT(o.err.size(), 160u) << arguments << "\n" << o.err;
            EXPECT_EQ(o.err.find('\n') + 1, o.err.size()) << arguments << "\n" << o.err;
            ++number;
        }
    }
    EXPECT_GT(number, 100u);
    const std::string start = "@none.glb -o @out.exr --method pt ";
    expectFailure(start + "--time=", 2, "--time");
    expectFailure("\"\" -o @out.exr --method pt", 2, "SCENE");
}

/// Numbers that the parser of the command line would misread.
TEST_F(RenderUsage, IntegersAreDecimalAndFit) {
    const std::string start = "@none.glb -o @out.exr --method pt ";
    for (const char* seed : {"18446744073709551616", "99999999999999999999999", "010", "0x10"}) {
        expectFailure(start + "--seed " + seed, 2, std::string("found '") + seed);
    }
    for (const char* option : {"--width", "--height", "--iterations", "--max-depth", "--threads"}) {
        expectFailure(start + option + " 9223372036854775808", 2, option);
        expectFailure(start + option + " 010", 2, "found '010'");
    }
    EXPECT_EQ(run(quick("pt", "--quiet --seed 18446744073709551615")).exitCode, 0);
    EXPECT_EQ(run(quick("pt", "--quiet --seed 0")).exitCode, 0);
}

TEST_F(RenderUsage, MessagesShowTheNumberThatWasFound) {
    const std::string start = "@none.glb -o @out.exr --method pt ";
    expectFailure(start + "--focus 1e-46", 2, "found 1e-46");
    expectFailure(start + "--focus 1e39", 2, "found 1e+39");
    expectFailure(start + "--tolerance -1e-46", 2, "found -1e-46");
}

/// An eight-bit picture has no light above white, and its values are not linear.
TEST_F(RenderUsage, EnvironmentsAreExrOrHdr) {
    ASSERT_EQ(run("@room.gltf -o @sheet.png --method pt --width 24 --height 16 --iterations 1 "
                  "--quiet")
                  .exitCode,
              0);
    std::filesystem::copy(path("sheet.png"), path("sheet.PNG"));
    std::filesystem::copy(path("sheet.png"), path("sheet"));
    for (const char* name : {"sheet.png", "sheet.PNG", "sheet", "sheet.pfm", "sheet.jpg"}) {
        const std::string more = std::string("--env @") + name;
        expectFailure(quick("pt", "--quiet " + more), 3, ".exr or .hdr");
        expectFailure("@room.gltf --effects " + more, 3, name);
    }
    TinyScene scene;
    scene.environment = "sheet.png";
    write("outside.gltf", scene.text());
    expectFailure("@outside.gltf -o @out.exr --method pt --quiet", 3, ".exr or .hdr");
    ASSERT_EQ(run(quick("pt", "--quiet")).exitCode, 0);
    std::filesystem::rename(path("out.exr"), path("SKY.EXR"));
    EXPECT_EQ(run(quick("pt", "--quiet --env @SKY.EXR")).exitCode, 0);
}

TEST_F(RenderUsage, WhatBlenderLeavesOutIsNamed) {
    TinyScene scene;
    scene.camera = scene.lamp = false;
    scene.generator = "Khronos glTF Blender I/O v3.4.50";
    write("blind.gltf", scene.text());
    expectFailure("@blind.gltf -o @out.exr --method pt --quiet", 3, "Include > Cameras");
    scene.camera = true;
    write("dark.gltf", scene.text());
    const Outcome dark =
        run("@dark.gltf -o @out.exr --width 12 --height 8 --iterations 1 --method pt --quiet");
    EXPECT_EQ(dark.exitCode, 0);
    EXPECT_NE(dark.err.find("no light in the scene"), std::string::npos) << dark.err;
    EXPECT_NE(dark.err.find("Include > Punctual Lights"), std::string::npos) << dark.err;
    scene.generator.clear();
    scene.pointLight = true;
    scene.pointIntensity = 0.0;
    write("off.gltf", scene.text());
    const Outcome off =
        run("@off.gltf -o @out.exr --width 12 --height 8 --iterations 1 --method pt --quiet");
    EXPECT_NE(off.err.find("have no power"), std::string::npos) << off.err;
    EXPECT_EQ(std::count(off.err.begin(), off.err.end(), '\n'), 1) << off.err;
}

TEST_F(RenderUsage, WhatTheSceneDecidesExitsWith2Too) {
    const std::string start = "@room.gltf -o @out.exr --method pt --iterations 1 --quiet ";
    expectFailure(start + "--width 24 --height 16 --crop 0,25,0,16", 2, "24 x 16");
    expectFailure(start + "--camera nobody", 2, "'eye'");
    expectFailure(start + "--aperture 0.1", 2, "--focus");
    expectFailure(start + "--env-scale 2", 2, "--env");
    expectFailure(start + "--width 24 --height 16 --replay 24,0,0", 2, "24 x 16");
    expectFailure(start + "--width 24 --height 16 --replay light:384,0", 2, "384");
    EXPECT_FALSE(exists("out.exr"));
}

TEST_F(RenderUsage, ScenesThatCannotBeUsedExitWith3) {
    TinyScene scene;
    scene.camera = false;
    write("blind.gltf", scene.text());
    write("broken.gltf", "{");
    write("empty.glb", "");
    expectFailure("@blind.gltf -o @out.exr --method pt --quiet", 3, "camera");
    expectFailure("@none.glb -o @out.exr --method pt --quiet", 3, "none.glb");
    expectFailure("@broken.gltf -o @out.exr --method pt --quiet", 3, "broken.gltf");
    expectFailure("@empty.glb -o @out.exr --method pt --quiet", 3, "empty.glb");
    expectFailure("@none.glb --effects", 3, "none.glb");
    expectFailure("@room.gltf -o @out.exr --method pt --env @none.hdr --quiet", 3, "none.hdr");
    expectFailure("@room.gltf -o @out.exr --method pt --reference @none.exr --quiet", 3,
                  "none.exr");
    EXPECT_FALSE(exists("out.exr"));
}

TEST_F(RenderUsage, OutputsThatCannotBeWrittenExitWith1BeforeRendering) {
    // The render would not end: these commands return only because nothing is rendered.
    const std::string endless = "@room.gltf --method pt --time 10h --quiet ";
    expectFailure(endless + "-o @none/out.exr", 1, "none/out.exr");
    expectFailure(endless + "-o @out.exr --json @none/out.json", 1, "none/out.json");
    expectFailure(endless + "-o @out.exr --log @none/out.csv", 1, "none/out.csv");
    std::filesystem::create_directory(path("folder.exr"));
    expectFailure(endless + "-o @folder.exr", 1, "folder.exr");
    EXPECT_FALSE(exists("out.exr"));
}

TEST_F(RenderUsage, ResultsNeverReplaceInputs) {
    ASSERT_EQ(run(quick("pt")).exitCode, 0);
    expectFailure("@room.gltf -o @out.exr --reference @out.exr --method pt", 2, "file of its own");
    const std::string before = read("room.gltf");
    expectFailure("@room.gltf -o @o.exr --json @room.gltf --method pt", 2, "file of its own");
    expectFailure("@room.gltf -o @o.exr --json @./room.gltf --method pt", 2, "file of its own");
    // Two results of the same name, before either file exists.
    expectFailure("@room.gltf -o @o.exr --json @c --log @./c --method pt", 2, "file of its own");
    expectFailure("@room.gltf --voxels @v.vdb -o @./v.vdb", 2, "file of its own",
                  LACUNA_SKELETONIZE);
    expectFailure("@room.gltf --json @room.gltf", 2, "file of its own", LACUNA_VOXELIZE);
    expectFailure("@out.exr -o @./out.exr", 2, "file of its own", LACUNA_MERGE);
    EXPECT_EQ(read("room.gltf"), before);
}

TEST_F(RenderUsage, QuietIsQuietAndResultsGoToStdout) {
    const Outcome o = run(quick("pt", "--quiet"));
    EXPECT_EQ(o.exitCode, 0);
    EXPECT_EQ(o.err, "");
    EXPECT_NE(o.out.find("out.exr"), std::string::npos);
    EXPECT_NE(run(quick("pt", "-v")).err.find("12 triangles"), std::string::npos);
    EXPECT_NE(run(quick("pt", "--prepare")).err.find("no caches"), std::string::npos);
    EXPECT_EQ(run(quick("pt", "--cache @c --quiet")).exitCode, 0);
}

TEST_F(RenderUsage, EffectsNeedNeitherOutputNorMethod) {
    const Outcome o = run("@room.gltf --effects");
    EXPECT_EQ(o.exitCode, 0) << o.err;
    for (const char* line :
         {"simulated  area_lights", "simulated  diffuse", "simulated  glossy", "simulated  mirror",
          "left_out   environment", "left_out   rough_refraction", "left_out   thin_lens",
          "left_out   point_lights", "left_out   alpha_mask"}) {
        EXPECT_NE(o.out.find(line), std::string::npos) << line << "\n" << o.out;
    }
    EXPECT_EQ(o.out.find("splats"), std::string::npos);
    const Outcome pt = run("@room.gltf --effects --method pt --json @e.json --aperture 0.1");
    EXPECT_NE(pt.out.find("left_out   splats"), std::string::npos) << pt.out;
    EXPECT_NE(pt.out.find("simulated  thin_lens"), std::string::npos) << pt.out;
    EXPECT_TRUE(json("e.json").at("effects").at("reasons").contains("mirror"));
    expectFailure("@room.gltf --effects --method nonsense", 2, "nonsense");

    TinyScene blind;  // --effects needs no camera
    blind.camera = false;
    blind.pointLight = true;
    blind.lamp = false;
    write("blind.gltf", blind.text());
    const Outcome b = run("@blind.gltf --effects --method bpt");
    EXPECT_EQ(b.exitCode, 0) << b.err;
    EXPECT_NE(b.out.find("simulated  point_lights"), std::string::npos) << b.out;
    EXPECT_NE(b.out.find("left_out   hits"), std::string::npos) << b.out;
}

}  // namespace
}  // namespace lacuna::test
