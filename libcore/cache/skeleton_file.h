// KEY.skeleton.vdb: what lacuna-skeletonize writes and lacuna-render reads. One grid, "node"
// (active where a node is mapped, value: its index), and the graph in the file's metadata.
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

/// `centre` as of Scene::centre(). Throws RunError.
void writeSkeletonFile(const std::string& path, const SkeletonFile& file, const Vec3d& centre);

/// Throws InputError if the file is missing, damaged, of another kind or version, or made of other
/// inputs than `expected` names; `remedy` says what to do.
SkeletonFile readSkeletonFile(const std::string& path, const CacheStamp& expected,
                              const Vec3d& centre, const std::string& remedy);

}  // namespace lacuna
