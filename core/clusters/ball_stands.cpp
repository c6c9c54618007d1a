#include "clusters/ball_stands.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>

#include "base/statistics.h"
#include "clusters/principal_axes.h"
#include "scene/rim.h"

namespace relamp {
namespace {

// In radii of the ball, from its centre.
constexpr double endsWithin = 2, knownTo = 4;
constexpr double bagsTo = 1.5;                ///< a mesh wraps ball and stand in one bag: what is nearer is no tube
constexpr double leastLength = 1;             ///< of the tube that is known
constexpr double thickest = 0.75;             ///< radius of the tube
constexpr double offCentre = 0.5;             ///< of the axis, at most
constexpr double sleeveEnd = 0.93;            ///< within the ball's flat faces
constexpr double leastAway = 0.8;             ///< cosine of the axis with the way from the ball
constexpr double ofOneRadius = 0.35;          ///< relative: distances from the axis that are a tube's
constexpr double mostOfOne = 0.75;            ///< of its vertices
constexpr int sectors = 8, leastSectors = 6;  ///< around it: that have some of it
constexpr int sleeveSides = 16;
constexpr size_t leastVertices = 12;

struct Tube {
    DVec3 through{0};    ///< metres
    glm::dmat3 axes{1};  ///< the first along it, away from the ball
    double radius = 0;   ///< metres
    double from = 0;     ///< metres along it from `through`: where it is whole
    double at(const DVec3& p) const { return glm::dot(p - through, axes[0]); }
    double off(const DVec3& p) const { return glm::length(p - through - at(p) * axes[0]); }
};

/// The tube that the points are of, away from the ball about `centre`; none where they are no tube.
std::optional<Tube> tubeOf(const std::vector<DVec3>& points, const DVec3& centre, double ball) {
    if (points.size() < leastVertices) return {};
    Tube tube;
    for (const DVec3& p : points) tube.through += p / double(points.size());
    tube.axes = principalAxes(points);
    const DVec3 away = tube.through - centre;
    if (glm::dot(tube.axes[0], away) < 0) tube.axes[0] = -tube.axes[0];
    if (glm::dot(tube.axes[0], away) < leastAway * glm::length(away)) return {};
    if (tube.off(centre) > offCentre * ball) return {};
    std::vector<double> heights;
    for (const DVec3& p : points) heights.push_back(tube.at(p));
    const auto [least, most] = std::minmax_element(heights.begin(), heights.end());
    if (*most - *least < leastLength * ball) return {};
    tube.from = *least + ball / 2;
    std::vector<double> radii;
    for (const DVec3& p : points)
        if (tube.at(p) > tube.from) radii.push_back(tube.off(p));
    if (radii.size() < leastVertices) return {};
    tube.radius = quantileOf(radii, 0.75);
    const auto ofTube = [&](double r) { return std::abs(r - tube.radius) < ofOneRadius * tube.radius; };
    const double part = double(std::count_if(radii.begin(), radii.end(), ofTube)) / double(radii.size());
    if (tube.radius > thickest * ball || part < mostOfOne) return {};
    unsigned around = 0;
    for (const DVec3& p : points) {
        const DVec3 d = p - tube.through;
        const double turn = std::atan2(glm::dot(d, tube.axes[2]), glm::dot(d, tube.axes[1])) / (2 * piD) + 0.5;
        around |= 1u << std::min(sectors - 1, int(turn * sectors));
    }
    return std::popcount(around) >= leastSectors ? std::optional(tube) : std::nullopt;
}

/// From the ball's inside to where the tube is whole, in place of `bag`, triangles of the mesh.
SurfacePatch sleeveOf(const Mesh& mesh, const std::vector<uint32_t>& bag, Tube tube, const DVec3& centre, double ball) {
    SurfacePatch patch;
    patch.replaced = bag;
    for (const uint32_t t : bag)
        for (const uint32_t v : mesh.triangles[t]) tube.from = std::max(tube.from, tube.at(DVec3(mesh.positions[v])));
    const DVec3& along = tube.axes[0];
    for (const bool inBall : {false, true})
        for (int i = 0; i < sleeveSides; ++i) {
            const double turn = 2 * piD * i / sleeveSides;
            const DVec3 foot =
                tube.through + tube.radius * (std::cos(turn) * tube.axes[1] + std::sin(turn) * tube.axes[2]);
            const DVec3 to = centre - foot;
            const double ahead = glm::dot(to, along), aside2 = glm::dot(to, to) - ahead * ahead,
                         end = ahead + std::sqrt(std::max(0.0, sleeveEnd * sleeveEnd * ball * ball - aside2));
            patch.positions.push_back(Vec3(foot + (inBall ? end : std::max(tube.from, end + ball / 20)) * along));
        }
    for (uint32_t i = 0; i < sleeveSides; ++i) {
        const uint32_t next = (i + 1) % sleeveSides;
        for (Triangle t : {Triangle{i, next, i + sleeveSides}, Triangle{next, next + sleeveSides, i + sleeveSides}}) {
            const Vec3 &a = patch.positions[t[0]], &b = patch.positions[t[1]], &c = patch.positions[t[2]];
            const DVec3 out = DVec3(a) - tube.through - tube.at(DVec3(a)) * along;
            if (glm::dot(DVec3(glm::cross(b - a, c - a)), out) < 0) std::swap(t[1], t[2]);
            patch.triangles.push_back(t);
            patch.area += glm::length(glm::cross(b - a, c - a)) / 2;
        }
    }
    return patch;
}

}  // namespace

std::vector<SurfacePatch> ballStands(const Mesh& mesh, const std::vector<ProxyLight>& balls) {
    std::vector<SurfacePatch> sleeves;
    if (balls.empty()) return sleeves;
    const std::vector<uint8_t> rim = rimVertices(mesh);
    for (const ProxyLight& ball : balls) {
        const double radius = double(ball.radius);
        Mesh about;
        about.positions = mesh.positions;
        const auto distance = [&](uint32_t v) { return glm::length(DVec3(mesh.positions[v]) - ball.centre); };
        std::vector<uint32_t> number;  // in the mesh, of the triangles about the ball
        for (uint32_t t = 0; t < mesh.triangles.size(); ++t) {
            const Triangle& corners = mesh.triangles[t];
            if (!std::all_of(corners.begin(), corners.end(),
                             [&](uint32_t v) { return distance(v) < knownTo * radius; }))
                continue;
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
                if (distance(v) > bagsTo * radius) points[piece[v]].push_back(DVec3(mesh.positions[v]));
                ends[piece[v]] |= rim[v] && distance(v) < endsWithin * radius;
            }
        for (uint32_t k = 0; k < count; ++k) {
            if (!ends[k]) continue;
            const std::optional<Tube> tube = tubeOf(points[k], ball.centre, radius);
            if (!tube) continue;
            std::vector<uint32_t> bag;
            for (size_t i = 0; i < number.size(); ++i) {
                const Triangle& t = about.triangles[i];
                if (piece[t[0]] == k &&
                    std::any_of(t.begin(), t.end(), [&](uint32_t v) { return distance(v) < bagsTo * radius; }))
                    bag.push_back(number[i]);
            }
            sleeves.push_back(sleeveOf(mesh, bag, *tube, ball.centre, radius));
        }
    }
    return sleeves;
}

}  // namespace relamp
