// Files that are damaged, at random or on purpose: every one is refused with one line or gives a
// description that holds together. None may crash (the sanitizer build runs these too).
#include <random>
#include <regex>
#include <set>

#include "tests/gltf/everything.h"

namespace lacuna::test {
namespace {

TEST(Malformed, TheIntactSceneLoads) {
    const SceneDescription scene = everything().load();
    expectValid(scene);
    EXPECT_EQ(scene.meshes.size(), 5u);  // one of them twice: as it is and bent
    EXPECT_EQ(scene.instances.size(), 4u);
    EXPECT_EQ(scene.textures.size(), 3u);
    EXPECT_EQ(scene.cameras.size(), 1u);
    EXPECT_EQ(scene.lights.size(), 1u);
}

TEST(Malformed, TruncatedAnywhere) {
    const TempDir dir;
    const ByteVector whole = everything().glb();
    for (std::size_t i = 0; i < 200; ++i) {
        ByteVector bytes = whole;
        bytes.resize(whole.size() * i / 200);
        EXPECT_FALSE(loadsOrIsRefused(dir, bytes)) << bytes.size();
    }
}

TEST(Malformed, TruncatedWithAHeaderThatAgrees) {
    const TempDir dir;
    const GltfBuilder b = everything();
    const std::string text = b.document().dump();
    for (std::size_t i = 0; i < 100; ++i) {
        ByteVector binary = b.binary;
        binary.resize(b.binary.size() * i / 100);
        EXPECT_FALSE(loadsOrIsRefused(dir, GltfBuilder::pack(text, binary)));
        EXPECT_FALSE(loadsOrIsRefused(
            dir, GltfBuilder::pack(text.substr(0, text.size() * i / 100), b.binary)));
    }
}

TEST(Malformed, RandomByteFlips) {
    const TempDir dir;
    const ByteVector whole = everything().glb();
    std::mt19937 random(1);
    int refused = 0;
    for (int i = 0; i < 300; ++i) {
        ByteVector bytes = whole;
        const int flips = 1 + int(random() % 4);
        for (int k = 0; k < flips; ++k)
            bytes[random() % bytes.size()] ^= std::uint8_t(1 + random() % 255);
        refused += !loadsOrIsRefused(dir, bytes);
    }
    EXPECT_GT(refused, 100);
    EXPECT_LT(refused, 300);
}

TEST(Malformed, RandomNumbersInTheJson) {
    const TempDir dir;
    const GltfBuilder b = everything();
    const std::string text = b.document().dump();
    std::vector<std::smatch> numbers;
    const std::regex number("[:,\\[](-?[0-9][0-9.eE+-]*)");
    for (std::sregex_iterator it(text.begin(), text.end(), number), end; it != end; ++it) {
        numbers.push_back(*it);
    }
    ASSERT_GT(numbers.size(), 100u);
    const std::vector<std::string> values = {"0",
                                             "-1",
                                             "1",
                                             "2",
                                             "7",
                                             "100",
                                             "65536",
                                             "2147483647",
                                             "2147483648",
                                             "1e308",
                                             "4294967295",
                                             "4294967296",
                                             "4294967297",
                                             "-1e308",
                                             "1e-320",
                                             "0.5",
                                             "-0",
                                             "1e400",
                                             "9007199254740993",
                                             "18446744073709551615",
                                             "18446744073709551616",
                                             "-9223372036854775808"};
    std::mt19937 random(2);
    int refused = 0;
    for (int i = 0; i < 300; ++i) {
        const std::smatch& at = numbers[random() % numbers.size()];
        std::string edited = text;
        edited.replace(std::size_t(at.position(1)), std::size_t(at.length(1)),
                       values[random() % values.size()]);
        refused += !loadsOrIsRefused(dir, GltfBuilder::pack(edited, b.binary));
    }
    EXPECT_GT(refused, 100);
    EXPECT_LT(refused, 300);
}

/// Every value of the document, containers included.
std::set<std::string> allPlaces(const json& document) {
    std::set<std::string> places;
    const json flat = document.flatten();
    for (auto leaf = flat.begin(); leaf != flat.end(); ++leaf) {
        json::json_pointer at(leaf.key());
        for (; !at.empty(); at = at.parent_pointer()) places.insert(at.to_string());
    }
    return places;
}

TEST(Malformed, ValuesOfTheWrongType) {
    const TempDir dir;
    const GltfBuilder b = everything();
    const json document = b.document();
    for (const std::string& place : allPlaces(document)) {
        for (const json& other : {json(nullptr), json("text"), json::array(), json::object(),
                                  json::array({json::object()}), json(true), json(3)}) {
            json edited = document;
            edited[json::json_pointer(place)] = other;
            SCOPED_TRACE(place + " = " + other.dump());
            loadsOrIsRefused(dir, GltfBuilder::pack(edited.dump(), b.binary));
        }
    }
}

TEST(Malformed, MembersMissing) {
    const TempDir dir;
    const GltfBuilder b = everything();
    const json document = b.document();
    for (const std::string& place : allPlaces(document)) {
        const json::json_pointer at(place);
        json edited = document;
        json& parent = edited[at.parent_pointer()];
        if (parent.is_object()) {
            parent.erase(at.back());
        } else {
            parent.erase(std::size_t(std::stoul(at.back())));
        }
        SCOPED_TRACE(place);
        loadsOrIsRefused(dir, GltfBuilder::pack(edited.dump(), b.binary));
    }
}

TEST(Malformed, IndicesOutOfRangeOfEveryKind) {
    const TempDir dir;
    const GltfBuilder b = everything();
    const json document = b.document();
    // The last view is a packed one.
    const std::string packed = "/bufferViews/" + std::to_string(document["bufferViews"].size() - 1);
    const struct {
        std::string pointer;
        const char* target;
    } references[] = {
        {"/scene", "scenes"},
        {"/scenes/0/nodes/0", "nodes"},
        {"/nodes/0/children/1", "nodes"},
        {"/nodes/1/mesh", "meshes"},
        {"/nodes/2/camera", "cameras"},
        {"/nodes/2/extensions/KHR_lights_punctual/light", "lights"},
        {"/meshes/0/primitives/0/attributes/POSITION", "accessors"},
        {"/meshes/0/primitives/0/attributes/NORMAL", "accessors"},
        {"/meshes/0/primitives/0/attributes/TEXCOORD_0", "accessors"},
        {"/meshes/0/primitives/0/indices", "accessors"},
        {"/meshes/0/primitives/0/material", "materials"},
        {"/accessors/0/bufferView", "bufferViews"},
        {"/accessors/0/sparse/indices/bufferView", "bufferViews"},
        {"/accessors/0/sparse/values/bufferView", "bufferViews"},
        {"/bufferViews/0/buffer", "buffers"},
        {"/images/0/bufferView", "bufferViews"},
        {"/textures/0/source", "images"},
        {"/textures/0/sampler", "samplers"},
        {"/materials/0/emissiveTexture/index", "textures"},
        {"/materials/0/normalTexture/index", "textures"},
        {"/materials/0/occlusionTexture/index", "textures"},
        {"/materials/0/pbrMetallicRoughness/baseColorTexture/index", "textures"},
        {"/materials/0/pbrMetallicRoughness/metallicRoughnessTexture/index", "textures"},
        {"/materials/0/extensions/KHR_materials_transmission/transmissionTexture/index",
         "textures"},
        {"/skins/1/joints/0", "nodes"},
        {"/skins/1/inverseBindMatrices", "accessors"},
        {"/textures/1/extensions/EXT_texture_webp/source", "images"},
        {"/meshes/1/primitives/0/extensions/KHR_draco_mesh_compression/bufferView", "bufferViews"},
        {packed + "/extensions/EXT_meshopt_compression/buffer", "buffers"},
    };
    for (const auto& reference : references) {
        const json::json_pointer at(reference.pointer);
        ASSERT_TRUE(document.contains(at)) << reference.pointer;
        // Far out; negative; what is 0 when cut to 32 bits; not an integer.
        for (const json& bad : {json(1000), json(-1), json(2147483647), json(4294967296u),
                                json(18446744073709551615u), json(0.5), json("0")}) {
            SCOPED_TRACE(reference.pointer + bad.dump());
            json edited = document;
            edited[at] = bad;
            expectRefused(dir.write("scene.glb", GltfBuilder::pack(edited.dump(), b.binary)),
                          {"an index below", reference.target});
        }
    }
}

TEST(Malformed, BufferViewsOutsideTheirBuffer) {
    const TempDir dir;
    const GltfBuilder b = everything();
    const json document = b.document();
    const std::size_t size = b.binary.size();
    const auto refuses = [&](std::size_t view, const char* member, const json& value) {
        json edited = document;
        json& plain = edited["bufferViews"][view];
        const bool isPacked = plain.contains("extensions");
        (isPacked ? plain["extensions"]["EXT_meshopt_compression"] : plain)[member] = value;
        expectRefused(dir.write("scene.glb", GltfBuilder::pack(edited.dump(), b.binary)),
                      {"bufferViews"});
    };
    for (std::size_t view = 0; view < document["bufferViews"].size(); ++view) {
        refuses(view, "byteOffset", size + 1);
        refuses(view, "byteOffset", std::uint64_t(1) << 52);
        refuses(view, "byteOffset", 18446744073709551600u);
        refuses(view, "byteLength", size + 1);
        refuses(view, "byteLength", 9007199254740992u);
        refuses(view, "byteOffset", -4);
    }
    json edited = document;
    edited["buffers"][0]["byteLength"] = size + 4;
    expectRefused(dir.write("scene.glb", GltfBuilder::pack(edited.dump(), b.binary)),
                  {"buffers[0]", "byteLength"});
}

TEST(Malformed, NestingIsBounded) {
    const TempDir dir;
    for (const char* open : {"[", "{\"a\":"}) {
        for (const int depth : {100, 100000}) {
            std::string nested;
            for (int i = 0; i < depth; ++i) nested += open;
            nested += "1";
            for (int i = 0; i < depth; ++i) nested += *open == '[' ? "]" : "}";
            const std::string text = R"({"asset": {"version": "2.0"}, "extras": )" + nested + "}";
            expectRefused(dir.write("a.gltf", text), {"nested", "64"});
            expectRefused(dir.write("a.glb", GltfBuilder::pack(text, {})), {"nested"});
            expectRefused(dir.write("a.gltf", text.substr(0, text.size() / 3)), {"JSON"});
        }
    }
    // Brackets in strings do not nest, nor do siblings.
    TriangleBuilder b;
    b.extras()["note"] = std::string(1000, '[') + "\\\"{" + std::string(1000, '{');
    for (int i = 0; i < 1000; ++i) b.extras()["list"].push_back(json::array({json::array()}));
    EXPECT_NO_THROW(b.load());
}

TEST(Malformed, MessagesAreOneShortLine) {
    TriangleBuilder b;
    b.add("materials", {{"alphaMode", std::string("x\ny\x1b[31m") + std::string(100000, 'z')}});
    try {
        b.load();
        FAIL();
    } catch (const InputError& error) {
        const std::string line = error.what();
        EXPECT_EQ(line.find('\n'), std::string::npos);
        EXPECT_EQ(line.find('\x1b'), std::string::npos);
        EXPECT_LT(line.size(), 1300u);
    }
}

}  // namespace
}  // namespace lacuna::test
