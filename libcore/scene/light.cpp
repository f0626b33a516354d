// (theory.md, "Lights", "Lamps that are seen")
#include "libcore/scene/light.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <numeric>

#include "libcore/base/below1.h"
#include "libcore/base/sampling.h"
#include "libcore/scene/texture.h"
#include "libcore/scene/triangle.h"

namespace lacuna {

namespace {
constexpr int kRoom = 64;  // binary orders of magnitude by which products of throughputs may vary

/// Mean of the channels of a product that may overflow a float.
double meanOf(const Rgb& a, const Rgb& b = Rgb(1.0f)) {
    return (double(a.r) * double(b.r) + double(a.g) * double(b.g) + double(a.b) * double(b.b)) /
           3.0;
}

double triangleArea(const EmissiveTriangle& t) {
    const Vec3d a(t.corners[0]);
    return 0.5 * length(cross(Vec3d(t.corners[1]) - a, Vec3d(t.corners[2]) - a));
}

/// 1 - cos(angle), without cancellation for narrow cones.
double versine(double angle) {
    const double s = std::sin(0.5 * angle);
    return 2.0 * s * s;
}

/// Solid angle of the cap within `angle` of an axis.
double capSolidAngle(double angle) {
    return 2.0 * std::numbers::pi * versine(angle);
}

/// KHR_lights_punctual: squared linear ramp in the cosine between the outer and the inner cone.
/// `v`: versine of the angle to the axis.
double spotFalloff(const PunctualLight& light, double v) {
    const double outer = versine(light.outerConeAngle), inner = versine(light.innerConeAngle);
    if (v >= outer) return 0.0;
    if (v <= inner) return 1.0;
    const double x = (outer - v) / (outer - inner);
    return x * x;
}

/// Integral of the falloff over directions: inner cap plus 2 pi (cos i - cos o) / 3.
double spotSolidAngle(const PunctualLight& light) {
    const double inner = capSolidAngle(light.innerConeAngle);
    return inner + (capSolidAngle(light.outerConeAngle) - inner) / 3.0;
}

/// Exitance over radiance.
float perRadiance(const EmissiveTriangle& t) {
    return t.twoSided ? 2.0f * kPi : kPi;
}

/// The resolution needed to integrate the triangle's emission: the longest edge in texels of the
/// finer of its two textures.
double texelsAlong(const EmissiveTriangle& t) {
    const auto longest = [](const Texture* texture, const std::array<Vec2, 3>& uvs) {
        if (!texture) return 0.0;
        double most = 0.0;
        for (std::size_t i = 0; i < 3; ++i) {
            const Vec2 d = uvs[(i + 1) % 3] - uvs[i];
            most = std::max(
                most, std::hypot(double(d.x) * texture->width, double(d.y) * texture->height));
        }
        return most;
    };
    const double colour = longest(t.texture, t.uvs);
    if (!t.alpha) return colour;
    std::array<Vec2, 3> uvs = t.alpha->uvs;
    for (Vec2& uv : uvs) uv = t.alpha->material->baseColorTexture.at(uv);
    return std::max(colour, longest(t.alpha->texture, uvs));
}

/// Mean emission over the triangle, as a factor of its radiance. It is never zero if a point
/// between the samples may emit.
Rgb meanEmission(const EmissiveTriangle& t) {
    if (!t.texture && !t.alpha) return Rgb(1.0f);
    constexpr int kFewest = 8, kMost = 64;  // samples along an edge
    const int steps = int(std::clamp(std::ceil(texelsAlong(t)), double(kFewest), double(kMost)));
    Rgb sum{};
    int n = 0;
    for (int i = 0; i < steps; ++i) {
        for (int j = 0; j < steps - i; ++j, ++n) {
            const Vec2 b{(float(i) + 1.0f / 3) / float(steps),
                         (float(j) + 1.0f / 3) / float(steps)};
            const Vec2 uv = t.uvs[0] * (1 - b.x - b.y) + t.uvs[1] * b.x + t.uvs[2] * b.y;
            const float opacity = t.alpha ? t.alpha->opacity(b) : 1.0f;
            sum += (t.texture ? sampleTexture(*t.texture, uv).rgb : Rgb(1.0f)) * opacity;
        }
    }
    const bool constant = !t.texture && !t.alpha->varies();
    return constant ? sum * (1.0f / float(n)) : sum * (1.0f / float(n)) + Rgb(1e-3f);
}

PlacedLight placedTriangle(const EmissiveTriangle& t, std::uint32_t light, double power) {
    const auto& [a, b, c] = t.corners;
    return {light,
            min(a, min(b, c)),
            max(a, max(b, c)),
            {Vec3d(triangleNormal(a, b, c)), 0.0, true, t.twoSided},
            power / double(perRadiance(t))};
}

/// Whether two triangles are the halves of one flat lamp, cut along a diagonal.
bool areHalves(const EmissiveTriangle& a, const EmissiveTriangle& b) {
    const auto normalOf = [](const EmissiveTriangle& t) {
        return triangleNormal(t.corners[0], t.corners[1], t.corners[2]);
    };
    int common = 0;
    for (const Vec3& corner : a.corners) {
        common += int(std::ranges::count(b.corners, corner));
    }
    return common == 2 && a.material == b.material && dot(normalOf(a), normalOf(b)) > 0.9999f;
}

void join(PlacedLight& first, const PlacedLight& second) {
    first.low = min(first.low, second.low);
    first.high = max(first.high, second.high);
    first.cone.add(second.cone);
    first.share = first.intensity / (first.intensity + second.intensity);
    first.intensity += second.intensity;
}
}  // namespace

Lights::Lights(std::vector<EmissiveTriangle> triangles, std::span<const PunctualLight> punctual,
               Vec3d offset, const Environment* environment, float sceneRadius)
    : triangles_(std::move(triangles)),
      punctual_(punctual.begin(), punctual.end()),
      environment_(environment),
      diskRadius_(sceneRadius > 0.0f ? sceneRadius * 1.0001f : 1.0f) {
    kinds_.assign(triangles_.size(), LightKind::Area);
    for (const PunctualLight& l : punctual_) {
        punctualPosition_.push_back(Vec3(l.position - offset));
        punctualDirection_.push_back(Vec3(normalize(l.direction)));
        kinds_.push_back(l.kind == PunctualLight::Kind::Point  ? LightKind::Point
                         : l.kind == PunctualLight::Kind::Spot ? LightKind::Spot
                                                               : LightKind::Directional);
    }
    if (environment_) {
        environmentIndex_ = std::uint32_t(kinds_.size());
        kinds_.push_back(LightKind::Environment);
    }
    powers_ = std::make_shared<const std::vector<double>>(powers());
    byPower_ = std::make_shared<const DiscreteDistribution>(*powers_);
    selection_ = *byPower_;
    findBalls();
    sumBalls();
    drawSky(Environment::SkyPart::AboveMean);
    chooseUnit(std::accumulate(powers_->begin(), powers_->end(), 0.0));
    for (std::uint32_t i = 0; i < triangles_.size(); ++i) {
        const EmissiveTriangle& t = triangles_[i];
        AreaLight& a = area_.emplace_back();
        a.corner = t.corners[0];
        a.edge1 = t.corners[1] - t.corners[0];
        a.edge2 = t.corners[2] - t.corners[0];
        a.ng = triangleNormal(t.corners[0], t.corners[1], t.corners[2]);
        a.exitance = t.radiance * perRadiance(t);
        a.area = triangleArea(t);
        a.pdfA = pdfOfTriangle(i);
        a.twoSided = t.twoSided;
        a.textured = t.texture != nullptr;
        a.hasHoles = t.alpha.has_value();
    }
}

Lights Lights::guidedBy(std::shared_ptr<const EmissionGuide> guide) const {
    Lights guided = withoutHits();
    guided.guide_ = std::move(guide);
    guided.selection_ = DiscreteDistribution(guided.guide_->pmf);
    guided.sumBalls();
    for (std::uint32_t i = 0; i < guided.area_.size(); ++i) {
        guided.area_[i].pdfA = guided.pdfOfTriangle(i);
    }
    return guided;
}

Lights Lights::withoutHits() const {
    Lights lights = *this;
    if (environment_) lights.drawSky(Environment::SkyPart::Whole);
    return lights;
}

/// Sets the part of the sky that next-event estimation samples, and rebuilds the tree with its
/// weight.
void Lights::drawSky(Environment::SkyPart part) {
    skyPart_ = environment_ ? part : Environment::SkyPart::Whole;
    skyKept_ = kept_ = 1.0;
    if (skyPart_ == Environment::SkyPart::AboveMean) {
        skyKept_ = environment_->contrast();
        kept_ = selection_.before(environmentIndex_) + skyKept_ * selection_.pmf(environmentIndex_);
    }
    tree_ = std::make_shared<const LampTree>(makeTree());
}

/// pdfA of the triangle's points, selection included. A triangle without area is never picked, but
/// rounding may let a ray hit it.
float Lights::pdfOfTriangle(std::uint32_t i) const {
    const double area = area_[i].area;
    return area > 0.0 ? float(selection_.pmf(i) / area) : 0.0f;
}

/// Powers of all lights in W.
std::vector<double> Lights::powers() const {
    std::vector<double> power;
    const double disk = std::numbers::pi * double(diskRadius_) * double(diskRadius_);
    for (const EmissiveTriangle& t : triangles_) {
        power.push_back(meanOf(t.radiance, meanEmission(t)) * triangleArea(t) * std::numbers::pi *
                        (t.twoSided ? 2.0 : 1.0));
    }
    for (const PunctualLight& l : punctual_) {
        power.push_back(meanOf(l.intensity) *
                        (l.kind == PunctualLight::Kind::Point  ? 4.0 * std::numbers::pi
                         : l.kind == PunctualLight::Kind::Spot ? spotSolidAngle(l)
                                                               : disk));
    }
    if (environment_) {
        power.push_back(environment_->black() ? 0.0 : meanOf(environment_->integral()) * disk);
    }
    return power;
}

void Lights::findBalls() {
    Balls balls{BallLamp::find(triangles_), std::vector<std::uint32_t>(kinds_.size(), kNone)};
    for (std::uint32_t b = 0; b < balls.lamps.size(); ++b) {
        for (const std::uint32_t light : balls.lamps[b].lights()) balls.of[light] = b;
    }
    balls_ = std::make_shared<const Balls>(std::move(balls));
}

void Lights::sumBalls() {
    ballPmfs_.clear();
    for (const BallLamp& ball : balls_->lamps) {
        double pmf = 0.0;
        for (const std::uint32_t light : ball.lights()) pmf += selection_.pmf(light);
        ballPmfs_.push_back(pmf);
    }
}

/// The least weight of a sky that next-event estimation samples as a whole: walks rarely find
/// windows.
constexpr double kEvenSky = 0.1;

/// The tree over the lights that can be picked.
LampTree Lights::makeTree() const {
    const std::vector<double>& powers = *powers_;
    std::vector<PlacedLight> placed;
    std::vector<DistantLight> distant;
    const double disk = std::numbers::pi * double(diskRadius_) * double(diskRadius_);
    const auto canBePicked = [&](std::uint32_t i) { return selection_.pmf(i) > 0.0; };
    for (std::uint32_t i = 0; i < kinds_.size(); ++i) {
        if (!canBePicked(i)) continue;
        if (const BallLamp* ball = ballOf(i)) {
            if (i != ball->lights().front()) continue;
            placed.push_back(ball->placed());
            placed.back().intensity *=
                powers[i] / (triangleArea(triangles_[i]) * double(perRadiance(triangles_[i])));
            continue;
        }
        if (kinds_[i] == LightKind::Area) {
            const EmissiveTriangle& t = triangles_[i];
            placed.push_back(placedTriangle(t, i, powers[i]));
            const std::uint32_t next = i + 1;
            if (next < triangles_.size() && canBePicked(next) && !ballOf(next) &&
                areHalves(t, triangles_[next])) {
                join(placed.back(), placedTriangle(triangles_[next], next, powers[next]));
                ++i;
            }
            continue;
        }
        if (kinds_[i] == LightKind::Environment) {
            // The irradiance of a surface from the whole sky, on average over its orientations: a
            // quarter.
            const double share = skyPart_ == Environment::SkyPart::Whole
                                     ? std::max(environment_->contrast(), kEvenSky)
                                     : skyKept_;
            if (share > 0.0) distant.push_back({i, {}, 0.25 * share * powers[i] / disk});
            continue;
        }
        const std::size_t p = i - triangles_.size();
        const PunctualLight& l = punctual_[p];
        if (kinds_[i] == LightKind::Directional) {
            distant.push_back({i, -punctualDirection_[p], powers[i] / disk});
            continue;
        }
        // The edge of a spot is dark, so that it costs nothing to enlarge the cone.
        const bool isPoint = kinds_[i] == LightKind::Point;
        const double cone =
            isPoint ? std::numbers::pi : std::min(l.outerConeAngle + 1e-3, std::numbers::pi);
        placed.push_back({i,
                          punctualPosition_[p],
                          punctualPosition_[p],
                          {Vec3d(punctualDirection_[p]), cone, false, false},
                          powers[i] / (isPoint ? 4.0 * std::numbers::pi : spotSolidAngle(l))});
    }
    const bool chooses = placed.size() + distant.size() > 1;
    const bool hasSky = !distant.empty() && distant.back().direction == Vec3{};
    return LampTree(std::move(placed), distant, diskRadius_, kinds_.size(),
                    chooses && hasSky ? environment_->sides(skyPart_) : SkySides{});
}

void Lights::chooseUnit(double power) {
    if (!(power > 0.0) || std::abs(std::ilogb(power)) <= kRoom) return;
    unit_ = std::ldexp(1.0, std::ilogb(power));
    for (EmissiveTriangle& t : triangles_) t.radiance = scaled(t.radiance, 1.0 / unit_);
    for (PunctualLight& l : punctual_) l.intensity = scaled(l.intensity, 1.0 / unit_);
}

Rgb Lights::skyExitance(const Rgb& radiance) const {
    return unit_ == 1.0 ? radiance : scaled(radiance, 1.0 / unit_);
}

Rgb Lights::texturedExitance(std::uint32_t light, Vec2 b) const {
    const EmissiveTriangle& t = triangles_[light];
    const Vec2 uv = t.uvs[0] * (1.0f - b.x - b.y) + t.uvs[1] * b.x + t.uvs[2] * b.y;
    return t.radiance * sampleTexture(*t.texture, uv).rgb * perRadiance(t);
}

LightPoint Lights::environmentPoint(Vec3 direction) const {
    LightPoint p;
    p.light = environmentIndex_;
    p.kind = LightKind::Environment;
    p.position = direction;
    const Environment::Seen seen = environment_->seen(direction);
    p.pdf = float(selection_.pmf(environmentIndex_)) * seen.pdfW;
    p.exitance = skyExitance(seen.radiance);
    if (guide_) p.pdf *= guidedPdf(p);
    return p;
}

const double Lights::kByPower = 0.1;

/// Extends the even numbers of 24 bits by 26 bits each, taken from `rest`: skies have texels of
/// tiny probability.
Environment::Sample Lights::sampleSky(double rest, float across, float down,
                                      Environment::SkyPart part) const {
    const double scaled = rest * 0x1p26, first = std::floor(scaled);
    const SquarePoint u{double(across) + first * 0x1p-50,
                        double(down) + (scaled - first) * 0x1p-24};
    const SquarePoint at = warpPoint(environmentIndex_, u);
    return environment_->sampleSquare(at[0], at[1], part);
}

/// Warps a uniform point by the guide.
SquarePoint Lights::warpPoint(std::uint32_t light, SquarePoint u) const {
    if (!guide_ || guide_->pointTree[light] == kNone) return u;
    return guide_->points[guide_->pointTree[light]].warp(u);
}

namespace {

/// The inverse of concentricDisk, for a point on the disk or close to it.
SquarePoint squareOfDisk(double x, double y) {
    constexpr double kPerRadian = 4.0 / std::numbers::pi;
    const double r = std::min(std::hypot(x, y), 1.0);
    double a = 0.0, b = 0.0;
    if (std::abs(x) > std::abs(y)) {
        a = std::copysign(r, x);
        b = a * std::atan(y / x) * kPerRadian;
    } else if (y != 0.0) {
        b = std::copysign(r, y);
        a = b * std::atan(x / y) * kPerRadian;
    }
    return {std::clamp(0.5 * (a + 1.0), 0.0, 1.0), std::clamp(0.5 * (b + 1.0), 0.0, 1.0)};
}

/// Angle about the axis as a share of a turn, in [0, 1].
double turnOf(double y, double x) {
    const double turn = std::atan2(y, x) / (2.0 * std::numbers::pi);
    return turn < 0.0 ? turn + 1.0 : turn;
}

}  // namespace

SquarePoint Lights::pointSquare(const LightPlace& y0) const {
    if (y0.light < area_.size()) {
        // The inverse of uniformTriangle.
        const double s = 1.0 - double(y0.uv.x);
        return {s * s, s > 0.0 ? std::clamp(double(y0.uv.y) / s, 0.0, 1.0) : 0.0};
    }
    if (y0.light == environmentIndex_) return environment_->squareOf(y0.position);
    return {0.0, 0.0};
}

SquarePoint Lights::raySquare(const LightPlace& y0, const Vec3& direction, const Vec3& x1) const {
    switch (kinds_[y0.light]) {
        case LightKind::Area: {
            // This must be the normal that rays are sampled about. A hit's normal may differ in the
            // sign of a zero, at which Frame is discontinuous.
            const AreaLight& a = area_[y0.light];
            const bool back = a.twoSided && dot(a.ng, direction) < 0.0f;
            const Vec3 local = Frame(back ? -a.ng : a.ng).toLocal(direction);
            SquarePoint p = squareOfDisk(double(local.x), double(local.y));
            if (a.twoSided) p[0] = 0.5 * (p[0] + (back ? 1.0 : 0.0));
            return p;
        }
        case LightKind::Point:
            return {0.5 * (1.0 - double(direction.z)),
                    turnOf(double(direction.y), double(direction.x))};
        case LightKind::Spot: {
            const std::size_t i = y0.light - triangles_.size();
            const Vec3 local = Frame(punctualDirection_[i]).toLocal(direction);
            const double v = 0.5 * lengthSquared(Vec3d(direction) - Vec3d(punctualDirection_[i]));
            return {std::clamp(v / versine(punctual_[i].outerConeAngle), 0.0, 1.0),
                    turnOf(double(local.y), double(local.x))};
        }
        case LightKind::Directional:
        case LightKind::Environment:
            break;
    }
    const Vec3 local = Frame(y0.position).toLocal(x1);
    return squareOfDisk(double(local.x) / double(diskRadius_),
                        double(local.y) / double(diskRadius_));
}

Lights::GuidedPdfs Lights::guidedPdfs(const LightPlace& y0, const Vec3& direction,
                                      const Vec3& x1) const {
    const double byPower = byPower_->pmf(y0.light);
    if (!guide_ || !(byPower > 0.0)) return {};
    return {float(selection_.pmf(y0.light) / byPower) * guidedPdf(y0),
            guidedRayPdf(y0, direction, x1)};
}

float Lights::guidedRayPdf(const LightPlace& y0, const Vec3& direction, const Vec3& x1) const {
    const SquareDensity* rays = guide_->at(y0.light, pointSquare(y0)).rays;
    return rays ? float(rays->at(raySquare(y0, direction, x1)).pdf) : 1.0f;
}

LightPoint Lights::pointOf(const Rng::Draw& draw) const {
    const DiscreteDistribution::Pick pick = selection_.sample(draw.pick);
    return pointOn(pick.index, pick.remapped(), draw);
}

LightPoint Lights::samplePoint(Rng& rng) const {
    return pointOf(rng.evenDraw());
}

Lights::SeenPoint Lights::sampleSeenPoint(const Viewpoint& from, Rng& rng) const {
    if (!samplesSeenPoints()) return {};
    const Rng::Draw draw = rng.evenDraw();
    if (picksAsWalks()) return {pointOf(draw), 1.0};
    if (picksBySight() && draw.pick >= kByPower) {
        const LampTree::Pick pick = tree_->pick(from, (draw.pick - kByPower) / (1.0 - kByPower));
        SeenPoint seen = seenPointOn(pick.light, pick.remapped, draw, from.position);
        if (seen.samples > 0.0) {
            seen.samples =
                pickSamples(seen.point.light, pick.pmf) * pointSamples(seen.point, from.position);
        }
        return seen;
    }
    const double u = picksBySight() ? draw.pick / kByPower : draw.pick;
    // The sky is the last light: the end of the table is the part of it that is left out.
    const DiscreteDistribution::Pick pick = selection_.sample(u * kept_);
    const double kept = pick.index == environmentIndex_ ? skyKept_ : 1.0;
    const double rest = below1(pick.remapped() / kept);
    SeenPoint seen = seenPointOn(pick.index, rest, draw, from.position);
    if (seen.samples > 0.0) seen.samples = seenSamples(seen.point, from);
    return seen;
}

/// Samples a point for next-event estimation on the light, or on the ball that contains it. `samples` is 1, or 0 if the
/// sample misses the ball.
Lights::SeenPoint Lights::seenPointOn(std::uint32_t light, double u, const Rng::Draw& draw,
                                      const Vec3& from) const {
    const BallLamp* ball = ballOf(light);
    if (!ball) return {pointOn(light, u, draw, skyPart_), 1.0};
    const auto found = ball->sample(from, u, draw.u1, draw.u2);
    if (!found) return {};
    return {pointOnTriangle(found->light, found->uv), 1.0, found->factor};
}

double Lights::seenSamples(const LightPlace& y0, const Viewpoint& from) const {
    if (picksAsWalks()) return selection_.pmf(y0.light) > 0.0 ? 1.0 : 0.0;
    const double ofPoint = pointSamples(y0, from.position);
    if (!(ofPoint > 0.0)) return 0.0;  // saves the query of the tree
    if (!picksBySight()) return pickSamples(y0.light, 0.0) * ofPoint;
    const BallLamp* ball = ballOf(y0.light);
    const std::uint32_t inTree = ball ? ball->lights().front() : y0.light;
    return pickSamples(y0.light, tree_->pmf(from, inTree)) * ofPoint;
}

/// Probability of picking the light, or its ball, over its pmf in samplePoint. `pmfOfTree` is read only if
/// picksBySight().
double Lights::pickSamples(std::uint32_t light, double pmfOfTree) const {
    const double power = selection_.pmf(light);
    if (!(power > 0.0)) return 0.0;
    double byPower = 1.0 / kept_;
    if (ballOf(light)) byPower *= ballPmfs_[balls_->of[light]] / power;
    if (light == environmentIndex_) byPower *= skyKept_;
    if (!picksBySight()) return byPower;
    return kByPower * byPower + (1.0 - kByPower) * (pmfOfTree / power);
}

/// The same ratio for the density of the point on the light.
double Lights::pointSamples(const LightPlace& y0, const Vec3& from) const {
    if (const BallLamp* ball = ballOf(y0.light)) {
        const AreaLight& a = area_[y0.light];
        const double samples = ball->pdfA(from, y0.position, a.ng) * a.area;
        return guide_ ? samples / double(guidedPdf(y0)) : samples;
    }
    if (y0.light != environmentIndex_ || skyPart_ == Environment::SkyPart::Whole) return 1.0;
    return environment_->aboveMean(y0.position);
}

/// Samples a point on the light. `u` picks among an environment's texels.
LightPoint Lights::pointOn(std::uint32_t light, double u, const Rng::Draw& draw,
                           Environment::SkyPart sky) const {
    if (light < area_.size()) {
        const SquarePoint at = warpPoint(light, {double(draw.u1), double(draw.u2)});
        return pointOnTriangle(light, uniformTriangle(float(at[0]), float(at[1])));
    }
    LightPoint p;
    p.light = light;
    p.kind = kinds_[light];
    const double pmf = selection_.pmf(light);
    if (p.kind == LightKind::Environment) {
        const Environment::Sample s = draw.even || guide_
                                          ? sampleSky(u, draw.u1, draw.u2, sky)
                                          : environment_->sample(u, draw.u1, draw.u2, sky);
        p.position = s.direction;
        p.pdf = float(pmf) * s.seen.pdfW;
        p.exitance = skyExitance(s.seen.radiance);
        if (guide_) p.pdf *= guidedPdf(p);
        return p;
    }
    const std::size_t i = light - triangles_.size();
    const PunctualLight& l = punctual_[i];
    p.pdf = float(pmf);
    if (p.kind == LightKind::Directional) {
        p.position = -punctualDirection_[i];
        p.exitance = l.intensity;
    } else {
        p.position = punctualPosition_[i];
        p.exitance = l.intensity *
                     float(p.kind == LightKind::Point ? 4.0 * std::numbers::pi : spotSolidAngle(l));
    }
    return p;
}

Lights::Emission Lights::spotEmission(const PunctualLight& l, Vec3 direction) const {
    const std::size_t i = std::size_t(&l - punctual_.data());
    // The versine for two unit vectors: half the square of their distance.
    const double v = 0.5 * lengthSquared(Vec3d(direction) - Vec3d(punctualDirection_[i]));
    const double falloff = spotFalloff(l, v);
    if (falloff == 0.0) return {};
    // Sampled uniformly inside the outer cone.
    return {float(falloff / spotSolidAngle(l)), float(1.0 / capSolidAngle(l.outerConeAngle))};
}

/// The emission of lights without a surface.
Lights::Emission Lights::otherEmission(std::uint32_t light, const Vec3& direction) const {
    if (kinds_[light] == LightKind::Point) return {0.25f / kPi, 0.25f / kPi};
    if (kinds_[light] == LightKind::Spot) {
        return spotEmission(punctual_[light - triangles_.size()], direction);
    }
    return {1.0f, 1.0f / (kPi * diskRadius_ * diskRadius_)};
}

std::optional<Lights::EmissionRay> Lights::sampleEmission(const LightPoint& point, Rng& rng) const {
    auto [u1, u2] = rng.evenPair();
    if (const SquareDensity* rays =
            guide_ ? guide_->at(point.light, pointSquare(point)).rays : nullptr) {
        const SquarePoint u = rays->warp({double(u1), double(u2)});
        u1 = float(u[0]);
        u2 = float(u[1]);
    }
    switch (point.kind) {
        case LightKind::Area: {
            const bool twoSided = area_[point.light].twoSided;
            const bool back = twoSided && u1 >= 0.5f;
            const float u = twoSided ? (back ? 2.0f * u1 - 1.0f : 2.0f * u1) : u1;
            const Vec3 normal = back ? -point.ng : point.ng;
            const Vec3 direction = Frame(normal).toWorld(cosineHemisphere(u, u2));
            const Emission e = emission(point, direction, {});
            if (e.pdfW <= 0.0f) return std::nullopt;
            return EmissionRay{point.position, direction, e};
        }
        case LightKind::Point: {
            const float z = 1.0f - 2.0f * u1, r = std::sqrt(std::max(0.0f, 1.0f - z * z));
            const float phi = 2.0f * kPi * u2;
            const Vec3 direction{r * std::cos(phi), r * std::sin(phi), z};
            return EmissionRay{point.position, direction, emission(point, direction, {})};
        }
        case LightKind::Spot: {
            const std::size_t i = point.light - triangles_.size();
            const double oneMinusCos = versine(punctual_[i].outerConeAngle) * double(u1);
            const double s = std::sqrt(std::max(0.0, oneMinusCos * (2.0 - oneMinusCos)));
            const double phi = 2.0 * std::numbers::pi * double(u2);
            const Vec3 local{float(s * std::cos(phi)), float(s * std::sin(phi)),
                             float(1.0 - oneMinusCos)};
            const Vec3 direction = Frame(punctualDirection_[i]).toWorld(local);
            const Emission e = emission(point, direction, {});
            if (e.pdfW <= 0.0f) return std::nullopt;
            return EmissionRay{point.position, direction, e};
        }
        case LightKind::Directional:
        case LightKind::Environment:
            break;
    }
    // The ray starts on a disk that covers the scene's bounding sphere, seen from the light.
    const Frame frame(point.position);
    const Vec2 d = concentricDisk(u1, u2) * diskRadius_;
    const Vec3 origin = frame.toWorld(Vec3{d.x, d.y, diskRadius_});
    return EmissionRay{origin, -point.position, emission(point, -point.position, origin)};
}

}  // namespace lacuna
