// How many samples each kind of technique stands for in the method that a guide is for.
// (theory.md, "Learned emission", "Guided walks")
#pragma once

#include "libcore/bidir/method.h"

namespace lacuna {

struct TechniqueWorth {
    double hit, direct, connection, splat;  ///< s = 0, s = 1, s >= 2 and t >= 2, t = 1

    /// The worth of a method's techniques. Connections with a pool choose among many light
    /// subpaths, those of bpt have one. Without splats there are no light subpaths to connect with.
    static TechniqueWorth of(const Techniques& t) {
        const double pool = t.ownLightPath ? 1.0 : t.splats ? kOfPool : 0.0;
        return {t.hits ? 1.0 : 0.0, t.connects ? 1.0 : 0.0, t.connects ? pool : 0.0,
                t.splats ? 1.0 : 0.0};
    }
    /// The worth of strategy t on a path of `edges` edges.
    double operator()(int t, int edges) const {
        return t == edges + 1 ? hit : t == edges ? direct : t == 1 ? splat : connection;
    }
    /// Which of the three kinds a method is: a guide learned for one does another harm.
    static const char* name(const Techniques& t) {
        return t.ownLightPath ? "own light paths"
               : t.splats     ? "a pool of light paths"
                              : "no light paths";
    }

    static constexpr double kOfPool = 100.0;
};

}  // namespace lacuna
