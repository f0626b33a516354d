// (theory.md, "Subspaces")
#include "libcore/subspace/decision_tree.h"

#include <algorithm>
#include <deque>
#include <numeric>
#include <stdexcept>
#include <string>

namespace lacuna {

namespace {
constexpr std::size_t kSamplesJudged = 2048;  // per node, when attributes are compared
}

DecisionTree::DecisionTree(std::vector<Node> nodes, std::uint32_t labels)
    : nodes_(std::move(nodes)) {
    if (nodes_.empty()) throw std::invalid_argument("decision tree: no node");
    std::vector<bool> hasParent(nodes_.size());
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
        const std::uint32_t attribute = nodes_[i].code & kLeaf, index = nodes_[i].index();
        bool good = nodes_[i].isLeaf() ? index < labels
                                       : attribute < SubpathEnd::kAttributes && index > i &&
                                             std::size_t(index) + 1 < nodes_.size();
        if (good && !nodes_[i].isLeaf()) {
            good = !hasParent[index] && !hasParent[index + 1];
            hasParent[index] = hasParent[index + 1] = true;
        }
        if (!good) throw std::invalid_argument("decision tree: node " + std::to_string(i));
    }
    arrange();
}

void DecisionTree::arrange() {
    // A pair of siblings that has no place yet, and where its parent lies.
    struct Pair {
        std::uint32_t first;
        Node* parent;
    };
    lines_.resize((nodes_.size() - 1 + kLine - 1) / kLine);
    root_ = nodes_[0];
    std::vector<Pair> begins;  // pairs that begin a line, unless there is room in one
    if (!root_.isLeaf()) begins.push_back({root_.index(), &root_});
    std::deque<Pair> next;  // pairs below those of this line, nearest first
    for (std::uint32_t place = 0; !begins.empty() || !next.empty(); place += 2) {
        if (place % kLine == 0) {
            begins.insert(begins.end(), next.rbegin(), next.rend());
            next.clear();
        }
        if (next.empty()) {
            next.push_back(begins.back());
            begins.pop_back();
        }
        const Pair pair = next.front();
        next.pop_front();
        pair.parent->code = place << 4 | (pair.parent->code & kLeaf);
        for (std::uint32_t k = 0; k < 2; ++k) {
            Node& node = lines_[place / kLine].node[place % kLine + k];
            node = nodes_[pair.first + k];
            if (!node.isLeaf()) next.push_back({node.index(), &node});
        }
    }
}

int DecisionTree::depth() const {
    std::vector<int> depth(nodes_.size(), 0);
    int deepest = 0;
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
        deepest = std::max(deepest, depth[i]);
        if (nodes_[i].isLeaf()) continue;
        const std::size_t child = nodes_[i].index();
        depth[child] = depth[child + 1] = depth[i] + 1;
    }
    return deepest;
}

class TreeGrower {
  public:
    TreeGrower(std::span<const SubpathEnd> samples, std::span<const std::uint32_t> labels,
               std::uint32_t labelCount, double purity)
        : samples_(samples),
          labels_(labels),
          purity_(purity),
          counts_{std::vector<std::uint32_t>(labelCount, 0),
                  std::vector<std::uint32_t>(labelCount, 0)},
          order_(samples.size()) {
        std::iota(order_.begin(), order_.end(), 0u);
    }

    std::vector<DecisionTree::Node> grow() {
        std::vector<DecisionTree::Node> nodes{{0.0f, DecisionTree::kLeaf}};
        if (!samples_.empty()) fill(nodes, 0, order_, 0);
        return nodes;
    }

  private:
    using Range = std::span<std::uint32_t>;  // of order_

    float at(std::uint32_t sample, std::size_t attribute) const {
        return samples_[sample].value[attribute];
    }

