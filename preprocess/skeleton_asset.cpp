#include "preprocess/skeleton_asset.h"

#include "libcore/tool/table_options.h"
#include "preprocess/number_layer.h"
#include "preprocess/skeletonize.h"

namespace lacuna {
namespace {

class SkeletonAsset final : public Asset {
  public:
    explicit SkeletonAsset(SkeletonFile file)
        : skeleton_(std::make_shared<const Skeleton>(std::move(file.skeleton))),
          contentHash_(std::move(file.contentHash)) {}

    void giveTo(AssetSet& assets) const override { assets.put(skeleton_); }
    std::string contentHash() const override { return contentHash_; }
    void draw(LayeredImage& image, const Scene& scene, const Camera& camera, const PixelRect& crop,
              const ThreadPool& pool) const override {
        image.setRgb("node", numberLayer(scene, camera, crop, pool,
                                         [&](const SurfacePoint& hit, const Vec3& direction) {
                                             return nodeOf(hit, direction);
                                         }));
    }

  private:
    std::optional<std::uint32_t> nodeOf(const SurfacePoint& hit, const Vec3& direction) const {
        const Vec3d side(dot(hit.ng, direction) > 0.0f ? -hit.ng : hit.ng);
        const std::uint16_t node = skeleton_->map.at(Vec3d(hit.position), side);
        if (node == NodeMap::kNone) return std::nullopt;
        return node;
    }

    std::shared_ptr<const Skeleton> skeleton_;
    std::string contentHash_;
};

}  // namespace

std::unique_ptr<Asset> acquireSkeleton(const AssetRequest& r) {
    const Scene& scene = *r.stage.scene;
    const VoxelSettings settings = voxelOptions().read(r.settings, r.prefix);
    const CacheStamp stamp = voxelStamp(sceneInputs(r.stage), settings);
    const std::string arguments = optionArguments(changedValues(voxelOptions(), settings)) +
                                  sceneArguments(r.options) + " " + shellQuoted(r.options.scene);
    const std::string remedy = "add --prepare, or run lacuna-voxelize" + arguments +
                               " and then lacuna-skeletonize" + arguments;
    std::optional<SkeletonFile> file;
    r.phases.run("read skeleton", [&] {
        file = readCache<SkeletonFile>(
            r, stamp, "skeleton.vdb", remedy,
            [&](const std::string& path, const CacheStamp& expected, const std::string& todo) {
                return readSkeletonFile(path, expected, scene.centre(), todo);
            });
    });
    if (!file) {
        const std::string path = r.file(stamp, "skeleton.vdb");
        const std::string voxelPath = r.file(stamp, "voxels.vdb");
        makeCacheDirectory(path);
        std::optional<VoxelFile> voxels;
        r.phases.run("read voxels", [&] {
            voxels = readCache<VoxelFile>(
                r, stamp, "voxels.vdb", remedy,
                [&](const std::string& from, const CacheStamp& expected, const std::string& todo) {
                    return readVoxelFile(from, expected, scene.centre(), todo);
                });
        });
        if (!voxels) {
            voxels = voxelizeScene(scene, settings, stamp, r.pool, r.cancel, r.phases).file;
            r.pool.run([&] {
                writeVoxelFile(voxelPath, *voxels, scene.centre());
                voxels = readVoxelFile(voxelPath, stamp, scene.centre(), remedy);
            });
        }
        file = skeletonize(scene, *voxels, r.pool, r.cancel, r.phases).file;
        // The file is read back: it stores positions in the scene's own coordinates, which rounds
        // them. The picture must be the same as that of later renders, which read the file.
        r.pool.run([&] {
            writeSkeletonFile(path, *file, scene.centre());
            file = readSkeletonFile(path, stamp, scene.centre(), remedy);
        });
        r.built(path);
    }
    return std::make_unique<SkeletonAsset>(std::move(*file));
}

}  // namespace lacuna
