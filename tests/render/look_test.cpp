// Looking at the result without other tools: exposure and tone of a .png, the sheet of all layers.
#include <nlohmann/json.hpp>

#include "libcore/image/exr.h"
#include "libcore/image/image_io.h"
#include "tests/fixtures/render_tool.h"

namespace lacuna::test {
namespace {

class RenderLook : public RenderTool {
  protected:
    std::string command(const std::string& more) const {
        return "@room.gltf --method bpt --width 24 --height 16 --iterations 4 --max-depth 4 " +
               more;
    }
};

TEST_F(RenderLook, aPngIsExposedByItself) {
    const Outcome o = run(command("-o @a.png --json @o.json"));
    ASSERT_EQ(o.exitCode, 0) << o.err;
    const double stops = json("o.json").at("exposure");
    EXPECT_NE(o.err.find("--exposure auto: "), std::string::npos) << o.err;
    EXPECT_NE(stops, 0.0);
    ASSERT_EQ(run(command("-o @b.png --quiet --tone filmic --exposure " + std::to_string(stops)))
                  .exitCode,
              0);
    EXPECT_EQ(read("a.png"), read("b.png"));
    // The exposure is the one that the linear picture asks for.
    ASSERT_EQ(run(command("-o @a.exr --quiet")).exitCode, 0);
    EXPECT_NEAR(stops, automaticExposure(readExr(path("a.exr"))), 0.006);
    for (const char* other : {"--tone standard", "--exposure 0", "--png-bits 16"}) {
        ASSERT_EQ(run(command(std::string("-o @b.png --quiet ") + other)).exitCode, 0);
        EXPECT_NE(read("a.png"), read("b.png")) << other;
    }
}

TEST_F(RenderLook, valuesOfAnExrKnowNothingOfIt) {
    ASSERT_EQ(run(command("-o @a.exr --quiet")).exitCode, 0);
    ASSERT_EQ(run(command("-o @b.exr --quiet --tone standard --exposure 3 --png-bits 16 --sheet "
                          "@sheet.png"))
                  .exitCode,
              0);
    expectSamePicture("a.exr", "b.exr");
}

TEST_F(RenderLook, theSheetHasEveryLayer) {
    ASSERT_EQ(run(command("-o @a.pfm --quiet --sheet @few.png")).exitCode, 0);
    ASSERT_EQ(run(command("-o @a.pfm --quiet --sheet @many.png --techniques")).exitCode, 0);
    const auto area = [&](const char* name) {
        const Image image = readImage(path(name));
        return image.width * image.height;
    };
    EXPECT_GT(area("few.png"), 5 * 24 * 16);  // the picture and four layers
    EXPECT_GT(area("many.png"), 2 * area("few.png"));
    // The sums in a part's file are no layers.
    ASSERT_EQ(run(command("-o @part.exr --quiet --sheet @part.png --blocks 0,1")).exitCode, 0);
    EXPECT_EQ(area("part.png"), area("few.png"));
}

TEST_F(RenderLook, errorsAreUsage) {
    const std::string start = "@none.glb -o @a.png --method pt ";
    for (const auto& [option, part] :
         {std::pair("--tone vivid", "filmic"), std::pair("--exposure bright", "auto"),
          std::pair("--png-bits 12", "8 or 16"), std::pair("--sheet @sheet.exr", ".png"),
          std::pair("--sheet @a.png", "file of its own"),
          std::pair("--estimate --sheet @b.png", "--sheet")}) {
        expectFailure(start + option, 2, part);
    }
}

}  // namespace
}  // namespace lacuna::test
