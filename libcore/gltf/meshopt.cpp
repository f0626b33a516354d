#include "libcore/gltf/meshopt.h"

#include <meshoptimizer.h>

#include <array>
#include <utility>

#include "libcore/gltf/in_parallel.h"

namespace lacuna::gltf {
namespace {

using nlohmann::json;

constexpr const char* kMeshopt = "EXT_meshopt_compression";

/// A mode of the extension: its decoder, the first byte of a stream without the version in its low
/// four bits, and the newest version that the library knows.
struct Codec {
    const char* mode;
    int (*decode)(void* to, std::size_t count, std::size_t stride, const unsigned char* from,
                  std::size_t size);
    std::uint8_t header;
    int newest;
    bool (*has)(std::uint64_t count, std::uint64_t stride);
    const char* shapes;
};

bool isIndex(std::uint64_t stride) {
    return stride == 2 || stride == 4;
}

constexpr std::array kCodecs = {
    Codec{"ATTRIBUTES", meshopt_decodeVertexBuffer, 0xA0, 0,
          [](std::uint64_t, std::uint64_t stride) {
              return stride > 0 && stride <= 256 && stride % 4 == 0;
          },
          "a byteStride of 4 to 256 that 4 divides"},
    Codec{
        "TRIANGLES", meshopt_decodeIndexBuffer, 0xE0, 1,
        [](std::uint64_t count, std::uint64_t stride) { return count % 3 == 0 && isIndex(stride); },
        "a count that 3 divides and a byteStride of 2 or 4"},
    Codec{"INDICES", meshopt_decodeIndexSequence, 0xD0, 1,
          [](std::uint64_t, std::uint64_t stride) { return isIndex(stride); },
          "a byteStride of 2 or 4"},
};

struct Filter {
    const char* name;
    void (*decode)(void* values, std::size_t count, std::size_t stride);
    bool (*has)(std::uint64_t stride);
    const char* strides;
};

constexpr std::array kFilters = {
    Filter{"NONE", [](void*, std::size_t, std::size_t) {}, [](std::uint64_t) { return true; }, ""},
    Filter{"OCTAHEDRAL", meshopt_decodeFilterOct,
           [](std::uint64_t stride) { return stride == 4 || stride == 8; },
           "a byteStride of 4 or 8"},
    Filter{"QUATERNION", meshopt_decodeFilterQuat, [](std::uint64_t stride) { return stride == 8; },
           "a byteStride of 8"},
    Filter{"EXPONENTIAL", meshopt_decodeFilterExp,
           [](std::uint64_t stride) { return stride % 4 == 0; }, "a byteStride that 4 divides"},
};

/// A packed view: the checked members of its extension, and later its bytes.
struct PackedView {
    std::size_t view = 0;
    std::string place;
    std::span<const std::uint8_t> coded;
    std::size_t count = 0, stride = 0;
    const Codec* codec = nullptr;
    const Filter* filter = nullptr;
    Bytes plain;
};

/// The entry of `table` whose `member` is `name`. Throws InputError if there is none.
template <class Entry, std::size_t N>
const Entry& lookUp(const Document& document, const PackedView& packed,
                    const std::array<Entry, N>& table, const char* Entry::*member,
                    const std::string& name, const char* what) {
    std::string names;
    for (const Entry& entry : table) {
        if (name == entry.*member) return entry;
        names += (names.empty() ? "" : ", ") + std::string(entry.*member);
    }
    refuse(document.file, packed.place + what, "one of " + names, '"' + printable(name, 40) + '"',
           "export again without meshopt compression");
}

/// The packed view that `extension` describes. Takes its memory from the allowance.
PackedView readPackedView(Document& document, std::size_t view, const json& extension) {
    PackedView packed;
    packed.view = view;
    packed.place = "bufferViews[" + std::to_string(view) + "].extensions." + kMeshopt;
    packed.coded = rangeOf(document, extension, packed.place);
    for (const char* member : {"count", "byteStride"}) {
        if (!extension.contains(member)) {
            refuse(document.file, packed.place + "." + member, "a number", "none");
        }
    }
    packed.codec = &lookUp(document, packed, kCodecs, &Codec::mode,
                           extension.value("mode", std::string()), ".mode");
    packed.filter = &lookUp(document, packed, kFilters, &Filter::name,
                            extension.value("filter", std::string("NONE")), ".filter");

    const auto count = extension["count"].get<std::uint64_t>();
    const auto stride = extension["byteStride"].get<std::uint64_t>();
    const auto found = [&] {
        return std::to_string(count) + " elements of " + std::to_string(stride) + " bytes";
    };
    if (count == 0 || !packed.codec->has(count, stride)) {
        refuse(document.file, packed.place,
               packed.codec->shapes + std::string(" in mode ") + packed.codec->mode, found());
    }
    if (!packed.filter->has(stride)) {
        refuse(document.file, packed.place,
               packed.filter->strides + std::string(" for filter ") + packed.filter->name, found());
    }
    // No overflow: at most 2^53 elements (rules.cpp) of 256 bytes.
    if (!document.allowance.take(count * stride)) refuseUnpacking(document, packed.place);
    packed.count = std::size_t(count);
    packed.stride = std::size_t(stride);
    return packed;
}

void decode(const Document& document, PackedView& packed) {
    const Codec& codec = *packed.codec;
    const auto coded = packed.coded;
    if (!coded.empty() && (coded[0] & 0xF0) == codec.header && (coded[0] & 0x0F) > codec.newest) {
        refuse(document.file, packed.place,
               "a meshopt stream of version " + std::to_string(codec.newest) + " or older",
               "version " + std::to_string(coded[0] & 0x0F),
               "export again without compression, or for EXT_meshopt_compression");
    }
    const std::size_t size = packed.count * packed.stride;
    packed.plain = {std::make_unique_for_overwrite<std::uint8_t[]>(size), size};
    if (codec.decode(packed.plain.data.get(), packed.count, packed.stride, coded.data(),
                     coded.size()) != 0) {
        refuse(document.file, packed.place,
               "a meshopt stream of " + std::to_string(packed.count) + " elements", "a damaged one",
               "copy the file again, or export again without compression");
    }
    packed.filter->decode(packed.plain.data.get(), packed.count, packed.stride);
}

}  // namespace

void unpackMeshopt(Document& document) {
    const auto views = document.json.find("bufferViews");
    if (views == document.json.end()) return;
    std::vector<PackedView> packed;
    for (std::size_t i = 0; i < views->size(); ++i) {
        const auto extensions = (*views)[i].find("extensions");
        if (extensions == (*views)[i].end() || !extensions->contains(kMeshopt)) continue;
        packed.push_back(readPackedView(document, i, (*extensions)[kMeshopt]));
    }
    inParallel(packed, [&](PackedView& entry) { decode(document, entry); });
    for (PackedView& entry : packed) {
        json& view = (*views)[entry.view];
        view["byteLength"] = entry.plain.size;
        view["byteOffset"] = 0;
        view["buffer"] = addBuffer(document, std::move(entry.plain));
        view.erase("extensions");
    }
}

}  // namespace lacuna::gltf
