#include "libcore/gltf/draco.h"

#include <draco/compression/attributes/prediction_schemes/mesh_prediction_scheme_tex_coords_portable_decoder.h>
#include <draco/compression/attributes/prediction_schemes/prediction_scheme_wrap_decoding_transform.h>
#include <draco/compression/mesh/mesh_edgebreaker_decoder.h>
#include <draco/compression/mesh/mesh_sequential_decoder.h>
#include <draco/core/varint_decoding.h>
#include <draco/mesh/mesh.h>

#include <limits>
#include <utility>

#include "libcore/gltf/component_type.h"
#include "libcore/gltf/in_parallel.h"

// Draco 1.5.5 trusts the stream's number of flags that help to predict texture coordinates. A stream of a few bytes may
// ask for 2^31 of them, which take seconds and 256 MB for each attribute. The code here is Draco's own with a bound:
// one flag for each value. These definitions take precedence over those of the library, which are weak.
namespace draco {
namespace {

using Wrap = PredictionSchemeWrapDecodingTransform<int, int>;
using Corners = MeshPredictionSchemeData<CornerTable>;
using AttributeCorners = MeshPredictionSchemeData<MeshAttributeCornerTable>;

template <class Predictor>
bool decodeFlags(DecoderBuffer& buffer, std::size_t values, Predictor& predictor) {
    std::int32_t count = 0;
    if (!buffer.Decode(&count) || count < 0 || std::size_t(count) > values) return false;
    predictor.ResizeOrientations(count);
    RAnsBitDecoder decoder;
    if (!decoder.StartDecoding(&buffer)) return false;
    bool flag = true;
    for (int i = 0; i < count; ++i) {
        if (!decoder.DecodeNextBit()) flag = !flag;
        predictor.set_orientation(i, flag);
    }
    decoder.EndDecoding();
    return true;
}

}  // namespace

template <>
bool MeshPredictionSchemeTexCoordsPortableDecoder<int, Wrap, Corners>::DecodePredictionData(
    DecoderBuffer* buffer) {
    return decodeFlags(*buffer, mesh_data().data_to_corner_map()->size(), predictor_) &&
           MeshPredictionSchemeDecoder<int, Wrap, Corners>::DecodePredictionData(buffer);
}

template <>
bool MeshPredictionSchemeTexCoordsPortableDecoder<
    int, Wrap, AttributeCorners>::DecodePredictionData(DecoderBuffer* buffer) {
    return decodeFlags(*buffer, mesh_data().data_to_corner_map()->size(), predictor_) &&
           MeshPredictionSchemeDecoder<int, Wrap, AttributeCorners>::DecodePredictionData(buffer);
}

}  // namespace draco

namespace lacuna::gltf {
namespace {

using nlohmann::json;

constexpr const char* kDraco = "KHR_draco_mesh_compression";
constexpr const char* kWithoutDraco = "export again without Draco compression";

/// An accessor of a packed primitive, and the place of its decoded values.
struct Target {
    std::string name;  ///< name of the attribute
    std::uint32_t id = 0;
    json accessor;
    int componentType = 0;
    std::size_t components = 1;
    std::size_t offset = 0;  ///< bytes from the start of the primitive's buffer
};

/// A packed primitive while it is being decoded.
struct PackedPrimitive {
    std::size_t mesh = 0, primitive = 0;
    std::string place;
    std::span<const std::uint8_t> coded;
    std::vector<Target> attributes;
    Target indices;
    std::uint64_t mostPoints = 0, mostFaces = 0;  ///< limits that the accessors give
    std::size_t points = 0, faces = 0;            ///< what the stream has
    Bytes plain;
};

/// Draco's decoder with limits. It stops before it allocates more than the accessors state or more than the allowance
/// has left. The sizes in bytes are rounded up from what version 1.5.5 allocates.
template <class Decoder>
class BoundedDecoder final : public Decoder {
  public:
    BoundedDecoder(const PackedPrimitive& packed, Allowance& allowance)
        : packed_(packed), allowance_(allowance) {}

    /// The number that exceeds its limit, as text; empty if none does.
    const std::string& excess() const { return excess_; }
    bool ranOut() const { return ranOut_; }

