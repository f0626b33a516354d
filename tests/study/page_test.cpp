// index.html in a real browser: headless Chromium, with a script of the test in the page.
#include <cstdlib>

#include "render/study/embed.h"
#include "tests/study/study_tool.h"

namespace lacuna::test {
namespace {

TEST(StudyPictures, Base64AndShrinking) {
    EXPECT_EQ(base64(""), "");
    EXPECT_EQ(base64("f"), "Zg==");
    EXPECT_EQ(base64("fo"), "Zm8=");
    EXPECT_EQ(base64("foob\xff"), "Zm9vYv8=");
    Image image(5, 3);
    for (std::size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] = Rgb(float(i));
    const Image small = shrunk(image, 2);
    ASSERT_EQ(small.width, 2);
    ASSERT_EQ(small.height, 1);
    EXPECT_EQ(small.at(0, 0).r, 3.0f);  // 0 1 5 6
    EXPECT_EQ(small.at(1, 0).b, 5.0f);  // 2 3 7 8
}

TEST(StudyPictures, PixelsAreHalvesTimesAPowerOfTwo) {
    Image image(1, 1);
    image.pixels[0] = {0.25f, -1.0f, 1e30f};
    // 1.0, -4.0 and the largest half: 3c00, c400, 7bff, low bytes first.
    EXPECT_EQ(pixelsText(image, 2), base64(std::string("\x00\x3c\x00\xc4\xff\x7b", 6)));
    EXPECT_EQ(stopsFor(0.25), 1);
    EXPECT_EQ(stopsFor(0.0), 0);
    EXPECT_EQ(shrinkFactor(1000.0, 8000.0), 1);
    EXPECT_EQ(shrinkFactor(1001.0, 8000.0), 2);
    EXPECT_EQ(shrinkFactor(1000.0, 801.0), 4);
}

class StudyPageSlow : public StudyTool {
  protected:
    /// Comes first in the page and records all faults.
    static constexpr const char* kBefore = R"(<script>
        const faults = [];
        addEventListener('error', e => faults.push('error: ' + e.message));
        addEventListener('securitypolicyviolation', e => faults.push('asked for ' + e.blockedURI));
        </script>)";

