// Helpers of the image tests: a directory per test, files as bytes, random pictures.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include "libcore/base/error.h"
#include "libcore/image/image.h"

namespace lacuna::test {

using Bytes = std::vector<char>;

inline Bytes slurp(const std::string& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

inline void spill(const std::string& path, const Bytes& bytes) {
    // To truncate an old file makes some file systems flush it, which is slow in tests with
    // thousands of files.
    std::filesystem::remove(path);
    std::ofstream out(path, std::ios::binary);
    out.write(bytes.data(), std::streamsize(bytes.size()));
    ASSERT_TRUE(out.flush());
}

inline void spill(const std::string& path, const std::string& text) {
    spill(path, Bytes(text.begin(), text.end()));
}

/// Values that must be preserved bit by bit: of many magnitudes, negative ones, a denormal and -0.
inline std::vector<float> randomFloats(std::size_t n, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> exponent(-30.0f, 30.0f), sign(-1.0f, 1.0f);
    std::vector<float> out(n);
    for (float& v : out) v = std::copysign(std::exp2(exponent(random)), sign(random));
    if (n > 1) out[0] = 1e-42f, out[1] = -0.0f;
    return out;
}

/// Positive random radiance.
inline Image randomImage(int width, int height, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> value(0.01f, 2.0f);
    Image image(width, height);
    for (Rgb& p : image.pixels) p = {value(random), value(random), value(random)};
    return image;
}

inline LayeredImage layered(const Image& image) {
    LayeredImage out(image.width, image.height);
    out.setRgb("", image);
    return out;
}

class FileTest : public ::testing::Test {
  protected:
    void SetUp() override {
        const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
        directory_ = std::filesystem::temp_directory_path() /
                     ("lacuna-" + std::string(info->test_suite_name()) + "-" + info->name() + "-" +
                      std::to_string(::getpid()));
        std::filesystem::remove_all(directory_);
        std::filesystem::create_directories(directory_);
    }
    void TearDown() override {
        std::error_code ignored;
        std::filesystem::remove_all(directory_, ignored);
    }

    std::string path(const std::string& name) const { return (directory_ / name).string(); }
    /// Names of everything in the directory, to test that nothing was left behind.
    std::vector<std::string> listing() const {
        std::vector<std::string> names;
        for (const auto& entry : std::filesystem::directory_iterator(directory_)) {
            names.push_back(entry.path().filename().string());
        }
        std::sort(names.begin(), names.end());
        return names;
    }

  private:
    std::filesystem::path directory_;
};

/// The message of the error of type E that `body` throws; fails the test if it throws none.
template <class E, class Body>
std::string messageOf(Body body) {
    try {
        body();
    } catch (const E& e) {
        return e.what();
    } catch (const std::exception& e) {
        ADD_FAILURE() << "another exception: " << e.what();
        return "";
    }
    ADD_FAILURE() << "no exception";
    return "";
}

}  // namespace lacuna::test
