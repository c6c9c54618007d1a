#include "clusters/light_stands.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "base/coordinate_search.h"
#include "base/sort_unique.h"
#include "base/statistics.h"

namespace relamp {
namespace {

// In sizes of the light, from its surface.
constexpr double endsWithin = 1;
constexpr double knownTo[] = {3, 2, 1.5, 1.1};  ///< what is farther may be a foot: as far as there is a tube
constexpr double bagsTo = 0.5;                  ///< a mesh wraps light and stand in one bag: what is nearer is no tube
constexpr double leastLength = 1;               ///< of the tube that a ball stands on
constexpr double leastOfBody = 0.3, slimmest = 3;  ///< below a body; in radii of the tube
constexpr double thickest = 0.75;                  ///< radius of the tube
constexpr double offCentre = 0.5;                  ///< of the axis, at most
constexpr double sleeveEnd = 0.93;                 ///< within the ball's flat faces
constexpr double bodyEnd = 0.98;                   ///< of a body, within its surface
constexpr double leastAway = 0.8;                  ///< cosine of the axis with the way from the ball
constexpr double ofOneRadius = 0.35;               ///< relative: distances from the axis that are a tube's
constexpr double mostOfOne = 0.75;                 ///< of its vertices
constexpr int sectors = 8, leastSectors = 6;       ///< around it: that have some of it
constexpr int sleeveSides = 16;
constexpr size_t leastOfStand = 12;

/// Tilt of the axis towards the two others and its shift along them, in sizes.
using AxisMotion = std::array<double, 4>;

StraightTube withAxis(const StraightTube& tube, const AxisMotion& by, double size) {
    StraightTube out = tube;
    out.through += size * (by[2] * tube.axes[1] + by[3] * tube.axes[2]);
    out.axes[0] = glm::normalize(tube.axes[0] + by[0] * tube.axes[1] + by[1] * tube.axes[2]);
    out.axes[1] = glm::normalize(tube.axes[1] - glm::dot(tube.axes[1], out.axes[0]) * out.axes[0]);
    out.axes[2] = glm::cross(out.axes[0], out.axes[1]);
    return out;
}

/// Brings the axis to where the points lie at one distance from it, in part only where a mesh lacks some of its sides:
/// coordinate search of a robust loss. Axes through `tube.through` are likelier than others.
void fitAxis(const std::vector<DVec3>& points, double size, StraightTube& tube) {
    constexpr double sigma = 0.05, offSigma = 1;  // sizes
    const auto lossOf = [&](const AxisMotion& by) {
        const StraightTube there = withAxis(tube, by, size);
        std::vector<double> distances;
        for (const DVec3& p : points) distances.push_back(there.off(p) / size);
        const double radius = medianOf(distances), off = std::hypot(by[2], by[3]) / offSigma;
        double loss = 0.5 * off * off;
        for (const double d : distances) loss += std::log1p(std::pow((d - radius) / sigma, 2)) / double(points.size());
        return loss;
    };
    AxisMotion best{};
    coordinateSearch(best, lossOf(best), 0.2, 0.005, lossOf);
    tube = withAxis(tube, best, size);
}

/// The tube that the points are of, away from the light; none where they are no tube.
std::optional<StraightTube> tubeOf(const std::vector<DVec3>& points, const HeldLight& light) {
    if (points.size() < leastOfStand) return {};
    DVec3 middle(0);
    for (const DVec3& p : points) middle += p / double(points.size());
    const DVec3 centre = light.anchor(middle);
    const double size = light.size;
    if (!(glm::length(middle - centre) > 0)) return {};
    StraightTube tube;
    tube.through = centre;
    tube.axes = glm::dmat3(frameAround(Vec3(glm::normalize(middle - centre))));
    std::swap(tube.axes[0], tube.axes[2]);  // left-handed until fitAxis
    fitAxis(points, size, tube);
    if (glm::dot(tube.axes[0], middle - centre) < leastAway * glm::length(middle - centre)) return {};
    if (tube.off(centre) > offCentre * size) return {};
    std::vector<double> heights;
    for (const DVec3& p : points) heights.push_back(tube.at(p));
    const auto [least, most] = std::minmax_element(heights.begin(), heights.end());
    if (*most - *least < (light.body ? leastOfBody : leastLength) * size) return {};
    tube.from = *least + (light.body ? 0.1 : 0.5) * size;
    std::vector<double> radii;
    for (const DVec3& p : points)
        if (tube.at(p) > tube.from) radii.push_back(tube.off(p));
    if (radii.size() < leastOfStand) return {};
    tube.radius = quantileOf(radii, 0.75);
    const auto ofTube = [&](double r) { return std::abs(r - tube.radius) < ofOneRadius * tube.radius; };
    const double part = double(std::count_if(radii.begin(), radii.end(), ofTube)) / double(radii.size());
    if (tube.radius > thickest * size || part < mostOfOne) return {};
    if (light.body && slimmest * tube.radius > *most - *least) return {};
    return tube;
}

/// Whether there are points on most sides of it.
bool allAround(const StraightTube& tube, const std::vector<DVec3>& points) {
    unsigned around = 0;
    for (const DVec3& p : points) {
        const DVec3 d = p - tube.through;
        const double turn = std::atan2(glm::dot(d, tube.axes[2]), glm::dot(d, tube.axes[1])) / (2 * piD) + 0.5;
        around |= 1u << std::min(sectors - 1, int(turn * sectors));
    }
    return std::popcount(around) >= leastSectors;
}

/// Those of one light, of what lies within `reach` sizes of it.
std::vector<LightStand> standsWithin(const Mesh& mesh, const HeldLight& light, double reach) {
    std::vector<LightStand> stands;
    Mesh about;
    about.positions = mesh.positions;
    const auto distance = [&](uint32_t v) { return light.distance(DVec3(mesh.positions[v])) / light.size; };
    std::vector<uint32_t> number;  // in the mesh, of the triangles about the light
    for (uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        const Triangle& corners = mesh.triangles[t];
        if (!std::all_of(corners.begin(), corners.end(), [&](uint32_t v) { return distance(v) < reach; })) continue;
        about.triangles.push_back(corners);
        number.push_back(t);
    }
    uint32_t count = 0;
    const std::vector<uint32_t> piece = connectedComponents(buildVertexGraph(about), &count);
    std::vector<uint8_t> ends(count, 0), used(mesh.vertexCount(), 0);
    std::vector<std::vector<DVec3>> points(count);
    for (const Triangle& t : about.triangles)
        for (const uint32_t v : t) {
            if (used[v]) continue;
            used[v] = 1;
            if (distance(v) > bagsTo) points[piece[v]].push_back(DVec3(mesh.positions[v]));
            ends[piece[v]] |= distance(v) < endsWithin;
        }
    for (uint32_t k = 0; k < count; ++k) {
        if (!ends[k]) continue;
        std::optional<StraightTube> tube = tubeOf(points[k], light);
        if (!tube) continue;
        std::vector<uint32_t> bag;
        for (size_t i = 0; i < number.size(); ++i) {
            const Triangle& t = about.triangles[i];
            if (piece[t[0]] == k && std::any_of(t.begin(), t.end(), [&](uint32_t v) { return distance(v) < bagsTo; }))
                bag.push_back(number[i]);
        }
        tube->to = tubeEnd(mesh, *tube);
        stands.push_back({*tube, light, allAround(*tube, points[k]), std::move(bag)});
    }
    return stands;
}

/// Metres along the direction from `foot`, just inside of where that line leaves the light.
double leaves(const HeldLight& light, const DVec3& foot, const DVec3& direction) {
    const DVec3 way = light.centre - foot;
    const double ahead = glm::dot(way, direction), aside2 = glm::dot(way, way) - ahead * ahead;
    if (!light.body) return ahead + std::sqrt(std::max(0.0, std::pow(sleeveEnd * light.size, 2) - aside2));
    const double before = ahead - 4 * glm::length(light.body->half);
    const glm::dvec2 chord = light.body->chord(foot + before * direction, direction, bodyEnd);
    return chord.x < chord.y ? before + chord.y : glm::dot(light.anchor(foot) - foot, direction);
}

/// The tube's side from the light's inside on, with rings `apart` metres apart, the last at `to`.
SurfacePatch sideOf(const StraightTube& tube, const HeldLight& light, double to, double apart) {
    SurfacePatch patch;
    const DVec3& along0 = tube.axes[0];
    const double from = light.body ? leaves(light, tube.onAxis(0), along0) : tube.at(light.centre) + light.size;
    const auto rings = uint32_t(std::max(1.0, std::ceil((to - from) / apart)));
    for (uint32_t ring = 0; ring <= rings; ++ring)
        for (uint32_t i = 0; i < sleeveSides; ++i) {
            const double turn = 2 * piD * i / sleeveSides, first = leaves(light, tube.onSurface(0, turn), along0),
                         along = from + (to - from) * ring / rings;
            patch.positions.push_back(
                Vec3(tube.onSurface(ring == 0 ? first : std::max(along, first + light.size / 20), turn)));
        }
    for (uint32_t ring = 0; ring < rings; ++ring)
        for (uint32_t i = 0; i < sleeveSides; ++i) {
            const uint32_t a = ring * sleeveSides + i, b = ring * sleeveSides + (i + 1) % sleeveSides;
            for (Triangle t : {Triangle{a, b, a + sleeveSides}, Triangle{b, b + sleeveSides, a + sleeveSides}}) {
                const Vec3 &p = patch.positions[t[0]], &q = patch.positions[t[1]], &r = patch.positions[t[2]];
                const Vec3 normal = glm::cross(q - p, r - p);
                const DVec3 out = DVec3(p) - tube.onAxis(tube.at(DVec3(p)));
                if (glm::dot(DVec3(normal), out) < 0) std::swap(t[1], t[2]);
                patch.triangles.push_back(t);
                patch.area += glm::length(normal) / 2;
            }
        }
    return patch;
}

}  // namespace

double tubeEnd(const Mesh& mesh, const StraightTube& tube) {
    std::vector<uint8_t> used(mesh.vertexCount(), 0);
    for (const Triangle& t : mesh.triangles)
        for (const uint32_t v : t) used[v] = 1;
    constexpr double piece = 1.5, near = 4, outer = 2.2, mostOn = 0.7;  // radii; of the vertices
    constexpr size_t mostPieces = 200;
    std::vector<std::array<uint32_t, 2>> counts(mostPieces, {0, 0});
    for (uint32_t v = 0; v < mesh.vertexCount(); ++v) {
        const DVec3 p(mesh.positions[v]);
        const double along = (tube.at(p) - tube.from) / (piece * tube.radius);
        if (!used[v] || !(along >= 0 && along < double(mostPieces)) || tube.off(p) > near * tube.radius) continue;
        auto& [all, on] = counts[size_t(along)];
        ++all;
        on += tube.off(p) < outer * tube.radius;
    }
    size_t whole = 0;
    while (whole < mostPieces && counts[whole][0] > 0 && counts[whole][1] > mostOn * counts[whole][0]) ++whole;
    return tube.from + double(whole) * piece * tube.radius;
}

SurfacePatch sleeveOf(const Mesh& mesh, const LightStand& stand) {
    double from = stand.tube.from;
    for (const uint32_t t : stand.bag)
        for (const uint32_t v : mesh.triangles[t]) from = std::max(from, stand.tube.at(DVec3(mesh.positions[v])));
    SurfacePatch patch = sideOf(stand.tube, stand.light, from, 1e30);
    patch.replaced = stand.bag;
    return patch;
}

SurfacePatch wholeStandOf(const Mesh& mesh, const LightStand& stand, const StraightTube& measured,
                          std::optional<double> ground) {
    constexpr double around = 2.2;  // radii: meshes bend posts by their radius
    const double radius = around * std::max(stand.tube.radius, measured.radius), into = measured.radius / 2;
    SurfacePatch patch =
        sideOf(measured, stand.light, ground ? *ground + into : measured.to + 3 * into, 2 * measured.radius);
    patch.replaced = stand.bag;
    const double above = measured.at(stand.light.anchor(measured.onAxis(measured.from))),
                 below = ground ? *ground - measured.radius : measured.to;
    for (uint32_t t = 0; t < mesh.triangles.size(); ++t)
        if (std::all_of(mesh.triangles[t].begin(), mesh.triangles[t].end(), [&](uint32_t v) {
                const DVec3 p(mesh.positions[v]);
                const double along = measured.at(p);
                return along > above && along < below && measured.off(p) < radius;
            }))
            patch.replaced.push_back(t);
    sortUnique(patch.replaced);
    return patch;
}

HeldLight HeldLight::of(const ProxyLight& ball) { return {ball.centre, double(ball.radius), {}}; }

HeldLight HeldLight::of(const EmitterBody& body) {
    const DVec3& h = body.half;
    return {body.centre, std::max(std::min(h.x, h.y), std::min(std::max(h.x, h.y), h.z)), body};
}

double HeldLight::distance(const DVec3& p) const { return body ? body->distance(p) : glm::length(p - centre) - size; }

DVec3 HeldLight::anchor(const DVec3& p) const {
    if (!body) return centre;
    const DVec3 inside = glm::clamp(glm::transpose(body->axes) * (p - centre), -body->half, body->half);
    return centre + body->axes * inside;
}

std::vector<LightStand> lightStands(const Mesh& mesh, const HeldLight& light) {
    for (const double reach : knownTo)
        if (std::vector<LightStand> found = standsWithin(mesh, light, reach); !found.empty()) return found;
    return {};
}

}  // namespace relamp