    /// Comes last in the page: uses it as a reader would, and reports the faults.
    static constexpr const char* kAfter = R"(<script>
        try {
        const expect = (truth, text) => { if (!truth) faults.push(text); };
        const key = k => document.body.dispatchEvent(
            new KeyboardEvent('keydown', {key: k, bubbles: true}));
        const choose = (id, value) => {
            const select = document.getElementById(id);
            select.value = value;
            select.dispatchEvent(new Event('change'));
        };
        const visible = () => [...document.querySelectorAll('#pictures figure')].filter(
            f => f.offsetParent !== null);
        const pixels = view => view.getContext('2d').getImageData(0, 0, view.width, view.height)
            .data.join();

        study.measures.forEach((measure, i) => {
            choose('measure', i);
            for (const id of ['plot-time', 'plot-iterations']) {
                study.methods.forEach((method, m) => {
                    const chart = charts[id];
                    const at = chart.data.datasets.findIndex(d => d.method === m && !d.edge);
                    const marks = chart.getDatasetMeta(at).data;
                    expect(marks.length > 0 && marks.every(p => isFinite(p.x) && isFinite(p.y)),
                           `${id}: no marks of ${method.name} for ${measure}`);
                });
            }
            for (const chart of Object.values(charts)) {
                const marks = chart.data.datasets.flatMap((d, k) => chart.getDatasetMeta(k).data);
                expect(marks.length > 0, `${chart.canvas.id}: empty for ${measure}`);
                const image = chart.ctx.getImageData(0, 0, chart.width, chart.height).data;
                expect(image.some(v => v > 0), `${chart.canvas.id}: nothing drawn`);
            }
        });
        choose('measure', study.measures.indexOf('mape'));
        expect(document.querySelectorAll('#plot-knob-0').length === 1, 'no knob plot');
        const knob = study.knobs[0].mape[0];
        expect(knob.iterations === 6 && knob.iteration_errors.every((e, i) => {
            const last = study.runs.filter(r => r.method === 1 + i).map(r => r.error.mape);
            return Math.abs(e.low / Math.min(...last) - 1) < 1e-6 &&
                   Math.abs(e.high / Math.max(...last) - 1) < 1e-6;
        }), 'knob at equal iterations');
        expect(charts['plot-knob-iterations-0'].data.datasets[0].data.every(v => v > 0),
               'knob at equal iterations is not drawn');
        expect(document.querySelectorAll('#tables table').length >= 4, 'tables are missing');
        expect(document.querySelector('#tables').textContent.includes('not reached'),
               'a bound that was not reached is not said to be');
        expect(document.querySelectorAll('#runs tr').length === study.runs.length + 1, 'runs');
        expect(document.querySelector('h1').textContent === 'A study <of> tests', 'title');
        expect([...document.querySelectorAll('#about p')].map(p => p.textContent).join('|') ===
               'pt is <what> lvcbpt is not.|Twice.', 'what the study is about');

        expect(visible().length === study.methods.length + 1, 'pictures are not side by side');
        const shown = visible();
        expect(pixels(shown[0].querySelector('canvas')) !== pixels(shown[1].querySelector('canvas')),
               'pictures are all the same');
        expect(pixels(shown[1].querySelector('canvas')) !== pixels(shown[2].querySelector('canvas')),
               'pictures of methods are all the same');

        // The crop "part" is the picture's own pixels, enlarged.
        const scene = pictureData[0], [whole, part] = scene.crops;
        expect(document.querySelectorAll('.crop-row').length === 2, 'rows of crops');
        expect(document.querySelectorAll('.crop-row figure').length ===
               2 * (study.methods.length + 1), 'crops are not side by side');
        part.pictures.forEach((crop, i) => {
            const [x, y, width, height] = part.rect, rows = [];
            for (let row = y; row < y + height; ++row) {
                const at = 3 * (row * scene.width + x);
                rows.push(...scene.pictures[i].halves.slice(at, at + 3 * width));
            }
            expect(rows.join() === crop.halves.join(), `crop of ${crop.name}: other pixels`);
            expect(crop.view.offsetWidth > width, 'crops are not enlarged');
        });
        const mape = study.runs.find(r => r.method === 0 && r.seed === study.seeds[0]).error.mape;
        expect(document.querySelector('#crops').textContent.includes(
               `pt\n${errorsText(whole.pictures[1].errors)}`), 'errors beneath crops');
        expect(Math.abs(whole.pictures[1].errors.mape / mape - 1) < 1e-6,
               'error of a crop that is the whole picture');
        expect(document.querySelector('#tables').textContent.includes('inside the crops'),
               'no table of crops');

        // Techniques: a row per length; of pt, without refractions, only those with no light vertex but y_0.
        const pyramid = document.getElementById('pyramid');
        const cells = () => [...pyramid.querySelectorAll('figure:not(.none)')];
        expect(pyramid.querySelectorAll('.pyramid-row').length === 4, 'rows of the pyramid');
        expect(pyramid.querySelectorAll('figure').length === 2 + 3 + 4 + 5, 'cells of the pyramid');
        const ofPt = cells().length;
        expect(ofPt > 0 && cells().every(f => /s = [01], /.test(f.textContent)), 'layers of pt');
        choose('pyramid-method', 1);
        expect(cells().length > ofPt && cells().some(f => f.textContent.includes('s = 2, t = 2')),
               'layers of lvcbpt');
        expect(document.querySelector('#pyramid-command').textContent.includes('lvcbpt'),
               'command line of the pyramid');
        for (const p of scene.techniques.pyramids) {
            const sum = p.layers.reduce((total, layer) => total + layer.share, p.longer);
            expect(Math.abs(sum - 1) < 1e-5 && p.longer > 0, `shares of ${p.name}: ${sum}`);
        }
        const direct = () => cells().find(f => f.textContent.includes('s = 1, t = 2'))
            .querySelector('canvas');
        const adds = pixels(direct());
        choose('pyramid-show', 'noise');
        expect(pixels(direct()) !== adds, 'noise of layers');
        choose('pyramid-show', 'adds');
        expect(pixels(direct()) === adds, 'layers after their noise');
        const costs = document.getElementById('technique-costs').textContent;
        expect(['splats', 'hits', 'direct', 'connections', 'eye walks'].every(n => costs.includes(n)),
               `groups of techniques: ${costs}`);
        const bright = direct();
        const before = [pixels(bright), pixels(part.pictures[1].view)];
        key('-');
        expect(pixels(bright) !== before[0], 'exposure of layers');
        expect(pixels(part.pictures[1].view) !== before[1], 'exposure of crops');
        key('0');
        expect(pixels(bright) === before[0], 'exposure of layers does not go back');
        key('ArrowRight');
        expect(visible().length === 1 && visible()[0] === shown[1], 'right arrow does not flip');
        key('ArrowLeft');
        expect(visible()[0] === shown[0], 'left arrow does not flip back');
        key('3');
        expect(visible()[0] === shown[2], 'digits do not flip');
        const view = visible()[0].querySelector('canvas');
        let last = pixels(view);
        const changed = text => { const now = pixels(view); expect(now !== last, text); last = now; };
        view.dispatchEvent(new WheelEvent('wheel', {deltaY: -480, clientX:
            view.getBoundingClientRect().left + 5, clientY: view.getBoundingClientRect().top + 5}));
        changed('the wheel does not zoom');
        view.dispatchEvent(new PointerEvent('pointerdown', {clientX: 100, clientY: 100}));
        dispatchEvent(new PointerEvent('pointermove', {clientX: 60, clientY: 80}));
        dispatchEvent(new PointerEvent('pointerup', {}));
        changed('dragging does not move');
        const place = `${viewer.x} ${viewer.y} ${viewer.zoom}`;
        key('1');
        expect(place === `${viewer.x} ${viewer.y} ${viewer.zoom}`, 'zoom is not linked');
        key('3');
        key('+');
        changed('exposure changes nothing');
        key('e');
        changed('no false colours');
        key('e');
        key('0');
        key('f');
        expect(visible().length === study.methods.length + 1, 'f does not go back');
        } catch (e) {
            faults.push(e.stack);
        }
        document.title = faults.length ? faults.join('; ') : 'no faults';
        </script>)";

