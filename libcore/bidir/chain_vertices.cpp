#include "libcore/bidir/chain_vertices.h"

#include "libcore/bidir/absorption.h"

namespace lacuna {

PathVertex vertexOf(const Walker& walker, const ChainVertex& from) {
    PathVertex v;
    v.position = from.point.position;
    v.ng = from.point.ng;
    v.toPrevious = from.toLight;
    v.bsdf = from.bsdf;
    v.event = from.event.event;
    v.light = from.point.light;
    v.lightUv = from.point.barycentric;
    v.material = from.point.material;
    v.object = from.point.object;
    v.survival = v.bsdf.survivalAlbedo();
    v.region = walker.regionOf(v);
    return v;
}

float appendChain(const Walker& walker, const Chain& chain, std::vector<PathVertex>& light) {
    float pdfW = 0.0f;  // of the direction that leaves the vertex before
    for (std::size_t i = chain.size(); i-- > 0;) {
        const ChainVertex& from = chain[i];
        PathVertex& v = light.emplace_back(vertexOf(walker, from));
        PathVertex& before = light[light.size() - 2];
        v.index = std::uint8_t(light.size() - 1);
        if (before.index == 0) {
            const Lights::Emission emission =
                emissionOf(walker.lights(), before, -v.toPrevious, v.position);
            before.scatter = Rgb(emission.profile);
            pdfW = emission.pdfW;
        }
        const Edge edge = edgeBetween(before, v);
        v.pdfA = pdfW * edge.toSecond;
        v.toPreviousFactor = edge.toFirst;
        const BsdfEvaluation e = walker.scattering(v, from.toEye, from.toLight, v.event);
        v.scatter = from.scatter;
        before.pdfReverseA = e.pdfWToLight * v.toPreviousFactor;
        pdfW = e.pdfWToEye;
    }
    return pdfW;
}

Rgb broughtBy(const Walker& walker, const FoundChain& found, Subpath light, const PathVertex& z,
              const Rgb& atEye) {
    const Chain& chain = found.chain;
    const PathVertex& y0 = light[0];
    const Vec3 toChain(chain.firstDirection());
    const std::span<const Rgb> absorption = walker.scene().absorption();
    Rgb through = transmittance(absorption, z, toChain, light.back());
    for (std::size_t i = 0; i < chain.size(); ++i) {
        const Subpath rest = light.first(light.size() - i);
        through *= chain[i].through *
                   transmittance(absorption, rest.back(), chain[i].toLight, rest[rest.size() - 2]);
    }
    const double spread = found.spread * measureCosine(z, toChain) *
                          measureCosine(y0, chain[chain.size() - 1].toLight);
    return z.throughput * atEye * through * y0.scatter * y0.throughput * float(spread);
}

double densityOfNextEvent(const Walker& walker, const FoundChain& found, const PathVertex& y0) {
    const Chain& chain = found.chain;
    double walk = found.spread * measureCosine(y0, chain[chain.size() - 1].toLight) *
                  double(walker.lights().opacity(y0.light, y0.lightUv));
    for (std::size_t i = 0; i < chain.size(); ++i) {
        const ChainVertex& v = chain[i];
        // Where the vertex has smooth lobes as well, guided walks choose its delta
        // event less often.
        const BsdfEvaluation e =
            walker.scattering(vertexOf(walker, v), v.toEye, v.toLight, v.event.event);
        walk *= double(e.pdfWToLight) / v.measure;
    }
    return walk > 0.0 ? double(lightPointOf(walker.lights(), y0).pdf) / walk : 0.0;
}

bool isOpen(const Walker& walker, Subpath light, const PathVertex& z, RayTally& tally) {
    for (std::size_t i = 0; i < light.size(); ++i) {
        const PathVertex& end = i + 1 < light.size() ? light[i + 1] : z;
        if (!connected(walker.scene(), light[i], end, RayKind::Chain, tally)) return false;
    }
    return true;
}

std::optional<NextEvent> closeNextEvent(const Walker& walker, const FoundChain& found,
                                        const PathVertex& y0, Subpath eye, RayTally& tally,
                                        std::vector<PathVertex>& light, FullPath& path) {
    const PathVertex& z = eye.back();
    light.assign(1, y0);
    float pdfWToEye = appendChain(walker, found.chain, light);
    Vec3 toChain(found.chain.firstDirection());
    PathVertex& last = light.back();
    if (!isDelta(last.event)) {
        // A narrow lobe is evaluated along the edge that other strategies see, between
        // ends in float.
        toChain = edgeBetween(z, last).direction;
        const BsdfEvaluation e = walker.scattering(last, -toChain, last.toPrevious);
        last.scatter = e.f;
        light[light.size() - 2].pdfReverseA = e.pdfWToLight * last.toPreviousFactor;
        pdfWToEye = e.pdfWToEye;
    }
    const BsdfEvaluation atEye = walker.scattering(z, z.toPrevious, toChain);
    const Rgb contribution = broughtBy(walker, found, light, z, atEye.f);
    if (isBlack(contribution) || !isOpen(walker, light, z, tally)) return std::nullopt;
    const Closed closed = closeRefraction(walker, light, pdfWToEye, eye, atEye, contribution, path);
    // Along the lamp's own plane rounding alone tells its sides apart, and no eye walk arrives.
    if (!(path.eyePdfA[0] > 0.0)) return std::nullopt;
    return NextEvent{closed, double(atEye.pdfWToLight)};
}

}  // namespace lacuna
