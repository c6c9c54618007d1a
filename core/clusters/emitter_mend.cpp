#include "clusters/emitter_mend.h"

#include <algorithm>
#include <set>

#include "base/error.h"
#include "base/log.h"
#include "base/statistics.h"
#include "clusters/body_obstacles.h"
#include "clusters/emitter_pixels.h"
#include "clusters/patches.h"
#include "scene/smooth_normals.h"

namespace relamp {
namespace {

constexpr float wellCovered = 0.97f;  // overlap of pixels and mesh that exact meshes always have
constexpr float clearlyBetter = 0.02f;
constexpr double groundReach = 0.01;  ///< of the diagonal: so near a body lies the border of what it hides
constexpr double bodyMargin = 0.001;  ///< of the diagonal: what lies so close about a body is of it

float meanRadius(const std::vector<EmitterOutline>& outlines) {
    double pixels = 0;
    for (const EmitterOutline& o : outlines) pixels += double(o.pixels);
    return float(std::sqrt(pixels / std::max<double>(1, double(outlines.size())) / piD));
}

/// Whether the ball is what the outlines show. Cameras that are off by half a pixel cost small discs more. One view
/// that shows all of the disc tells its size, and a quarter of it in another one how far away it is.
bool explains(const EmitterSphere& ball, const std::vector<EmitterOutline>& outlines) {
    return ball.overlap > 0.95f - 0.7f / std::max(1.0f, meanRadius(outlines)) && ball.mostSeen > 0.9f &&
           ball.nextSeen > 0.25f;
}

/// How far the surface must move out so that its outlines have the pixels' area, metres.
float missingWidth(const Capture& capture, const RadianceSamples& samples, const EmitterCluster& cluster,
                   const std::vector<EmitterOutline>& outlines) {
    double missing = 0, length = 0;
    for (const EmitterOutline& o : outlines) {
        const Camera& camera = capture.views[o.view].camera;
        const double metres =
            glm::length(DVec3(cluster.centroid) - camera.position()) / std::sqrt(camera.focalX * camera.focalY);
        double covered = 0;
        for (const uint32_t t : samples.geometry[o.view].triangle)
            covered += t != Hit::none && std::binary_search(cluster.triangles.begin(), cluster.triangles.end(), t);
        // Steps along a straight edge are longer than it: by 4 / pi, the mean over its directions.
        const double sides = double(o.boundaryLength) * piD / 4;
        missing += (double(o.pixels) - covered) * metres * sides;
        length += sides * sides;
    }
    return length > 0 ? float(missing / length) : 0;
}

/// The patch as a cluster, so that outlines can be looked for where it lies.
EmitterCluster clusterOf(const Scene& scene, const RejectedPatch& patch) {
    EmitterCluster cluster;
    cluster.radiance = patch.radiance;
    cluster.evidence = patch.evidence;
    cluster.centroid = patch.centroid;
    for (uint32_t v = 0; v < scene.mesh.vertexCount(); ++v)
        if (scene.referenced[v] && glm::length(scene.mesh.positions[v] - patch.centroid) < 0.005f * scene.diagonal)
            cluster.vertices.push_back(v);
    return cluster;
}

std::string percent(float fraction) { return fmt::format("{:.0f} %", 100 * fraction); }

std::string placeOf(const Capture& capture, const Vec3& p) {
    return fmt::format("{:.2f} {:.2f} {:.2f}", p.x + capture.origin.x, p.y + capture.origin.y, p.z + capture.origin.z);
}

/// Groups of two emitters and more of one radiance that most views which show both show in one piece.
std::vector<std::vector<size_t>> onePieces(const Scene& scene, const Capture& capture, const RadianceSamples& samples,
                                           const EmitterClusters& clusters) {
    const size_t count = clusters.emitters.size();
    std::vector<size_t> root(count);
    for (size_t k = 0; k < count; ++k) root[k] = k;
    const auto usable = [](const EmitterCluster& e) { return !e.unobserved && !e.fitted && !e.triangles.empty(); };
    for (size_t a = 0; a < count; ++a)
        for (size_t b = a + 1; b < count; ++b) {
            const EmitterCluster &first = clusters.emitters[a], &second = clusters.emitters[b];
            if (root[a] == root[b] || !usable(first) || !usable(second)) continue;
            if (glm::length(first.radiance - second.radiance) > pixelTolerance(first) * glm::length(first.radiance))
                continue;
            if (shownInOnePiece(scene, capture, samples, first, second)) {
                const size_t from = root[b], to = root[a];
                for (size_t& r : root)
                    if (r == from) r = to;
            }
        }
    std::vector<std::vector<size_t>> groups(count), large;
    for (size_t k = 0; k < count; ++k) groups[root[k]].push_back(k);
    for (std::vector<size_t>& g : groups)
        if (g.size() > 1) large.push_back(std::move(g));
    return large;
}

EmitterCluster joined(const EmitterClusters& clusters, const std::vector<size_t>& group) {
    EmitterCluster whole = clusters.emitters[group[0]];
    for (size_t i = 1; i < group.size(); ++i) {
        const EmitterCluster& e = clusters.emitters[group[i]];
        whole.centroid = (whole.area * whole.centroid + e.area * e.centroid) / (whole.area + e.area);
        whole.area += e.area;
        whole.vertices.insert(whole.vertices.end(), e.vertices.begin(), e.vertices.end());
        whole.triangles.insert(whole.triangles.end(), e.triangles.begin(), e.triangles.end());
    }
    std::sort(whole.vertices.begin(), whole.vertices.end());
    std::sort(whole.triangles.begin(), whole.triangles.end());
    return whole;
}

/// A candidate that no albedo explains, and that shines evenly: an edge that is not quite sharp made it one.
bool tooBrightToReflect(const EmitterCluster& candidate) {
    constexpr float surelyEven = 0.05f;
    return candidate.evidence.sceneContrast > ClusterOptions{}.certainContrast && candidate.level.empty() &&
           candidate.evidence.uniformity < surelyEven && !candidate.fitted && !candidate.unobserved;
}

/// The brightest pixel of the emitter's hue about its vertices, the median over the views; 0 if they do not agree.
Rgb brightestAbout(const Scene& scene, const Capture& capture, const EmitterCluster& emitter) {
    constexpr float sameHue = 0.999f, sameRadiance = 0.03f;
    constexpr size_t leastViews = 3;
    std::vector<float> values[3], all;
    for (const View& view : capture.views) {
        Rgb most(0);
        for (const uint32_t v : emitter.vertices) {
            const std::optional<Vec2> at = view.camera.project(DVec3(scene.mesh.positions[v]));
            if (!at || !(at->x >= 1) || !(at->y >= 1) || !(at->x < float(view.camera.width - 1)) ||
                !(at->y < float(view.camera.height - 1)))
                continue;
            for (int k = 0; k < 9; ++k) {
                const int x = int(at->x) + k % 3 - 1, y = int(at->y) + k / 3 - 1;
                if (!view.image.usableAt(x, y)) continue;
                const Rgb value = view.image.at(x, y);
                const float hue = glm::dot(value, emitter.radiance) / glm::length(emitter.radiance);
                if (luminance(value) > luminance(most) && hue > sameHue * glm::length(value)) most = value;
            }
        }
        if (most == Rgb(0)) continue;
        for (int c = 0; c < 3; ++c) values[c].push_back(most[c]);
        all.push_back(luminance(most));
    }
    if (all.size() < leastViews) return Rgb(0);
    Rgb median;
    for (int c = 0; c < 3; ++c) median[c] = medianOf(std::move(values[c]));
    const auto agrees = [&](float l) { return std::abs(l - luminance(median)) < sameRadiance * luminance(median); };
    return 2 * std::count_if(all.begin(), all.end(), agrees) > std::ptrdiff_t(all.size()) ? median : Rgb(0);
}

/// The emitter with the median radiance of pixels that lie inside its outlines: vertices at its edge are darker.
EmitterCluster withInnerRadiance(const Scene& scene, const Capture& capture, const RadianceSamples& samples,
                                 const EmitterClusters& clusters, EmitterCluster emitter) {
    std::vector<float> values[3];
    for (const EmitterOutline& o : emitterOutlines(scene, capture, samples, clusters, emitter, true)) {
        const View& view = capture.views[o.view];
        const int width = view.camera.width, height = view.camera.height;
        for (int y = 1; y + 1 < height; ++y)
            for (int x = 1; x + 1 < width; ++x) {
                bool inside = view.image.usableAt(x, y);
                for (int k = 0; k < 9 && inside; ++k)
                    inside = o.shows[size_t(y + k / 3 - 1) * size_t(width) + size_t(x + k % 3 - 1)] != 0;
                if (!inside) continue;
                for (int c = 0; c < 3; ++c) values[c].push_back(view.image.at(x, y)[c]);
            }
    }
    if (!values[0].empty())
        for (int c = 0; c < 3; ++c) emitter.radiance[c] = medianOf(std::move(values[c]));
    else if (const Rgb shown = brightestAbout(scene, capture, emitter); shown != Rgb(0)) emitter.radiance = shown;
    return emitter;
}

/// Lights of one radiance whose balls touch in some views.
struct NearBalls {
    std::vector<size_t> lights;  ///< the first has the radiance of all
    std::vector<EmitterSphere> balls;
};

/// Whether discs of the balls, known roughly, nearly touch in a view, though the balls themselves lie apart.
bool touch(const Capture& capture, const EmitterSphere& a, const EmitterSphere& b) {
    constexpr double rough = 1.5;
    if (glm::distance(a.centre, b.centre) < a.radius + b.radius) return false;
    for (const View& view : capture.views) {
        const std::optional<Vec2> p = view.camera.project(a.centre), q = view.camera.project(b.centre);
        if (!p || !q) continue;
        const DVec3 eye = view.camera.position();
        const double focal = std::max(view.camera.focalX, view.camera.focalY),
                     radii =
                         focal * (a.radius / glm::distance(eye, a.centre) + b.radius / glm::distance(eye, b.centre));
        if (double(glm::distance(*p, *q)) < rough * radii + 2) return true;
    }
    return false;
}

/// A rough place, from what the mesh has of a light.
EmitterSphere sphereAbout(const Scene& scene, const EmitterCluster& e) {
    EmitterSphere ball;
    ball.centre = DVec3(e.centroid);
    for (const uint32_t v : e.vertices)
        ball.radius = std::max(ball.radius, double(glm::distance(scene.mesh.positions[v], e.centroid)));
    return ball;
}

/// Groups of such lights of which at least one is explained badly on its own.
std::vector<NearBalls> ballsInTouch(const Scene& scene, const Capture& capture, const RadianceSamples& samples,
                                    const EmitterClusters& clusters, const std::vector<EmitterCluster>& asked) {
    constexpr double largest = 0.1;  // of the diagonal
    std::vector<size_t> lights, root;
    std::vector<EmitterSphere> balls;
    std::vector<uint8_t> alone;
    for (size_t k = 0; k < asked.size(); ++k) {
        const EmitterCluster& e = asked[k];
        if (e.unobserved || e.fitted || e.triangles.empty()) continue;
        const std::vector<EmitterOutline> outlines = emitterOutlines(scene, capture, samples, clusters, e);
        std::optional<EmitterSphere> ball;
        if (outlines.size() >= 2) ball = fitSphere(scene, capture, samples, outlines);
        if (!ball) ball = sphereAbout(scene, e);
        if (!(ball->radius < largest * double(scene.diagonal))) continue;
        root.push_back(lights.size());
        lights.push_back(k);
        balls.push_back(*ball);
        const bool covered = outlines.size() >= 2 && meshOverlap(samples, e, outlines) >= wellCovered;
        alone.push_back(covered || explains(*ball, outlines));
    }
    for (size_t a = 0; a < lights.size(); ++a)
        for (size_t b = a + 1; b < lights.size(); ++b) {
            const EmitterCluster &first = asked[lights[a]], &second = asked[lights[b]];
            if (root[a] == root[b] || !touch(capture, balls[a], balls[b]) ||
                glm::length(first.radiance - second.radiance) > pixelTolerance(first) * glm::length(first.radiance))
                continue;
            const size_t from = root[b], to = root[a];
            for (size_t& r : root)
                if (r == from) r = to;
        }
    std::vector<NearBalls> groups;
    for (size_t k = 0; k < lights.size(); ++k) {
        NearBalls group;
        bool all = true;
        for (size_t i = 0; i < lights.size(); ++i)
            if (root[i] == k) {
                group.lights.push_back(lights[i]);
                group.balls.push_back(balls[i]);
                all &= alone[i] != 0;
            }
        if (group.lights.size() > 1 && !all) groups.push_back(std::move(group));
    }
    return groups;
}

/// The tube or box that takes the emitter's place, if one explains the outlines clearly better than the mesh.
std::optional<EmitterReplacement> replacementOf(const Scene& scene, const Capture& capture,
                                                const RadianceSamples& samples, const EmitterClusters& clusters,
                                                const EmitterCluster& e, const std::vector<EmitterOutline>& all) {
    std::vector<EmitterOutline> outlines = all;
    const std::optional<EmitterBody> body = fitUnhidden(scene, capture, samples, e, outlines);
    if (!body) return {};
    const float mesh = meshOverlap(samples, e, outlines);
    const std::string what = wordsOf(*body);
    logInfo("{} covers {} of the pixels of a light at {}, the mesh {}; seen {} and {}", what, percent(body->overlap),
            placeOf(capture, e.centroid), percent(mesh), percent(body->mostSeen), percent(body->nextSeen));
    if (!explainsOutlines(*body, outlines) || !(body->overlap > mesh + clearlyBetter)) return {};
    EmitterReplacement r = replacedBy(
        *body, scene, capture, samples, clusters, e, outlines, mesh,
        fmt::format("the mesh covers {} of what photographs show of a light at {}, {} covers {}: it takes its place",
                    percent(mesh), placeOf(capture, e.centroid), what, percent(body->overlap)));
    for (const EmitterOutline& o : all)
        if (std::none_of(outlines.begin(), outlines.end(), [&](const auto& kept) { return kept.view == o.view; }))
            r.was.hiddenIn.push_back(o.view);
    return r;
}

}  // namespace

EmitterReplacement replacedBy(const EmitterBody& body, const Scene& scene, const Capture& capture,
                              const RadianceSamples& samples, const EmitterClusters& clusters,
                              const EmitterCluster& light, const std::vector<EmitterOutline>& outlines, float covered,
                              std::string words) {
    EmitterReplacement r;
    r.body = body;
    r.margin = bodyMargin * double(scene.diagonal);
    std::set<uint32_t> removed;
    r.setBack = ridgeSetBack(scene, light);
    if (r.setBack.empty()) {
        collectObstacles(scene, capture, samples, outlines, LightBody(body, r.margin), light.triangles,
                         clusters.emitterOfTriangle, removed);
        const Scraps scraps = scrapsBehind(scene, capture, samples, outlines, body, removed);
        logInfo("{} triangles in the body's place go, and {} scraps that hang on them; {} may be there", removed.size(),
                scraps.sure.size(), scraps.doubtful.size());
        removed.insert(scraps.sure.begin(), scraps.sure.end());
        double reach = groundReach * double(scene.diagonal);
        const std::optional<FlatGround> flat = flatGround(scene, body, removed);
        const auto placeNow = [&] {
            EmitterReplacement::Place place;
            place.removed.assign(removed.begin(), removed.end());
            groundUnder(scene, body, reach, removed, place.ground, place.groundTriangles);
            for (Vec3& p : place.ground)
                if (const auto level = flat ? flat->levelled(DVec3(p), body) : std::nullopt) p = Vec3(*level);
            return place;
        };
        for (uint32_t v = 0; v < scene.mesh.vertexCount() && flat; ++v)
            if (const auto level = flat->levelled(DVec3(scene.mesh.positions[v]), body))
                r.setBack.push_back({v, Vec3(*level)});
        if (flat) {
            r.level = Vec3(flat->normal);
            logInfo("the body stands on a flat surface: {} vertices within {:.1f} mm of it are on that plane",
                    r.setBack.size(), 1000 * flat->reach);
        }
        r.place = placeNow();
        std::set<uint32_t> bag;
        for (const uint32_t t : scraps.doubtful)
            for (const uint32_t v : scene.mesh.triangles[t]) {
                bag.insert(v);
                reach = std::max(reach, body.distance(DVec3(scene.mesh.positions[v])) + 1e-3 * reach);
            }
        r.bag.assign(bag.begin(), bag.end());
        removed.insert(scraps.doubtful.begin(), scraps.doubtful.end());
        if (!bag.empty()) r.whole = placeNow();
    }
    r.light = light;
    r.was.centroid = Vec3(body.centre);
    r.was.radius = float(glm::length(body.half));
    r.was.overlap = covered;
    r.was.words = std::move(words);
    return r;
}

EmitterMend mendEmitters(const Scene& scene, const Capture& capture, const RadianceSamples& samples,
                         const EmitterClusters& clusters) {
    EmitterMend mend;
    std::set<uint32_t> removed;
    std::vector<Vec3> normals;
    const auto replace = [&](const EmitterCluster& e, const EmitterSphere& ball,
                             const std::vector<EmitterOutline>& outlines) {
        collectObstacles(scene, capture, samples, outlines, LightBody(ball), e.triangles, clusters.emitterOfTriangle,
                         removed);
        ProxyLight proxy;
        proxy.centre = ball.centre;
        proxy.radius = float(ball.radius);
        proxy.radiance = e.radiance;
        mend.balls.push_back(proxy);
    };
    const auto takeBall = [&](const EmitterCluster& e, const EmitterSphere& ball,
                              const std::vector<EmitterOutline>& outlines, float mesh) {
        replace(e, ball, outlines);
        mend.words.push_back(fmt::format(
            "the mesh covers {} of what photographs show of a light at {}, a ball of {:.1f} cm covers {}: the ball "
            "takes its place",
            percent(mesh), placeOf(capture, e.centroid), 100 * ball.radius, percent(ball.overlap)));
    };
    // A ball, else a tube or a box, if one explains the outlines clearly better than the mesh does.
    const auto reshape = [&](const EmitterCluster& e, const std::vector<EmitterOutline>& outlines, float mesh,
                             bool cut) {
        const std::optional<EmitterSphere> ball = fitSphere(scene, capture, samples, outlines);
        if (ball && explains(*ball, outlines) && ball->overlap > mesh + clearlyBetter) {
            takeBall(e, *ball, outlines, mesh);
            return true;
        }
        std::optional<EmitterReplacement> body;
        if (!cut) body = replacementOf(scene, capture, samples, clusters, e, outlines);
        if (body) mend.bodies.push_back(std::move(*body));
        return body.has_value();
    };
    std::vector<EmitterCluster> asked = clusters.emitters;
    for (const EmitterCluster& e : clusters.candidates)
        if (tooBrightToReflect(e)) asked.push_back(withInnerRadiance(scene, capture, samples, clusters, e));
    std::vector<uint8_t> replaced(asked.size(), 0);
    for (const NearBalls& group : ballsInTouch(scene, capture, samples, clusters, asked)) {
        const BallsTogether found = fitSpheresTogether(scene, capture, samples, asked[group.lights[0]], group.balls);
        for (size_t i = 0; i < group.lights.size(); ++i) {
            const EmitterCluster& e = asked[group.lights[i]];
            const float mesh = meshOverlap(samples, e, found.outlines[i]);
            if (found.outlines[i].size() < 2 || !explains(found.balls[i], found.outlines[i]) ||
                !(found.balls[i].overlap > mesh + clearlyBetter))
                continue;
            takeBall(e, found.balls[i], found.outlines[i], mesh);
            replaced[group.lights[i]] = 1;
        }
    }
    for (const std::vector<size_t>& group : onePieces(scene, capture, samples, clusters)) {
        if (std::any_of(group.begin(), group.end(), [&](size_t k) { return replaced[k] != 0; })) continue;
        const EmitterCluster whole = joined(clusters, group);
        const std::vector<EmitterOutline> outlines = emitterOutlines(scene, capture, samples, clusters, whole);
        if (outlines.size() < 2 || !reshape(whole, outlines, meshOverlap(samples, whole, outlines), false)) continue;
        for (const size_t k : group) replaced[k] = 1;
    }
    for (size_t k = 0; k < asked.size(); ++k) {
        const EmitterCluster& e = asked[k];
        if (e.unobserved || e.triangles.empty() || replaced[k]) continue;
        std::vector<EmitterOutline> outlines = emitterOutlines(scene, capture, samples, clusters, e);
        const bool cut = outlines.size() < 2;
        if (cut) outlines = emitterOutlines(scene, capture, samples, clusters, e, true);
        if (outlines.size() < 2) continue;
        const float mesh = meshOverlap(samples, e, outlines);
        if (mesh >= wellCovered || reshape(e, outlines, mesh, cut) || cut) continue;
        const float most = 0.02f * scene.diagonal,
                    width = std::clamp(missingWidth(capture, samples, e, outlines), -most, most);
        if (std::abs(width) < 1e-4f * scene.diagonal) continue;
        if (normals.empty()) normals = smoothedNormals(capture.mesh, 3);
        EmitterMove move;
        move.centroid = e.centroid;
        move.overlap = mesh;
        for (const uint32_t v : e.vertices) {
            move.vertices.push_back({v, scene.mesh.positions[v] + width * normals[v]});
            move.radius = std::max(move.radius, glm::distance(scene.mesh.positions[v], e.centroid));
        }
        move.words = fmt::format(
            "the mesh covers {} of what photographs show of a light at {}: its surface moves out by {:.1f} mm",
            percent(mesh), placeOf(capture, e.centroid), 1000 * width);
        mend.moves.push_back(std::move(move));
    }
    for (const RejectedPatch& patch : clusters.rejected) {
        constexpr size_t leastViews = 3;
        constexpr float leastContrast = 1.6f;
        if (patch.reason != tooFewPixelsReason || patch.evidence.sceneContrast < leastContrast) continue;
        const EmitterCluster e = clusterOf(scene, patch);
        const std::vector<EmitterOutline> outlines = emitterOutlines(scene, capture, samples, clusters, e);
        if (outlines.size() < leastViews) continue;
        const std::optional<EmitterSphere> ball = fitSphere(scene, capture, samples, outlines);
        if (!ball || !explains(*ball, outlines)) continue;
        replace(e, *ball, outlines);
        mend.words.push_back(fmt::format(
            "{} photographs show a ball of light of {:.1f} cm at {} that the mesh does not have: it is added",
            outlines.size(), 100 * ball->radius, placeOf(capture, Vec3(ball->centre))));
    }
    mend.removed.assign(removed.begin(), removed.end());
    return mend;
}

std::vector<uint8_t> darkSides(const EmitterReplacement& replacement, const Scene& scene, const Capture& capture,
                               const RadianceSamples& samples) {
    constexpr size_t leastPixels = 20;
    std::vector<Vec3> positions;
    std::vector<Triangle> triangles;
    const std::vector<uint32_t> starts = replacement.body.surface(positions, triangles);
    std::vector<size_t> shown(starts.size(), 0), all = shown;
    const auto sideAt = [&](uint32_t triangle) {
        if (triangle == Hit::none) return -1;
        const uint32_t v = scene.mesh.triangles[triangle][0] - replacement.first;  // wraps where it is before the body
        if (v >= positions.size()) return -1;
        return int(std::upper_bound(starts.begin(), starts.end(), v) - starts.begin()) - 1;
    };
    for (size_t i = 0; i < capture.views.size() && i < samples.geometry.size(); ++i) {
        const std::vector<uint8_t> shows =
            emittingPixels(capture.views[i], replacement.light.radiance, pixelTolerance(replacement.light));
        const ViewGeometry& g = samples.geometry[i];
        // Pixels at a side's edge show what is beside it as well.
        for (int y = 1; y + 1 < g.height; ++y)
            for (int x = 1; x + 1 < g.width; ++x) {
                const size_t p = size_t(y) * size_t(g.width) + size_t(x);
                const int side = sideAt(g.triangle[p]);
                if (side < 0 || sideAt(g.triangle[p - 1]) != side || sideAt(g.triangle[p + 1]) != side ||
                    sideAt(g.triangle[p - size_t(g.width)]) != side || sideAt(g.triangle[p + size_t(g.width)]) != side)
                    continue;
                shown[size_t(side)] += shows[p];
                ++all[size_t(side)];
            }
    }
    std::vector<uint8_t> dark(starts.size(), 0);
    for (size_t side = 0; side < dark.size(); ++side)
        dark[side] = all[side] >= leastPixels && 2 * shown[side] < all[side];
    return dark;
}

float overlapAfter(const EmitterMove& move, const Scene& scene, const Capture& capture, const RadianceSamples& samples,
                   const EmitterClusters& clusters) {
    float best = 0;
    for (const EmitterCluster& e : clusters.emitters) {
        if (e.unobserved || e.fitted || e.triangles.empty() || glm::distance(e.centroid, move.centroid) > move.radius)
            continue;
        std::vector<EmitterOutline> outlines = emitterOutlines(scene, capture, samples, clusters, e);
        std::erase_if(outlines, [&](const EmitterOutline& o) {
            return std::find(move.hiddenIn.begin(), move.hiddenIn.end(), o.view) != move.hiddenIn.end();
        });
        if (outlines.size() >= 2) best = std::max(best, meshOverlap(samples, e, outlines));
    }
    return best;
}

}  // namespace relamp
