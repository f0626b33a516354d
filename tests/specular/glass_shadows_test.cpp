// Where next event through glass is tried, and how often.
#include <gtest/gtest.h>

#include "libcore/specular/glass_boxes.h"
#include "libcore/specular/glass_shadows.h"
#include "tests/scene/scene_builder.h"

namespace lacuna::test {
namespace {

Vec3 random(Rng& rng, const Vec3& low, const Vec3& high) {
    const float x = rng.uniform(), y = rng.uniform(), z = rng.uniform();
    return {low.x + x * (high.x - low.x), low.y + y * (high.y - low.y),
            low.z + z * (high.z - low.z)};
}

/// A point lies in the shadow of the glass if a straight line from it to a lamp may meet that
/// glass.
TEST(GlassShadows, lieBehindAllGlass) {
    SceneBuilder b;
    b.add(quad({-9, 0, 5}, {18, 0, 0}, {0, 0, -10}));
    b.add(box({-4, 1, -0.4f}, {-3.2f, 1.5f, 0.4f}, b.add(glass())));
    b.add(box({2, 0, 2}, {2.1f, 2, 3}, b.add(glass(1.2f))));
    const auto lamp = b.add(emitter(Rgb(1.0f)));
    b.add(quad({-7, 3, 1}, {0, 0, 1}, {1, 0, 0}, lamp));
    b.add(quad({8, 2, 4}, {0, 1, 0}, {0, 0, 1}, lamp));
    const auto scene = b.build();
    const auto glass = glassInBoxes(*scene);
    const GlassBoxes boxes(glass);
    const GlassShadows shadows(*scene, glass);
    ASSERT_FALSE(shadows.empty());
    Rng rng(5, 0, StreamKind::User, 0);
    const Vec3 middle(scene->centre());
    const Vec3 half = scene->halfSize();
    int behind = 0, free = 0;
    for (int n = 0; n < 60000; ++n) {
        // Everywhere in the scene's space, including its border.
        Vec3 place = random(rng, -half, half);
        if (n % 9 == 0) place.y = -half.y;
        if (n % 9 == 1) place.x = half.x;
        const Vec3 at =
            n % 2 == 0 ? random(rng, {-7, 3, 1}, {-6, 3, 2}) : random(rng, {8, 2, 4}, {8, 3, 5});
        const bool meets = boxes.mayLieOn(place, at - middle - place, false);
        if (meets) {
            ++behind;
            EXPECT_TRUE(shadows.reach(place));
        }
        EXPECT_EQ(shadows.reach(place), shadows.triesAt(place) > 0.0);
        if (shadows.reach(place)) {
            EXPECT_GE(shadows.triesAt(place), GlassShadows::kLeast);
            EXPECT_LE(shadows.triesAt(place), 1.0);
        } else {
            ++free;
        }
    }
    EXPECT_GT(behind, 300);
    EXPECT_GT(free, 40000);
}

/// Glass that a lamp shines on, glass in the next room, and glass behind a lamp's back.
TEST(GlassShadows, areDeepWhereTheGlassIsLit) {
    SceneBuilder b;
    b.d.materials[0] = matte(Rgb(0.5f));
    b.add(box({-10, 0, -2}, {-9.9f, 4, 2}));
    b.add(box({-0.1f, 0, -2}, {0.1f, 4, 2}));
    b.add(box({9.9f, 0, -2}, {10, 4, 2}));
    for (const float x : {-5.0f, 5.0f}) {
        b.add(box({x - 1, 1, -1}, {x + 1, 1.1f, 1}, b.add(glass())));
    }
    b.add(quad({-6, 3, -1}, {2, 0, 0}, {0, 0, 2}, b.add(emitter(Rgb(1.0f)))));  // downwards
    b.add(box({-5.5f, 3.5f, -0.5f}, {-4.5f, 3.6f, 0.5f}, b.add(glass())));
    const auto scene = b.build();
    const GlassShadows shadows(*scene, glassInBoxes(*scene));
    const Vec3 middle(scene->centre());
    EXPECT_EQ(shadows.triesAt(Vec3{-5, 0.5f, 0} - middle), 1.0);
    EXPECT_EQ(shadows.triesAt(Vec3{9, 0.2f, 0} - middle), GlassShadows::kLeast);
    EXPECT_EQ(shadows.triesAt(Vec3{-5, 3.9f, 0} - middle), GlassShadows::kLeast);
    EXPECT_FALSE(shadows.reach(Vec3{-5, 2, 0} - middle));
}

/// A sky shines from all sides.
TEST(GlassShadows, areEverywhereUnderASky) {
    SceneBuilder b;
    b.add(quad({-9, 0, 5}, {18, 0, 0}, {0, 0, -10}));
    b.add(box({-4, 1, -0.4f}, {-3.2f, 1.5f, 0.4f}, b.add(glass())));
    const auto dark = b.build();
    EXPECT_TRUE(GlassShadows(*dark, glassInBoxes(*dark)).empty());
    b.d.environment = EnvironmentDescription{};
    b.d.environment->colour = Rgb(1.0f);
    const auto scene = b.build();
    const GlassShadows shadows(*scene, glassInBoxes(*scene));
    Rng rng(5, 0, StreamKind::User, 0);
    for (int n = 0; n < 1000; ++n) {
        EXPECT_EQ(shadows.triesAt(random(rng, -scene->halfSize(), scene->halfSize())), 1.0);
    }
}

}  // namespace
}  // namespace lacuna::test