  private:
    static constexpr bool kHasSeams = std::is_same_v<Decoder, draco::MeshEdgebreakerDecoder>;

    bool DecodeConnectivity() override {
        draco::DecoderBuffer ahead = *this->buffer();
        std::uint32_t first = 0, second = 0;
        std::uint8_t seams = 0;
        if (!draco::DecodeVarint(&first, &ahead) || !draco::DecodeVarint(&second, &ahead) ||
            (kHasSeams && !ahead.Decode(&seams))) {
            return false;
        }
        const std::uint64_t faces = kHasSeams ? second : first;
        if (faces > packed_.mostFaces) return exceeds(faces, "triangles");
        if (seams > Limits::kDracoAttributes) return exceeds(seams, "attributes with seams");
        return take(faces * (160 + 90 * std::uint64_t(seams))) && Decoder::DecodeConnectivity();
    }

    bool DecodeAllAttributes() override {
        const draco::PointCloud& cloud = *this->point_cloud();
        const std::uint64_t points = cloud.num_points();
        const auto attributes = std::size_t(cloud.num_attributes());
        if (points > packed_.mostPoints) return exceeds(points, "vertices");
        if (attributes > Limits::kDracoAttributes) return exceeds(attributes, "attributes");
        std::uint64_t perPoint = 16 * std::uint64_t(this->num_attributes_decoders());
        for (int i = 0; i < cloud.num_attributes(); ++i) {
            const auto size = std::uint64_t(cloud.attribute(i)->byte_stride());
            const auto components = std::uint64_t(cloud.attribute(i)->num_components());
            constexpr std::uint64_t kMost =
                std::numeric_limits<std::int32_t>::max();  // Draco's own
            if (points * std::max(size, 4 * components) > kMost) return exceeds(points, "vertices");
            perPoint += size + 8 * components + 4;
        }
        return take(points * perPoint) && Decoder::DecodeAllAttributes();
    }

    bool exceeds(std::uint64_t count, const char* what) {
        excess_ = std::to_string(count) + " " + what;
        return false;
    }

    bool take(std::uint64_t bytes) {
        ranOut_ = !allowance_.take(bytes);
        return !ranOut_;
    }

