#include "libcore/bidir/full_path.h"

#include "libcore/bidir/absorption.h"

namespace lacuna {

double FullPath::geometryOf(int i) const {
    // The end whose toPrevious is the edge's direction: the later one in the walk that
    // made the edge.
    const PathVertex* end = i < lightEdges          ? &lightsEnd(i)
                            : i >= edges - eyeEdges ? vertex[i]
                                                    : nullptr;
    return end ? measureCosine(*end, end->toPrevious) * double(end->toPreviousFactor)
               : double(edgeBetween(*vertex[i], *vertex[i + 1]).geometry);
}

Vec3 FullPath::directionOf(int i) const {
    if (i < lightEdges) return -lightsEnd(i).toPrevious;
    if (i >= edges - eyeEdges) return vertex[i]->toPrevious;
    return edgeBetween(*vertex[i], *vertex[i + 1]).direction;
}

void FullPath::fillLightThroughputs(int rouletteDepth) {
    beta[0] = sourceBeta;
    for (int i = 1; i < edges; ++i) {
        // beta_i = beta_{i-1} f G / p(x_i): both steps of the measure in double.
        const double g = geometry[i - 1] = geometryOf(i - 1);
        const double pdf = double(lightPdfA[i]) * lightRoulette(i, rouletteDepth);
        beta[i] = pdf > 0.0 ? beta[i - 1] * scatter[i - 1] * float(g / pdf) : Rgb{};
        if (!absorption.empty()) {
            beta[i] *=
                transmittance(absorption, *vertex[i - 1], directionOf(i - 1), lightsEnd(i - 1));
        }
    }
}

}  // namespace lacuna
