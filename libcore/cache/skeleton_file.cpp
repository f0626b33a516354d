#include "libcore/cache/skeleton_file.h"

#include <openvdb/tools/Dense.h>

#include <cmath>
#include <cstring>

#include "libcore/cache/vdb.h"

namespace lacuna {

namespace {

const char* const kSkeletonKind = "skeleton";
const char* const kNodes = "lacuna.nodes";  // x y z radius, doubles, the file's coordinates
const char* const kEdges = "lacuna.edges";  // two indices and six coordinates per edge, doubles

/// An entry's value in the file: index >= 0 of the node, -2 - index for solid voxels, -1 for no
/// node.
std::int32_t toFile(std::uint16_t entry) {
    const std::int32_t node = entry & ~NodeMap::kSolid;
    if (node == NodeMap::kNone) return -1;
    return entry & NodeMap::kSolid ? -2 - node : node;
}

template <class T>
std::string bytesOf(const std::vector<T>& values) {
    return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

std::vector<double> doublesOf(const openvdb::MetaMap& meta, const char* name, std::size_t group,
                              const std::string& path, const std::string& remedy) {
    const auto text = meta.getMetadata<openvdb::StringMetadata>(name);
    if (!text || text->value().size() % (group * sizeof(double)) != 0) {
        vdb::refuse(path, name, "something else", remedy);
    }
    std::vector<double> values(text->value().size() / sizeof(double));
    // For a graph without edges, data() may be null, which memcpy must not get.
    if (!values.empty()) {
        std::memcpy(values.data(), text->value().data(), text->value().size());
    }
    for (const double v : values) {
        if (!std::isfinite(v)) vdb::refuse(path, name, "numbers that are not finite", remedy);
    }
    return values;
}

}  // namespace

void writeSkeletonFile(const std::string& path, const SkeletonFile& file, const Vec3d& centre) {
    openvdb::initialize();
    const Skeleton& s = file.skeleton;
    const VoxelShape& shape = s.map.shape();
    auto grid = openvdb::Int32Grid::create(-1);
    grid->setName("node");
    grid->setTransform(vdb::transformOf(shape, centre));
    std::vector<std::int32_t> values;
    values.reserve(s.map.entries().size());
    for (const std::uint16_t e : s.map.entries()) values.push_back(toFile(e));
    const openvdb::CoordBBox box(
        openvdb::Coord(0), openvdb::Coord(shape.size[0] - 1, shape.size[1] - 1, shape.size[2] - 1));
    const openvdb::tools::Dense<std::int32_t, openvdb::tools::LayoutXYZ> dense(box, values.data());
    openvdb::tools::copyFromDense(dense, *grid, 0);

    std::vector<double> nodes, edges;
    const auto add = [&](std::vector<double>& to, const Vec3d& p) {
        to.insert(to.end(), {p.x + centre.x, p.y + centre.y, p.z + centre.z});
    };
    for (const SkeletonNode& n : s.nodes) {
        add(nodes, n.position);
        nodes.push_back(n.radius);
    }
    for (const FilteredEdge& e : s.edges) {
        edges.insert(edges.end(), {double(e.nodes[0]), double(e.nodes[1])});
        add(edges, e.leave);
        add(edges, e.enter);
    }
    openvdb::MetaMap meta;
    vdb::putHeader(meta, kSkeletonKind, file.stamp, shape, centre, s.contentHash());
    meta.insertMeta(kNodes, openvdb::StringMetadata(bytesOf(nodes)));
    meta.insertMeta(kEdges, openvdb::StringMetadata(bytesOf(edges)));
    vdb::write(path, {grid}, meta);
}

SkeletonFile readSkeletonFile(const std::string& path, const CacheStamp& expected,
                              const Vec3d& centre, const std::string& remedy) {
    const vdb::Content content = vdb::read(path, kSkeletonKind, expected, centre, remedy);
    SkeletonFile file;
    file.stamp = content.stamp;
    file.contentHash = content.contentHash;
    const std::vector<double> nodes = doublesOf(*content.meta, kNodes, 4, path, remedy);
    for (std::size_t i = 0; i < nodes.size(); i += 4) {
        file.skeleton.nodes.push_back(
            {Vec3d{nodes[i], nodes[i + 1], nodes[i + 2]} - centre, nodes[i + 3]});
    }
    const auto count = file.skeleton.nodes.size();
    if (count > NodeMap::kNone) {
        vdb::refuse(path, "at most " + std::to_string(NodeMap::kNone) + " nodes",
                    std::to_string(count), remedy);
    }
    const std::vector<double> edges = doublesOf(*content.meta, kEdges, 8, path, remedy);
    for (std::size_t i = 0; i < edges.size(); i += 8) {
        if (!(edges[i] >= 0 && edges[i] < double(count) && edges[i + 1] >= 0 &&
              edges[i + 1] < double(count))) {
            vdb::refuse(path, "edges between its nodes", "others", remedy);
        }
        file.skeleton.edges.push_back({{std::uint32_t(edges[i]), std::uint32_t(edges[i + 1])},
                                       Vec3d{edges[i + 2], edges[i + 3], edges[i + 4]} - centre,
                                       Vec3d{edges[i + 5], edges[i + 6], edges[i + 7]} - centre});
    }

    const auto grid = vdb::gridOf<openvdb::Int32Grid>(content, "node", path, remedy);
    const VoxelShape& shape = content.shape;
    std::vector<std::int32_t> values(shape.count());
    openvdb::tools::Dense<std::int32_t, openvdb::tools::LayoutXYZ> dense(
        openvdb::CoordBBox(openvdb::Coord(0),
                           openvdb::Coord(shape.size[0] - 1, shape.size[1] - 1, shape.size[2] - 1)),
        values.data());
    openvdb::tools::copyToDense(*grid, dense);
    std::vector<std::uint16_t> entries;
    entries.reserve(values.size());
    for (const std::int32_t v : values) {
        const std::int64_t node = v < -1 ? -2 - std::int64_t(v) : v;
        if (node >= std::int64_t(count)) vdb::refuse(path, "its own nodes", "others", remedy);
        entries.push_back(node < 0 ? NodeMap::kNone
                                   : std::uint16_t(node | (v < -1 ? NodeMap::kSolid : 0)));
    }
    file.skeleton.map = NodeMap(shape, std::move(entries));
    return file;
}

}  // namespace lacuna
