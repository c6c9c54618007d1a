#include "clusters/emitter_body.h"

#include <algorithm>
#include <array>

#include "base/log.h"
#include "base/random.h"
#include "base/statistics.h"
#include "clusters/follow_outlines.h"
#include "clusters/outline_pixels.h"
#include "clusters/principal_axes.h"

namespace relamp {
namespace {

using DMat3 = glm::dmat3;

constexpr size_t leastBodyViews = 3;
constexpr double widestCosine = 0.985;  ///< 10 degrees between two views
constexpr size_t coarsePixels = 3000, finePixels = 30000;
constexpr double coarseStep = 0.5, finestStep = 0.1;  ///< pixels where the searches end
constexpr size_t hullPoints = 30000, leastHullPoints = 40;
constexpr double roundFirst = 0.01;     ///< overlap by which a box must be better than a tube
constexpr double evenFirst = 0.01;      ///< by which a cone must be
constexpr double worseOverlap = 0.005;  ///< by which the body that follows outlines may be worse
constexpr double hiddenPrice = 0.05;    ///< of a hidden pixel: what nothing shows is not there without need
constexpr double leastHalf = 0.25;      ///< pixels
constexpr double mostOfPart = 0.7;      ///< of a body, that a view shows where something hides the rest
constexpr double allButNoise = 0.95;    ///< of what it shows lies on the body then

/// Slab test along one axis; narrows `chord`.
void clipSlab(double from, double along, double half, glm::dvec2& chord) {
    if (along == 0) {
        if (std::abs(from) > half) chord.y = -1e300;
        return;
    }
    const double a = (-half - from) / along, b = (half - from) / along;
    chord.x = std::max(chord.x, std::min(a, b));
    chord.y = std::min(chord.y, std::max(a, b));
}

DMat3 turnedAbout(const DMat3& axes, int k, double angle) {
    const DVec3 a = axes[(k + 1) % 3], b = axes[(k + 2) % 3];
    DMat3 turned = axes;
    turned[(k + 1) % 3] = std::cos(angle) * a + std::sin(angle) * b;
    turned[(k + 2) % 3] = std::cos(angle) * b - std::sin(angle) * a;
    return turned;
}

/// The body's silhouettes against the outlines.
class Silhouettes {
public:
    Silhouettes(std::vector<OutlineView> views, double slack) : views_(std::move(views)), slack_(slack) {
        for (const OutlineView& view : views_)
            for (const OutlinePixel& p : view.pixels) shown_ += p.shows;
    }
    OutlineOverlap of(const EmitterBody& body) const {
        return outlineOverlap(views_, slack_,
                              [&](const DVec3& eye, const DVec3& direction) { return hitOf(body, eye, direction); });
    }
    /// Views that show a part of the body and nothing beside it, as if something hid the rest.
    std::vector<size_t> partOnly(const EmitterBody& body) const {
        std::vector<size_t> views;
        for (size_t i = 0; i < views_.size(); ++i) {
            size_t shows = 0, disc = 0, both = 0;
            for (const OutlinePixel& p : views_[i].pixels) {
                const double hit = hitOf(body, views_[i].eye, DVec3(p.direction));
                if (!p.shows && hit > 0 && double(p.depth) + slack_ < hit) continue;
                shows += p.shows;
                disc += hit > 0;
                both += hit > 0 && p.shows;
            }
            if (double(both) < mostOfPart * double(disc) && double(both) > allButNoise * double(shows))
                views.push_back(i);
        }
        return views;
    }
    double score(const EmitterBody& body) const {
        const OutlineOverlap o = of(body);
        return double(o.overlap()) - hiddenPrice * double(o.hidden) / double(std::max<size_t>(1, shown_));
    }

private:
    std::vector<OutlineView> views_;
    double slack_;
    size_t shown_ = 0;

    static double hitOf(const EmitterBody& body, const DVec3& eye, const DVec3& direction) {
        const glm::dvec2 chord = body.chord(eye, direction);
        return chord.x <= chord.y ? chord.x : -1.0;
    }
};

/// Ways to change a body by about `size` metres at its surface: moves, turns, each end.
struct BodyChange {
    enum Kind { move, turn, end, radius, taper } kind;
    int axis;
    double sign;

