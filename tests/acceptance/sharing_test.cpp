// Walks that pixels share: no light is lost or counted twice, whatever the scene. (theory.md, "Shared walks")
#include <gtest/gtest.h>

#include "tests/acceptance/render_test.h"
#include "tests/acceptance/scenes.h"
#include "tests/stability.h"

namespace lacuna::test {
namespace {

Picture withShare(const Scene& scene, const char* share, Shot shot) {
    const MethodRow row = rowNamed("sharebpt");
    shot.settings.push_back(std::string("share=").append(share));
    return render(scene, row, shot);
}

class SharedWalks : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(All, SharedWalks, testing::Range(0, int(weightScenes().size())),
                         [](const testing::TestParamInfo<int>& test) {
                             return testName(weightScenes()[std::size_t(test.param)].name);
                         });

/// In groups of sixteen, and of four with guided walks. Paths go on behind the shared edge.
TEST_P(SharedWalks, haveTheMeanOfWalksAlone) {
    const NamedScene named = weightScenes()[std::size_t(GetParam())];
    const auto scene = named.builder.build();
    Shot shot;
    shot.iterations = 250;
    shot.maxDepth = 5;
    const Picture alone = withShare(*scene, "1", shot);
    shot.seed = 2;
    expectSame(withShare(*scene, "16", shot), alone, named.name + ", sixteen",
               Judge::BlocksAndMean);
    shot.seed = 3;
    shot.walkGuide = 7;
    expectSame(withShare(*scene, "4", shot), alone, named.name + ", four guided",
               Judge::BlocksAndMean);
}

/// Pixels beside each other look over and under a shelf that is lit on one side. A pixel that sees one side does not
/// see what lies on the other, and its walk could not have gone on from there.
TEST(SharedWalks, stayOnTheirSideOfAShelf) {
    SceneBuilder b;
    b.d.materials[0] = matte(Rgb(0.7f));
    b.add(box({-1, -1, -1}, {1, 1, 1}, 0, true));
    b.add(quad({-1, 0, 0.1f}, {2, 0, 0}, {0, 0, -1.1f}));
    b.add(quad({-0.3f, 0.99f, -0.7f}, {0.6f, 0, 0}, {0, 0, 0.4f}, b.add(emitter(Rgb(5.0f)))));
    b.add(lookAt({0, 0, 0.9}, {0, 0, -1}, 30));
    const auto scene = b.build();
    Shot shot;
    shot.iterations = 800;
    const Picture alone = withShare(*scene, "1", shot);
    shot.seed = 2;
    expectSame(withShare(*scene, "16", shot), alone, "shelf");
}

/// A walk may have lost one colour or all of them: the pixels that share it still get them.
TEST(SharedWalks, carryColoursThatTheirOwnersLack) {
    for (const Rgb& walls : {Rgb(0.9f), Rgb(0, 0.9f, 0.3f)}) {
        const auto scene = tilesOfPureColours(walls).build();
        Shot shot;
        shot.iterations = 700;
        shot.maxDepth = 8;
        const Picture alone = withShare(*scene, "1", shot);
        shot.seed = 2;
        expectSame(withShare(*scene, "16", shot), alone,
                   walls.r > 0 ? "white walls" : "green walls");
    }
    stabilityCase("pure-colours", worstDeviation(), kOfAllowed);
}

/// The picture's border cuts squares of pixels, and a crop of one line cuts all of them.
TEST(SharedWalks, ofACropAreThoseOfTheWholePicture) {
    const auto scene = diffuseBox().builder.build();
    Shot shot;
    shot.width = 18;
    shot.height = 15;
    shot.iterations = 3;
    shot.lightPaths = 1;  // as many for the crop as for the whole
    shot.settings = {"emission=plain"};
    MethodRow row = rowNamed("sharebpt");
    row.techniques.splats = false;
    const Image whole = render(*scene, row, shot).pixels.image();
    shot.crop = {5, 12, 3, 4};
    const Image part = render(*scene, row, shot).pixels.image();
    for (int x = shot.crop.x0; x < shot.crop.x1; ++x) {
        EXPECT_EQ(part.at(x - shot.crop.x0, 0), whole.at(x, 3)) << x;
    }
}

/// Less noise is what sharing is for.
TEST(SharedWalks, areLessNoisy) {
    const auto scene = diffuseBox().builder.build();
    Shot shot;
    shot.width = shot.height = 64;
    shot.iterations = 16;
    const auto noise = [&](const char* share) {
        const Picture picture = withShare(*scene, share, shot);
        const Image variance = picture.pixels.variance();
        double sum = 0;
        for (int y = 0; y < shot.height; ++y) {
            for (int x = 0; x < shot.width; ++x) sum += mean(variance.at(x, y));
        }
        return sum;
    };
    EXPECT_LT(noise("16"), 0.9 * noise("1"));
}

}  // namespace
}  // namespace lacuna::test
