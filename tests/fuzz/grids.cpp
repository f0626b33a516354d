// OpenVDB files that are sound, with content that is not.
#include <type_traits>

#include "libcore/cache/skeleton_file.h"
#include "libcore/cache/vdb.h"
#include "libcore/cache/voxel_file.h"
#include "tests/cache/example_subspaces.h"
#include "tests/fuzz/attempt.h"

namespace lacuna::test {
namespace {

/// Takes values from the front of the input; zeros behind its end.
class Source {
  public:
    explicit Source(Bytes bytes) : bytes_(bytes) {}

    template <class T>
    T value() {
        T result{};
        const Bytes from = take(sizeof(T));
        std::copy(from.begin(), from.end(), reinterpret_cast<std::uint8_t*>(&result));
        return result;
    }
    /// As many bytes as the next one says, in units of `unit`.
    std::string text(std::size_t unit) {
        const Bytes from = take(value<std::uint8_t>() * unit);
        return {from.begin(), from.end()};
    }
    bool empty() const { return bytes_.empty(); }

  private:
    Bytes take(std::size_t size) {
        const Bytes front = bytes_.first(std::min(size, bytes_.size()));
        bytes_ = bytes_.subspan(front.size());
        return front;
    }
    Bytes bytes_;
};

openvdb::MetaMap metaOf(Source& source, const char* kind) {
    VoxelShape shape;
    for (int& side : shape.size) side = source.value<std::int32_t>();
    // Large ones are sound, and would keep the fuzzer waiting for memory.
    constexpr double kMany = 1 << 22, kTooMany = 1 << 30;
    const double voxels = double(shape.size[0]) * shape.size[1] * shape.size[2];
    if (voxels > kMany && voxels <= kTooMany) shape.size = {1, 1, 1};
    shape.origin = {source.value<double>(), source.value<double>(), source.value<double>()};
    shape.voxel = source.value<double>();
    openvdb::MetaMap meta;
    vdb::putHeader(meta, kind, kStamp, shape, {}, "content");
    return meta;
}

/// Voxels with values, some where the grid should have none. A value may fill a whole tile.
template <class GridType>
typename GridType::Ptr gridOf(Source& source, const char* name) {
    auto grid = GridType::create();
    grid->setName(name);
    while (!source.empty()) {
        const auto where = [&] { return int(source.value<std::int16_t>()); };
        const openvdb::Coord at(where(), where(), where());
        using Value = typename GridType::ValueType;
        using Bits = std::conditional_t<std::is_same_v<Value, bool>, std::uint8_t, Value>;
        const auto value = Value(source.value<Bits>());
        const auto tile = source.value<std::uint8_t>();
        if (tile % 8 == 7) {
            grid->fill(openvdb::CoordBBox::createCube(at, 8), value);
        } else {
            grid->tree().setValue(at, value);
        }
    }
    return grid;
}

template <class Read>
bool acceptsGrids(const openvdb::GridPtrVec& grids, const openvdb::MetaMap& meta,
                  const Read& read) {
    const std::string path = fileOf("grids.vdb", {});
    vdb::write(path, grids, meta);
    return attempt([&] { read(path); });
}

}  // namespace

bool acceptsSkeleton(Bytes bytes) {
    openvdb::initialize();
    Source source(bytes);
    openvdb::MetaMap meta = metaOf(source, "skeleton");
    meta.insertMeta("lacuna.nodes", openvdb::StringMetadata(source.text(8)));
    meta.insertMeta("lacuna.edges", openvdb::StringMetadata(source.text(8)));
    const auto node = gridOf<openvdb::Int32Grid>(source, "node");
    return acceptsGrids({node}, meta, [](const std::string& path) {
        const SkeletonFile file = readSkeletonFile(path, kStamp, {}, "make it again");
        // At any place the map names a node of the skeleton or none.
        for (const double x : {-1e30, -1.0, 0.0, 0.5, 1.0, 3.0, 1e30}) {
            const std::uint16_t found = file.skeleton.map.at({x, x, x}, {0, 0, 1});
            if (found != NodeMap::kNone && found >= file.skeleton.nodes.size()) {
                throw std::logic_error("a node that is not there");
            }
        }
    });
}

bool acceptsVoxels(Bytes bytes) {
    openvdb::initialize();
    Source source(bytes);
    const openvdb::MetaMap meta = metaOf(source, "voxels");
    const auto distance = gridOf<openvdb::FloatGrid>(source, "distance");
    // The same bytes once more: what is solid.
    Source again(bytes.subspan(std::min<std::size_t>(44, bytes.size())));
    const auto solid = gridOf<openvdb::BoolGrid>(again, "solid");
    return acceptsGrids({solid, distance}, meta, [](const std::string& path) {
        readVoxelFile(path, kStamp, {}, "make it again");
    });
}

}  // namespace lacuna::test
