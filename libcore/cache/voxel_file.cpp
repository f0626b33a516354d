#include "libcore/cache/voxel_file.h"

#include <openvdb/tools/Dense.h>

#include "libcore/cache/vdb.h"

namespace lacuna {

namespace {

const char* const kVoxelKind = "voxels";

template <class T>
using DenseView = openvdb::tools::Dense<T, openvdb::tools::LayoutXYZ>;

openvdb::CoordBBox boxOf(const VoxelShape& shape) {
    return {openvdb::Coord(0),
            openvdb::Coord(shape.size[0] - 1, shape.size[1] - 1, shape.size[2] - 1)};
}

}  // namespace

void writeVoxelFile(const std::string& path, const VoxelFile& file, const Vec3d& centre) {
    openvdb::initialize();
    const VoxelSpace& space = file.space;
    const VoxelShape& shape = space.shape;
    auto solid = openvdb::BoolGrid::create(false);
    solid->setName("solid");
    auto accessor = solid->getAccessor();
    for (std::size_t i = 0; i < space.state.size(); ++i) {
        if (space.state[i] != VoxelState::Solid) continue;
        const VoxelIndex v = shape.indexOf(i);
        accessor.setValueOn({v[0], v[1], v[2]}, true);
    }

    auto distance = openvdb::FloatGrid::create(0.0f);
    distance->setName("distance");
    // OpenVDB's view of foreign memory demands writable memory but does not write.
    DenseView<float> dense(boxOf(shape), const_cast<float*>(space.distance.data()));
    openvdb::tools::copyFromDense(dense, *distance, 0.0f);

    for (const openvdb::GridBase::Ptr& grid :
         {openvdb::GridBase::Ptr(solid), openvdb::GridBase::Ptr(distance)}) {
        grid->setTransform(vdb::transformOf(shape, centre));
    }
    openvdb::MetaMap meta;
    vdb::putHeader(meta, kVoxelKind, file.stamp, shape, centre, space.contentHash());
    vdb::write(path, {solid, distance}, meta);
}

VoxelFile readVoxelFile(const std::string& path, const CacheStamp& expected, const Vec3d& centre,
                        const std::string& remedy) {
    const vdb::Content content = vdb::read(path, kVoxelKind, expected, centre, remedy);
    VoxelFile file;
    file.stamp = content.stamp;
    VoxelSpace& space = file.space;
    space.shape = content.shape;
    const auto solid = vdb::gridOf<openvdb::BoolGrid>(content, "solid", path, remedy);
    const auto distance = vdb::gridOf<openvdb::FloatGrid>(content, "distance", path, remedy);

    space.distance.resize(space.shape.count());
    DenseView<float> dense(boxOf(space.shape), space.distance.data());
    openvdb::tools::copyToDense(*distance, dense);
    space.state.resize(space.shape.count(), VoxelState::Unreached);
    for (std::size_t i = 0; i < space.state.size(); ++i) {
        if (space.distance[i] > 0.0f) space.state[i] = VoxelState::Empty;
    }
    for (auto it = solid->cbeginValueOn(); it; ++it) {
        const openvdb::CoordBBox box = it.getBoundingBox();
        if (!boxOf(space.shape).isInside(box)) {
            vdb::refuse(path, "solid voxels inside the grid", "others", remedy);
        }
        for (auto c = box.begin(); c; ++c) {
            space.state[space.shape.at({(*c).x(), (*c).y(), (*c).z()})] = VoxelState::Solid;
        }
    }
    return file;
}

}  // namespace lacuna
