// Runs lacuna-render itself (or another tool) in a directory of the test's own.
#pragma once

#include <gtest/gtest.h>

#include <sys/types.h>

#include <chrono>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "tests/render/tiny_scene.h"

namespace lacuna::test {

struct Outcome {
    int exitCode = -1;  ///< -1: ended by a signal
    std::string out, err;
};

class RenderTool : public ::testing::Test {
  protected:
    void SetUp() override;
    void TearDown() override;
    /// Path of the program that is started where none is named.
    virtual std::string ownTool() const { return LACUNA_RENDER; }

    std::string path(const std::string& name) const { return (directory_ / name).string(); }
    std::string write(const std::string& name, const std::string& text) const;
    std::string read(const std::string& name) const;
    bool exists(const std::string& name) const { return std::filesystem::exists(path(name)); }
    /// Files of the directory that a tool left behind by mistake.
    std::vector<std::string> temporaries() const;

    /// `arguments` go through a shell; @ stands for the directory and its slash.
    Outcome run(const std::string& arguments, const char* tool = nullptr) const;
    /// Starts it, sends `signals` one after the other, `delay` before each; waits for the end.
    Outcome runAndSignal(const std::string& arguments, const std::vector<int>& signals,
                         std::chrono::milliseconds delay, const char* tool = nullptr) const;
    /// Starts it and does not wait. One at a time.
    pid_t start(const std::string& arguments, const char* tool = nullptr) const;
    /// Waits for its end.
    Outcome end(pid_t child) const;
    /// Must fail with this code, `part` in one line on stderr, nothing on stdout.
    void expectFailure(const std::string& arguments, int exitCode, const std::string& part,
                       const char* tool = nullptr) const;
    nlohmann::json json(const std::string& name) const;
    /// Two .exr of the directory: all but what tells when and by which command they were made.
    void expectSamePicture(const std::string& a, const std::string& b) const;
    /// A quick render of @room.gltf (written by SetUp) to @out.exr.
    std::string quick(const std::string& method, const std::string& more = "") const;

  private:
    std::filesystem::path directory_;
};

/// Parameters that make a method cheap on a tiny picture.
std::string cheap(const std::string& method);

}  // namespace lacuna::test
