#include "libcore/cache/emission_file.h"

#include <stdexcept>

#include "libcore/base/error.h"
#include "libcore/cache/section_file.h"
#include "libcore/cache/square_forest.h"

namespace lacuna {

namespace {

constexpr SectionFormat kFormat = {
    {'L', 'A', 'C', 'U', 'N', 'A', 'E', 'M'}, 1, 9, "learned emission", "lacuna-train"};

/// The sections as arrays.
struct Arrays {
    std::string inputs, contentHash;
    std::vector<double> pmf;
    std::vector<std::uint32_t> pointTree, rayTree;
    SquareForest points, rays;
};

/// Calls visit(name, array) for every section in the order of the file: the schema for writing and
/// reading.
template <class Visitor, class ArraysOf>
void forEachSection(Visitor& visit, ArraysOf& a) {
    visit("inputs", a.inputs);             // text: CacheStamp::text()
    visit("content_hash", a.contentHash);  // text
    visit("light_pmf", a.pmf);             // double, by light; empty: nothing was learned
    visit("point_tree", a.pointTree);      // uint32, by light: index of its tree of points
    visit("ray_tree", a.rayTree);          // uint32, by leaf of those: index of its tree of rays
    visit("point_sizes", a.points.sizes);  // uint32, by tree of points: number of nodes
    visit("point_nodes", a.points.nodes);  // float lower; uint32 code
    visit("ray_sizes", a.rays.sizes);      // likewise for trees of rays
    visit("ray_nodes", a.rays.nodes);
}

}  // namespace

void writeEmissionFile(const std::string& path, const EmissionFile& file) {
    Arrays a;
    a.inputs = file.stamp.text();
    a.contentHash = file.contentHash;
    if (file.guide) {
        const EmissionGuide& g = *file.guide;
        a.pmf = g.pmf;
        a.pointTree = g.pointTree;
        a.rayTree = g.rayTree;
        for (const SquareDensity& t : g.points) a.points.add(t);
        for (const SquareDensity& t : g.rays) a.rays.add(t);
    }
    SectionWriter writer;
    forEachSection(writer, a);
    writer.write(path, kFormat);
}

EmissionFile readEmissionFile(const std::string& path, const CacheStamp& expected,
                              const std::string& remedy) {
    const auto refuse = [&](const std::string& what, const std::string& found) {
        throw InputError(path + ": expected " + what + ", found " + found + "; " + remedy);
    };
    SectionReader reader(path, kFormat, remedy);
    EmissionFile file;
    try {
        Arrays a;
        forEachSection(reader, a);
        if (!a.pmf.empty()) {
            EmissionGuide g{std::move(a.pmf),     std::move(a.pointTree), a.points.trees(), {},
                            std::move(a.rayTree), a.rays.trees()};
            std::uint32_t leaves = 0;
            for (const SquareDensity& t : g.points) {
                g.firstLeaf.push_back(leaves);
                leaves += t.leafCount();
            }
            g.check(g.pmf.size());
            file.guide = std::make_shared<const EmissionGuide>(std::move(g));
        }
        file.stamp = CacheStamp::parse(a.inputs);
        file.contentHash = a.contentHash;
    } catch (const std::invalid_argument& e) {
        refuse("learned emission that fits together", std::string("something else: ") + e.what());
    }
    const std::string differ = differencesText(expected, file.stamp);
    if (!differ.empty()) refuse("emission learned of what is rendered", differ);
    return file;
}

}  // namespace lacuna
