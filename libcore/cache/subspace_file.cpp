#include "libcore/cache/subspace_file.h"

#include <array>
#include <cstring>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include "libcore/base/atomic_file.h"
#include "libcore/base/content_hash.h"
#include "libcore/base/error.h"

namespace lacuna {

namespace {

constexpr char kMagic[8] = {'L', 'A', 'C', 'U', 'N', 'A', 'S', 'S'};
constexpr std::uint32_t kVersion = 2;

struct Header {
    char magic[8];
    std::uint32_t version, sections;
    std::uint64_t bytes;  // of the file
    std::uint64_t hash[2];
    std::uint64_t reserved[3];
};
static_assert(sizeof(Header) == 64);

struct Section {
    char name[16];
    std::uint64_t elementBytes, count;
};
static_assert(sizeof(Section) == 32);

constexpr std::uint32_t kSections = 10;
static_assert(sizeof(LightCells::Block) == 8 && sizeof(DecisionTree::Node) == 8);

/// Calls put(name, array) for every section in the order of the file: the schema, for both ways.
template <class Visitor>
void forEachSection(Visitor& visit) {
    visit("inputs", visit.inputs);             // text: CacheStamp::text()
    visit("content_hash", visit.contentHash);  // text
    visit("subspaces", visit.counts);          // uint32: of light, of eye
    visit("light_paths", visit.lightPaths);    // uint64: M'
    visit("light_cells", visit.blocks);        // uint32 first; uint16 rows, columns: by light
    visit("light_tree", visit.lightNodes);     // float threshold; uint32 code
    visit("eye_tree", visit.eyeNodes);         // likewise
    visit("q", visit.q);                       // double, by light subspace
    visit("population", visit.population);     // double, by light subspace
    visit("gamma", visit.gamma);               // float, eye subspace by eye subspace
}

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

std::size_t padded(std::size_t bytes) {
    return (bytes + 7) / 8 * 8;
}

struct Writer : Arrays {
    std::string bytes = std::string(sizeof(Header), '\0');

    template <class Array>
    void operator()(const char* name, const Array& values) {
        Section s{};
        std::strncpy(s.name, name, sizeof(s.name) - 1);
        s.elementBytes = sizeof(values[0]);
        s.count = values.size();
        bytes.append(reinterpret_cast<const char*>(&s), sizeof(s));
        bytes.append(reinterpret_cast<const char*>(values.data()), s.elementBytes * s.count);
        bytes.resize(padded(bytes.size()), '\0');
    }
};

struct Reader : Arrays {
    const std::string& bytes;
    std::size_t at = sizeof(Header);

    explicit Reader(const std::string& content) : bytes(content) {}

    /// Throws std::invalid_argument.
    template <class Array>
    void operator()(const char* name, Array& values) {
        const auto require = [&](bool good) {
            if (!good) throw std::invalid_argument(std::string("section ") + name);
        };
        require(bytes.size() - at >= sizeof(Section));
        Section s;
        std::memcpy(&s, bytes.data() + at, sizeof(s));
        at += sizeof(s);
        char expected[sizeof(s.name)] = {};
        std::strncpy(expected, name, sizeof(expected) - 1);
        require(std::memcmp(s.name, expected, sizeof(expected)) == 0);
        require(s.elementBytes == sizeof(values[0]));
        require(s.count <= (bytes.size() - at) / s.elementBytes);
        const std::size_t size = s.count * s.elementBytes;
        values.resize(s.count);
        if (size > 0) std::memcpy(values.data(), bytes.data() + at, size);
        require(padded(at + size) <= bytes.size());
        at = padded(at + size);
    }
};

/// Of everything but the hash itself.
std::array<std::uint64_t, 2> hashOf(Header header, const std::string& bytes) {
    header.hash[0] = header.hash[1] = 0;
    ContentHash hash;
    hash.addValue(header);
    hash.addValues(std::span(bytes).subspan(sizeof(header)));
    return hash.digest();
}

}  // namespace

void writeSubspaceFile(const std::string& path, const SubspaceFile& file) {
    const Subspaces& s = file.subspaces;
    Writer w;
    w.inputs = file.stamp.text();
    w.contentHash = file.contentHash;
    w.counts = {s.lightCount, s.eyeCount};
    w.lightPaths = {s.lightPaths};
    w.blocks.assign(s.cells.blocks().begin(), s.cells.blocks().end());
    w.lightNodes.assign(s.lightTree.nodes().begin(), s.lightTree.nodes().end());
    w.eyeNodes.assign(s.eyeTree.nodes().begin(), s.eyeTree.nodes().end());
    w.q = s.q;
    w.population = s.population;
    w.gamma = s.gamma;
    forEachSection(w);
    Header header{};
    std::memcpy(header.magic, kMagic, sizeof(kMagic));
    header.version = kVersion;
    header.sections = kSections;
    header.bytes = w.bytes.size();
    const auto hash = hashOf(header, w.bytes);
    header.hash[0] = hash[0];
    header.hash[1] = hash[1];
    std::memcpy(w.bytes.data(), &header, sizeof(header));
    writeFileAtomically(path, w.bytes);
}

SubspaceFile readSubspaceFile(const std::string& path, const CacheStamp& expected,
                              const std::string& remedy) {
    const auto refuse = [&](const std::string& what, const std::string& found) {
        throw InputError(path + ": expected " + what + ", found " + found + "; " + remedy);
    };
    std::string bytes;
    {
        std::ifstream in(path, std::ios::binary);
        if (!in.is_open()) refuse("a cache", "no such file");
        std::ostringstream content;
        content << in.rdbuf();
        bytes = std::move(content).str();
    }
    Header header{};
    if (bytes.size() >= sizeof(header)) std::memcpy(&header, bytes.data(), sizeof(header));
    if (std::memcmp(header.magic, kMagic, sizeof(kMagic)) != 0) {
        refuse("subspaces written by lacuna-train", "another file");
    }
    if (header.version != kVersion) {
        refuse("format " + std::to_string(kVersion), std::to_string(header.version));
    }
    const auto hash = hashOf(header, bytes);
    if (header.bytes != bytes.size() || header.sections != kSections || header.hash[0] != hash[0] ||
        header.hash[1] != hash[1]) {
        refuse("what its checksum says", "other bytes");
    }

    SubspaceFile file;
    try {
        Reader r(bytes);
        forEachSection(r);
        if (r.counts.size() != 2 || r.lightPaths.size() != 1 || r.q.empty()) {
            throw std::invalid_argument("number of subspaces, light subpaths or Q");
        }
        Subspaces& s = file.subspaces;
        s.lightCount = r.counts[0];
        s.eyeCount = r.counts[1];
        s.lightPaths = r.lightPaths[0];
        s.cells = LightCells(std::move(r.blocks));
        s.lightTree = DecisionTree(std::move(r.lightNodes), s.lightCount);
        s.eyeTree = DecisionTree(std::move(r.eyeNodes), s.eyeCount);
        s.q = std::move(r.q);
        s.population = std::move(r.population);
        s.gamma = std::move(r.gamma);
        s.check();
        file.stamp = CacheStamp::parse(r.inputs);
        file.contentHash = r.contentHash;
    } catch (const std::invalid_argument& e) {
        refuse("subspaces that fit together", std::string("something else: ") + e.what());
    }
    const std::string differ = differencesText(expected, file.stamp);
    if (!differ.empty()) refuse("subspaces made of what is rendered", differ);
    return file;
}

}  // namespace lacuna
