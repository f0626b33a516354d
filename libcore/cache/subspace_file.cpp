#include "libcore/cache/subspace_file.h"

#include <stdexcept>

#include "libcore/base/error.h"
#include "libcore/cache/section_file.h"

namespace lacuna {

namespace {

constexpr SectionFormat kFormat = {
    {'L', 'A', 'C', 'U', 'N', 'A', 'S', 'S'}, 2, 10, "subspaces", "lacuna-train"};
static_assert(sizeof(LightCells::Block) == 8 && sizeof(DecisionTree::Node) == 8);

/// The sections as arrays.
struct Arrays {
    std::string inputs, contentHash;
    std::vector<std::uint32_t> counts;
    std::vector<std::uint64_t> lightPaths;
    std::vector<LightCells::Block> blocks;
    std::vector<DecisionTree::Node> lightNodes, eyeNodes;
    std::vector<double> q, population;
    std::vector<float> gamma;
};

/// Calls visit(name, array) for every section in the order of the file: the schema for writing and
/// reading.
template <class Visitor, class ArraysOf>
void forEachSection(Visitor& visit, ArraysOf& a) {
    visit("inputs", a.inputs);             // text: CacheStamp::text()
    visit("content_hash", a.contentHash);  // text
    visit("subspaces", a.counts);          // uint32: number of light subspaces, of eye subspaces
    visit("light_paths", a.lightPaths);    // uint64: M'
    visit("light_cells", a.blocks);        // uint32 first; uint16 rows, columns: by light
    visit("light_tree", a.lightNodes);     // float threshold; uint32 code
    visit("eye_tree", a.eyeNodes);         // likewise
    visit("q", a.q);                       // double, by light subspace
    visit("population", a.population);     // double, by light subspace
    visit("gamma", a.gamma);               // float, one eye subspace after the other
}

}  // namespace

void writeSubspaceFile(const std::string& path, const SubspaceFile& file) {
    const Subspaces& s = file.subspaces;
    Arrays a;
    a.inputs = file.stamp.text();
    a.contentHash = file.contentHash;
    a.counts = {s.lightCount, s.eyeCount};
    a.lightPaths = {s.lightPaths};
    a.blocks.assign(s.cells.blocks().begin(), s.cells.blocks().end());
    a.lightNodes.assign(s.lightTree.nodes().begin(), s.lightTree.nodes().end());
    a.eyeNodes.assign(s.eyeTree.nodes().begin(), s.eyeTree.nodes().end());
    a.q = s.q;
    a.population = s.population;
    a.gamma = s.gamma;
    SectionWriter writer;
    forEachSection(writer, a);
    writer.write(path, kFormat);
}

SubspaceFile readSubspaceFile(const std::string& path, const CacheStamp& expected,
                              const std::string& remedy) {
    const auto refuse = [&](const std::string& what, const std::string& found) {
        throw InputError(path + ": expected " + what + ", found " + found + "; " + remedy);
    };
    SectionReader reader(path, kFormat, remedy);
    SubspaceFile file;
    try {
        Arrays a;
        forEachSection(reader, a);
        if (a.counts.size() != 2 || a.lightPaths.size() != 1 || a.q.empty()) {
            throw std::invalid_argument("number of subspaces, light subpaths or Q");
        }
        Subspaces& s = file.subspaces;
        s.lightCount = a.counts[0];
        s.eyeCount = a.counts[1];
        s.lightPaths = a.lightPaths[0];
        s.cells = LightCells(std::move(a.blocks));
        s.lightTree = DecisionTree(std::move(a.lightNodes), s.lightCount);
        s.eyeTree = DecisionTree(std::move(a.eyeNodes), s.eyeCount);
        s.q = std::move(a.q);
        s.population = std::move(a.population);
        s.gamma = std::move(a.gamma);
        s.check();
        file.stamp = CacheStamp::parse(a.inputs);
        file.contentHash = a.contentHash;
    } catch (const std::invalid_argument& e) {
        refuse("subspaces that fit together", std::string("something else: ") + e.what());
    }
    const std::string differ = differencesText(expected, file.stamp);
    if (!differ.empty()) refuse("subspaces made of what is rendered", differ);
    return file;
}

}  // namespace lacuna
