// --help-as: manual pages and completion agree with --help, and shells accept them.
#include <sstream>

#include "libcore/methods/registry.h"
#include "tests/fixtures/render_tool.h"

namespace lacuna::test {
namespace {

class HelpForms : public RenderTool {
  protected:
    /// What bash offers after `words`, the last of which is being typed. They are split as readline
    /// does.
    std::string offered(const std::string& words) const {
        std::ostringstream script;
        script << "COMP_WORDS=(lacuna-render " << words << ")\n"
               << "COMP_CWORD=$((${#COMP_WORDS[@]} - 1))\ncd '" << path("") << "'\n"
               << "COMP_WORDBREAKS=$' \\t\\n=:'\nsource completion.bash\n_lacuna_render\n"
               << "echo \"${COMPREPLY[*]}\"\n";
        const Outcome o = run("'" + write("ask.bash", script.str()) + "'", "/bin/bash");
        EXPECT_EQ(o.err, "") << words;
        return o.out.substr(0, o.out.size() - 1);
    }
    void makeCompletion() const {
        const Outcome made = run("--help-as bash > @completion.bash");
        ASSERT_EQ(made.exitCode, 0) << made.err;
    }
};

std::string namesOfMethods() {
    std::string names = "auto";
    for (const MethodRow& row : methods()) names += " " + row.name;
    return names;
}

TEST_F(HelpForms, ManualPagesHaveAllSectionsAndNoRoffError) {
    for (const char* tool : {LACUNA_RENDER, LACUNA_MERGE, LACUNA_RELIGHT, LACUNA_COMPARE,
                             LACUNA_VOXELIZE, LACUNA_SKELETONIZE, LACUNA_TRAIN}) {
        const Outcome page = run("--help-as man", tool);
        EXPECT_EQ(page.exitCode, 0) << page.err;
        std::size_t at = 0;
        for (const char* title : {"NAME", "SYNOPSIS", "DESCRIPTION", "OPTIONS", "EXIT STATUS",
                                  "EXAMPLES", "SEE ALSO"}) {
            const std::size_t section = page.out.find(std::string("\n.SH ") + title + "\n");
            ASSERT_NE(section, std::string::npos) << tool << title;
            EXPECT_GT(section, at) << tool << title;
            at = section;
        }
        for (const char* status : {"\\fB0\\fR\nDone.", "\\fB3\\fR\n"}) {
            EXPECT_NE(page.out.find(status), std::string::npos) << tool;
        }
        if (!std::filesystem::exists("/usr/bin/groff")) continue;
        const Outcome checked =
            run("-ww -man -Tutf8 '" + write("page.1", page.out) + "'", "/usr/bin/groff");
        EXPECT_EQ(checked.err, "") << tool;
    }
}

TEST_F(HelpForms, ManualPageHasEveryOptionOfHelp) {
    const std::string page = run("--help-as man").out;
    std::istringstream help(run("--help").out);
    std::size_t options = 0;
    for (std::string line; std::getline(help, line);) {
        const std::size_t at = line.find("--");
        if (!line.starts_with("  -") || at == std::string::npos) continue;
        std::string name = line.substr(at + 2, line.find_first_of(" ,", at) - at - 2);
        for (std::size_t i = 0; (i = name.find('-', i)) != std::string::npos; i += 2) {
            name.insert(i, "\\");
        }
        EXPECT_NE(page.find("\\fB\\-\\-" + name + "\\fR"), std::string::npos) << line;
        ++options;
    }
    EXPECT_GT(options, 40u);
}

TEST_F(HelpForms, BashCompletesOptionsMethodsAndTheirSettings) {
    makeCompletion();
    EXPECT_EQ(offered("--tol"), "--tolerance");
    EXPECT_EQ(offered("--method ''"), namesOfMethods());
    EXPECT_EQ(offered("--help-method = ''"), namesOfMethods());
    EXPECT_EQ(offered("--sampler s"), "sobol");
    EXPECT_EQ(offered("--until ''"), "mape= relmse= rmse=");
    EXPECT_EQ(offered("--tone = f"), "filmic");
    EXPECT_EQ(offered("--replay ''"), "");
    EXPECT_EQ(offered("--effect thin"), "thin_lens=");
    EXPECT_EQ(offered("--effect thin_lens = ''"), "on off");
    // Keys belong to the method. A key's values are offered after the key.
    EXPECT_EQ(offered("--set ''"), "");
    for (const MethodRow& row : methods()) {
        std::string keys;
        for (const Option& o : row.options) keys += (keys.empty() ? "" : " ") + o.name + "=";
        EXPECT_EQ(offered("--method " + row.name + " --set ''"), keys);
        EXPECT_EQ(offered("--set = '' --method = " + row.name + " --set = ''"), keys);
    }
    EXPECT_EQ(offered("--method pt --set lamps = ''"), "seen power");
}

TEST_F(HelpForms, BashCompletesFilesByTheirEndings) {
    makeCompletion();
    for (const char* name : {"a.glb", "b.gltf", "c.txt", "d.png"}) write(name, "");
    std::filesystem::create_directory(path("folder"));
    EXPECT_EQ(offered("--seed 3 a"), "a.glb");
    EXPECT_EQ(offered("--sheet d"), "d.png");
    EXPECT_EQ(offered("--sheet = d"), "d.png");
    EXPECT_EQ(offered("--sheet a"), "");
    EXPECT_EQ(offered("-o c.t"), "c.txt");
    EXPECT_EQ(offered("--cache ''"), "folder");
    EXPECT_EQ(offered("fol"), "folder");
}

TEST_F(HelpForms, ZshTakesItsCompletion) {
    if (!std::filesystem::exists("/usr/bin/zsh")) GTEST_SKIP() << "there is no zsh";
    const Outcome made = run("--help-as zsh > @_lacuna-render");
    ASSERT_EQ(made.exitCode, 0) << made.err;
    EXPECT_NE(read("_lacuna-render").find("_lacuna_words " + namesOfMethods() + "'"),
              std::string::npos);
    const Outcome checked = run("-n @_lacuna-render", "/usr/bin/zsh");
    EXPECT_EQ(checked.exitCode, 0) << checked.err;
    EXPECT_EQ(checked.err, "");
}

TEST_F(HelpForms, OtherFormsAreRefused) {
    expectFailure("--help-as troff", 2, "man, bash or zsh");
}

}  // namespace
}  // namespace lacuna::test
