#include "libcore/bidir/path_layers.h"

#include <algorithm>
#include <limits>
#include <map>
#include <set>

#include "libcore/base/error.h"
#include "libcore/base/text_list.h"
#include "libcore/scene/scene.h"

namespace lacuna {

namespace {

using Letter = Automaton::Letter;
using Names = std::vector<std::string>;

/// The names of lights: what they are called, and their group.
Names namesOf(const NamedLights& lights) {
    Names names = lights.names;
    if (!lights.group.empty()) names.push_back(lights.group);
    return names;
}

EventType typeOf(NamedLights::Kind kind) {
    switch (kind) {
        case NamedLights::Kind::Mesh:
            return EventType::Mesh;
        case NamedLights::Kind::Environment:
            return EventType::Environment;
        case NamedLights::Kind::Lamp:
            break;
    }
    return EventType::Lamp;
}

/// The names among `names` that expressions mention, in order. Other names tell nothing apart.
Names mentioned(const Names& names, const std::set<std::string>& mentions) {
    std::set<std::string> some;
    for (const std::string& name : names) {
        if (mentions.contains(name)) some.insert(name);
    }
    return {some.begin(), some.end()};
}

/// Throws UsageError where an expression uses a name that the scene does not have.
void requireNames(std::span<const LayerExpression> expressions, const std::set<std::string>& all) {
    constexpr std::size_t kShown = 30;
    for (const LayerExpression& e : expressions) {
        for (const auto& [name, position] : e.parsed.names) {
            if (all.contains(name)) continue;
            const Names shown(all.begin(),
                              std::next(all.begin(), std::ptrdiff_t(std::min(all.size(), kShown))));
            throw UsageError(e.title + ": position " + std::to_string(position) +
                             ": expected the name of a light, node or material (" +
                             (all.empty() ? "the scene has none" : joined(shown, ", ")) +
                             (all.size() > kShown ? ", ..." : "") + "), found \"" + name + "\"");
        }
    }
}

/// Throws UsageError where there are more letters than a Letter can number. Only names that
/// expressions mention need letters.
Letter letterAt(std::size_t index) {
    if (index > std::numeric_limits<Letter>::max()) {
        throw UsageError(
            "light path expressions: expected ones that tell fewer objects apart by names");
    }
    return Letter(index);
}

void add(std::vector<PathLayers::Live>& all, JointAutomaton::State state, const Rgb& weight) {
    for (PathLayers::Live& live : all) {
        if (live.state != state) continue;
        live.weight += weight;
        return;
    }
    all.push_back({state, weight});
}

/// Unit directions at x_i, towards x_{i+1} and x_{i-1}.
struct Directions {
    Directions(const FullPath& path, int i)
        : toEye(path.directionOf(i)), toLight(-path.directionOf(i - 1)) {}
    Vec3 toEye, toLight;
};

/// The share of f at x_i that the diffuse base adds, by channel.
Rgb diffuseShare(const FullPath& path, int i) {
    const Directions to(path, i);
    const Rgb part = path.vertex[std::size_t(i)]->bsdf.diffusePart(to.toEye, to.toLight);
    const Rgb& f = path.scatter[std::size_t(i)];
    const auto share = [](float diffuse, float all) {
        return all > 0.0f ? std::min(1.0f, diffuse / all) : 0.0f;
    };
    return {share(part.r, f.r), share(part.g, f.g), share(part.b, f.b)};
}

}  // namespace

PathLayers::PathLayers(const Scene& scene, bool lightGroups,
                       std::span<const LayerExpression> expressions) {
    if (lightGroups) {
        LightGroups groups = scene.lightGroups();
        for (const std::string& name : groups.names) names_.push_back(lightLayer(name));
        lightGroups_ = names_.size();
        group_ = std::move(groups.group);
    }
    if (!expressions.empty()) addExpressions(scene, expressions);
}

void PathLayers::addExpressions(const Scene& scene, std::span<const LayerExpression> expressions) {
    std::vector<Names> objects;
    for (const ObjectNames& names : scene.objectNames()) objects.push_back(names.all());
    const std::vector<NamedLights> lights = scene.namedLights();
    std::set<std::string> all, mentions;
    for (const Names& names : objects) all.insert(names.begin(), names.end());
    for (const NamedLights& some : lights) {
        const Names names = namesOf(some);
        all.insert(names.begin(), names.end());
    }
    requireNames(expressions, all);
    for (const LayerExpression& e : expressions) {
        for (const NameMention& mention : e.parsed.names) mentions.insert(mention.name);
    }

    Alphabet alphabet;
    std::map<Names, Letter> firstOfNames;
    for (const Names& names : objects) {
        const Names known = mentioned(names, mentions);
        const auto [entry, isNew] = firstOfNames.try_emplace(known, 0);
        if (isNew) {
            entry->second = letterAt(alphabet.scattering.size());
            using enum EventType;
            // In the order of Kind.
            alphabet.scattering.insert(alphabet.scattering.end(),
                                       {{Reflection, Scattering::Diffuse, known},
                                        {Reflection, Scattering::Glossy, known},
                                        {Reflection, Scattering::Singular, known},
                                        {Transmission, Scattering::Diffuse, known},
                                        {Transmission, Scattering::Glossy, known},
                                        {Transmission, Scattering::Singular, known}});
            letterAt(alphabet.scattering.size());  // the last of them fits as well
        }
        ofObject_.push_back(entry->second);
    }
    for (const NamedLights& some : lights) {
        const VertexEvent event{typeOf(some.kind), Scattering::None,
                                mentioned(namesOf(some), mentions)};
        const auto at = std::ranges::find(alphabet.lights, event);
        const Letter letter = letterAt(std::size_t(at - alphabet.lights.begin()));
        if (at == alphabet.lights.end()) alphabet.lights.push_back(event);
        ofLight_.insert(ofLight_.end(), some.count, letter);
    }

    const std::size_t first = names_.size();
    std::vector<Automaton> automata;
    for (const LayerExpression& e : expressions) {
        names_.push_back(e.name);
        automata.emplace_back(e.parsed.root, alphabet, e.title);
    }
    for (std::size_t i = 0; i < automata.size(); i += automata_.back().size()) {
        automata_.emplace_back(std::span(automata).subspan(i), std::uint32_t(first + i));
    }
}

inline PathLayers::Scattered PathLayers::scatteredAt(const FullPath& path, int i) const {
    const PathVertex& v = *path.vertex[std::size_t(i)];
    const auto of = [&](Kind kind, bool mixed = false) {
        return Scattered{Letter(ofObject_[v.object] + kind), mixed, false, {}};
    };
    if (path.delta[std::size_t(i)]) {
        return of(v.event == ScatterEvent::DeltaReflection ? kMirror : kSmoothTransmission);
    }
    if (v.bsdf.transmits()) {
        const Directions to(path, i);
        if ((dot(to.toEye, v.ng) > 0.0f) != (dot(to.toLight, v.ng) > 0.0f)) {
            if (!v.bsdf.transmitsDiffusely()) return of(kRoughTransmission);
            return of(kDiffuseTransmission, v.bsdf.transmitsGlossily());
        }
    }
    if (!v.bsdf.isDiffuse()) return of(kGlossyReflection);
    return of(kDiffuseReflection, v.bsdf.isGlossy());
}

/// Likewise, computed once per path. Vertices must be asked for in order, from the camera on.
inline PathLayers::Scattered& PathLayers::scatteredAt(const FullPath& path, int i,
                                                      Scratch& s) const {
    const auto asked = std::size_t(path.edges - 1 - i);
    if (asked == s.vertices.size()) s.vertices.push_back(scatteredAt(path, i));
    return s.vertices[asked];
}

/// Appends the shares of the layers that match. Mostly that is the whole path, and
/// nothing is split.
void PathLayers::match(const JointAutomaton& automaton, const FullPath& path, const Rgb& value,
                       Scratch& s) const {
    JointAutomaton::State state = automaton.start();
    const Letter light = ofLight_[path.vertex[0]->light];
    for (int i = path.edges - 1; i > 0 && !automaton.settled(state); --i) {
        const Scattered& at = scatteredAt(path, i, s);
        const JointAutomaton::State to = automaton.next(state, at.letter);
        if (at.mixed && automaton.next(state, Letter(at.letter + 1)) != to) {
            split(automaton, path, i, state, s);
            s.weights.assign(names_.size(), Rgb{});
            for (const auto& [end, weight] : s.live) {
                for (const std::uint32_t layer : automaton.accepted(end, light)) {
                    s.weights[layer] += weight;
                }
            }
            for (std::uint32_t layer = 0; layer < s.weights.size(); ++layer) {
                if (isBlack(s.weights[layer])) continue;
                s.shares.push_back({layer, value * s.weights[layer]});
            }
            return;
        }
        state = to;
    }
    for (const std::uint32_t layer : automaton.accepted(state, light)) {
        s.shares.push_back({layer, value});
    }
}

/// Follows a path on from x_i, which it has reached in `state`. Leaves its final states in `live`.
void PathLayers::split(const JointAutomaton& automaton, const FullPath& path, int i,
                       JointAutomaton::State state, Scratch& s) const {
    s.live.assign(1, {state, Rgb(1.0f)});
    const auto settled = [&](const Live& live) { return automaton.settled(live.state); };
    for (; i > 0 && !std::ranges::all_of(s.live, settled); --i) {
        Scattered& at = scatteredAt(path, i, s);
        s.next.clear();
        for (const auto& [from, weight] : s.live) {
            const JointAutomaton::State to = automaton.next(from, at.letter);
            const JointAutomaton::State other =
                at.mixed ? automaton.next(from, Letter(at.letter + 1)) : to;
            if (to == other) {
                add(s.next, to, weight);
                continue;
            }
            if (!at.shareKnown) at.diffuse = diffuseShare(path, i);
            at.shareKnown = true;
            add(s.next, to, weight * at.diffuse);
            add(s.next, other, weight * (Rgb(1.0f) - at.diffuse));
        }
        std::swap(s.live, s.next);
    }
}

std::span<const PathLayers::Share> PathLayers::shares(const FullPath& path, const Rgb& value,
                                                      Scratch& s) const {
    s.shares.clear();
    s.vertices.clear();
    if (isBlack(value)) return {};
    if (!group_.empty()) s.shares.push_back({group_[path.vertex[0]->light], value});
    for (const JointAutomaton& automaton : automata_) match(automaton, path, value, s);
    return s.shares;
}

}  // namespace lacuna
