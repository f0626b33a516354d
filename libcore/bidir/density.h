// The weights' belief about a selector: how many samples a connection is worth. The belief is a
// function of the path and of frozen data alone. The method itself makes the picks (method.h).
// (theory.md, "Beliefs")
#pragma once

#include <optional>
#include <span>

#include "libcore/bidir/path.h"

namespace lacuna {

/// One end of a connection as the density sees it, whichever walk made the vertex.
struct ConnectionEnd {
    const PathVertex* vertex;
    const PathVertex*
        predecessor;      ///< in this role: towards the light, or towards the lens; may be null
    int count;            ///< s for the light's end, t for the eye's
    Rgb scatter;          ///< f between predecessor and the other end (y_0: emission profile)
    Label label = kNone;  ///< the vertex's in this role, where it is known
};

/// The edge that a strategy closes a path by.
struct Connection {
    ConnectionEnd eye, light;
    Rgb beta;         ///< throughput that light tracing would have had at the light's end
    double geometry;  ///< G of the edge
    /// Number of the eye's end among the eye vertices that a connection could end at. The first
    /// one, z_1 or what is seen in mirrors and through glass, has number 1.
    int order;
};

/// Two subpaths whose last vertices see each other: s >= 1, t >= 2.
struct OpenConnection {
    Subpath light, eye;
    Edge edge;                 ///< from the light's last vertex to the eye's
    Label lightAsEye = kNone;  ///< of y_{s-1} as an eye vertex, z_{t-1} its predecessor
    Label eyeAsLight = kNone;  ///< of z_{t-1} as a light vertex, y_{s-1} its predecessor
};

/// How the light of a fresh y_0 is picked (light_sampler.h).
enum class Lamps {
    Power,  ///< by its power, as light walks pick it
    Seen,   ///< by what the eye vertex can see of it
};

/// The lights for whose direct light weights have b = 2 (theory.md, "Weights").
enum class SquaredLights { None, Hittable, All };

/// The effective number of samples n r that strategy (s, t) has for a connection (theory.md,
/// "Weights"); positive only where the selector can pick the vertex.
class ConnectionDensity {
  public:
    /// For densities that depend on nothing but whether s = 1.
    struct Constants {
        double direct;    ///< s = 1
        double indirect;  ///< s >= 2
    };

    virtual ~ConnectionDensity() = default;
    /// If set, effectiveSamples is never called.
    virtual std::optional<Constants> constants() const { return std::nullopt; }
    virtual double effectiveSamples(const Connection& connection) const = 0;
    /// With Lamps::Seen, what effectiveSamples and constants say of s = 1 is still to be multiplied
    /// by LightSampler::seenSamples.
    virtual Lamps lamps() const { return Lamps::Power; }
    /// Where lamps are picked by sight, s = 1 has little variance.
    virtual SquaredLights squaredLights() const {
        return lamps() == Lamps::Seen ? SquaredLights::All : SquaredLights::None;
    }

    /// Whether the density keeps labels. A label (of a cache point, a node, a subspace) is what the
    /// density knows a vertex by; it is looked up once and not once per path. It is a function of
    /// the vertex, of its predecessor in the role, and of frozen data. effectiveSamples must accept
    /// ends without one.
    virtual bool keepsLabels() const { return false; }
    /// Labels the vertices of a whole walk, z_0 or y_0 first, in both roles. In the walk's own role
    /// the predecessor is the vertex before. In the other role it is the vertex behind, which the
    /// last vertex does not have.
    virtual void labelWalk(std::span<PathVertex> walk) const { (void)walk; }
    /// Labels the two ends of each connection in the role that the other walk would have given
    /// them.
    virtual void labelEnds(std::span<OpenConnection> connections) const { (void)connections; }
};

}  // namespace lacuna
