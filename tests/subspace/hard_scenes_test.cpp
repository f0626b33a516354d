// Training in difficult scenes: of any size and brightness, and with lamps that differ by thirty
// decades.
#include <gtest/gtest.h>

#include <cmath>

#include "preprocess/train.h"
#include "tests/scene/scene_builder.h"
#include "tests/stability.h"

namespace lacuna::test {
namespace {

Trained trained(const Scene& scene) {
    const std::atomic<bool> never{false};
    TrainSettings settings;
    settings.paths = 3000;
    settings.subspaces = 30;
    settings.lightPaths = 3000;
    settings.epochs = 5;
    Phases phases;
    const double aspect = 16.0 / 9.0;
    const TrainingView view =
        trainingView(scene.makeCamera("", {16, 9}, {}), aspect, WalkLimits{}, settings.paths);
    return train(scene, view, settings, {}, pool(), never, phases);
}

/// A room with a block, scaled by `scale`, with one lamp of each radiance.
std::unique_ptr<Scene> room(double scale, const std::vector<float>& radiances) {
    const Affine place = scaling({scale, scale, scale});
    SceneBuilder b;
    b.add(box({-1, -1, -1}, {1, 1, 1}, 0, true), place);
    b.add(box({-0.5f, -1, -0.4f}, {0, 0, 0.1f}), place);
    for (std::size_t i = 0; i < radiances.size(); ++i) {
        const float x = 0.5f * float(i) - 0.8f;
        b.add(quad({x, 0.9f, -0.3f}, {0.4f, 0, 0}, {0, 0, 0.6f}, b.add(emitter(Rgb(radiances[i])))),
              place);
    }
    b.add(lookAt(Vec3d{0, 0, 0.9} * scale, Vec3d{0, -0.2, 0} * scale, 70));
    return b.build();
}

/// Scaling size and brightness by powers of two gives the same subspaces, Gamma to the last bit,
/// and Q in proportion.
TEST(HardTraining, sizeAndBrightnessChangeNothing) {
    const Subspaces unit = trained(*room(1, {2})).file.subspaces;
    ASSERT_GT(unit.gamma.size(), 200u);
    std::size_t different = 0;
    for (const double scale : {0x1p-10, 0x1p20}) {
        for (const float radiance : {2.0f, 0x1p-60f, 0x1p60f}) {
            const auto scene = room(scale, {radiance});
            const Subspaces found = trained(*scene).file.subspaces;
            EXPECT_NO_THROW(found.check());
            ASSERT_EQ(found.gamma.size(), unit.gamma.size());
            ASSERT_EQ(found.q.size(), unit.q.size());
            for (std::size_t i = 0; i < unit.gamma.size(); ++i) {
                different += found.gamma[i] != unit.gamma[i];
            }
            for (std::size_t i = 0; i < unit.q.size(); ++i) {
                different += found.q[i] * scene->lights().unit() !=
                             unit.q[i] * scale * scale * double(radiance) / 2;
            }
        }
    }
    EXPECT_EQ(different, 0u);
    stabilityCase("train-scale", double(different), "numbers differ in a bit");
}

TEST(HardTraining, lampsThirtyDecadesApart) {
    const Trained t = trained(*room(1, {1e-15f, 1, 1e15f, 0x1p-20f}));
    const Subspaces& found = t.file.subspaces;
    EXPECT_NO_THROW(found.check());
    EXPECT_GT(t.trainPaths, 0u);
    for (const double loss : t.gamma.trainLoss) EXPECT_TRUE(std::isfinite(loss));
    for (const double loss : t.gamma.heldOutLoss) EXPECT_TRUE(std::isfinite(loss));
    std::size_t bad = 0;
    for (const float g : found.gamma) bad += !(std::isfinite(g) && g > 0.0f);
    for (const double q : found.q) bad += !(std::isfinite(q) && q >= 0.0);
    EXPECT_EQ(bad, 0u);
    stabilityCase("train-range", double(bad), "numbers not finite");
}

}  // namespace
}  // namespace lacuna::test
