// What can be seen while a picture is rendered: --display-server and --write-every. No viewer
// changes the picture.
#include <signal.h>

#include <algorithm>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <thread>

#include "libcore/base/error.h"
#include "libcore/image/exr.h"
#include "libcore/image/image_io.h"
#include "render/live/layer_names.h"
#include "render/live/live_view.h"
#include "render/live/tev_packets.h"
#include "tests/fixtures/render_tool.h"
#include "tests/render/tev_double.h"

namespace lacuna::test {
namespace {

using std::chrono::milliseconds;
using Manner = TevDouble::Manner;

/// Tries until it succeeds, for at most two minutes.
bool comesAbout(const std::function<bool()>& wanted) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(120);
    while (std::chrono::steady_clock::now() < end) {
        if (wanted()) return true;
        std::this_thread::sleep_for(milliseconds(5));
    }
    return false;
}

TEST(ServerAddresses, haveAHostAPortOrBoth) {
    const auto of = [](const char* text) { return parseServerAddress("--display-server", text); };
    EXPECT_EQ(of("there:7"), (ServerAddress{"there", 7}));
    EXPECT_EQ(of("there"), (ServerAddress{"there", 14158}));
    EXPECT_EQ(of(":7"), (ServerAddress{"localhost", 7}));
    EXPECT_EQ(of("127.0.0.1:65535"), (ServerAddress{"127.0.0.1", 65535}));
    EXPECT_EQ(of("[::1]"), (ServerAddress{"::1", 14158}));
    EXPECT_EQ(of("[fe80::1%eth0]:7").text(), "[fe80::1%eth0]:7");
    for (const char* text : {"", ":", "a:", "a:0", "a:65536", "a:-1", "a:1x", "::1", "[::1", "[]",
                             "[a]", "[::1]7", "a b", "http://a:1", "a:1:2", "a/b"}) {
        EXPECT_THROW(of(text), UsageError) << text;
    }
}

/// The bytes are those of tev's protocol.
TEST(TevPackets, areWrittenAsTevReadsThem) {
    const auto bytes = [](const Packet& packet) {
        std::string text;
        for (const std::byte b : packet) text += char(b);
        return text;
    };
    const TevImage image{"a", 2, 3, {"R", "Z"}};
    using namespace std::string_literals;
    EXPECT_EQ(bytes(createImage(image)),
              "\x18\0\0\0\x04\x01"
              "a\0\x02\0\0\0\x03\0\0\0\x02\0\0\0R\0Z\0"s);
    const std::vector<float> r{0, 0, 0, 0, 0, 1}, z{0, 0, 0, 0, 0, -2};
    const std::vector<float>* const planes[] = {&r, &z};
    EXPECT_EQ(bytes(updateImage(image, {1, 2, 2, 3}, planes)),
              "\x48\0\0\0\x06\0"
              "a\0\x02\0\0\0R\0Z\0"s
              "\x01\0\0\0\x02\0\0\0\x01\0\0\0\x01\0\0\0"s
              "\0\0\0\0\0\0\0\0\x01\0\0\0\0\0\0\0"s
              "\x01\0\0\0\0\0\0\0\x01\0\0\0\0\0\0\0"s
              "\0\0\x80\x3f\0\0\0\xc0"s);
}

TEST(TevPackets, tilesCoverAnImageInOrderAndAreOfABoundedSize) {
    for (const auto& [width, height] :
         {std::pair{1, 1}, {24, 16}, {1280, 720}, {65536, 2}, {1, 65536}, {333, 777}}) {
        for (const std::size_t channels : {1u, 3u, 13u, 600u}) {
            std::vector<bool> seen(std::size_t(width) * std::size_t(height));
            std::size_t covered = 0;
            std::pair<int, int> last{-1, -1};
            for (const PixelRect& t :
                 tilesOf({"", width, height, std::vector<std::string>(channels)})) {
                EXPECT_LE(std::size_t(t.width()) * std::size_t(t.height()) * channels, 65536u);
                EXPECT_LT(last, std::pair(t.y0, t.x0));
                last = {t.y0, t.x0};
                for (int y = t.y0; y < t.y1; ++y) {
                    for (int x = t.x0; x < t.x1; ++x) {
                        const std::size_t i = std::size_t(y) * std::size_t(width) + std::size_t(x);
                        covered += seen.at(i) ? 0 : 1;
                        seen[i] = true;
                    }
                }
            }
            EXPECT_EQ(covered, seen.size()) << width << " x " << height << ", " << channels;
        }
    }
}

TEST(LayerNames, standForTheirChannels) {
    const std::vector<std::string> there{"variance.R", "variance.G", "variance.B",
                                         "Z",          "share.t02",  "weighted.s00t02.R"};
    const auto of = [&](const std::vector<std::string>& layers) {
        return channelsOfLayers("--display-layers", layers, there);
    };
    using Names = std::vector<std::string>;
    EXPECT_EQ(of({}), (Names{"R", "G", "B"}));
    EXPECT_EQ(of({"share.t02", "Z", "Z"}), (Names{"R", "G", "B", "share.t02", "Z"}));
    EXPECT_EQ(of({"variance"}), (Names{"R", "G", "B", "variance.R", "variance.G", "variance.B"}));
    EXPECT_EQ(of({"weighted.s00t02"}), (Names{"R", "G", "B", "weighted.s00t02.R"}));
    for (const char* unknown : {"Variance", "weighted", "share", "z", ""}) {
        try {
            of({unknown});
            ADD_FAILURE() << unknown;
        } catch (const UsageError& e) {
            EXPECT_NE(std::string(e.what()).find("variance, Z, share.t02, weighted.sSStTT"),
                      std::string::npos)
                << e.what();
        }
    }
}

class LiveViews : public ::testing::Test {
  protected:
    static constexpr int kWidth = 2000, kHeight = 1000;  // 24 MB: more than sockets hold

