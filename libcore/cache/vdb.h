// Reads and writes grids in .vdb files. For those files of this folder that include OpenVDB.
#pragma once

#include <openvdb/openvdb.h>

#include <string>

#include "libcore/cache/cache_name.h"
#include "libcore/voxel/grid.h"

// Debian 12's library exports the grid classes used here. To compile them anew would take ten seconds per grid and
// file. (Where GCC optimises, it needs no more of them than what is exported.)
#ifdef LACUNA_GRIDS_OF_OPENVDB
namespace openvdb {
OPENVDB_USE_VERSION_NAMESPACE
namespace OPENVDB_VERSION_NAME {
extern template class Grid<BoolTree>;
extern template class Grid<FloatTree>;
extern template class Grid<Int32Tree>;
namespace tree {
extern template class Tree<BoolTree::RootNodeType>;
extern template class Tree<FloatTree::RootNodeType>;
extern template class Tree<Int32Tree::RootNodeType>;
}  // namespace tree
}  // namespace OPENVDB_VERSION_NAME
}  // namespace openvdb
#endif

namespace lacuna::vdb {

inline constexpr int kVersion = 2;

/// Writes the stamp, `kind`, the version and the lattice into a file's metadata.
void putHeader(openvdb::MetaMap& meta, const std::string& kind, const CacheStamp& stamp,
               const VoxelShape& shape, const Vec3d& centre, const std::string& contentHash);

/// Index space -> the scene file's coordinates; OpenVDB's voxels are centred at their index.
openvdb::math::Transform::Ptr transformOf(const VoxelShape& shape, const Vec3d& centre);

/// Writes the file and its sidecar (guarded_file.h). Throws RunError.
void write(const std::string& path, const openvdb::GridPtrVec& grids, const openvdb::MetaMap& meta);

struct Content {
    openvdb::GridPtrVecPtr grids;
    openvdb::MetaMap::Ptr meta;
    VoxelShape shape;  ///< in recentred coordinates
    CacheStamp stamp;
    std::string contentHash;
};
/// Throws InputError naming what does not fit: kind, version, size or inputs. `remedy` tells the
/// user what to do.
Content read(const std::string& path, const std::string& kind, const CacheStamp& expected,
             const Vec3d& centre, const std::string& remedy);

/// The grid of that name and type. Throws InputError if there is none.
template <class GridType>
typename GridType::Ptr gridOf(const Content& content, const std::string& name,
                              const std::string& path, const std::string& remedy);

/// Throws InputError "`path`: expected .., found ..; `remedy`".
[[noreturn]] void refuse(const std::string& path, const std::string& expected,
                         const std::string& found, const std::string& remedy);

template <class GridType>
typename GridType::Ptr gridOf(const Content& content, const std::string& name,
                              const std::string& path, const std::string& remedy) {
    for (const auto& grid : *content.grids) {
        if (grid->getName() != name) continue;
        if (auto typed = openvdb::gridPtrCast<GridType>(grid)) return typed;
    }
    refuse(path, "a grid '" + name + "'", "none of its kind", remedy);
}

}  // namespace lacuna::vdb