    struct Majority {
        std::uint32_t label = 0;
        std::size_t count = 0;
    };
    Majority majority(Range range) {
        std::vector<std::uint32_t>& counts = counts_[0];
        Majority most;
        for (const std::uint32_t i : range) {
            const std::uint32_t n = ++counts[labels_[i]];
            if (n > most.count || (n == most.count && labels_[i] < most.label)) {
                most = {labels_[i], n};
            }
        }
        for (const std::uint32_t i : range) counts[labels_[i]] = 0;
        return most;
    }

    /// Sum over both children of sum_l n_l^2 / n: the larger, the purer.
    double score(Range range, std::size_t step, std::size_t attribute, float threshold) {
        double n[2] = {0, 0}, squares[2] = {0, 0};
        for (std::size_t k = 0; k < range.size(); k += step) {
            const std::uint32_t i = range[k];
            const std::size_t side = at(i, attribute) < threshold ? 0 : 1;
            squares[side] += 2.0 * counts_[side][labels_[i]]++ + 1.0;
            n[side] += 1.0;
        }
        for (std::size_t k = 0; k < range.size(); k += step) {
            counts_[0][labels_[range[k]]] = counts_[1][labels_[range[k]]] = 0;
        }
        return (n[0] > 0 ? squares[0] / n[0] : 0.0) + (n[1] > 0 ? squares[1] / n[1] : 0.0);
    }

    void fill(std::vector<DecisionTree::Node>& nodes, std::size_t node, Range range, int depth) {
        const Majority most = majority(range);
        nodes[node] = {0.0f, most.label << 4 | DecisionTree::kLeaf};
        if (double(most.count) >= purity_ * double(range.size()) ||
            depth >= DecisionTree::kMaxDepth || nodes.size() + 2 > DecisionTree::kMaxIndex) {
            return;
        }
        const std::size_t step = (range.size() + kSamplesJudged - 1) / kSamplesJudged;
        double best = -1.0;
        std::size_t attribute = 0;
        float threshold = 0.0f;
        for (std::size_t a = 0; a < SubpathEnd::kAttributes; ++a) {
            float low = at(range[0], a), high = low;
            for (const std::uint32_t i : range) {
                low = std::min(low, at(i, a));
                high = std::max(high, at(i, a));
            }
            if (!(low < high)) continue;
            // The centre may round to `low`, and then parts nothing.
            float centre = 0.5f * low + 0.5f * high;
            if (!(centre > low)) centre = high;
            const double s = score(range, step, a, centre);
            if (s > best) {
                best = s;
                attribute = a;
                threshold = centre;
            }
        }
        if (best < 0.0) return;  // coincident samples of different labels
        const auto middle = std::stable_partition(range.begin(), range.end(), [&](std::uint32_t i) {
            return at(i, attribute) < threshold;
        });
        const auto first = std::size_t(middle - range.begin());
        if (first == 0 || first == range.size()) return;  // NaN among the samples
        const auto child = std::uint32_t(nodes.size());
        nodes[node] = {threshold, child << 4 | std::uint32_t(attribute)};
        nodes.resize(nodes.size() + 2);
        fill(nodes, child, range.first(first), depth + 1);
        fill(nodes, child + 1, range.subspan(first), depth + 1);
    }

    std::span<const SubpathEnd> samples_;
    std::span<const std::uint32_t> labels_;
    double purity_;
    std::vector<std::uint32_t> counts_[2];  // by label; zero between uses
    std::vector<std::uint32_t> order_;
};

DecisionTree growTree(std::span<const SubpathEnd> samples, std::span<const std::uint32_t> labels,
                      std::uint32_t labelCount, double purity) {
    return {TreeGrower(samples, labels, labelCount, purity).grow(), std::max(labelCount, 1u)};
}

double treeAccuracy(const DecisionTree& tree, std::span<const SubpathEnd> samples,
                    std::span<const std::uint32_t> labels) {
    if (samples.empty()) return 1.0;
    std::size_t right = 0;
    for (std::size_t i = 0; i < samples.size(); ++i) right += tree(samples[i]) == labels[i];
    return double(right) / double(samples.size());
}

}  // namespace lacuna
