// (theory.md, "Light tree")
#include "libcore/resampling/light_tree.h"

#include <algorithm>
#include <cmath>

#include "libcore/base/parallel.h"

namespace lacuna {

namespace {

constexpr std::uint32_t kSerialLeaves = 1024;  // below: one task for the whole subtree

float along(Vec3 v, int axis) {
    return axis == 0 ? v.x : axis == 1 ? v.y : v.z;
}

}  // namespace

LightTree::LightTree(const LightPool& pool, std::span<const LightPool::Entry> candidates,
                     const ThreadPool& threads) {
    std::vector<Leaf> leaves;
    leaves.reserve(candidates.size());
    for (const bool infinite : {false, true}) {
        if (infinite) infinite_ = std::uint32_t(leaves.size());
        for (std::uint32_t i = 0; i < candidates.size(); ++i) {
            const PathVertex& y = pool.prefix(candidates[i]).back();
            const double power = double(mean(y.throughput));
            if (y.infinite() != infinite || !(power > 0.0)) continue;
            leaves.push_back({y.position, infinite ? Vec3{} : scatteringSide(y), power, i});
        }
    }
    const auto n = std::uint32_t(leaves.size());
    nodes_.resize(n == 0 ? 0 : 2 * std::size_t(n));
    build(leaves, 0, infinite_, threads);
    build(leaves, infinite_, n, threads);
    order_.reserve(n);
    for (const Leaf& leaf : leaves) order_.push_back(leaf.candidate);
}

// A subtree over n leaves takes 2 n - 1 nodes in a row: its root, the left subtree, the right one.
// The tree over leaves [begin, end) starts at node 2 begin.
void LightTree::build(std::vector<Leaf>& leaves, std::uint32_t begin, std::uint32_t end,
                      const ThreadPool& threads) {
    if (begin == end) return;
    struct Task {
        std::uint32_t node, begin, end;
    };
    // The top of the tree is built level by level, large nodes in parallel. Then whole subtrees are
    // built in parallel.
    std::vector<Task> level{{2 * begin, begin, end}}, subtrees;
    std::vector<std::vector<Task>> levels;
    const auto split = [&](const Task& t) {
        fillNode(t.node, std::span(leaves).subspan(t.begin, t.end - t.begin), t.begin);
    };
    const auto childrenOf = [&](const Task& t, auto&& add) {
        const std::uint32_t middle = t.begin + (t.end - t.begin) / 2;
        add(Task{t.node + 1, t.begin, middle});
        add(Task{rightOf(t.node), middle, t.end});
    };
    while (!level.empty()) {
        std::vector<Task> large, next;
        for (const Task& t : level) {
            (t.end - t.begin > kSerialLeaves ? large : subtrees).push_back(t);
        }
        threads.forEach(large.size(), [&](std::size_t i) { split(large[i]); });
        for (const Task& t : large) childrenOf(t, [&](const Task& c) { next.push_back(c); });
        levels.push_back(std::move(large));
        level = std::move(next);
    }
    threads.forEach(subtrees.size(), [&](std::size_t i) {
        const auto descend = [&](const auto& self, const Task& t) -> void {
            split(t);
            if (t.end - t.begin == 1) return;
            childrenOf(t, [&](const Task& c) { self(self, c); });
            joinChildren(t.node);
        };
        descend(descend, subtrees[i]);
    });
    for (std::size_t l = levels.size(); l-- > 0;) {
        for (const Task& t : levels[l]) joinChildren(t.node);
    }
}

/// Sets the box of the leaves, and sorts them so that the lower half along its longest
/// axis comes first.
void LightTree::fillNode(std::uint32_t node, std::span<Leaf> leaves, std::uint32_t begin) {
    Node& n = nodes_[node];
    n.begin = begin;
    n.end = begin + std::uint32_t(leaves.size());
    n.low = n.high = leaves[0].place;
    for (const Leaf& leaf : leaves) {
        const Vec3 p = leaf.place;
        n.low = min(n.low, p);
        n.high = max(n.high, p);
    }
    if (leaves.size() == 1) {
        const Leaf& leaf = leaves[0];
        n.axis = leaf.normal;
        n.sine = 0.0f;
        n.cosine = 1.0f;
        n.power = leaf.power;
        return;
    }
    const Vec3 size = n.high - n.low;
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    std::nth_element(leaves.begin(), leaves.begin() + std::ptrdiff_t(leaves.size() / 2),
                     leaves.end(), [&](const Leaf& a, const Leaf& b) {
                         const float pa = along(a.place, axis), pb = along(b.place, axis);
                         return pa != pb ? pa < pb : a.candidate < b.candidate;
                     });
}

/// Sets power and cone from those of the children.
void LightTree::joinChildren(std::uint32_t node) {
    Node& n = nodes_[node];
    const Node &a = nodes_[node + 1], &b = nodes_[rightOf(node)];
    n.power = a.power + b.power;
    const Vec3 sum = a.axis + b.axis;
    const float norm = length(sum);
    n.axis = {};
    n.sine = 0.0f;
    n.cosine = -1.0f;
    if (a.axis == Vec3{} || b.axis == Vec3{} || norm < 1e-3f) return;
    n.axis = sum * (1.0f / norm);
    // The axis halves the angle between the children's; each child's cone adds its half angle.
    const auto reach = [&](const Node& child) {
        const float between = std::acos(std::clamp(dot(n.axis, child.axis), -1.0f, 1.0f));
        return between + std::atan2(child.sine, child.cosine);
    };
    const float angle = std::max(reach(a), reach(b));
    if (angle >= 3.14159265f) {
        n.axis = {};
        return;
    }
    n.sine = std::sin(angle);
    n.cosine = std::cos(angle);
}

LightTree::Draw LightTree::draw(Cluster c, double u) const {
    std::uint32_t node = c;
    while (nodes_[node].end - nodes_[node].begin > 1) {
        const std::uint32_t left = node + 1, right = rightOf(node);
        const double share = nodes_[left].power / nodes_[node].power;
        if (u < share) {
            u /= share;
            node = left;
        } else {
            u = (u - share) / (1.0 - share);
            node = right;
        }
        u = std::min(u, 1.0 - 0x1p-53);
    }
    return {order_[nodes_[node].begin], nodes_[node].power / nodes_[c].power};
}

/// An estimate from above of power x G towards the eye vertex, visibility and BSDFs left out.
double LightTree::bound(const Node& node, const PathVertex& eye, Vec3 eyeNormal) const {
    // A cosine is never trusted to be zero: cones and boxes are rounded.
    constexpr float kLeastCosine = 0.02f;
    const Vec3 centre = (node.low + node.high) * 0.5f, half = (node.high - node.low) * 0.5f;
    const float radius2 = dot(half, half);
    if (node.begin >= infinite_) {
        const float cosine =
            eyeNormal == Vec3{} ? 1.0f : dot(eyeNormal, centre) + std::sqrt(radius2);
        return node.power * double(std::clamp(cosine, kLeastCosine, 1.0f));
    }
    const Vec3 to = eye.position - centre;
    const float d2 = dot(to, to);
    const float d = std::sqrt(d2), radius = std::sqrt(radius2);
    // Distance to the box itself, but at least half its radius: else one cluster around the point
    // would take all splits.
    const Vec3 out = max(max(node.low - eye.position, eye.position - node.high), Vec3{});
    const float near = std::max(length(out), 0.5f * radius);
    const double power = node.power / std::max(1e-30, double(near) * double(near));
    if (d <= radius) return power;
    const float atEye = eyeNormal == Vec3{}
                            ? 1.0f
                            : std::clamp((radius - dot(eyeNormal, to)) / d, kLeastCosine, 1.0f);
    float atLight = 1.0f;
    if (node.axis != Vec3{}) {
        // Angle to the axis, less the cone's and the box's half angles.
        const float cosine = std::clamp(dot(node.axis, to) / d, -1.0f, 1.0f);
        const float sine = std::sqrt(1.0f - cosine * cosine);
        const float boxSine = radius / d, boxCosine = std::sqrt(1.0f - boxSine * boxSine);
        const float openCosine = node.cosine * boxCosine - node.sine * boxSine;
        const float openSine = node.sine * boxCosine + node.cosine * boxSine;
        const bool inside = cosine >= openCosine || openSine < 0.0f;
        atLight = inside ? 1.0f : std::max(cosine * openCosine + sine * openSine, kLeastCosine);
    }
    return power * double(atEye * atLight);
}

void LightTree::cut(const PathVertex& eye, std::size_t budget, std::vector<CutNode>& heap,
                    std::vector<Cluster>& cut) const {
    cut.clear();
    heap.clear();
    const Vec3 normal = scatteringSide(eye);
    const auto lower = [](const CutNode& a, const CutNode& b) {
        return a.bound != b.bound ? a.bound < b.bound : a.node > b.node;
    };
    const auto add = [&](std::uint32_t node) {
        const Node& n = nodes_[node];
        if (n.end - n.begin == 1) {
            cut.push_back(node);
            return;
        }
        heap.push_back({bound(n, eye, normal), node});
        std::push_heap(heap.begin(), heap.end(), lower);
    };
    if (infinite_ > 0) add(0);
    if (infinite_ < size()) add(2 * infinite_);
    while (!heap.empty() && heap.size() + cut.size() < budget) {
        std::pop_heap(heap.begin(), heap.end(), lower);
        const std::uint32_t node = heap.back().node;
        heap.pop_back();
        add(node + 1);
        add(rightOf(node));
    }
    for (const CutNode& n : heap) cut.push_back(n.node);
}

std::uint64_t LightTree::bytes() const {
    return order_.size() * sizeof(order_[0]) + nodes_.size() * sizeof(Node);
}

}  // namespace lacuna