    const PackedPrimitive& packed_;
    Allowance& allowance_;
    std::string excess_;
    bool ranOut_ = false;
};

/// Whether the bytes after the header can hold the metadata that they claim. Draco allocates a place for each part that
/// is still to come, and trusts the claims of each part.
bool holdsMetadata(draco::DecoderBuffer ahead) {
    const auto skip = [&](std::uint64_t size) {
        if (size > std::uint64_t(ahead.remaining_size())) return false;
        ahead.Advance(std::int64_t(size));
        return true;
    };
    const auto skipName = [&] {
        std::uint8_t size = 0;
        return ahead.Decode(&size) && skip(size);
    };
    const auto skipEntry = [&] {
        std::uint32_t size = 0;
        return skipName() && draco::DecodeVarint(&size, &ahead) && skip(size);
    };
    const auto skipTree = [&] {
        std::uint64_t open = 1;
        for (bool isRoot = true; open > 0; isRoot = false, --open) {
            std::uint32_t entries = 0, parts = 0;
            if (!(isRoot || skipName()) || !draco::DecodeVarint(&entries, &ahead)) return false;
            for (; entries > 0; --entries) {
                if (!skipEntry()) return false;
            }
            if (!draco::DecodeVarint(&parts, &ahead)) return false;
            open += parts;
            if (open > std::uint64_t(ahead.remaining_size()) + 1) return false;
        }
        return true;
    };
    std::uint32_t attributes = 0, id = 0;
    if (!draco::DecodeVarint(&attributes, &ahead)) return false;
    for (; attributes > 0; --attributes) {
        if (!draco::DecodeVarint(&id, &ahead) || !skipTree()) return false;
    }
    return skipTree();
}

template <class Decoder>
void decodeBy(Document& document, const PackedPrimitive& packed, draco::DecoderBuffer& buffer,
              draco::Mesh& mesh) {
    BoundedDecoder<Decoder> decoder(packed, document.allowance);
    const draco::DecoderOptions options;
    const draco::Status status =
        static_cast<draco::MeshDecoder&>(decoder).Decode(options, &buffer, &mesh);
    if (decoder.ranOut()) refuseUnpacking(document, packed.place);
    if (!decoder.excess().empty()) {
        refuse(document.file, packed.place,
               "at most " + std::to_string(packed.mostFaces) + " triangles and " +
                   std::to_string(packed.mostPoints) + " vertices, as its accessors say, of " +
                   std::to_string(Limits::kDracoAttributes) + " attributes",
               decoder.excess(), kWithoutDraco);
    }
    if (!status.ok()) {
        refuse(document.file, packed.place, "a mesh packed by Draco",
               "a damaged one (" + printable(status.error_msg_string(), 80) + ")",
               "copy the file again, or " + std::string(kWithoutDraco));
    }
}

void decodeStream(Document& document, const PackedPrimitive& packed, draco::Mesh& mesh) {
    draco::DecoderBuffer buffer;
    buffer.Init(reinterpret_cast<const char*>(packed.coded.data()), packed.coded.size());
    draco::DecoderBuffer ahead = buffer;
    draco::DracoHeader header;
    if (!draco::PointCloudDecoder::DecodeHeader(&ahead, &header).ok() ||
        header.encoder_type != draco::TRIANGULAR_MESH) {
        refuse(document.file, packed.place, "a mesh packed by Draco", "something else",
               kWithoutDraco);
    }
    // Older versions have other headers; the extension demands this one.
    if (header.version_major != 2 || header.version_minor != 2) {
        refuse(document.file, packed.place, "a Draco stream of version 2.2",
               "version " + std::to_string(header.version_major) + "." +
                   std::to_string(header.version_minor),
               kWithoutDraco);
    }
    ahead.set_bitstream_version(DRACO_BITSTREAM_VERSION(2, 2));
    if ((header.flags & METADATA_FLAG_MASK) && !holdsMetadata(ahead)) {
        refuse(document.file, packed.place, "a mesh packed by Draco", "damaged metadata",
               kWithoutDraco);
    }
    switch (header.encoder_method) {
        case draco::MESH_SEQUENTIAL_ENCODING:
            return decodeBy<draco::MeshSequentialDecoder>(document, packed, buffer, mesh);
        case draco::MESH_EDGEBREAKER_ENCODING:
            return decodeBy<draco::MeshEdgebreakerDecoder>(document, packed, buffer, mesh);
        default:
            refuse(document.file, packed.place, "Draco's sequential or edgebreaker coding",
                   "method " + std::to_string(header.encoder_method), kWithoutDraco);
    }
}

std::size_t bytesOf(const Target& target) {
    return componentSize(target.componentType) * target.components;
}

void writeAttribute(const Document& document, PackedPrimitive& packed, const draco::Mesh& mesh,
                    const Target& target) {
    const draco::PointAttribute* attribute = mesh.GetAttributeByUniqueId(target.id);
    const std::string place = packed.place + ".attributes." + target.name;
    if (!attribute) {
        refuse(document.file, place, "an attribute of the stream",
               "none of id " + std::to_string(target.id), kWithoutDraco);
    }
    if (attribute->num_components() != target.components) {
        refuse(document.file, place,
               std::to_string(target.components) + " components, as its accessor says",
               std::to_string(attribute->num_components()), kWithoutDraco);
    }
    // The bytes of a boolean may be neither true nor false; Draco does not check that.
    if (attribute->data_type() == draco::DT_BOOL) {
        refuse(document.file, place, "values that are numbers", "values that are booleans",
               kWithoutDraco);
    }
    withComponentType(target.componentType, [&](auto zero) {
        using T = decltype(zero);
        auto* to = reinterpret_cast<T*>(packed.plain.data.get() + target.offset);
        for (std::uint32_t i = 0; i < mesh.num_points(); ++i, to += target.components) {
            const auto value = attribute->mapped_index(draco::PointIndex(i));
            if (!attribute->ConvertValue(value, std::int8_t(target.components), to)) {
                refuse(document.file, place, "values that its accessor's component type can hold",
                       "another one, of vertex " + std::to_string(i), kWithoutDraco);
            }
        }
    });
}

void writeIndices(const Document& document, PackedPrimitive& packed, const draco::Mesh& mesh) {
    withComponentType(packed.indices.componentType, [&](auto zero) {
        using T = decltype(zero);
        auto* to = reinterpret_cast<T*>(packed.plain.data.get());
        for (std::uint32_t i = 0; i < mesh.num_faces(); ++i) {
            for (const draco::PointIndex& corner : mesh.face(draco::FaceIndex(i))) {
                const std::uint32_t vertex = corner.value();
                *to++ = T(vertex);
                if (vertex < mesh.num_points() && std::uint32_t(T(vertex)) == vertex) continue;
                refuse(document.file, packed.place,
                       "vertex indices below " + std::to_string(mesh.num_points()) +
                           " that their accessor can hold",
                       std::to_string(vertex), kWithoutDraco);
            }
        }
    });
}

/// Decodes the primitive into `plain`: indices, then one attribute after the other, each at a
/// multiple of four bytes.
void unpack(Document& document, PackedPrimitive& packed) {
    draco::Mesh mesh;
    decodeStream(document, packed, mesh);
    packed.points = mesh.num_points();
    packed.faces = mesh.num_faces();
    std::size_t size = packed.faces * 3 * bytesOf(packed.indices);
    for (Target& target : packed.attributes) {
        target.offset = (size + 3) / 4 * 4;
        size = target.offset + packed.points * bytesOf(target);
    }
    if (!document.allowance.take(size)) refuseUnpacking(document, packed.place);
    packed.plain = {std::make_unique<std::uint8_t[]>(size), size};
    writeIndices(document, packed, mesh);
    for (const Target& target : packed.attributes) writeAttribute(document, packed, mesh, target);
}

/// The target that accessor `index` (in range) describes.
Target targetOf(const Document& document, std::size_t index, const std::string& name) {
    Target target;
    target.name = name;
    target.accessor = document.json["accessors"][index];
    const std::string place = "accessors[" + std::to_string(index) + "]";
    target.componentType = target.accessor.value("componentType", 0);
    if (componentSize(target.componentType) == 0) {
        refuse(document.file, place + ".componentType", "5120 to 5123, 5125 or 5126",
               std::to_string(target.componentType));
    }
    const std::string type = target.accessor.value("type", std::string());
    if (type.starts_with("VEC") && type.size() == 4 && type[3] >= '2' && type[3] <= '4') {
        target.components = std::size_t(type[3] - '0');
    } else if (type != "SCALAR") {
        refuse(document.file, place + ".type", "SCALAR or VEC2 to VEC4",
               '"' + printable(type, 40) + '"');
    }
    return target;
}

std::uint64_t countOf(const Target& target) {
    return target.accessor.value("count", std::uint64_t(0));
}

/// Without an accessor of indices, the number of triangles is that of the stream.
void readIndexTarget(const Document& document, const json& primitive, PackedPrimitive& packed) {
    const auto indices = primitive.find("indices");
    if (indices == primitive.end()) {
        packed.indices.componentType = TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
        packed.indices.accessor = {{"componentType", packed.indices.componentType},
                                   {"type", "SCALAR"}};
        packed.mostFaces = Limits::kTriangles;
        return;
    }
    packed.indices = targetOf(document, indices->get<std::size_t>(), "");
    const int type = packed.indices.componentType;
    if (!isIndexType(type) || packed.indices.components != 1) {
        refuse(document.file, packed.place, "indices that are plain unsigned integers",
               "component type " + std::to_string(type));
    }
    const std::uint64_t count = countOf(packed.indices);
    packed.mostFaces = std::min<std::uint64_t>(
        primitive.value("mode", TINYGLTF_MODE_TRIANGLES) == TINYGLTF_MODE_TRIANGLES ? count / 3
                                                                                    : count,
        Limits::kTriangles);
}

PackedPrimitive readPackedPrimitive(const Document& document, std::size_t mesh, std::size_t index,
                                    const json& primitive, const json& extension) {
    PackedPrimitive packed;
    packed.mesh = mesh;
    packed.primitive = index;
    const std::string place =
        "meshes[" + std::to_string(mesh) + "].primitives[" + std::to_string(index) + "]";
    packed.place = place + ".extensions." + kDraco;
    const int mode = primitive.value("mode", TINYGLTF_MODE_TRIANGLES);
    if (mode != TINYGLTF_MODE_TRIANGLES && mode != TINYGLTF_MODE_TRIANGLE_STRIP) {
        refuse(document.file, place + ".mode", "4 or 5, which Draco packs", std::to_string(mode));
    }
    const auto view = extension.find("bufferView");
    const auto ids = extension.find("attributes");
    if (view == extension.end() || ids == extension.end()) {
        refuse(document.file, packed.place, "a bufferView and attributes", "one or none",
               kWithoutDraco);
    }
    packed.coded = rangeOf(document, document.json["bufferViews"][view->get<std::size_t>()],
                           "bufferViews[" + view->dump() + "]");
    const auto accessors = primitive.find("attributes");
    for (auto id = ids->begin(); id != ids->end(); ++id) {
        const std::string name = printable(id.key(), 40);
        if (accessors == primitive.end() || !accessors->contains(id.key())) {
            refuse(document.file, packed.place + ".attributes." + name,
                   "an attribute of the primitive too", "none", kWithoutDraco);
        }
        Target target = targetOf(document, (*accessors)[id.key()].get<std::size_t>(), id.key());
        target.id = id->get<std::uint32_t>();
        if (target.name == "POSITION") packed.mostPoints = countOf(target);
        packed.attributes.push_back(std::move(target));
    }
    if (!ids->contains("POSITION")) {
        refuse(document.file, packed.place + ".attributes", "POSITION", "none", kWithoutDraco);
    }
    readIndexTarget(document, primitive, packed);
    return packed;
}

/// Replaces the packed primitive by one that needs no extension.
void makePlain(Document& document, PackedPrimitive& packed, Warnings& warnings) {
    json& root = document.json;
    const std::size_t view = root["bufferViews"].size();
    root["bufferViews"].push_back({{"byteLength", packed.plain.size},
                                   {"buffer", addBuffer(document, std::move(packed.plain))}});
    const auto add = [&](Target& target, std::size_t count) {
        target.accessor["bufferView"] = view;
        target.accessor["byteOffset"] = target.offset;
        target.accessor["count"] = count;
        root["accessors"].push_back(std::move(target.accessor));
        return root["accessors"].size() - 1;
    };
    json& primitive = root["meshes"][packed.mesh]["primitives"][packed.primitive];
    const bool isStrip =
        primitive.value("mode", TINYGLTF_MODE_TRIANGLES) != TINYGLTF_MODE_TRIANGLES;
    warnings.add("Draco streams have fewer vertices or triangles than their accessors say",
                 packed.points < packed.mostPoints ||
                     (primitive.contains("indices") && !isStrip && packed.faces < packed.mostFaces),
                 packed.place);
    for (Target& target : packed.attributes) {
        primitive["attributes"][target.name] = add(target, packed.points);
    }
    primitive["indices"] = add(packed.indices, packed.faces * 3);
    primitive["mode"] = TINYGLTF_MODE_TRIANGLES;
    primitive.erase("extensions");
}

}  // namespace

void unpackDraco(Document& document, Warnings& warnings) {
    const auto meshes = document.json.find("meshes");
    if (meshes == document.json.end()) return;
    std::vector<PackedPrimitive> packed;
    for (std::size_t m = 0; m < meshes->size(); ++m) {
        const auto primitives = (*meshes)[m].find("primitives");
        if (primitives == (*meshes)[m].end()) continue;
        for (std::size_t p = 0; p < primitives->size(); ++p) {
            const json& primitive = (*primitives)[p];
            const auto extensions = primitive.find("extensions");
            if (extensions == primitive.end() || !extensions->contains(kDraco)) continue;
            packed.push_back(readPackedPrimitive(document, m, p, primitive, (*extensions)[kDraco]));
        }
    }
    inParallel(packed, [&](PackedPrimitive& entry) { unpack(document, entry); });
    for (PackedPrimitive& entry : packed) makePlain(document, entry, warnings);
}

}  // namespace lacuna::gltf
