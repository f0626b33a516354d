// KEY.skeleton.vdb, which lacuna-skeletonize writes and lacuna-render reads. It holds one grid,
// "node" (active where a node is mapped; value: its index), and the graph in the file's metadata.
// (files.md, "Skeleton")
#pragma once

#include "libcore/cache/cache_name.h"
#include "libcore/skeleton/node_map.h"

namespace lacuna {

struct SkeletonFile {
    Skeleton skeleton;
    CacheStamp stamp;
    std::string contentHash;
};

/// Writes the file. `centre`: Scene::centre(). Throws RunError.
void writeSkeletonFile(const std::string& path, const SkeletonFile& file, const Vec3d& centre);

/// Throws InputError if the file is missing, damaged, of another kind or version, or made of other
/// inputs than `expected` names; `remedy` tells the user what to do.
SkeletonFile readSkeletonFile(const std::string& path, const CacheStamp& expected,
                              const Vec3d& centre, const std::string& remedy);

}  // namespace lacuna