    static std::string browser() {
        const char* named = std::getenv("CHROMIUM");
        return named ? named : "chromium";
    }
};

TEST_F(StudyPageSlow, WorksInChromiumWithoutNetwork) {
    if (std::system(("command -v " + browser() + " > /dev/null 2>&1").c_str()) != 0) {
        GTEST_SKIP() << browser() << " is not installed (Debian: chromium): the page is not tried";
    }
    writeStudy(R"({"techniques": {"iterations": 3, "edges": 4},
        "scenes": [{"file": "room.gltf",
                    "options": {"width": 24, "height": 16, "max-depth": 5, "effect": "refractions=off"},
                    "reference": {"method": "bpt", "iterations": 32, "parts": 2},
                    "crops": [{"name": "all", "x": 0, "y": 0, "width": 24, "height": 16},
                              {"name": "part", "x": 5, "y": 3, "width": 8, "height": 6}]}]})");
    const Outcome made = study();
    ASSERT_EQ(made.exitCode, 0) << made.err;
    std::string page = read("out/index.html");
    EXPECT_LT(page.size(), std::size_t(30) << 20);
    page.insert(page.find("<meta charset"), kBefore);
    page.insert(page.rfind("</body>"), kAfter);
    write("tried.html", page);
    // Own profile, and no sandbox, because that needs rights that root lacks in a container.
    const std::string command =
        browser() + " --headless --no-sandbox --disable-gpu --user-data-dir=" + path("profile") +
        " --window-size=1400,4000 --dump-dom file://" + path("tried.html") + " > " +
        path("dom.html") + " 2> " + path("browser.log");
    ASSERT_EQ(std::system(command.c_str()), 0) << read("browser.log");
    const std::string dom = read("dom.html");
    const std::size_t title = dom.find("<title>") + 7;
    EXPECT_EQ(dom.substr(title, dom.find("</title>") - title), "no faults") << read("browser.log");
}

}  // namespace
}  // namespace lacuna::test
