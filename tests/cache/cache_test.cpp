// Cache files come back as they were written, open in OpenVDB as they are, and are refused when
// anything about them is wrong.
#include <gtest/gtest.h>
#include <openvdb/openvdb.h>

#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "libcore/base/error.h"
#include "libcore/base/parallel.h"
#include "libcore/base/rng.h"
#include "libcore/cache/guarded_file.h"
#include "libcore/cache/skeleton_file.h"
#include "libcore/cache/voxel_file.h"

namespace lacuna::test {
namespace {

const Vec3d kCentre{10, -20, 30};

class Directory {
  public:
    Directory() : path_(std::filesystem::temp_directory_path() / ("lacuna-cache-test-" + name())) {
        std::filesystem::create_directories(path_);
    }
    ~Directory() { std::filesystem::remove_all(path_); }
    std::string file(const std::string& name) const { return (path_ / name).string(); }

  private:
    static std::string name() {
        return testing::UnitTest::GetInstance()->current_test_info()->name();
    }
    std::filesystem::path path_;
};

std::string contentOf(const std::string& path) {
    std::ostringstream bytes;
    bytes << std::ifstream(path, std::ios::binary).rdbuf();
    return bytes.str();
}

void replace(const std::string& path, const std::string& bytes) {
    std::ofstream(path, std::ios::binary | std::ios::trunc) << bytes;
}

const CacheStamp kVoxelStamp{{{"scene", "0123abc"}, {"resolution", "24"}, {"domain", "auto"}}};

VoxelFile voxels() {
    VoxelFile file;
    file.stamp = kVoxelStamp;
    VoxelSpace& space = file.space;
    space.shape = {{24, 17, 9}, {-3, -2, -1}, 0.25};
    Rng rng(4, 0, StreamKind::User, 0);
    for (std::size_t i = 0; i < space.shape.count(); ++i) {
        const auto state = VoxelState(rng.below(3));
        space.state.push_back(state);
        space.distance.push_back(state == VoxelState::Empty ? 0.01f + rng.uniform() : 0.0f);
    }
    return file;
}

SkeletonFile skeleton() {
    SkeletonFile file;
    file.stamp = kVoxelStamp;
    file.skeleton.nodes = {{{-1, 0.5, 0.25}, 0.75}, {{1, 0.5, 0.25}, 0.5}};
    file.skeleton.edges = {{{0, 1}, {0, 0.5, 0.25}, {0.25, 0.5, 0.25}}};
    const VoxelShape shape{{24, 17, 9}, {-3, -2, -1}, 0.25};
    std::vector<std::uint16_t> entries;
    for (std::size_t i = 0; i < shape.count(); ++i) {
        entries.push_back(i % 5 == 0   ? NodeMap::kNone
                          : i % 3 == 0 ? std::uint16_t(NodeMap::kSolid | i % 2)
                                       : std::uint16_t(i % 2));
    }
    file.skeleton.map = NodeMap(shape, std::move(entries));
    return file;
}

TEST(Cache, voxelsComeBack) {
    const Directory d;
    const VoxelFile written = voxels();
    writeVoxelFile(d.file("v.vdb"), written, kCentre);
    const VoxelFile read = readVoxelFile(d.file("v.vdb"), kVoxelStamp, kCentre, "do it again");
    EXPECT_EQ(read.space.shape.size, written.space.shape.size);
    EXPECT_EQ(read.space.shape.origin, written.space.shape.origin);
    EXPECT_EQ(read.space.state, written.space.state);
    EXPECT_EQ(read.space.distance, written.space.distance);
    EXPECT_EQ(read.stamp, written.stamp);
    EXPECT_EQ(read.space.contentHash(), written.space.contentHash());
}

TEST(Cache, skeletonsComeBack) {
    const Directory d;
    const SkeletonFile written = skeleton();
    writeSkeletonFile(d.file("s.vdb"), written, kCentre);
    const SkeletonFile read =
        readSkeletonFile(d.file("s.vdb"), kVoxelStamp, kCentre, "do it again");
    ASSERT_EQ(read.skeleton.nodes.size(), 2u);
    EXPECT_EQ(read.skeleton.nodes[1].position, written.skeleton.nodes[1].position);
    EXPECT_EQ(read.skeleton.nodes[1].radius, 0.5);
    ASSERT_EQ(read.skeleton.edges.size(), 1u);
    EXPECT_EQ(read.skeleton.edges[0].enter, written.skeleton.edges[0].enter);
    const auto a = read.skeleton.map.entries(), b = written.skeleton.map.entries();
    EXPECT_TRUE(std::equal(a.begin(), a.end(), b.begin(), b.end()));
}

TEST(Cache, viewersOpenTheFileInItsOwnCoordinates) {
    const Directory d;
    writeVoxelFile(d.file("v.vdb"), voxels(), kCentre);
    openvdb::initialize();
    openvdb::io::File file(d.file("v.vdb"));
    file.open();
    const auto grid = openvdb::gridPtrCast<openvdb::FloatGrid>(file.readGrid("distance"));
    ASSERT_TRUE(grid);
    const openvdb::Vec3d p = grid->indexToWorld(openvdb::Coord(0, 0, 0));
    EXPECT_NEAR(p.x(), -3 + 0.125 + kCentre.x, 1e-12);
    EXPECT_NEAR(p.y(), -2 + 0.125 + kCentre.y, 1e-12);
    EXPECT_EQ(file.getMetadata()->metaValue<std::string>("lacuna.inputs"), kVoxelStamp.text());
}

template <class Read>
void expectRefused(const Read& read, const std::string& what) {
    try {
        read();
        ADD_FAILURE() << what << " was accepted";
    } catch (const InputError& e) {
        EXPECT_NE(std::string(e.what()).find("do it again"), std::string::npos) << e.what();
    }
}

TEST(Cache, damagedFilesAreRefused) {
    const Directory d;
    const std::string path = d.file("v.vdb");
    writeVoxelFile(path, voxels(), kCentre);
    const std::string good = contentOf(path), guard = contentOf(path + ".xxh3");
    const auto read = [&] { readVoxelFile(path, kVoxelStamp, kCentre, "do it again"); };
    Rng rng(5, 0, StreamKind::User, 0);
    for (int n = 0; n < 100; ++n) {
        std::string bad = good;
        const auto at = rng.below(std::uint32_t(bad.size()));
        bad[at] = char(bad[at] ^ (1 << rng.below(8)));
        replace(path, bad);
        expectRefused(read, "a flipped bit");
        replace(path, good.substr(0, rng.below(std::uint32_t(good.size()))));
        expectRefused(read, "a truncated file");
    }
    replace(path, good);
    read();
    replace(path + ".xxh3", guard.substr(0, 20));
    expectRefused(read, "a damaged checksum");
    std::filesystem::remove(path + ".xxh3");
    expectRefused(read, "a file without a checksum");
    std::filesystem::remove(path);
    expectRefused(read, "no file");
}

/// Two writers of one path: the file of one never lies beside the checksum of the other.
TEST(Cache, pairsOfTwoWritersFitTogether) {
    const Directory d;
    const std::string path = d.file("pair.vdb");
    writeGuarded(path, "first");
    std::vector<std::jthread> writers;
    for (const char letter : {'a', 'b'}) {
        writers.emplace_back([&path, letter] {
            for (std::size_t n = 1; n <= 40; ++n) writeGuarded(path, std::string(n, letter));
        });
    }
    for (int n = 0; n < 40; ++n) EXPECT_NO_THROW(readGuarded(path, "do it again"));
    writers.clear();
    EXPECT_NO_THROW(readGuarded(path, "do it again"));
}

/// Every input is a part of the file's name; a newline in a value starts no line of the stamp's text.
TEST(CacheStamps, inputsTellFilesApart) {
    std::set<std::string> names{cacheFile("d", kVoxelStamp, "x")};
    for (const auto& [name, value] : kVoxelStamp.inputs) {
        CacheStamp other = kVoxelStamp;
        other.inputs[name] = value + "0";
        EXPECT_TRUE(names.insert(cacheFile("d", other, "x")).second) << name;
        ASSERT_EQ(differences(kVoxelStamp, other).size(), 1u);
        EXPECT_EQ(differences(kVoxelStamp, other)[0].substr(0, name.size()), name);
    }
    CacheStamp odd = kVoxelStamp;
    odd.inputs["camera"] = "1 a=b\nscene=c";
    const CacheStamp back = CacheStamp::parse(odd.text());
    EXPECT_EQ(back.inputs.size(), 4u);
    EXPECT_EQ(back.inputs.at("scene"), "0123abc");
    EXPECT_EQ(back.inputs.at("camera"), "1 a=b scene=c");
    // Messages do not show hashes, and say what one side lacks.
    const std::string hash(32, 'a'), other(32, 'b');
    EXPECT_EQ(differencesText({{{"scene", hash}}}, {{{"scene", other}}}),
              "scene (of another content)");
    EXPECT_EQ(differencesText({{{"environment", "none"}}}, {{{"environment", other}}}),
              "environment (there one, here 'none')");
    EXPECT_EQ(differencesText({{{"lens", "pinhole"}}}, {}), "lens (not said there)");
}

TEST(Cache, foreignFilesAreRefused) {
    const Directory d;
    writeVoxelFile(d.file("v.vdb"), voxels(), kCentre);
    writeSkeletonFile(d.file("s.vdb"), skeleton(), kCentre);
    expectRefused(
        [&] {
            readVoxelFile(d.file("v.vdb"), CacheStamp{{{"scene", "another"}}}, kCentre,
                          "do it again");
        },
        "another scene's");
    expectRefused([&] { readVoxelFile(d.file("s.vdb"), kVoxelStamp, kCentre, "do it again"); },
                  "a skeleton for voxels");
    expectRefused([&] { readSkeletonFile(d.file("v.vdb"), kVoxelStamp, kCentre, "do it again"); },
                  "voxels for a skeleton");
    EXPECT_EQ(cacheDirectory("scenes/door.glb", ""), "scenes/door.cache");
    EXPECT_EQ(cacheDirectory("scenes/door.glb", "there"), "there");
}

TEST(Cache, wrongEntriesAreRefused) {
    const Directory d;
    SkeletonFile file = skeleton();
    file.skeleton.nodes.pop_back();  // edge and map name a node that is not there
    writeSkeletonFile(d.file("s.vdb"), file, kCentre);
    expectRefused([&] { readSkeletonFile(d.file("s.vdb"), kVoxelStamp, kCentre, "do it again"); },
                  "a map to missing nodes");
}

}  // namespace
}  // namespace lacuna::test
