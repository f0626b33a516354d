// For the parser `scene`: changes that leave a scene glTF. libFuzzer's own seldom come through the parser of JSON,
// and never keep the chunks' lengths.
#include <algorithm>
#include <iterator>
#include <optional>
#include <random>

#include "tests/fuzz/parsers.h"
#include "tests/gltf/gltf_builder.h"

using namespace lacuna::test;

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t maxSize);

namespace {

using Rng = std::minstd_rand;
using Values = std::vector<json*>;

struct Asset {
    json document;
    ByteVector binary;
    bool isGlb = false;
};

/// Empty for what is no glTF. Leaves out what is nested deeper than in any sound file.
std::optional<Asset> read(Bytes bytes) {
    constexpr std::size_t kHeaders = 20,
                          kHeader = 8;  // of the file and its first chunk; of the next
    Asset asset;
    if (bytes.size() >= kHeaders && std::equal(bytes.begin(), bytes.begin() + 4, "glTF")) {
        std::uint32_t length = 0;
        std::memcpy(&length, &bytes[12], sizeof length);
        bytes = bytes.subspan(kHeaders);
        if (length > bytes.size()) return {};
        if (const Bytes next = bytes.subspan(length); next.size() > kHeader) {
            asset.binary.assign(next.begin() + kHeader, next.end());
        }
        bytes = bytes.first(length);
        asset.isGlb = true;
    }
    const auto isShallow = [](int depth, auto, auto&) { return depth < 64; };
    asset.document = json::parse(bytes.begin(), bytes.end(), isShallow, false);
    if (!asset.document.is_object()) return {};
    return asset;
}

/// Collects those of `value` and all below it for which `suits(value, key)` holds.
template <class Suits>
void collect(json& value, const Suits& suits, Values& all, const std::string& key = "") {
    if (suits(value, key)) all.push_back(&value);
    if (!value.is_structured()) return;
    for (auto& [name, child] : value.items()) collect(child, suits, all, name);
}

template <class Choices>
auto& oneOf(Choices& choices, Rng& rng) {
    return *std::next(std::begin(choices), std::ptrdiff_t(rng() % std::size(choices)));
}

const json& edge(Rng& rng) {
    static const json kEdges[] = {0,          -1,    0.5,        255,        65536,
                                  1e38,       1e308, 2147483647, 2147483648, 4294967295,
                                  4294967296, -1e38, 1e-45};
    return oneOf(kEdges, rng);
}

/// Replaces a value: by another number, an index, another type (null is what writers have for NaN), or what stands
/// elsewhere.
void changeValue(json& document, Rng& rng) {
    static const json kTypes[] = {nullptr, true, 1, "a", json::array(), json::object()};
    const bool isNumber = rng() % 2 == 0;
    Values values;
    collect(
        document, [&](const json& v, auto&) { return v.is_number() || !isNumber; }, values);
    if (values.empty()) return;
    const json choices[] = {edge(rng), rng() % 8, oneOf(kTypes, rng), *oneOf(values, rng)};
    *oneOf(values, rng) = oneOf(choices, rng);
}

/// Removes an element or a key, or copies it: a key in place of another one, or elsewhere.
void changeMembers(json& document, Rng& rng) {
    const auto type = rng() % 2 == 0 ? json::value_t::array : json::value_t::object;
    Values containers;
    collect(
        document, [&](const json& v, auto&) { return v.type() == type && !v.empty(); }, containers);
    if (containers.empty()) return;
    json& container = *oneOf(containers, rng);
    const auto member = std::next(container.begin(), std::ptrdiff_t(rng() % container.size()));
    const json copy = *member;
    if (rng() % 2 == 0) {
        container.erase(member);
    } else if (container.is_array()) {
        container.push_back(copy);
    } else if (rng() % 2 == 0) {
        oneOf(container, rng) = copy;
    } else {
        const std::string key = member.key();
        (*oneOf(containers, rng))[key] = copy;
    }
}

/// Changes where data lies or how much of it there is: to more, mostly.
void changeExtent(json& document, Rng& rng) {
    static const std::string kKeys[] = {"count", "byteOffset", "byteLength", "byteStride"};
    const auto suits = [](const json& v, const std::string& key) {
        return v.is_number_unsigned() && std::ranges::find(kKeys, key) != std::end(kKeys);
    };
    Values extents;
    collect(document, suits, extents);
    if (extents.empty()) return;
    json& extent = *oneOf(extents, rng);
    const auto before = extent.get<std::uint64_t>();
    const json choices[] = {before + 1, before + 4, 2 * before, before / 2, edge(rng)};
    extent = oneOf(choices, rng);
}

/// Changes the file in place. Returns the new size, or 0 where nothing is to be changed so.
std::size_t changeAsset(std::uint8_t* data, std::size_t size, std::size_t maxSize, Rng& rng) {
    std::optional<Asset> asset = read({data, size});
    if (!asset) return 0;
    ByteVector& binary = asset->binary;
    const auto way = binary.empty() ? 1 + rng() % 3 : rng() % 4;
    if (way == 0) LLVMFuzzerMutate(binary.data(), binary.size(), binary.size());
    if (way == 1) changeMembers(asset->document, rng);
    if (way == 2) changeExtent(asset->document, rng);
    if (way == 3) changeValue(asset->document, rng);
    const std::string text = asset->document.dump(-1, ' ', false, json::error_handler_t::replace);
    const ByteVector changed =
        asset->isGlb ? GltfBuilder::pack(text, binary) : ByteVector(text.begin(), text.end());
    if (changed.size() > maxSize) return 0;
    std::ranges::copy(changed, data);
    return changed.size();
}

}  // namespace

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                               std::size_t maxSize, unsigned seed) {
    static const char* const parser = std::getenv("LACUNA_FUZZ_PARSER");
    static const bool isScene = parser && std::strcmp(parser, "scene") == 0;
    Rng rng(seed);
    if (isScene && rng() % 2 == 0) {
        if (const std::size_t changed = changeAsset(data, size, maxSize, rng)) return changed;
    }
    return LLVMFuzzerMutate(data, size, maxSize);
}
