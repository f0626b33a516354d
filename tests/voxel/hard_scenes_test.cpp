// lacuna-voxelize and lacuna-skeletonize on difficult scenes: of any size, flat, with hardly any
// room.
#include <gtest/gtest.h>

#include "libcore/base/error.h"
#include "preprocess/skeletonize.h"
#include "tests/fixtures/never.h"
#include "tests/scene/scene_builder.h"
#include "tests/stability.h"

namespace lacuna::test {
namespace {

Voxelized voxelized(const Scene& scene, int resolution, const std::string& domain = {}) {
    Phases phases;
    return voxelizeScene(scene, {resolution, domain}, {}, pool(), kNever, phases);
}

Skeletonized skeletonOf(const Scene& scene, const Voxelized& voxels) {
    Phases phases;
    return skeletonize(scene, voxels.file, pool(), kNever, phases);
}

/// Two rooms with a door and a pillar, a lamp under the ceiling.
std::unique_ptr<Scene> rooms(double scale) {
    const Affine place = scaling({scale, scale, scale});
    SceneBuilder b;
    b.add(box({-2, -1, -1}, {2, 1, 1}, 0, true), place);
    b.add(box({-0.05f, -1, -1}, {0.05f, 1, 0.2f}), place);
    b.add(box({1, -1, -0.3f}, {1.4f, 1, 0.1f}), place);
    const auto glow = b.add(emitter(Rgb(1.0f)));
    b.add(quad({-1.5f, 0.9f, -0.3f}, {0.6f, 0, 0}, {0, 0, 0.6f}, glow), place);
    b.add(lookAt(Vec3d{1.8, 0, 0.8} * scale, Vec3d{0, 0, 0}, 70));
    return b.build();
}

TEST(HardScenes, sizeChangesNoSkeleton) {
    const auto unit = rooms(1);
    const Voxelized voxels = voxelized(*unit, 32);
    const Skeletonized expected = skeletonOf(*unit, voxels);
    EXPECT_EQ(expected.empty.b0, 1);
    EXPECT_EQ(expected.empty.b1, 1);  // about the pillar
    std::size_t different = 0;
    for (const double scale : {0x1p-10, 0x1p20, 1e-3, 1e6}) {
        const auto scene = rooms(scale);
        const Voxelized there = voxelized(*scene, 32);
        ASSERT_EQ(there.file.space.shape.size, voxels.file.space.shape.size) << scale;
        const Skeletonized found = skeletonOf(*scene, there);
        EXPECT_EQ(found.empty, expected.empty) << scale;
        EXPECT_EQ(found.filtered, expected.filtered) << scale;
        if (scale == 1e-3 || scale == 1e6) continue;  // rounded: voxels on a border may differ
        const auto &a = voxels.file.space.state, &b = there.file.space.state;
        for (std::size_t i = 0; i < a.size(); ++i) different += a[i] != b[i];
        EXPECT_EQ(found.raw.edges, expected.raw.edges) << scale;
    }
    EXPECT_EQ(different, 0u);
    stabilityCase("space-scale", double(different), "voxels differ");
}

TEST(HardScenes, flatOnesNeedADomain) {
    SceneBuilder b;
    b.add(quad({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}, b.add(emitter(Rgb(1.0f)))));
    b.add(lookAt({0, 1, 0.1}, {0, 0, 0}, 50));
    const auto scene = b.build();
    for (const int resolution : {16, 100}) {
        try {
            voxelized(*scene, resolution);
            FAIL();
        } catch (const UsageError& e) {
            EXPECT_TRUE(std::string(e.what()).starts_with("--domain")) << e.what();
        }
    }
    const Voxelized voxels = voxelized(*scene, 16, "-1,-1,-1,1,1,1");
    EXPECT_EQ(voxels.parts.total, 2u);
    EXPECT_EQ(voxels.parts.reached, 1u);
    const Skeletonized found = skeletonOf(*scene, voxels);
    EXPECT_EQ(found.filtered.b0, 1);
    stabilityCase("voxel-flat", double(found.filtered.b0), "part with a skeleton");
}

TEST(HardScenes, hardlyAnyRoom) {
    const auto scene = rooms(1);
    // One voxel in the open.
    const Skeletonized found =
        skeletonOf(*scene, voxelized(*scene, 1, "-1.05,-0.05,0.45,-0.95,0.05,0.55"));
    EXPECT_EQ(found.empty, (Betti{1, 0, 0}));
    EXPECT_EQ(found.file.skeleton.nodes.size(), 1u);
    // A box inside the pillar, and voxels as large as the rooms.
    EXPECT_THROW(voxelized(*scene, 4, "1.1,-0.1,-0.1,1.2,0,0"), UsageError);
    try {
        voxelized(*scene, 3);
        FAIL();
    } catch (const UsageError& e) {
        EXPECT_TRUE(std::string(e.what()).starts_with("--resolution")) << e.what();
    }
    stabilityCase("space-one-voxel", double(found.file.skeleton.nodes.size()), "node");
}

}  // namespace
}  // namespace lacuna::test
