// Every file of tests/studies/ can be read as it is and with --quick. Quick studies use only our
// scenes, and their runs take at most two minutes. Studies of papers' figures use no techniques
// that the papers lack.
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <set>

#include "render/options.h"
#include "render/study/plan.h"
#include "render/study/study_file.h"

namespace lacuna {
namespace {

std::vector<std::string> shipped() {
    std::vector<std::string> files;
    for (const auto& entry : std::filesystem::directory_iterator(LACUNA_STUDIES)) {
        if (entry.path().extension() == ".json") files.push_back(entry.path().stem());
    }
    return files;
}

class ShippedStudies : public ::testing::TestWithParam<std::string> {
  protected:
    std::string path() const { return LACUNA_STUDIES "/" + GetParam() + ".json"; }
};

TEST_P(ShippedStudies, CanBeRead) {
    setenv("LACUNA_SHARED_SCENES", "/nowhere", 0);
    const Study study = readStudy(path(), false);
    EXPECT_GE(study.methods.size(), 2u);
    EXPECT_GE(study.seeds.size(), 3u) << "medians with ranges";
}

/// Whether `word` occurs as a word of its own: "bpt" is not in "lvcbpt".
bool names(const std::string& text, const std::string& word) {
    const auto inWord = [](char c) {
        return std::isalnum(static_cast<unsigned char>(c)) || c == '_';
    };
    for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) {
        const std::size_t end = at + word.size();
        const bool begins = at == 0 || !inWord(text[at - 1]);
        if (begins && (end == text.size() || !inWord(text[end]))) return true;
    }
    return false;
}

TEST_P(ShippedStudies, SaysWhatEachSettingStandsFor) {
    setenv("LACUNA_SHARED_SCENES", "/nowhere", 0);
    for (const bool quick : {false, true}) {
        const Study study = readStudy(path(), quick);
        std::string about;
        for (const std::string& paragraph : study.about) about += paragraph + "\n";
        for (const StudyMethod& method : study.methods) {
            const std::string& name = method.knob.empty() ? method.name : method.knobGroup;
            EXPECT_TRUE(names(about, name)) << "about: expected the setting '" << name << "'";
        }
    }
}

TEST_P(ShippedStudies, QuickNeedsNoSceneOfOthersAndLittleTime) {
    unsetenv("LACUNA_SHARED_SCENES");
    const Study study = readStudy(path(), true);
    double seconds = 0.0;
    for (const StudyScene& scene : study.scenes) {
        EXPECT_TRUE(std::filesystem::exists(scene.file)) << scene.file;
        const double runs = double(study.methods.size() * study.seeds.size());
        seconds +=
            runs * (study.effort[0] == "--time" ? parseDuration("--time", study.effort[1]) : 1.0);
    }
    EXPECT_LE(seconds, 120.0);
}

TEST_P(ShippedStudies, CropsLieInsideThePictures) {
    setenv("LACUNA_SHARED_SCENES", "/nowhere", 0);
    const ThreadPool pool(1);
    for (const bool quick : {false, true}) {
        for (const StudyScene& scene : readStudy(path(), quick).scenes) {
            if (scene.crops.empty() || !std::filesystem::exists(scene.file)) continue;
            const SceneFacts facts = inspectScene(scene, pool);
            for (const StudyCrop& crop : scene.crops) {
                EXPECT_LE(crop.rect.x1, facts.crop.width()) << scene.name << ": " << crop.name;
                EXPECT_LE(crop.rect.y1, facts.crop.height()) << scene.name << ": " << crop.name;
            }
        }
    }
}

/// Studies of papers' figures are named after the paper's row.
std::vector<std::string> ofPapers() {
    const std::set<std::string> rows = {"risbpt", "tsrbpt", "skelbpt", "spcbpt"};
    std::vector<std::string> files = shipped();
    std::erase_if(files, [&](const std::string& file) {
        return !rows.contains(file.substr(0, file.find('-')));
    });
    return files;
}

class PaperStudies : public ShippedStudies {};

TEST_P(PaperStudies, HaveNoTechniquesThatPapersLack) {
    setenv("LACUNA_SHARED_SCENES", "/nowhere", 0);
    for (const bool quick : {false, true}) {
        const Study study = readStudy(path(), quick);
        for (const StudyScene& scene : study.scenes) {
            for (const StudyMethod& method : study.methods) {
                SCOPED_TRACE(scene.name + ", " + method.name);
                const std::vector<std::string> options = mergedOptions(scene, method);
                for (const char* effect : {"refractions=off", "chains=off"}) {
                    EXPECT_EQ(std::count(options.begin(), options.end(), effect), 1) << effect;
                }
                if (method.method != "bpt") continue;
                EXPECT_EQ(method.assignments, std::vector<std::string>{"lamps=power"});
            }
        }
    }
}

std::string identifier(const ::testing::TestParamInfo<std::string>& instance) {
    std::string name = instance.param;
    std::replace(name.begin(), name.end(), '-', '_');
    return name;
}

INSTANTIATE_TEST_SUITE_P(Files, ShippedStudies, ::testing::ValuesIn(shipped()), identifier);
INSTANTIATE_TEST_SUITE_P(Files, PaperStudies, ::testing::ValuesIn(ofPapers()), identifier);

}  // namespace
}  // namespace lacuna
