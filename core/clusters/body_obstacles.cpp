#include "clusters/body_obstacles.h"

#include <algorithm>

#include <map>
#include <optional>

#include "base/statistics.h"
#include "clusters/patches.h"
#include "scene/flat_surface.h"
#include "scene/vertex_rings.h"

namespace relamp {
namespace {

constexpr double innerPart = 0.9, outerPart = 1.05;
constexpr int ridgeRingsFrom = 5, ridgeRingsTo = 9;  ///< of neighbours that tell where the surface about it lies
constexpr int ridgeFoot = 3;                         ///< rings that a ridge's rounded foot has
constexpr float alongRidge = 0.8f;                   ///< cosine of that surface's normals with their mean
constexpr double scrapReach = 2;        ///< of a body's half length: so far away a bag goes that hangs on it
constexpr ptrdiff_t leastOnCut = 4;     ///< vertices that a piece shares with what goes
constexpr float islandPart = 0.25f;     ///< of the scraps' area: an island of theirs is no larger
constexpr float doubtfulIsland = 2;     ///< the same of doubtful ones
constexpr int rimPixels = 3;            ///< about a light, in which a photograph mixes it with what lies beside it
constexpr float radianceBehind = 0.2f;  ///< relative: a pixel shows what lies behind
constexpr float floorBehind = 4;        ///< noise floors besides
constexpr float mostlyRidge = 0.8f;     ///< of the area, and of the vertices about it

/// Pixels through triangles that show the body, and that do not.
class ThroughVotes {
public:
    ThroughVotes(const Scene& scene, const LightBody& body) : scene_(scene), body_(body) {
        in_.assign(scene.mesh.triangles.size(), 0);
        out_.assign(scene.mesh.triangles.size(), 0);
    }

    void vote(const View& view, const EmitterOutline& outline) {
        const Camera& camera = view.camera;
        const DVec3 eye = camera.position();
        for (int y = 0; y < camera.height; ++y)
            for (int x = 0; x < camera.width; ++x) {
                const Vec3 direction = camera.rayDirection(Vec2(float(x) + 0.5f, float(y) + 0.5f));
                // To the body's middle: what lies in its near half hides it as well.
                const double along = body_.middle(eye, DVec3(direction));
                if (!(along > 0)) continue;
                const bool shows = outline.shows[size_t(y) * size_t(camera.width) + size_t(x)] != 0;
                float from = 0;
                for (int layers = 0; layers < 16; ++layers) {
                    const Hit hit = scene_.tracer->closest({Vec3(eye), direction, from, float(along)});
                    if (!hit) break;
                    ++(shows ? in_ : out_)[hit.triangle];
                    from = hit.distance + 0.25f * scene_.tracer->surfaceOffset() + 1e-6f * float(along);
                }
            }
    }

