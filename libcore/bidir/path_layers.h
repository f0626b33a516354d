// Which layers a path adds to beside the picture: that of its group of lights, and those of light path
// expressions. Whatever technique made a path, all of its vertices are known, so that layers are
// exact for every method. (theory.md, "Layers of paths")
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "libcore/bidir/full_path.h"
#include "libcore/expression/joint_automaton.h"
#include "libcore/scene/light_groups.h"

namespace lacuna {

class Scene;

/// A layer of the paths that an expression matches.
struct LayerExpression {
    std::string name, text;
    std::string title;  ///< the beginning of its error messages
    ParsedExpression parsed;
};

/// The name of the layer of a group of lights.
inline std::string lightLayer(const std::string& group) {
    return "light." + group;
}

class PathLayers {
  public:
    /// No layers.
    PathLayers() = default;
    /// A layer light.GROUP for each group of lights where they are asked for, then one for each
    /// expression. Throws UsageError for an expression that names what the scene has not, that
    /// matches no path, or that needs too large an automaton.
    PathLayers(const Scene& scene, bool lightGroups, std::span<const LayerExpression> expressions);

    bool empty() const { return names_.empty(); }
    /// Names by layer, as in the picture.
    const std::vector<std::string>& names() const { return names_; }
    /// How many layers are those of groups of lights. They come first.
    std::size_t lightGroups() const { return lightGroups_; }

    /// A part of what a path adds to the picture, and the layer that it is added to.
    struct Share {
        std::uint32_t layer;
        Rgb value;
    };
    /// A state of the automata, and the share of the path that led to it.
    struct Live {
        JointAutomaton::State state;
        Rgb weight;
    };
    /// The event at a vertex. Where both the diffuse base and rough lobes scatter (`mixed`), `letter` is that of the
    /// base, and the next letter is that of the rough lobes.
    struct Scattered {
        Automaton::Letter letter = 0;
        bool mixed = false, shareKnown = false;
        Rgb diffuse;  ///< the base's share of f
    };
    /// Memory for shares(), kept from path to path.
    struct Scratch {
        std::vector<Share> shares;
        std::vector<Live> live, next;
        std::vector<Rgb> weights;  ///< by layer: the shares of the path that it matches
        std::vector<Scattered>
            vertices;  ///< x_{k-1}, x_{k-2}, .. as far as they have been asked for
    };
    /// The layers that this path adds to, each once, and the part of `value` that each gets. Valid
    /// until the next call.
    std::span<const Share> shares(const FullPath& path, const Rgb& value, Scratch& scratch) const;

  private:
    /// The kinds of scattering that there are, in the order of an object's letters.
    enum Kind : Automaton::Letter {
        kDiffuseReflection,
        kGlossyReflection,
        kMirror,
        kDiffuseTransmission,
        kRoughTransmission,
        kSmoothTransmission
    };

    void addExpressions(const Scene& scene, std::span<const LayerExpression> expressions);
    Scattered scatteredAt(const FullPath& path, int i) const;
    Scattered& scatteredAt(const FullPath& path, int i, Scratch& scratch) const;
    void match(const JointAutomaton& automaton, const FullPath& path, const Rgb& value,
               Scratch& scratch) const;
    void split(const JointAutomaton& automaton, const FullPath& path, int i,
               JointAutomaton::State state, Scratch& scratch) const;

    std::vector<std::string> names_;
    std::size_t lightGroups_ = 0;
    std::vector<std::uint32_t> group_;         // by light, where groups are asked for
    std::vector<JointAutomaton> automata_;     // of the expressions' layers
    std::vector<Automaton::Letter> ofObject_;  // by object, its first letter
    std::vector<Automaton::Letter> ofLight_;   // by light
};

}  // namespace lacuna
