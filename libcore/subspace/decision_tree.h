// A decision tree from a subpath's end to its subspace: the practical kappa [Su22 6.4, 7.2.2],
// which stands in for the search of the nearest centroid. (theory.md, "Subspaces")
//
// A node compares one attribute (a coordinate of position, normal or incident direction) with one
// threshold. Children lie side by side in one array, 8 bytes per node. Nodes are split as in the
// paper: as long as less than 99 % of a node's samples have its most frequent label, at the centre
// of the samples' bounds. The attribute is the one that leaves the labels purest by Gini's measure
// (the paper draws it at random).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libcore/subspace/subpath_end.h"

namespace lacuna {

class DecisionTree {
  public:
    struct Node {
        float threshold;     ///< below it: first child; else (NaN too) the second
        std::uint32_t code;  ///< attribute in the low 4 bits, above them the first child's index;
                             ///< or kLeaf and the label

        bool isLeaf() const { return (code & kLeaf) == kLeaf; }
        /// The leaf's label, or the first child's index.
        std::uint32_t index() const { return code >> 4; }
    };
    static constexpr std::uint32_t kLeaf = 15;
    static constexpr std::uint32_t kMaxIndex = (1u << 28) - 1;
    static constexpr int kMaxDepth = 32;

    /// One leaf with the label 0.
    DecisionTree() : DecisionTree({{0.0f, kLeaf}}, 1) {}
    /// Throws std::invalid_argument unless every child lies behind its one parent, inside the array,
    /// with labels below `labels`.
    DecisionTree(std::vector<Node> nodes, std::uint32_t labels);

    /// The label of the leaf that `end` comes to.
    std::uint32_t operator()(const SubpathEnd& end) const {
        Node n = root_;
        while (!n.isLeaf()) n = childOf(n, lines_.data(), end);
        return n.index();
    }
    class Descent;

    std::span<const Node> nodes() const { return nodes_; }
    std::size_t leaves() const { return (nodes_.size() + 1) / 2; }
    int depth() const;

  private:
    static constexpr std::uint32_t kLine = 8;
    /// A cache line, which the processor fetches at once: four pairs of siblings.
    struct alignas(64) Line {
        Node node[kLine];
    };

    /// The child that `end` goes on to from a node of the lines. The node must be no leaf.
    static Node childOf(const Node& n, const Line* lines, const SubpathEnd& end) {
        const std::uint32_t second = end.value[n.code & kLeaf] < n.threshold ? 0u : 1u;
        const std::uint32_t i = n.index() + second;
        return lines[i / kLine].node[i % kLine];
    }
    void arrange();

    std::vector<Node> nodes_;
    // The same tree in the order of descents: pairs that follow each other on the way down share a
    // line, so that a descent of d steps fetches about d / 2.3 lines instead of nearly d.
    Node root_;
    std::vector<Line> lines_;
};

/// A look-up, step by step. Each step waits for memory, so steps of many look-ups, in any trees,
/// are best taken in turn: finish(). The tree must outlive it.
class DecisionTree::Descent {
  public:
    /// A look-up that has come to a leaf already.
    explicit Descent(std::uint32_t label = 0) : node_{0.0f, label << 4 | kLeaf} {}
    Descent(const DecisionTree& tree, const SubpathEnd& end)
        : lines_(tree.lines_.data()), node_(tree.root_), end_(end) {}

    /// One step down; false at a leaf.
    bool step() {
        if (node_.isLeaf()) return false;
        node_ = childOf(node_, lines_, end_);
        return true;
    }
    /// The label of the leaf that it has come to.
    std::uint32_t label() const { return node_.index(); }

  private:
    const Line* lines_ = nullptr;
    Node node_;
    SubpathEnd end_;
};

/// Takes a step of each in turn, until all have come to their leaves.
inline void finish(std::span<DecisionTree::Descent> descents) {
    for (bool going = true; going;) {
        going = false;
        for (DecisionTree::Descent& d : descents) going |= d.step();
    }
}

/// Grows a tree from labelled samples; labels are below `labels`. Samples that no attribute tells
/// apart end in one leaf under their most frequent label; no samples give one leaf, label 0.
DecisionTree growTree(std::span<const SubpathEnd> samples, std::span<const std::uint32_t> labels,
                      std::uint32_t labelCount, double purity = 0.99);

/// Share of the samples that the tree labels as given; 1 for none.
double treeAccuracy(const DecisionTree& tree, std::span<const SubpathEnd> samples,
                    std::span<const std::uint32_t> labels);

}  // namespace lacuna
