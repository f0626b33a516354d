#include "tests/fuzz/seeds.h"

#include <stb/stb_image_write.h>

#include "libcore/cache/emission_file.h"
#include "libcore/cache/guarded_file.h"
#include "libcore/cache/walk_file.h"
#include "libcore/image/exr.h"
#include "libcore/image/image_io.h"
#include "render/part.h"
#include "tests/cache/example_guide.h"
#include "tests/cache/example_subspaces.h"
#include "tests/fixtures/random_walk_guide.h"
#include "tests/gltf/everything.h"
#include "tests/gltf/packed.h"

namespace lacuna::test {
namespace {

namespace fs = std::filesystem;

void write(const fs::path& file, std::string_view bytes) {
    fs::create_directories(file.parent_path());
    std::ofstream(file, std::ios::binary).write(bytes.data(), std::streamsize(bytes.size()));
}

std::string bytesOf(const fs::path& file) {
    std::ostringstream bytes;
    bytes << std::ifstream(file, std::ios::binary).rdbuf();
    return std::move(bytes).str();
}

std::string textOf(const ByteVector& bytes) {
    return {bytes.begin(), bytes.end()};
}

/// A triangle whose buffer, texture and environment are files beside it (scenes.cpp has them).
std::string withFilesBesideIt() {
    TriangleBuilder b;
    b.add("images", {{"uri", "a.png"}});
    b.add("textures", {{"source", 0}});
    b.add("materials", {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}});
    b.primitive()["material"] = 0;
    b.add("buffers", {{"byteLength", 36}, {"uri", "a.bin"}});
    b.extras()["environment"] = {{"file", "a.hdr"}, {"scale", 2}, {"rotation_degrees", 90}};
    return b.root.dump();
}

/// Everything as JSON alone.
std::string withDataUris() {
    const GltfBuilder b = everything();
    json document = b.document();
    document["buffers"][0]["uri"] = "data:application/octet-stream;base64," + base64(b.binary);
    return document.dump();
}

void scenes(const fs::path& folder) {
    write(folder / "triangle.glb", textOf(TriangleBuilder().glb()));
    write(folder / "everything.glb", textOf(everything().glb()));
    write(folder / "data-uris.gltf", withDataUris());
    write(folder / "files.gltf", withFilesBesideIt());
}

/// Streams alone, as packed_streams.cpp reads them.
void packed(const fs::path& folder) {
    write(folder / "draco" / "edgebreaker",
          textOf(dracoStream(GridBuilder(2), 0, {true, 10, true})));
    write(folder / "draco" / "floats", textOf(dracoStream(GridBuilder(2))));
    write(folder / "draco" / "sequential",
          textOf(dracoStream(GridBuilder(2), 0, {false, 10, true})));
    write(folder / "webp" / "a", textOf(webp(3, 2, ByteVector(24, 99))));

    GridBuilder grid(2);  // 9 vertices, 24 corners
    const auto meshopt = [&](const char* name, int accessor, int mode, int stride, int count) {
        packByMeshopt(grid, accessor);
        const std::size_t view = grid.root["accessors"][std::size_t(accessor)]["bufferView"];
        const json& range = grid.root["bufferViews"][view]["extensions"]["EXT_meshopt_compression"];
        const std::size_t offset = range["byteOffset"], size = range["byteLength"];
        const std::string head = {char(mode), char(stride / 2), char(count / 3)};
        write(folder / "meshopt" / name,
              head + std::string(grid.binary.begin() + std::ptrdiff_t(offset),
                                 grid.binary.begin() + std::ptrdiff_t(offset + size)));
    };
    meshopt("positions", grid.accessorOf("POSITION"), 0, 12, 9);
    meshopt("normals", grid.accessorOf("NORMAL"), 3, 4, 9);
    meshopt("triangles", grid.indices(), 1, 2, 24);
    declareFallback(grid);
    write(folder / "scene" / "meshopt.glb", textOf(grid.glb()));
}

/// Baseline JPEGs; corpus/jpeg/ has those of other kinds. Up to a quality of 90 colours have half the resolution.
void jpegs(const fs::path& folder) {
    ByteVector texels;
    for (int i = 0; i < 3 * 17 * 9; ++i) texels.push_back(std::uint8_t(i * i / 7));
    const auto append = [](void* to, void* data, int size) {
        static_cast<std::string*>(to)->append(static_cast<const char*>(data), std::size_t(size));
    };
    const auto jpeg = [&](const char* name, int channels, int quality) {
        std::string bytes;
        stbi_write_jpg_to_func(append, &bytes, 17, 9, channels, texels.data(), quality);
        write(folder / name, bytes);
    };
    jpeg("half.jpg", 3, 80);
    jpeg("whole.jpg", 3, 95);
    jpeg("grey.jpg", 1, 80);
}

LayeredImage smallPicture() {
    LayeredImage image(5, 3);
    image.setRgb("", Image(5, 3, {0.5f, 1.0f, 2.0f}));
    image.channel("Z").assign(15, 3.0f);
    image.attributes["seed"] = 1;
    image.attributes["renderTimeSeconds"] = 0.25;
    return image;
}

/// A part of one block.
Part smallPart() {
    const auto sum = [] {
        auto made = std::make_shared<FilmSum>();
        made->iterations = 2;
        made->samples = 2;
        made->mean.assign(1, {1, 2, 3});
        made->spread.assign(1, {1, 1, 1});
        made->layers["layer"] = {1.0f};
        return made;
    };
    Part part;
    part.inputs = kStamp;
    part.width = part.height = 1;
    part.plan = {2, false, 2};
    part.sums.blocks = {{0, 1, sum()}};
    return part;
}

void pictures(const fs::path& folder) {
    fs::create_directories(folder / "exr");
    LayeredImage image = smallPicture();
    writeExr(folder / "exr" / "zip.exr", image);
    writeExr(folder / "exr" / "plain.exr", image, {.compression = ExrCompression::None});
    writeExr(folder / "exr" / "parts.exr", image, {.half = true, .multiPart = true});
    LayeredImage small(1, 1);
    addPart(small, smallPart());
    writeExr(folder / "exr" / "part.exr", small);
    write(folder / "part" / "small", std::get<std::string>(small.attributes.at("partSums")) + "\n" +
                                         std::get<std::string>(small.attributes.at("partTotals")));
    fs::create_directories(folder / "pfm");
    writePfm(folder / "pfm" / "a.pfm", image.rgb());
    fs::create_directories(folder / "png");
    writePng(folder / "png" / "8.png", image.rgb(), {});
    writePngBytes(folder / "png" / "16.png", 2, 1, std::vector<std::uint8_t>(12, 7), 16);
    const std::string head = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n";
    write(folder / "hdr" / "flat.hdr", head + "-Y 1 +X 2\n" + std::string(8, char(128)));
    std::string runs = head + "-Y 1 +X 8\n\x02\x02" + std::string(1, '\0') + "\x08";
    for (int channel = 0; channel < 4; ++channel) runs += "\x88\x40";
    write(folder / "hdr" / "runs.hdr", runs);
}

void caches(const fs::path& folder) {
    for (const char* kind : {"subspaces", "emission", "walks", "guarded"}) {
        fs::create_directories(folder / kind);
    }
    writeSubspaceFile(folder / "subspaces" / "a", example(5, 3));
    const auto guide = randomWalkGuide(1);
    writeWalkFile(folder / "walks" / "a", {guide, kStamp, guide->contentHash()});
    const auto emission = exampleGuide();
    writeEmissionFile(folder / "emission" / "a", {emission, kStamp, emission->contentHash()});
    const fs::path pair = folder / "guarded" / "pair";
    writeGuarded(pair, "some bytes");
    const std::string sidecar = bytesOf(pair.string() + ".xxh3");
    write(pair, sidecar + '\0' + "some bytes");
    fs::remove(pair.string() + ".xxh3");

    // A grid of 2 x 2 x 2, one node, no edge, and one voxel, in the order in which grids.cpp reads them.
    std::string grid;
    const auto put = [&](const auto& value) {
        grid.append(reinterpret_cast<const char*>(&value), sizeof value);
    };
    for (int i = 0; i < 3; ++i) put(std::int32_t(2));
    for (int i = 0; i < 3; ++i) put(0.0);
    put(0.5);
    const std::string voxels = grid + std::string(11, '\0');
    write(folder / "voxels" / "a", voxels);
    put(std::uint8_t(4));
    for (const double value : {0.5, 0.5, 0.5, 0.25}) put(value);
    put(std::uint8_t(0));
    write(folder / "skeleton" / "a", grid + std::string(11, '\0'));
}

void texts(const fs::path& folder) {
    write(folder / "study" / "a", R"({"title": "t", "about": "a", "time": "2s", "seeds": [1, 2],
        "baseline": "bpt", "bounds": {"mape": [1, 0.5]}, "measures": ["mape", "relmse"],
        "techniques": {"iterations": 8}, "times": [1], "threads": 1,
        "scenes": [{"name": "s", "file": "s.glb", "options": {"width": 12, "height": 7},
        "reference": {"file": "r.exr", "method": "spcbpt", "set": {"candidates": 500},
        "iterations": 2, "parts": 2}, "crops": [{"name": "c", "x": 2, "y": 4, "width": 3,
        "height": 1}]}], "methods": [{"method": "auto"}, {"method": "bpt"},
        {"method": "lvcbpt", "name": "n", "set": {"candidates": 10}},
        {"method": "tsrbpt", "vary": {"candidates": [1, 2]}}], "quick": {"time": "1s"}})");
    write(folder / "curve" / "a",
          "iteration,seconds,setup_seconds,rays,mae,rmse,mape,relmse,phases\n"
          "1,0.5,0.1,100,1,2,3,4,a=1\n4,2,0.1,400,0.5,1,1.5,inf,a=4\n");
    write(folder / "arguments" / "most",
          "--method\nspcbpt\n--set\ncandidates=200\n--set\nweights=paper\n--width\n64\n--time\n"
          "90s\n--max-depth\n5\n--crop\n0,4,0,4\n--checkpoint\nc\n--checkpoint-every\n1m\n"
          "--exposure\nauto\n--tone\nfilmic\n--shift\n0.1,0.2\n--scale\n50%\n"
          "--env-colour\n1,1,1\n--effect\nclearcoat=off");
    write(folder / "arguments" / "others",
          "--until\nmape=0.05\n--display-server\nlocalhost:14158\n--write-every\n30s\n"
          "--sampler\nsobol\n--verify\n--techniques\n--light-groups\n--seed\n7");
    write(folder / "arguments" / "replay", "--method\nbpt\n--replay\n1,2,3");
    write(folder / "arguments" / "part",
          "--method\npt\n--iterations\n8\n--block-iterations\n2\n--blocks\n0,2");
    write(folder / "expressions" / "most",
          "C.*\nC<RD>.+L\nC(<TS>|<RS>)*[^S]?B\nC<..['a''b']>{2,3}<[^C].[^'a']>O\nCs?D{1}G{0,}L");
}

}  // namespace

void writeSeeds(const fs::path& folder) {
    scenes(folder / "scene");
    packed(folder);
    jpegs(folder / "jpeg");
    pictures(folder);
    caches(folder);
    texts(folder);
}

}  // namespace lacuna::test