    static LayeredImage grey(float value) {
        LayeredImage image(kWidth, kHeight);
        image.setRgb("", Image(kWidth, kHeight, Rgb{value, 2 * value, 3 * value}));
        return image;
    }
    std::unique_ptr<LiveView> view(const TevDouble& tev, const LiveView::Timing& timing = {}) {
        return std::make_unique<LiveView>(
            ServerAddress{"127.0.0.1", tev.port()},
            TevImage{"grey", kWidth, kHeight, {"R", "G", "B"}},
            [this](const std::string& text) { told_.push_back(text); }, timing);
    }
    static void expectGrey(const TevDouble& tev, float value) {
        const TevDouble::State state = tev.state();
        EXPECT_EQ(state.fault, "");
        const auto& channels = state.pictures.at("grey").channels;
        for (const auto& [name, factor] : {std::pair("R", 1.0f), {"G", 2.0f}, {"B", 3.0f}}) {
            EXPECT_EQ(std::ranges::count(channels.at(name), factor * value), kWidth * kHeight)
                << name;
        }
    }

    std::vector<std::string> told_;
};

TEST_F(LiveViews, askOnceAndSendWhatTheyGet) {
    const TevDouble tev;
    LiveView::Timing timing;
    timing.share = 1.0;
    const auto live = view(tev, timing);
    ASSERT_TRUE(comesAbout([&] { return live->wants(); }));
    live->show(grey(1), LiveView::Seconds(0));
    EXPECT_FALSE(live->wants());
    ASSERT_TRUE(comesAbout([&] { return live->wants(); }));
    live->showLast(grey(2));
    live->leave();
    EXPECT_TRUE(tev.waitFor(
        [&](const auto& s) { return s.pictures.at("grey").channels.at("B").back() == 6.0f; }));
    expectGrey(tev, 2);
    EXPECT_EQ(tev.state().created, 1);
    EXPECT_TRUE(told_.empty());
}

/// A picture of 1000 s is the last one for 2000 s at a share of 1/2.
TEST_F(LiveViews, costNoMoreThanTheirShare) {
    const TevDouble tev;
    LiveView::Timing timing;
    timing.share = 0.5;
    const auto live = view(tev, timing);
    ASSERT_TRUE(comesAbout([&] { return live->wants(); }));
    live->show(grey(1), LiveView::Seconds(1000));
    ASSERT_TRUE(tev.waitForPicture("grey"));
    std::this_thread::sleep_for(milliseconds(1500));
    EXPECT_FALSE(live->wants());
}

TEST_F(LiveViews, doNotWaitForAViewerThatHangs) {
    const TevDouble tev(Manner::NeverReads);
    LiveView::Timing timing;
    timing.farewell = LiveView::Seconds(0.3);
    const auto live = view(tev, timing);
    ASSERT_TRUE(comesAbout([&] { return live->wants(); }));
    live->show(grey(1), LiveView::Seconds(0));
    std::this_thread::sleep_for(milliseconds(500));
    EXPECT_FALSE(live->wants());  // no more pictures for a viewer that takes none
    live->showLast(grey(2));
    const auto before = std::chrono::steady_clock::now();
    live->leave();
    EXPECT_LT(std::chrono::steady_clock::now() - before, std::chrono::seconds(10));
    ASSERT_EQ(told_.size(), 1u);
    EXPECT_NE(told_[0].find("last picture within 0.3 s"), std::string::npos) << told_[0];
}

/// When the last picture comes, no more of an older one is sent than the sockets already hold.
TEST_F(LiveViews, sendTheLastPictureInPlaceOfAnOlderOne) {
    TevDouble tev(Manner::NeverReads);
    LiveView::Timing timing;
    timing.farewell = LiveView::Seconds(100);
    const auto live = view(tev, timing);
    ASSERT_TRUE(comesAbout([&] { return live->wants(); }));
    live->show(grey(1), LiveView::Seconds(0));
    std::this_thread::sleep_for(milliseconds(200));
    live->showLast(grey(2));
    tev.setManner(Manner::Reads);
    live->leave();
    EXPECT_TRUE(tev.waitFor(
        [&](const auto& s) { return s.pictures.at("grey").channels.at("B").back() == 6.0f; }));
    expectGrey(tev, 2);
    const auto tiles = tilesOf({"grey", kWidth, kHeight, {"R", "G", "B"}}).size();
    EXPECT_LT(std::size_t(tev.state().pictures.at("grey").updates), 2 * tiles);
    EXPECT_TRUE(told_.empty());
}

TEST_F(LiveViews, leaveAViewerThatTakesNothingAndTryAgain) {
    const TevDouble tev(Manner::NeverReads);
    LiveView::Timing timing;
    timing.stall = timing.again = LiveView::Seconds(0.1);
    timing.farewell = LiveView::Seconds(0.1);
    const auto live = view(tev, timing);
    EXPECT_TRUE(comesAbout([&] {
        if (live->wants()) live->show(grey(1), LiveView::Seconds(0));
        return tev.state().connections >= 3;
    }));
    live->leave();
    EXPECT_GE(told_.size(), 1u);
    EXPECT_EQ(std::ranges::count_if(
                  told_, [](const std::string& t) { return t.find("to stay at") != t.npos; }),
              1);
}

class RenderLive : public RenderTool {
  protected:
    std::string server(const TevDouble& tev) const {
        return " --display-server 127.0.0.1:" + std::to_string(tev.port()) + " ";
    }
    /// An endless render of two tiles.
    std::string endless(const std::string& more) const {
        return "@room.gltf -o @out.exr --method pt --width 200 --height 150 --max-depth 4 --quiet "
               "--time 1h " +
               more;
    }
    Outcome interrupt(pid_t child) const {
        kill(child, SIGINT);
        return end(child);
    }
    /// Expects the viewer to have the file's pixels, to the last bit.
    void expectShown(const TevDouble& tev, const std::vector<std::string>& channels) const {
        const LayeredImage file = readExrLayers(path("out.exr"));
        const auto same = [&](const TevDouble::State& state) {
            const auto found = state.pictures.find(path("out.exr"));
            if (found == state.pictures.end()) return false;
            const TevDouble::Picture& picture = found->second;
            return picture.channels.size() == channels.size() && picture.width == file.width() &&
                   picture.height == file.height() &&
                   std::ranges::all_of(channels, [&](const std::string& c) {
                       return picture.channels.contains(c) && file.find(c) &&
                              picture.channels.at(c) == *file.find(c);
                   });
        };
        // What has been sent may still be on its way.
        const bool shown =
            comesAbout([&] { return same(tev.state()) || !tev.state().fault.empty(); });
        EXPECT_EQ(tev.state().fault, "");
        EXPECT_TRUE(shown);
        float most = 0.0f;
        for (const float v : *file.find("G")) most = std::max(most, v);
        EXPECT_GT(most, 0.0f);
    }
    /// Compares all channels and all attributes, except times and the command line.
    void expectSameFile(const std::string& a, const std::string& b) const {
        LayeredImage one = readExrLayers(path(a)), other = readExrLayers(path(b));
        EXPECT_TRUE(one.channels() == other.channels()) << a << " and " << b;
        for (LayeredImage* image : {&one, &other}) {
            for (const char* name : {"commandLine", "renderTimeSeconds", "setupTimeSeconds"}) {
                image->attributes.erase(name);
            }
        }
        EXPECT_EQ(one.attributes, other.attributes);
    }
};

TEST_F(RenderLive, theViewerEndsWithThePictureOfTheFile) {
    const TevDouble tev;
    const Outcome o = run(quick("bpt", "--quiet --width 200 --height 150" + server(tev)));
    EXPECT_EQ(o.exitCode, 0);
    EXPECT_EQ(o.err, "");
    expectShown(tev, {"R", "G", "B"});
    EXPECT_EQ(tev.state().connections, 1);
}

TEST_F(RenderLive, layersAreShownByName) {
    for (const char* method : {"icbpt", "skelbpt"}) {
        const TevDouble tev;
        const bool nodes = std::string(method) == "skelbpt";
        const Outcome o =
            run(quick(method, "--quiet --techniques" + server(tev) +
                                  "--display-layers variance,albedo,normal,Z,weighted.s02t02,"
                                  "unweighted.s00t03,share.t02" +
                                  (nodes ? ",node" : "")));
        ASSERT_EQ(o.exitCode, 0) << o.err;
        std::vector<std::string> channels{"R",         "G",        "B",        "Z",
                                          "share.t02", "normal.X", "normal.Y", "normal.Z"};
        for (const std::string layer :
             {"variance", "albedo", "weighted.s02t02", "unweighted.s00t03"}) {
            for (const char* part : {".R", ".G", ".B"}) channels.push_back(layer + part);
        }
        if (nodes) channels.insert(channels.end(), {"node.R", "node.G", "node.B"});
        expectShown(tev, channels);
    }
}

TEST_F(RenderLive, layersThatAreNotThereExitWith2) {
    const auto command = [&](const std::string& layers) {
        return quick("pt", "--quiet --display-server :1 --display-layers " + layers);
    };
    expectFailure(command("variance,depth"), 2, "'depth'");
    expectFailure(command("depth"), 2, "variance, Z, albedo, normal");
    expectFailure(command("weighted.s00t02"), 2, "'weighted.s00t02'");
    expectFailure(command("weighted.s00t99 --techniques"), 2, "weighted.sSStTT");
    EXPECT_FALSE(exists("out.exr"));
}

TEST_F(RenderLive, aCropHasItsOwnSize) {
    const TevDouble tev;
    ASSERT_EQ(run(quick("pt", "--quiet --crop 3,20,5,9" + server(tev))).exitCode, 0);
    expectShown(tev, {"R", "G", "B"});
    EXPECT_EQ(tev.state().pictures.at(path("out.exr")).width, 17);
}

TEST_F(RenderLive, aViewerMayComeLater) {
    TevDouble tev(Manner::Absent);
    const pid_t child = start(endless(server(tev)));
    EXPECT_TRUE(
        comesAbout([&] { return read("stderr.txt").find("refused") != std::string::npos; }));
    tev.setManner(Manner::Reads);
    EXPECT_TRUE(tev.waitForPicture(path("out.exr")));
    const Outcome o = interrupt(child);
    EXPECT_EQ(o.exitCode, 130);
    EXPECT_EQ(std::ranges::count(o.err, '\n'), 1) << o.err;
    expectShown(tev, {"R", "G", "B"});
}

TEST_F(RenderLive, aViewerMayGoAwayInTheMiddleOfATileAndComeBack) {
    const TevDouble tev(Manner::LeavesEarly);
    const pid_t child = start(endless(server(tev)));
    EXPECT_TRUE(tev.waitFor([](const auto& s) { return s.connections == 2; }));
    EXPECT_TRUE(tev.waitForPicture(path("out.exr")));
    const Outcome o = interrupt(child);
    EXPECT_EQ(o.exitCode, 130);
    EXPECT_EQ(std::ranges::count(o.err, '\n'), 1) << o.err;
    EXPECT_NE(o.err.find("to stay at"), std::string::npos) << o.err;
    expectShown(tev, {"R", "G", "B"});
}

TEST_F(RenderLive, noViewerChangesThePicture) {
    const std::string command = quick("pt", "--quiet --width 900 --height 600 --max-depth 3 ");
    ASSERT_EQ(run(command).exitCode, 0);
    std::filesystem::rename(path("out.exr"), path("alone.exr"));
    const TevDouble hangs(Manner::NeverReads), away(Manner::Absent);
    const std::pair<std::string, const char*> viewers[] = {
        {server(hangs), "last picture"},
        {server(away), "Connection refused"},
        {" --display-server nobody.invalid ", "nobody.invalid:14158"},
    };
    for (const auto& [option, says] : viewers) {
        const Outcome o = run(command + option + "--write-every 0.01s");
        EXPECT_EQ(o.exitCode, 0) << o.err;
        EXPECT_EQ(std::ranges::count(o.err, '\n'), 1) << o.err;
        EXPECT_NE(o.err.find(says), std::string::npos) << o.err;
        expectSameFile("out.exr", "alone.exr");
    }
}

TEST_F(RenderLive, theFileIsNewerAgainAndAgainAndAlwaysWhole) {
    const TevDouble tev;
    const pid_t child = start(endless("--techniques --write-every 0.05s" + server(tev)));
    std::vector<int> iterations;
    EXPECT_TRUE(comesAbout([&] {
        if (!exists("out.exr")) return false;
        const LayeredImage image = readExrLayers(path("out.exr"));
        EXPECT_EQ(std::get<std::string>(image.attributes.at("stopped")), "no: still rendering");
        for (const char* name : {"variance.G", "albedo.G", "normal.X", "Z", "share.t02"}) {
            EXPECT_NE(image.find(name), nullptr) << name;
        }
        const int n = std::get<int>(image.attributes.at("iterations"));
        if (iterations.empty() || iterations.back() != n) iterations.push_back(n);
        return iterations.size() == 5;
    }));
    EXPECT_TRUE(std::ranges::is_sorted(iterations));
    const Outcome o = interrupt(child);
    EXPECT_EQ(o.exitCode, 130) << o.err;
    EXPECT_EQ(o.err, "");
    EXPECT_TRUE(temporaries().empty());
    expectShown(tev, {"R", "G", "B"});

    // The file is the same as that of an undisturbed render.
    const LayeredImage last = readExrLayers(path("out.exr"));
    EXPECT_EQ(std::get<std::string>(last.attributes.at("stopped")), "interrupt");
    const int n = std::get<int>(last.attributes.at("iterations"));
    EXPECT_GE(n, iterations.back());
    ASSERT_EQ(run(endless("--techniques --iterations " + std::to_string(n))).exitCode, 0);
    EXPECT_TRUE(last.channels() == readExrLayers(path("out.exr")).channels());
}

TEST_F(RenderLive, otherFormatsAreWrittenAnewAsWell) {
    for (const char* name : {"out.png", "out.pfm"}) {
        std::string command = endless("--write-every 0.05s");
        command.replace(command.find("@out.exr"), 8, std::string("@") + name);
        const pid_t child = start(command);
        std::vector<std::string> contents;
        EXPECT_TRUE(comesAbout([&] {
            if (!exists(name)) return false;
            EXPECT_EQ(readImage(path(name)).width, 200);
            const std::string bytes = read(name);
            if (contents.empty() || contents.back() != bytes) contents.push_back(bytes);
            return contents.size() == 3;
        })) << name;
        EXPECT_EQ(interrupt(child).exitCode, 130);
        EXPECT_TRUE(temporaries().empty());
    }
}

/// For a while, a folder is in the place of the file.
TEST_F(RenderLive, aFileThatCannotBeWrittenIsAWarning) {
    const pid_t child = start(endless("--write-every 0.05s"));
    EXPECT_TRUE(comesAbout([&] { return exists("out.exr"); }));
    EXPECT_TRUE(comesAbout([&] {
        std::error_code ignored;
        std::filesystem::remove(path("out.exr"), ignored);
        return std::filesystem::create_directory(path("out.exr"), ignored);
    }));
    EXPECT_TRUE(comesAbout(
        [&] { return read("stderr.txt").find("the render goes on") != std::string::npos; }));
    std::filesystem::remove(path("out.exr"));
    const Outcome o = interrupt(child);
    EXPECT_EQ(o.exitCode, 130) << o.err;
    EXPECT_EQ(std::get<std::string>(readExrLayers(path("out.exr")).attributes.at("stopped")),
              "interrupt");
}

/// All options together that write or show something.
TEST_F(RenderLive, everythingTogetherIsThePicture) {
    for (const char* method : {"bpt", "icbpt", "spcbpt"}) {
        const auto command = [&](const std::string& name, const std::string& more) {
            std::string text = quick(method,
                                     "--quiet --techniques --iterations 6 "
                                     "--block-iterations 4 " +
                                         more);
            return text.replace(text.find("@out.exr"), 8, "@" + name);
        };
        const TevDouble tev;
        const std::string live = server(tev) + "--write-every 0.001s --display-layers variance ";
        ASSERT_EQ(run(command("alone.exr", "")).exitCode, 0);
        ASSERT_EQ(run(command("a.exr", "--blocks 0,1 --checkpoint @ck" + live)).exitCode, 0);
        ASSERT_EQ(run(command("b.exr", "--blocks 1,2" + live)).exitCode, 0);
        ASSERT_EQ(run("@a.exr @b.exr -o @out.exr", LACUNA_MERGE).exitCode, 0);
        expectSameFile("out.exr", "alone.exr");
        EXPECT_EQ(tev.state().pictures.size(), 2u);
        EXPECT_EQ(tev.state().fault, "");
        std::filesystem::remove(path("ck"));
    }
}

}  // namespace
}  // namespace lacuna::test
