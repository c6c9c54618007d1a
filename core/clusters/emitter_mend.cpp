#include "clusters/emitter_mend.h"

#include <algorithm>
#include <set>

#include "base/error.h"
#include "clusters/emitter_sphere.h"
#include "clusters/patches.h"
#include "scene/smooth_normals.h"

namespace relamp {
namespace {

constexpr float wellCovered = 0.97f;  // overlap of pixels and mesh that exact meshes always have
constexpr float clearlyBetter = 0.02f;

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

/// Triangles that a ball of light takes the place of: its own, those within it, and those before it where photographs
/// see it all the same. Those of other emitters stay: what they show is their own light.
class Obstacles {
public:
    Obstacles(const Scene& scene, const EmitterSphere& ball) : scene_(scene), ball_(ball) {
        in_.assign(scene.mesh.triangles.size(), 0);
        out_.assign(scene.mesh.triangles.size(), 0);
    }

    void vote(const View& view, const EmitterOutline& outline) {
        const Camera& camera = view.camera;
        const DVec3 eye = camera.position();
        const double inner = 0.9 * ball_.radius;
        for (int y = 0; y < camera.height; ++y)
            for (int x = 0; x < camera.width; ++x) {
                const Vec3 direction = camera.rayDirection(Vec2(float(x) + 0.5f, float(y) + 0.5f));
                const DVec3 to = ball_.centre - eye;
                const double along = glm::dot(to, DVec3(direction)), squared = glm::dot(to, to) - along * along;
                if (!(squared < inner * inner) || !(along > 0)) continue;
                const bool shows = outline.shows[size_t(y) * size_t(camera.width) + size_t(x)] != 0;
                float from = 0;
                // To the ball's middle: what lies in its near half hides it as well.
                for (int layers = 0; layers < 16; ++layers) {
                    const Hit hit = scene_.tracer->closest({Vec3(eye), direction, from, float(along)});
                    if (!hit) break;
                    ++(shows ? in_ : out_)[hit.triangle];
                    from = hit.distance + 0.25f * scene_.tracer->surfaceOffset() + 1e-6f * float(along);
                }
            }
    }

    void collect(const std::vector<uint32_t>& own, const std::vector<int>& emitterOfTriangle,
                 std::set<uint32_t>& removed) const {
        removed.insert(own.begin(), own.end());
        std::vector<uint8_t> open(scene_.mesh.vertexCount(), 0), closed = open;
        for (uint32_t t = 0; t < in_.size(); ++t)
            for (const uint32_t v : scene_.mesh.triangles[t]) {
                open[v] |= in_[t] > out_[t];
                closed[v] |= out_[t] > in_[t];
            }
        for (uint32_t t = 0; t < in_.size(); ++t) {
            const Triangle& corners = scene_.mesh.triangles[t];
            const bool within = std::all_of(corners.begin(), corners.end(), [&](uint32_t v) {
                return glm::length(DVec3(scene_.mesh.positions[v]) - ball_.centre) < 1.05 * ball_.radius;
            });
            // Triangles between pixels go with what is around them.
            const bool between = in_[t] + out_[t] == 0 && std::all_of(corners.begin(), corners.end(), [&](uint32_t v) {
                                     return open[v] && !closed[v];
                                 });
            const bool seenThrough = between || in_[t] > out_[t];
            if (within || (seenThrough && emitterOfTriangle[t] < 0)) removed.insert(t);
        }
    }

private:
    const Scene& scene_;
    const EmitterSphere& ball_;
    std::vector<uint32_t> in_, out_;  ///< pixels through the triangle that show the ball, and that do not
};

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

}  // namespace

EmitterMend mendEmitters(const Scene& scene, const Capture& capture, const RadianceSamples& samples,
                         const EmitterClusters& clusters) {
    EmitterMend mend;
    std::set<uint32_t> removed;
    std::vector<Vec3> normals;
    const auto replace = [&](const EmitterCluster& e, const EmitterSphere& ball,
                             const std::vector<EmitterOutline>& outlines) {
        Obstacles obstacles(scene, ball);
        for (const EmitterOutline& o : outlines) obstacles.vote(capture.views[o.view], o);
        obstacles.collect(e.triangles, clusters.emitterOfTriangle, removed);
        ProxyLight proxy;
        proxy.centre = ball.centre;
        proxy.radius = float(ball.radius);
        proxy.radiance = e.radiance;
        mend.balls.push_back(proxy);
    };
    for (const EmitterCluster& e : clusters.emitters) {
        if (e.unobserved || e.triangles.empty()) continue;
        const std::vector<EmitterOutline> outlines = emitterOutlines(scene, capture, samples, clusters, e);
        if (outlines.size() < 2) continue;
        const float mesh = meshOverlap(samples, e, outlines);
        if (mesh >= wellCovered) continue;
        const std::optional<EmitterSphere> ball = fitSphere(scene, capture, samples, outlines);
        if (ball && explains(*ball, outlines) && ball->overlap > mesh + clearlyBetter) {
            replace(e, *ball, outlines);
            mend.words.push_back(fmt::format(
                "the mesh covers {} of what photographs show of a light at {:.2f} {:.2f} {:.2f}, a ball of {:.1f} cm "
                "covers {}: the ball takes its place",
                percent(mesh), e.centroid.x + capture.origin.x, e.centroid.y + capture.origin.y,
                e.centroid.z + capture.origin.z, 100 * ball->radius, percent(ball->overlap)));
            continue;
        }
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
            "the mesh covers {} of what photographs show of a light at {:.2f} {:.2f} {:.2f}: its surface moves out by "
            "{:.1f} mm",
            percent(mesh), e.centroid.x + capture.origin.x, e.centroid.y + capture.origin.y,
            e.centroid.z + capture.origin.z, 1000 * width);
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
        mend.words.push_back(
            fmt::format("{} photographs show a ball of light of {:.1f} cm at {:.2f} {:.2f} {:.2f} that "
                        "the mesh does not have: it is added",
                        outlines.size(), 100 * ball->radius, ball->centre.x + capture.origin.x,
                        ball->centre.y + capture.origin.y, ball->centre.z + capture.origin.z));
    }
    mend.removed.assign(removed.begin(), removed.end());
    return mend;
}

float overlapAfter(const EmitterMove& move, const Scene& scene, const Capture& capture, const RadianceSamples& samples,
                   const EmitterClusters& clusters) {
    float best = 0;
    for (const EmitterCluster& e : clusters.emitters) {
        if (e.unobserved || e.fitted || e.triangles.empty() || glm::distance(e.centroid, move.centroid) > move.radius)
            continue;
        const std::vector<EmitterOutline> outlines = emitterOutlines(scene, capture, samples, clusters, e);
        if (outlines.size() >= 2) best = std::max(best, meshOverlap(samples, e, outlines));
    }
    return best;
}

}  // namespace relamp
