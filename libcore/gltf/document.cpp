#include "libcore/gltf/document.h"

#include <algorithm>
#include <array>
#include <utility>

#include "libcore/base/error.h"
#include "libcore/gltf/draco.h"
#include "libcore/gltf/guard.h"
#include "libcore/gltf/meshopt.h"

namespace lacuna::gltf {
namespace {

using nlohmann::json;

json parseJson(const std::string& file, std::string_view text) {
    checkJsonDepth(file, text);
    try {
        return json::parse(text.begin(), text.end());
    } catch (const json::exception& error) {
        refuse(file, "", "valid JSON", error.what(), "copy or export the file again");
    }
}

/// Whether the buffer is only a fallback of EXT_meshopt_compression, which need not exist.
bool isFallback(const json& buffer) {
    const auto extensions = buffer.find("extensions");
    if (extensions == buffer.end()) return false;
    const auto meshopt = extensions->find("EXT_meshopt_compression");
    return meshopt != extensions->end() && meshopt->value("fallback", false);
}

/// The bytes of buffer `index`: the BIN chunk, a data URI or an external file; none for a fallback.
std::span<const std::uint8_t> loadBuffer(Document& document, const json& buffer, std::size_t index,
                                         std::span<const std::uint8_t> binary) {
    const std::string place = "buffers[" + std::to_string(index) + "]";
    if (isFallback(buffer)) return {};
    const auto length = buffer.find("byteLength");
    if (length == buffer.end()) refuse(document.file, place + ".byteLength", "a number", "none");
    const std::uint64_t size = length->get<std::uint64_t>();

    std::span<const std::uint8_t> bytes;
    const auto uri = buffer.find("uri");
    if (uri != buffer.end()) {
        const auto& text = uri->get_ref<const std::string&>();
        document.external.push_back(
            isDataUri(text) ? decodeDataUri(document.file, place + ".uri", text)
                            : document.readExternal(resolveUri(document.file, place + ".uri", text),
                                                    document.file + ", " + place));
        bytes = document.external.back().span();
    } else if (index == 0 && !binary.empty()) {
        bytes = binary;
    } else if (size > 0) {
        refuse(document.file, place, "a uri (or a .glb with binary data)", "none");
    }
    if (size > bytes.size()) {
        refuse(document.file, place, std::to_string(size) + " bytes, as byteLength says",
               std::to_string(bytes.size()), "copy or export the files again");
    }
    return bytes.first(std::size_t(size));
}

void loadBuffers(Document& document, std::span<const std::uint8_t> binary) {
    const auto buffers = document.json.find("buffers");
    if (buffers == document.json.end()) return;
    for (std::size_t i = 0; i < buffers->size(); ++i) {
        document.buffers.push_back(loadBuffer(document, (*buffers)[i], i, binary));
        (*buffers)[i].erase("uri");  // a data URI can be half the file
    }
}

/// tinygltf's messages have one line per error; the first suffices.
std::string firstLine(const std::string& text) {
    return text.substr(0, text.find('\n'));
}

/// Fills document.nodes and document.model. Leaves in document.json only what is read from it later.
void parseModel(Document& document) {
    constexpr std::array kKept = {"buffers", "images", "animations", "skins"};
    constexpr std::array kDone = {"accessors", "bufferViews", "meshes"};
    json& root = document.json;
    if (const auto nodes = root.find("nodes"); nodes != root.end()) {
        document.nodes = readNodes(std::move(*nodes));
        root.erase(nodes);
    }
    json kept = json::object();
    for (const char* key : kKept) {
        if (const auto member = root.find(key); member != root.end()) {
            kept[key] = std::move(*member);
            root.erase(member);
        }
    }
    const std::string text = root.dump();
    for (const char* key : kDone) root.erase(key);
    root.update(kept);
    if (text.size() > Limits::kFileBytes) {
        refuse(document.file, "", "less JSON", std::to_string(text.size()) + " bytes",
               "split the scene");
    }

    tinygltf::TinyGLTF parser;
    std::string error, warning;
    bool parsed = false;
    try {
        parsed = parser.LoadASCIIFromString(&document.model, &error, &warning, text.data(),
                                            static_cast<unsigned int>(text.size()), "");
    } catch (const std::exception& exception) {
        error = exception.what();
    }
    // tinygltf may also drop what it cannot parse and go on; then it only leaves a message.
    if (!parsed || !error.empty()) {
        refuse(document.file, "", "valid glTF 2.0",
               error.empty() ? "what tinygltf cannot parse" : firstLine(error));
    }
}

void checkBufferViews(const Document& document) {
    const auto& views = document.model.bufferViews;
    for (std::size_t i = 0; i < views.size(); ++i) {
        const std::size_t size = document.buffers[std::size_t(views[i].buffer)].size();
        if (views[i].byteOffset > size || views[i].byteLength > size - views[i].byteOffset) {
            refuseRange(document.file, "bufferViews[" + std::to_string(i) + "]",
                        views[i].byteLength, views[i].byteOffset, size);
        }
    }
}

}  // namespace

void Allowance::addFile(std::uint64_t bytes) {
    left_ += bytes * kUnpackedPerByte;
}

bool Allowance::take(std::uint64_t bytes) {
    std::uint64_t left = left_;
    do {
        if (bytes > left) return false;
    } while (!left_.compare_exchange_weak(left, left - bytes));
    return true;
}

void refuseUnpacking(const Document& document, const std::string& place, const char* advice) {
    refuse(document.file, place,
           "content that unpacks to at most " + std::to_string(kUnpackedPerByte) +
               " times the file's bytes",
           "more", advice);
}

void refuseRange(const std::string& file, const std::string& place, std::uint64_t length,
                 std::uint64_t offset, std::size_t size) {
    refuse(file, place, "a range within the " + std::to_string(size) + " bytes of its buffer",
           std::to_string(length) + " bytes at " + std::to_string(offset));
}

std::span<const std::uint8_t> rangeOf(const Document& document, const json& range,
                                      const std::string& place) {
    for (const char* member : {"buffer", "byteLength"}) {
        if (!range.contains(member))
            refuse(document.file, place + "." + member, "a number", "none");
    }
    const auto buffer = document.buffers[range["buffer"].get<std::size_t>()];
    const std::uint64_t length = range["byteLength"].get<std::uint64_t>();
    const std::uint64_t offset = range.value("byteOffset", std::uint64_t(0));
    if (offset > buffer.size() || length > buffer.size() - offset) {
        refuseRange(document.file, place, length, offset, buffer.size());
    }
    return buffer.subspan(std::size_t(offset), std::size_t(length));
}

std::size_t addBuffer(Document& document, Bytes bytes) {
    document.external.push_back(std::move(bytes));
    document.buffers.push_back(document.external.back().span());
    return document.buffers.size() - 1;
}

std::span<const std::uint8_t> Document::view(int bufferView) const {
    const tinygltf::BufferView& range = model.bufferViews[std::size_t(bufferView)];
    return buffers[std::size_t(range.buffer)].subspan(range.byteOffset, range.byteLength);
}

Bytes Document::readExternal(const std::filesystem::path& path, const std::string& place) {
    Bytes read =
        readFile(path, std::min(Limits::kFileBytes, Limits::kTotalBytes - bytesRead), place);
    bytesRead += read.size;
    allowance.addFile(read.size);
    hash.addValues(read.span());
    return read;
}

void loadDocument(const std::string& file, Bytes bytes, Document& document, Warnings& warnings) {
    document.file = file;
    document.bytes = std::move(bytes);
    document.bytesRead = document.bytes.size;
    document.allowance.addFile(document.bytes.size);
    document.hash.addValues(document.bytes.span());

    const Chunks chunks = splitContainer(file, document.bytes.span());
    document.json = parseJson(file, chunks.json);
    if (!document.json.is_object()) {
        refuse(file, "", "a JSON object", document.json.type_name(), "convert to glTF 2.0");
    }
    checkRules(file, document.json);
    checkVersionAndExtensions(file, document.json, warnings);
    loadBuffers(document, chunks.binary);
    unpackMeshopt(document);
    unpackDraco(document, warnings);
    parseModel(document);
    checkBufferViews(document);
    document.scene = std::size_t(std::max(document.model.defaultScene, 0));
}

}  // namespace lacuna::gltf
