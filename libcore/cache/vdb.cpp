#include "libcore/cache/vdb.h"

#include <openvdb/io/Stream.h>

#include <cmath>
#include <sstream>

#include "libcore/base/error.h"
#include "libcore/cache/guarded_file.h"

namespace lacuna::vdb {

namespace {
const char* const kKind = "lacuna.kind";
const char* const kFormat = "lacuna.version";
const char* const kInputs = "lacuna.inputs";  // CacheStamp::text()
const char* const kContent = "lacuna.content_hash";
const char* const kOrigin = "lacuna.origin";  // in the scene file's coordinates
const char* const kVoxel = "lacuna.voxel_size";
const char* const kSize = "lacuna.size";
constexpr int kLargestSide = 4096;
constexpr double kMostVoxels = double(1 << 30);  // readers make dense arrays of them

openvdb::Vec3d toVdb(const Vec3d& v) {
    return {v.x, v.y, v.z};
}
}  // namespace

void putHeader(openvdb::MetaMap& meta, const std::string& kind, const CacheStamp& stamp,
               const VoxelShape& shape, const Vec3d& centre, const std::string& contentHash) {
    meta.insertMeta(kKind, openvdb::StringMetadata(kind));
    meta.insertMeta(kFormat, openvdb::Int32Metadata(kVersion));
    meta.insertMeta(kInputs, openvdb::StringMetadata(stamp.text()));
    meta.insertMeta(kContent, openvdb::StringMetadata(contentHash));
    meta.insertMeta(kOrigin, openvdb::Vec3DMetadata(toVdb(shape.origin + centre)));
    meta.insertMeta(kVoxel, openvdb::DoubleMetadata(shape.voxel));
    meta.insertMeta(kSize, openvdb::Vec3IMetadata({shape.size[0], shape.size[1], shape.size[2]}));
}

openvdb::math::Transform::Ptr transformOf(const VoxelShape& shape, const Vec3d& centre) {
    auto transform = openvdb::math::Transform::createLinearTransform(shape.voxel);
    transform->postTranslate(toVdb(shape.centre({0, 0, 0}) + centre));
    return transform;
}

void write(const std::string& path, const openvdb::GridPtrVec& grids,
           const openvdb::MetaMap& meta) {
    std::ostringstream bytes(std::ios::binary);
    openvdb::io::Stream stream(bytes);
    stream.setCompression(openvdb::io::COMPRESS_BLOSC | openvdb::io::COMPRESS_ACTIVE_MASK);
    stream.write(grids, meta);
    writeGuarded(path, std::move(bytes).str());
}

void refuse(const std::string& path, const std::string& expected, const std::string& found,
            const std::string& remedy) {
    throw InputError(path + ": expected " + expected + ", found " + found + "; " + remedy);
}

Content read(const std::string& path, const std::string& kind, const CacheStamp& expected,
             const Vec3d& centre, const std::string& remedy) {
    std::istringstream bytes(readGuarded(path, remedy), std::ios::binary);
    openvdb::initialize();
    Content content;
    try {
        openvdb::io::Stream stream(bytes, false);  // no delayed loading: `bytes` ends here
        content.grids = stream.getGrids();
        content.meta = stream.getMetadata();
        const openvdb::MetaMap& meta = *content.meta;
        const auto text = [&](const char* name) { return meta.metaValue<std::string>(name); };
        if (text(kKind) != kind) refuse(path, kind, text(kKind), remedy);
        const int version = meta.metaValue<std::int32_t>(kFormat);
        if (version != kVersion) {
            refuse(path, "format " + std::to_string(kVersion), std::to_string(version), remedy);
        }
        content.stamp = CacheStamp::parse(text(kInputs));
        content.contentHash = text(kContent);
        const auto origin = meta.metaValue<openvdb::Vec3d>(kOrigin);
        content.shape.origin = Vec3d{origin.x(), origin.y(), origin.z()} - centre;
        content.shape.voxel = meta.metaValue<double>(kVoxel);
        const auto size = meta.metaValue<openvdb::Vec3i>(kSize);
        content.shape.size = {size.x(), size.y(), size.z()};
    } catch (const openvdb::Exception& e) {
        refuse(path, kind + " written by lacuna", e.what(), remedy);
    }
    bool isSane = true;
    double voxels = 1.0;
    for (const int n : content.shape.size) {
        isSane = isSane && n >= 1 && n <= kLargestSide;
        voxels *= n;
    }
    if (!isSane || voxels > kMostVoxels) refuse(path, "a grid of sane size", "another", remedy);
    const Vec3d& origin = content.shape.origin;
    if (!(content.shape.voxel > 0.0) || !std::isnormal(content.shape.voxel) ||
        !std::isfinite(origin.x + origin.y + origin.z)) {
        refuse(path, "voxels with a size and a place", "none", remedy);
    }
    const std::string differ = differencesText(expected, content.stamp);
    if (!differ.empty()) refuse(path, kind + " made of what is rendered", differ, remedy);
    return content;
}

}  // namespace lacuna::vdb