    /// Adds to `within` the triangles in the body, marks in `through` those before it that show it all the same.
    void collect(const std::vector<int>& emitterOfTriangle, std::set<uint32_t>& within,
                 std::vector<uint8_t>& through) const {
        std::vector<uint8_t> open(scene_.mesh.vertexCount(), 0), closed = open;
        for (uint32_t t = 0; t < in_.size(); ++t)
            for (const uint32_t v : scene_.mesh.triangles[t]) {
                open[v] |= in_[t] > out_[t];
                closed[v] |= out_[t] > in_[t];
            }
        for (uint32_t t = 0; t < in_.size(); ++t) {
            const Triangle& corners = scene_.mesh.triangles[t];
            const bool inBody = std::all_of(corners.begin(), corners.end(),
                                            [&](uint32_t v) { return body_.holds(DVec3(scene_.mesh.positions[v])); });
            // Triangles between pixels go with what is around them.
            const bool between = in_[t] + out_[t] == 0 && std::all_of(corners.begin(), corners.end(), [&](uint32_t v) {
                                     return open[v] && !closed[v];
                                 });
            if (inBody) within.insert(t);
            else through[t] = (between || in_[t] > out_[t]) && emitterOfTriangle[t] < 0;
        }
    }

private:
    const Scene& scene_;
    const LightBody& body_;
    std::vector<uint32_t> in_, out_;
};

/// Radiance that other photographs show at a hit, or of the background along the ray; none where none shows it.
std::optional<Rgb> shownThere(const Scene& scene, const RadianceSamples& samples,
                              const std::vector<VertexRadiance>& seen, const Hit& hit, const Vec3& direction,
                              uint32_t view) {
    if (!hit) {
        const int environment = samples.environmentOf(samples.stateOf(view));
        if (environment < 0) return {};
        const size_t cell =
            size_t(environment) * samples.backgroundGrid.cells() + size_t(samples.backgroundGrid.cellOf(direction));
        if (cell >= samples.backgroundPixels.size() || !samples.backgroundPixels[cell]) return {};
        return samples.background[cell];
    }
    Rgb sum(0);
    float weight = 0;
    for (const uint32_t v : scene.mesh.triangles[hit.triangle])
        if (seen[v].weight > 0) {
            sum += seen[v].radiance;
            weight += 1;
        }
    if (!(weight > 0)) return {};
    return sum / weight;
}

/// Per pixel of an outline's view 1 where it shows the light or lies within `reach` pixels of one that does.
std::vector<uint8_t> withinReach(const EmitterOutline& outline, const Camera& camera, int reach) {
    std::vector<uint8_t> near = outline.shows;
    const int w = camera.width, h = camera.height;
    for (int y = 0; y < h; ++y)
        for (int x = 0; x < w; ++x) {
            if (!outline.shows[size_t(y) * size_t(w) + size_t(x)]) continue;
            for (int v = std::max(0, y - reach); v <= std::min(h - 1, y + reach); ++v)
                for (int u = std::max(0, x - reach); u <= std::min(w - 1, x + reach); ++u)
                    near[size_t(v) * size_t(w) + size_t(u)] = 1;
        }
    return near;
}

/// Of the triangles `about`, 1 for those that no pixel hits or at most one view sees, from which nothing is
/// reconstructed, and for those through which most pixels on and around them show what lies behind; pixels of
/// `outlines` and within `rim` pixels of them are not asked.
std::vector<uint8_t> notThere(const Scene& scene, const Capture& capture, const RadianceSamples& samples,
                              const std::vector<uint8_t>& about, const std::vector<EmitterOutline>& outlines, int rim) {
    std::vector<std::vector<uint8_t>> unasked(samples.geometry.size());
    for (const EmitterOutline& o : outlines) unasked[o.view] = withinReach(o, capture.views[o.view].camera, rim);
    const std::vector<VertexRadiance> seen = vertexRadiance(scene, samples);
    std::vector<uint32_t> through(scene.mesh.vertexCount(), 0), against = through;
    std::vector<uint8_t> hits(about.size(), 0);
    for (size_t i = 0; i < samples.geometry.size(); ++i) {
        const ViewGeometry& g = samples.geometry[i];
        for (size_t p = 0; p < g.triangle.size(); ++p) {
            const uint32_t t = g.triangle[p];
            if (t == Hit::none || (!unasked[i].empty() && unasked[i][p])) continue;
            hits[t] = 1;
            if (!about[t] || i >= capture.views.size()) continue;
            const View& view = capture.views[i];
            const int x = int(p % size_t(g.width)), y = int(p / size_t(g.width));
            if (!view.image.usableAt(x, y)) continue;
            const Vec3 eye(view.camera.position()),
                direction = view.camera.rayDirection(Vec2(float(x) + 0.5f, float(y) + 0.5f));
            float from = g.depth[p];
            Hit hit;
            for (int layers = 0; layers < 16; ++layers) {
                hit = scene.cameraTracer->closest(
                    {eye, direction, from + 0.25f * scene.tracer->surfaceOffset() + 1e-6f * from, 1e30f});
                if (!hit || !about[hit.triangle]) break;
                from = hit.distance;
            }
            const std::optional<Rgb> behind = shownThere(scene, samples, seen, hit, direction, uint32_t(i));
            if (!behind) continue;
            const Rgb value = view.image.at(x, y);
            const bool same =
                glm::length(value - *behind) < radianceBehind * glm::length(*behind) + floorBehind * samples.noiseFloor;
            for (const uint32_t v : scene.mesh.triangles[t]) ++(same ? through[v] : against[v]);
        }
    }
    std::vector<uint8_t> result(about.size(), 0);
    for (uint32_t t = 0; t < about.size(); ++t) {
        if (!about[t]) continue;
        uint32_t yes = 0, no = 0;
        for (const uint32_t v : scene.mesh.triangles[t]) yes += through[v], no += against[v];
        size_t views = 0;
        for (const uint32_t v : scene.mesh.triangles[t]) views = std::max(views, samples.countOf(v));
        result[t] = yes + no > 0 ? yes > 2 * no : !hits[t] || views < 2;
    }
    return result;
}

float areaOf(const Scene& scene, const std::vector<uint32_t>& triangles) {
    float area = 0;
    for (const uint32_t t : triangles) area += scene.mesh.triangleArea(t);
    return area;
}

/// Pieces that are left of a bag once its `scraps` are gone: those that hang on nothing else, of up to `part` of the
/// scraps' area.
std::vector<uint32_t> islandsAmong(const Scene& scene, const std::vector<uint8_t>& about,
                                   const std::set<uint32_t>& removed, const std::vector<uint32_t>& scraps, float part) {
    std::vector<uint8_t> gone(about.size(), 0);
    for (const uint32_t t : removed) gone[t] = 1;
    for (const uint32_t t : scraps) gone[t] = 1;
    std::vector<std::vector<uint32_t>> at(scene.mesh.vertexCount());
    for (uint32_t t = 0; t < about.size(); ++t)
        if (!gone[t])
            for (const uint32_t v : scene.mesh.triangles[t]) at[v].push_back(t);
    const float most = part * areaOf(scene, scraps);
    std::vector<uint32_t> found;
    for (const uint32_t scrap : scraps)
        for (const uint32_t start : scene.mesh.triangles[scrap]) {
            std::vector<uint32_t> piece, front{start};
            float area = 0;
            bool island = true;
            while (!front.empty()) {  // to its end: what is left of a surface would look like an island
                const uint32_t v = front.back();
                front.pop_back();
                for (const uint32_t t : at[v]) {
                    if (gone[t]) continue;
                    gone[t] = 1;
                    piece.push_back(t);
                    area += scene.mesh.triangleArea(t);
                    island = island && about[t] && area < most;
                    for (const uint32_t u : scene.mesh.triangles[t]) front.push_back(u);
                }
            }
            if (island) found.insert(found.end(), piece.begin(), piece.end());
        }
    return found;
}

}  // namespace

double LightBody::middle(const DVec3& eye, const DVec3& direction) const {
    if (body_) {
        const glm::dvec2 chord = body_->chord(eye, direction, innerPart);
        return chord.x <= chord.y ? 0.5 * (chord.x + chord.y) : -1;
    }
    const DVec3 to = ball_->centre - eye;
    const double along = glm::dot(to, direction), squared = glm::dot(to, to) - along * along,
                 inner = innerPart * ball_->radius;
    return squared < inner * inner ? along : -1;
}

bool LightBody::holds(const DVec3& point) const {
    if (body_) return body_->distance(point) < margin_;
    return glm::length(point - ball_->centre) < outerPart * ball_->radius;
}

void collectObstacles(const Scene& scene, const Capture& capture, const RadianceSamples& samples,
                      const std::vector<EmitterOutline>& outlines, const LightBody& body,
                      const std::vector<uint32_t>& own, const std::vector<int>& emitterOfTriangle,
                      std::set<uint32_t>& removed) {
    ThroughVotes votes(scene, body);
    for (const EmitterOutline& o : outlines) votes.vote(capture.views[o.view], o);
    removed.insert(own.begin(), own.end());
    std::vector<uint8_t> through(scene.mesh.triangles.size(), 0);
    votes.collect(emitterOfTriangle, removed, through);
    for (const uint32_t t : removed) through[t] = 0;
    // What stands a little into its outline, as rounded as a reconstruction is, and is a surface elsewhere, stays.
    if (body.straight()) through = notThere(scene, capture, samples, through, outlines, 0);
    for (uint32_t t = 0; t < through.size(); ++t)
        if (through[t]) removed.insert(t);
}

std::vector<MeshMend::MovedVertex> ridgeSetBack(const Scene& scene, const EmitterCluster& emitter) {
    std::vector<uint32_t> reached = emitter.vertices;
    const std::vector<int> rings = ringsAbout(scene.graph, ridgeRingsTo, reached);
    Vec3 normal(0);
    std::vector<uint32_t> about;
    for (const uint32_t v : reached)
        if (rings[v] >= ridgeRingsFrom) {
            about.push_back(v);
            normal += scene.mesh.normals[v];
        }
    if (about.empty() || !(glm::length(normal) > 0)) return {};
    normal = glm::normalize(normal);
    std::vector<float> heights;
    for (const uint32_t v : about)
        if (glm::dot(scene.mesh.normals[v], normal) > alongRidge)
            heights.push_back(glm::dot(scene.mesh.positions[v], normal));
    if (float(heights.size()) < mostlyRidge * float(about.size())) return {};
    const float base = medianOf(std::move(heights));
    // A ridge's faces look away from the surface; a finger's or a bag's look all ways.
    float away = 0, area = 0;
    for (const uint32_t t : emitter.triangles) {
        const float a = scene.mesh.triangleArea(t);
        area += a;
        if (glm::dot(scene.mesh.faceNormal(t), normal) > 0) away += a;
    }
    if (!(away > mostlyRidge * area)) return {};
    std::vector<MeshMend::MovedVertex> moved;
    for (const uint32_t v : reached) {
        const float part = std::min(1.0f, float(ridgeRingsFrom + 1 - rings[v]) / float(ridgeRingsFrom + 1 - ridgeFoot));
        if (!(part > 0)) continue;
        const Vec3& p = scene.mesh.positions[v];
        moved.push_back({v, p - part * (glm::dot(p, normal) - base) * normal});
    }
    return moved;
}

Scraps scrapsBehind(const Scene& scene, const Capture& capture, const RadianceSamples& samples,
                    const std::vector<EmitterOutline>& outlines, const EmitterBody& body,
                    const std::set<uint32_t>& removed) {
    const size_t count = scene.mesh.triangles.size();
    const double reach = scrapReach * std::max({body.half.x, body.half.y, body.half.z});
    std::vector<uint8_t> about(count, 0), gone(scene.mesh.vertexCount(), 0);
    for (const uint32_t t : removed)
        for (const uint32_t v : scene.mesh.triangles[t]) gone[v] = 1;
    // A floor or wall goes on where nobody sees it behind the body.
    for (uint32_t v = 0; v < gone.size(); ++v) gone[v] |= samples.countOf(v) < 2;
    const std::vector<FlatSurface> flat = flatSurfaces(scene, gone);
    for (uint32_t t = 0; t < count; ++t) {
        const Triangle& c = scene.mesh.triangles[t];
        about[t] = !removed.count(t) && std::all_of(c.begin(), c.end(), [&](uint32_t v) {
            return body.distance(DVec3(scene.mesh.positions[v])) < reach;
        }) && std::none_of(flat.begin(), flat.end(), [&](const FlatSurface& surface) {
            return std::all_of(c.begin(), c.end(), [&](uint32_t v) { return liesOn(scene, surface, v); });
        });
    }
    const std::vector<uint8_t> free = notThere(scene, capture, samples, about, outlines, rimPixels);
    std::vector<std::vector<uint32_t>> at(scene.mesh.vertexCount());
    std::vector<uint8_t> cut(scene.mesh.vertexCount(), 0), kept = cut, left = free;
    for (uint32_t t = 0; t < count; ++t)
        for (const uint32_t v : scene.mesh.triangles[t])
            if (free[t]) at[v].push_back(t);
            else (removed.count(t) ? cut[v] : kept[v]) = 1;
    // Connected pieces. One that borders what goes more than what stays hangs on it; others are ground.
    Scraps found;
    for (const uint32_t first : removed)
        for (const uint32_t start : scene.mesh.triangles[first]) {
            std::vector<uint32_t> piece, front{start};
            std::set<uint32_t> corners;
            while (!front.empty()) {
                const uint32_t v = front.back();
                front.pop_back();
                for (const uint32_t t : at[v]) {
                    if (!left[t]) continue;
                    left[t] = 0;
                    piece.push_back(t);
                    for (const uint32_t u : scene.mesh.triangles[t])
                        if (corners.insert(u).second) front.push_back(u);
                }
            }
            const auto onCut = std::count_if(corners.begin(), corners.end(), [&](uint32_t v) { return cut[v] != 0; }),
                       onKept = std::count_if(corners.begin(), corners.end(), [&](uint32_t v) { return kept[v] != 0; });
            if (onCut > onKept) found.sure.insert(found.sure.end(), piece.begin(), piece.end());
            else if (onCut >= leastOnCut) found.doubtful.insert(found.doubtful.end(), piece.begin(), piece.end());
        }
    std::set<uint32_t> going = removed;
    const auto withIslands = [&](std::vector<uint32_t>& scraps, float part) {
        const std::vector<uint32_t> islands = islandsAmong(scene, about, going, scraps, part);
        scraps.insert(scraps.end(), islands.begin(), islands.end());
        going.insert(scraps.begin(), scraps.end());
    };
    withIslands(found.sure, islandPart);
    withIslands(found.doubtful, doubtfulIsland);
    for (std::vector<uint32_t>* scraps : {&found.sure, &found.doubtful}) std::sort(scraps->begin(), scraps->end());
    return found;
}

std::optional<DVec3> FlatGround::levelled(const DVec3& point, const EmitterBody& body) const {
    const double height = glm::dot(point, normal) - offset, left = reach - body.distance(point);
    if (!(std::abs(height) > 1e-4 * reach) || !(std::abs(height) < left / 2)) return {};
    return point - height * normal;
}

std::optional<FlatGround> flatGround(const Scene& scene, const EmitterBody& body, const std::set<uint32_t>& removed) {
    constexpr double nearest = 0.01, farthest = 0.03, inPlane = 2e-5, standsOn = 0.004;  // of the diagonal
    constexpr float sameWay = 0.999f;
    constexpr size_t least = 30, trials = 48;
    constexpr double fillet = 4;  // spacings of vertices
    const double diagonal = double(scene.diagonal);
    std::vector<uint8_t> used(scene.mesh.vertexCount(), 0);
    for (uint32_t t = 0; t < scene.mesh.triangles.size(); ++t)
        for (const uint32_t v : scene.mesh.triangles[t]) used[v] |= removed.count(t) == 0;
    std::vector<uint32_t> about;
    for (uint32_t v = 0; v < used.size(); ++v) {
        if (!used[v]) continue;
        const double distance = body.distance(DVec3(scene.mesh.positions[v])) / diagonal;
        if (distance > nearest && distance < farthest) about.push_back(v);
    }
    FlatGround best;
    size_t most = 0;
    std::vector<float> spacing;
    for (size_t k = 0; k < trials && !about.empty(); ++k) {
        const uint32_t seed = about[(2 * k + 1) * about.size() / (2 * trials)];
        const Vec3 normal = scene.mesh.normals[seed];
        const DVec3 unit = glm::normalize(DVec3(normal));
        const double offset = glm::dot(unit, DVec3(scene.mesh.positions[seed]));
        std::vector<float> on;
        for (const uint32_t v : about)
            if (std::abs(glm::dot(unit, DVec3(scene.mesh.positions[v])) - offset) < inPlane * diagonal &&
                glm::dot(scene.mesh.normals[v], normal) > sameWay)
                on.push_back(scene.vertexSpacing[v]);
        if (on.size() <= most) continue;
        most = on.size();
        best = {unit, offset, 0};
        spacing = std::move(on);
    }
    if (most < std::max(least, about.size() / 4)) return {};
    // Of the body, what lies deepest.
    double lowest = glm::dot(body.centre, best.normal);
    for (int k = 0; k < 3; ++k) lowest -= body.half[k] * std::abs(glm::dot(body.axes[k], best.normal));
    if (std::abs(lowest - best.offset) > standsOn * diagonal) return {};
    best.reach = fillet * double(medianOf(std::move(spacing)));
    return best;
}

void groundUnder(const Scene& scene, const EmitterBody& body, double reach, const std::set<uint32_t>& removed,
                 std::vector<Vec3>& positions, std::vector<Triangle>& triangles) {
    // Edges of what is removed that another triangle has the other way round: the border, as the fan runs along it.
    std::set<std::pair<uint32_t, uint32_t>> inside;
    for (const uint32_t t : removed)
        for (size_t k = 0; k < 3; ++k) {
            const Triangle& c = scene.mesh.triangles[t];
            inside.insert({c[k], c[(k + 1) % 3]});
        }
    std::map<uint32_t, uint32_t> next;
    for (uint32_t t = 0; t < scene.mesh.triangles.size(); ++t) {
        if (removed.count(t)) continue;
        const Triangle& c = scene.mesh.triangles[t];
        for (size_t k = 0; k < 3; ++k)
            if (inside.count({c[(k + 1) % 3], c[k]})) next[c[(k + 1) % 3]] = c[k];
    }
    while (!next.empty()) {
        std::vector<uint32_t> loop;
        for (auto it = next.begin(); it != next.end(); it = next.find(loop.back())) {
            loop.push_back(it->second);
            next.erase(it);
        }
        DVec3 middle(0);
        bool near = loop.size() > 2;
        for (const uint32_t v : loop) {
            middle += DVec3(scene.mesh.positions[v]) / double(loop.size());
            near = near && body.distance(DVec3(scene.mesh.positions[v])) < reach;
        }
        if (!near) continue;
        const auto first = uint32_t(positions.size()), count = uint32_t(loop.size());
        for (const uint32_t v : loop) positions.push_back(scene.mesh.positions[v]);
        positions.push_back(Vec3(middle));
        for (uint32_t k = 0; k < count; ++k) triangles.push_back({first + k, first + (k + 1) % count, first + count});
    }
}

}  // namespace relamp