    EmitterBody of(EmitterBody body, double size, double least) const {
        const int a = (axis + 1) % 3, b = (axis + 2) % 3;
        if (kind == move) body.centre += sign * size * body.axes[axis];
        if (kind == turn) {
            const double arm = std::max({body.half[a], body.half[b], size});
            body.axes = turnedAbout(body.axes, axis, sign * std::min(0.4, size / arm));
        }
        if (kind == end) {  // the end on the axis' side moves, the other stays
            const double change = std::max(sign * size, 2 * (least - body.half[axis]));
            body.half[axis] += 0.5 * change;
            body.centre += 0.5 * change * (endSide > 0 ? 1.0 : -1.0) * body.axes[axis];
        }
        if (kind == taper)
            body.taper =
                std::clamp(body.taper + sign * size / body.half.y, -EmitterBody::steepest, EmitterBody::steepest);
        if (kind == radius) body.half[1] = body.half[2] = std::max(least, body.half[1] + sign * size);
        return body;
    }
    int endSide = 1;
};

std::vector<BodyChange> changesOf(const EmitterBody& body, bool conical) {
    std::vector<BodyChange> changes;
    for (int axis = 0; axis < 3; ++axis)
        for (const double sign : {1.0, -1.0}) {
            changes.push_back({BodyChange::move, axis, sign});
            if (!body.round || axis > 0) changes.push_back({BodyChange::turn, axis, sign});
            if (!body.round || axis == 0)
                for (const int side : {1, -1}) changes.push_back({BodyChange::end, axis, sign, side});
        }
    if (body.round)
        for (const double sign : {1.0, -1.0}) {
            changes.push_back({BodyChange::radius, 1, sign});
            if (conical) changes.push_back({BodyChange::taper, 1, sign});
        }
    return changes;
}

/// Pattern search: changes that raise the score are kept, and go on; where none does, steps are halved. Steps in
/// metres.
double climb(const Silhouettes& outlines, double from, double to, double least, EmitterBody& body,
             bool conical = false) {
    double best = outlines.score(body);
    const std::vector<BodyChange> changes = changesOf(body, conical);
    int rounds = 0;
    for (double step = from; step >= to && rounds < 60; ++rounds) {
        bool better = false;
        for (const BodyChange& change : changes)
            for (int repeat = 0; repeat < 6; ++repeat) {
                const EmitterBody tried = change.of(body, step, least);
                const double score = outlines.score(tried);
                if (!(score > best + 1e-7)) break;
                best = score;
                body = tried;
                better = true;
            }
        if (!better) step *= 0.5;
    }
    return best;
}

/// Points that all outlines allow: within them, or behind what hides them.
std::vector<DVec3> visualHull(const Capture& capture, const RadianceSamples& samples,
                              const std::vector<EmitterOutline>& outlines, const DVec3& centre, double radius) {
    std::vector<DVec3> inside;
    const size_t mayMiss = outlines.size() / 6;
    for (uint32_t n = 0; n < hullPoints; ++n) {
        const Vec2 u = r2Point(n, Vec2(0.5f));
        const double z = unitFloat(mixBits(n));
        const DVec3 p = centre + radius * (2.0 * DVec3(u.x, u.y, z) - 1.0);
        size_t missed = 0;
        for (const EmitterOutline& o : outlines) {
            const Camera& camera = capture.views[o.view].camera;
            const auto at = camera.project(p);
            if (!at || at->x < 0 || at->y < 0 || at->x >= float(camera.width) || at->y >= float(camera.height)) {
                missed += !o.cut;
                continue;
            }
            const size_t pixel = size_t(at->y) * size_t(camera.width) + size_t(at->x);
            missed += !o.shows[pixel] &&
                      double(samples.geometry[o.view].depth[pixel]) > glm::length(p - camera.position()) - 0.1 * radius;
            if (missed > mayMiss) break;
        }
        if (missed <= mayMiss) inside.push_back(p);
    }
    return inside;
}

/// A body with these axes about the points.
EmitterBody bodyAbout(const std::vector<DVec3>& points, const DMat3& axes, double least) {
    EmitterBody body;
    body.axes = axes;
    DVec3 middle(0);
    for (int k = 0; k < 3; ++k) {
        std::vector<double> along;
        for (const DVec3& p : points) along.push_back(glm::dot(p, axes[k]));
        std::sort(along.begin(), along.end());
        const double low = along[along.size() / 20], high = along[along.size() - 1 - along.size() / 20];
        middle[k] = 0.5 * (low + high);
        body.half[k] = std::max(least, 0.55 * (high - low));
    }
    body.centre = axes * middle;
    return body;
}

std::vector<EmitterBody> startsFrom(const std::vector<DVec3>& points, double least) {
    std::vector<EmitterBody> starts;
    const DMat3 own = principalAxes(points), upright(DVec3(0, 0, 1), DVec3(1, 0, 0), DVec3(0, 1, 0));
    for (const double turn : {0.0, piD / 4}) starts.push_back(bodyAbout(points, turnedAbout(own, 2, turn), least));
    for (int i = 0; i < 4; ++i) starts.push_back(bodyAbout(points, turnedAbout(upright, 0, i * piD / 8), least));
    for (const DMat3& axes : {own, upright}) {
        EmitterBody tube = bodyAbout(points, axes, least);
        tube.round = true;
        tube.half[1] = tube.half[2] = 0.5 * (tube.half[1] + tube.half[2]);
        starts.push_back(tube);
    }
    return starts;
}

}  // namespace

glm::dvec2 EmitterBody::chord(const DVec3& eye, const DVec3& direction, double scale) const {
    const DVec3 from = (eye - centre) * axes, along = direction * axes, size = scale * half;
    glm::dvec2 chord(0, 1e300);
    clipSlab(from.x, along.x, size.x, chord);
    if (!round) {
        clipSlab(from.y, along.y, size.y, chord);
        clipSlab(from.z, along.z, size.z, chord);
        return chord;
    }
    // Radius at `from`, and what it grows by along the ray.
    const double radius = size.y * (1 + taper * from.x / size.x), grows = size.y * taper * along.x / size.x;
    const double a = along.y * along.y + along.z * along.z - grows * grows,
                 b = from.y * along.y + from.z * along.z - radius * grows,
                 c = from.y * from.y + from.z * from.z - radius * radius;
    const double inside = b * b - a * c;
    if (a == 0) return c > 0 ? glm::dvec2(1, -1) : chord;
    if (a > 0) {
        if (!(inside > 0)) return {1, -1};
        chord.x = std::max(chord.x, (-b - std::sqrt(inside)) / a);
        chord.y = std::min(chord.y, (-b + std::sqrt(inside)) / a);
        return chord;
    }
    // A ray steeper than the cone's sides crosses them once where the radius is above 0.
    if (!(inside > 0)) return chord;
    if (grows > 0) chord.x = std::max(chord.x, (-b - std::sqrt(inside)) / a);
    else chord.y = std::min(chord.y, (-b + std::sqrt(inside)) / a);
    return chord;
}

double EmitterBody::distance(const DVec3& point) const {
    const DVec3 at = (point - centre) * axes;
    // A cone's sides lean by half.y taper / half.x.
    const DVec3 past =
        round ? DVec3(std::abs(at.x) - half.x,
                      (std::hypot(at.y, at.z) - radiusAt(at.x)) / std::hypot(1, half.y * taper / half.x), -1e300)
              : DVec3(std::abs(at.x) - half.x, std::abs(at.y) - half.y, std::abs(at.z) - half.z);
    const double most = std::max({past.x, past.y, past.z});
    return most < 0 ? most : glm::length(glm::max(past, DVec3(0)));
}

std::vector<uint32_t> EmitterBody::surface(std::vector<Vec3>& positions, std::vector<Triangle>& triangles,
                                           bool open) const {
    std::vector<uint32_t> sides;
    const double longest = 2 * std::max({half.x, half.y, half.z});
    const double thin = 2 * std::min({half.x, half.y, half.z});
    const double edge = std::clamp(thin, longest / 24, longest / 8);
    // A sheet of points(s, t), outwards on its front.
    const auto sheet = [&](int columns, int rows, const auto& point) {
        const auto first = uint32_t(positions.size());
        sides.push_back(first);
        for (int i = 0; i <= columns; ++i)
            for (int j = 0; j <= rows; ++j)
                positions.push_back(Vec3(centre + axes * point(double(i) / columns, double(j) / rows)));
        for (int i = 0; i < columns; ++i)
            for (int j = 0; j < rows; ++j) {
                const uint32_t a = first + uint32_t(i * (rows + 1) + j), b = a + uint32_t(rows) + 1;
                triangles.push_back({a, b, b + 1});
                triangles.push_back({a, b + 1, a + 1});
            }
    };
    const auto cells = [&](double length) { return std::clamp(int(std::lround(length / edge)), 1, 64); };
    if (round) {
        constexpr int around = 16;
        // A polygon of the same mean width as the circle, of the whole radius or a part of it.
        const double polygon = (piD / around) / std::sin(piD / around);
        const auto rim = [&](double x, double t, double part) {
            const double a = 2 * piD * t, r = polygon * part * radiusAt(x);
            return DVec3(x, r * std::cos(a), r * std::sin(a));
        };
        sheet(around, cells(2 * half.x), [&](double s, double t) { return rim(half.x * (2 * t - 1), s, 1); });
        if (open) return sides;
        sheet(around, 1, [&](double s, double t) { return rim(half.x, s, 1e-3 + (1 - 1e-3) * (1 - t)); });
        sheet(around, 1, [&](double s, double t) { return rim(-half.x, s, 1e-3 + (1 - 1e-3) * t); });
        return sides;
    }
    // Photographs mix what lies on an edge with what lies beside it: a side has vertices within.
    const auto across = [&](double length) { return std::max(2, cells(length)); };
    for (int k = 0; k < 3; ++k)
        for (const double side : {1.0, -1.0}) {
            const int a = (k + 1) % 3, b = (k + 2) % 3;
            sheet(across(2 * half[a]), across(2 * half[b]), [&](double s, double t) {
                DVec3 at(0);
                at[k] = side * half[k];
                at[a] = half[a] * side * (2 * s - 1);
                at[b] = half[b] * (2 * t - 1);
                return at;
            });
        }
    return sides;
}

std::optional<EmitterBody> fitBody(const Scene& scene, const Capture& capture, const RadianceSamples& samples,
                                   const EmitterCluster& cluster, const std::vector<EmitterOutline>& outlines) {
    if (outlines.size() < leastBodyViews) return {};
    DVec3 centre(cluster.centroid);
    std::vector<DVec3> fromMesh;
    for (const uint32_t v : cluster.vertices) fromMesh.emplace_back(scene.mesh.positions[v]);
    double widest = 1, unit = 0, reachable = 0;
    std::vector<float> reach;
    size_t pixels = 0;
    for (const EmitterOutline& o : outlines) {
        const Camera& camera = capture.views[o.view].camera;
        const DVec3 to = centre - camera.position();
        const double metres = glm::length(to) / std::sqrt(camera.focalX * camera.focalY);
        unit += metres / double(outlines.size());
        // Twice its mean width.
        const float width = 2 * float(o.pixels) / std::max(1.0f, float(o.boundaryLength) * pi / 4);
        reach.push_back(std::max(8.0f, 2 * width));
        pixels += size_t(reach.back() * float(o.boundaryLength)) + o.pixels;
        for (const Vec2& b : o.boundary)
            reachable = std::max(reachable, 1.2 * metres * double(glm::distance(b, o.centre)));
        for (const EmitterOutline& other : outlines)
            widest = std::min(widest, glm::dot(glm::normalize(to),
                                               glm::normalize(centre - capture.views[other.view].camera.position())));
    }
    if (widest > widestCosine || fromMesh.empty()) return {};
    const double least = leastHalf * unit, slack = 0.005 * double(scene.diagonal);
    const auto silhouettes = [&](size_t most) {
        return Silhouettes(pixelsAbout(capture, samples, outlines, cluster.triangles, reach, pixels / most + 1), slack);
    };
    std::vector<EmitterBody> starts = startsFrom(fromMesh, least);
    const std::vector<DVec3> hull = visualHull(capture, samples, outlines, centre, reachable);
    if (hull.size() >= leastHullPoints)
        for (const EmitterBody& b : startsFrom(hull, least)) starts.push_back(b);
    const Silhouettes coarse = silhouettes(coarsePixels);
    std::array<std::optional<EmitterBody>, 2> best;  // box, tube
    std::array<double, 2> scores{0, 0};
    for (EmitterBody& body : starts) {
        const double from = std::max(4 * unit, 0.3 * body.half.x);
        const double score = climb(coarse, from, coarseStep * unit, least, body);
        const size_t kind = body.round ? 1 : 0;
        if (score > scores[kind]) {
            scores[kind] = score;
            best[kind] = body;
        }
    }
    const Silhouettes fine = silhouettes(finePixels);
    for (size_t kind : {0, 1}) {
        if (!best[kind]) continue;
        scores[kind] = climb(fine, unit, finestStep * unit, least, *best[kind]);
        const EmitterBody followed = followOutlines(capture, outlines, *best[kind], unit, least);
        if (const double score = fine.score(followed); score > scores[kind] - worseOverlap) {
            scores[kind] = score;
            best[kind] = followed;
        }
    }
    if (best[1]) {
        EmitterBody cone = *best[1];
        climb(fine, 4 * unit, unit, least, cone, true);
        cone = followOutlines(capture, outlines, cone, unit, least, true);
        if (const double score = fine.score(cone); score > scores[1] + evenFirst) {
            scores[1] = score;
            best[1] = cone;
        }
    }
    const size_t chosen = best[1] && !(best[0] && scores[0] > scores[1] + roundFirst) ? 1 : 0;
    if (!best[chosen]) return {};
    EmitterBody body = *best[chosen];
    const OutlineOverlap o = fine.of(body);
    body.partOnly = fine.partOnly(body);
    body.overlap = o.overlap();
    body.mostSeen = o.mostSeen;
    body.nextSeen = o.nextSeen;
    return body;
}

std::optional<EmitterBody> fitUnhidden(const Scene& scene, const Capture& capture, const RadianceSamples& samples,
                                       const EmitterCluster& cluster, std::vector<EmitterOutline>& outlines) {
    std::optional<EmitterBody> body = fitBody(scene, capture, samples, cluster, outlines);
    if (!body || body->partOnly.empty() || explainsOutlines(*body, outlines) ||
        4 * body->partOnly.size() > outlines.size())
        return body;
    for (auto i = body->partOnly.rbegin(); i != body->partOnly.rend(); ++i)
        outlines.erase(outlines.begin() + std::ptrdiff_t(*i));
    return fitBody(scene, capture, samples, cluster, outlines);
}

/// For a disc, length of the outline over its area is two over the radius.
bool explainsOutlines(const EmitterBody& body, const std::vector<EmitterOutline>& outlines) {
    double pixels = 0, sides = 0;
    for (const EmitterOutline& o : outlines) {
        pixels += double(o.pixels);
        sides += double(o.boundaryLength) * piD / 4;
    }
    return double(body.overlap) > 0.95 - 0.35 * sides / std::max(1.0, pixels) && body.mostSeen > 0.8f &&
           body.nextSeen > 0.5f;
}

std::string wordsOf(const EmitterBody& body) {
    const DVec3 size = 2000.0 * body.half;
    if (body.taper != 0)
        return fmt::format("a cone of {:.0f} x {:.1f} to {:.1f} mm", size.x, 2000 * body.radiusAt(-body.half.x),
                           2000 * body.radiusAt(body.half.x));
    return body.round ? fmt::format("a tube of {:.0f} x {:.1f} mm", size.x, size.y)
                      : fmt::format("a box of {:.0f} x {:.0f} x {:.1f} mm", size.x, size.y, size.z);
}

}  // namespace relamp
