// What the weights believe about a selector: how many samples a connection stands for. A function
// of the path and of frozen data alone; the picks themselves are the method's business (method.h).
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
    /// Which of the eye vertices that a connection could end at is the eye's end: 1 for the first,
    /// z_1 or what is seen in mirrors and through glass.
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
    /// Set: effectiveSamples is never asked.
    virtual std::optional<Constants> constants() const { return std::nullopt; }
    virtual double effectiveSamples(const Connection& connection) const = 0;
    /// Seen: what is said of s = 1 above is still to be multiplied by LightSampler::seenSamples.
    virtual Lamps lamps() const { return Lamps::Power; }

    /// Whether it keeps labels: what it knows a vertex by, so that it is looked up once and not
    /// once per path. A label is a function of the vertex, of its predecessor in the role, and of
    /// frozen data; effectiveSamples must do with ends that have none.
    virtual bool keepsLabels() const { return false; }
    /// Labels the vertices of a whole walk, z_0 or y_0 first, in both roles: in that of the walk
    /// with the vertex before as predecessor, in the other one with the vertex behind (the last
    /// vertex has none).
    virtual void labelWalk(std::span<PathVertex> walk) const { (void)walk; }
    /// Labels the two ends of each connection in the role that the other walk would have given
    /// them.
    virtual void labelEnds(std::span<OpenConnection> connections) const { (void)connections; }
};

}  // namespace lacuna
