#include "libcore/cache/walk_file.h"

#include <cmath>
#include <stdexcept>

#include "libcore/base/error.h"
#include "libcore/cache/section_file.h"
#include "libcore/cache/square_forest.h"

namespace lacuna {

namespace {

constexpr SectionFormat kFormat = {
    {'L', 'A', 'C', 'U', 'N', 'A', 'W', 'A'}, 1, 8, "guided walks", "lacuna-train"};
static_assert(sizeof(WalkGuide::Node) == 8);

/// The sections as arrays.
struct Arrays {
    std::string inputs, contentHash;
    std::vector<WalkGuide::Node> nodes;
    std::vector<float> axes, shares;
    std::vector<std::uint32_t> bothSides;
    SquareForest directions;
};

/// Calls visit(name, array) for every section in the order of the file: the schema for writing and
/// reading.
template <class Visitor, class ArraysOf>
void forEachSection(Visitor& visit, ArraysOf& a) {
    visit("inputs", a.inputs);                // text: CacheStamp::text()
    visit("content_hash", a.contentHash);     // text
    visit("place_nodes", a.nodes);            // float threshold; uint32 code; empty: nothing
                                              // learned
    visit("axes", a.axes);                    // float, three per region
    visit("both_sides", a.bothSides);         // uint32, by region
    visit("shares", a.shares);                // float, by region: for light walks, for eye walks
    visit("tree_sizes", a.directions.sizes);  // uint32, likewise: number of nodes
    visit("tree_nodes", a.directions.nodes);  // float lower; uint32 code
}

WalkGuide guideOf(Arrays& a) {
    const std::size_t regions = a.bothSides.size();
    std::vector<SquareDensity> trees = a.directions.trees();
    if (a.axes.size() != 3 * regions || a.shares.size() != 2 * regions ||
        trees.size() != 2 * regions) {
        throw std::invalid_argument("arrays by region");
    }
    std::vector<WalkGuide::Region> all(regions);
    for (std::size_t i = 0; i < regions; ++i) {
        const Vec3 axis(a.axes[3 * i], a.axes[3 * i + 1], a.axes[3 * i + 2]);
        all[i].square = DirectionSquare(axis, a.bothSides[i] != 0);
        for (std::size_t side = 0; side < 2; ++side) {
            all[i].fields[side] = {a.shares[2 * i + side], std::move(trees[2 * i + side])};
        }
    }
    return WalkGuide(std::move(a.nodes), std::move(all));
}

}  // namespace

void writeWalkFile(const std::string& path, const WalkFile& file) {
    Arrays a;
    a.inputs = file.stamp.text();
    a.contentHash = file.contentHash;
    if (file.guide) {
        a.nodes.assign(file.guide->nodes().begin(), file.guide->nodes().end());
        for (const WalkGuide::Region& r : file.guide->regions()) {
            const Vec3 axis = r.square.axis();
            a.axes.insert(a.axes.end(), {axis.x, axis.y, axis.z});
            a.bothSides.push_back(r.square.bothSides() ? 1 : 0);
            for (const WalkGuide::Field& f : r.fields) {
                a.shares.push_back(f.share);
                a.directions.add(f.directions);
            }
        }
    }
    SectionWriter writer;
    forEachSection(writer, a);
    writer.write(path, kFormat);
}

WalkFile readWalkFile(const std::string& path, const CacheStamp& expected,
                      const std::string& remedy) {
    const auto refuse = [&](const std::string& what, const std::string& found) {
        throw InputError(path + ": expected " + what + ", found " + found + "; " + remedy);
    };
    SectionReader reader(path, kFormat, remedy);
    WalkFile file;
    try {
        Arrays a;
        forEachSection(reader, a);
        file.stamp = CacheStamp::parse(a.inputs);
        file.contentHash = a.contentHash;
        if (!a.nodes.empty()) file.guide = std::make_shared<const WalkGuide>(guideOf(a));
    } catch (const std::invalid_argument& e) {
        refuse("a guide of walks that fits together", std::string("something else: ") + e.what());
    }
    const std::string differ = differencesText(expected, file.stamp);
    if (!differ.empty()) refuse("walks learned of what is rendered", differ);
    return file;
}

}  // namespace lacuna
