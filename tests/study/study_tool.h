// Runs lacuna-study in a directory of the test's own.
#pragma once

#include "tests/fixtures/render_tool.h"

namespace lacuna::test {

class StudyTool : public RenderTool {
  protected:
    std::string ownTool() const override { return LACUNA_STUDY; }

    /// Writes @study.json: a tiny study with two methods, two seeds and a reference of two parts.
    /// `changes`: JSON that is merged into it (RFC 7386).
    void writeStudy(const std::string& changes = "{}") const {
        nlohmann::json study = nlohmann::json::parse(R"({
            "title": "A study <of> tests", "about": ["pt is <what> lvcbpt is not.", "Twice."],
            "iterations": 6, "seeds": [1, 2],
            "equal_iterations": [4], "bounds": {"mape": [10, 1e-6]},
            "scenes": [{"file": "room.gltf",
                        "options": {"width": 24, "height": 16, "max-depth": 5},
                        "reference": {"method": "bpt", "iterations": 32, "parts": 2}}],
            "methods": [{"method": "pt"},
                        {"method": "lvcbpt", "vary": {"candidates": [50, 200]}}]})");
        study.merge_patch(nlohmann::json::parse(changes));
        write("study.json", study.dump());
    }
    Outcome study(const std::string& more = "") const {
        return run("@study.json -o @out --quiet " + more);
    }
};

}  // namespace lacuna::test
