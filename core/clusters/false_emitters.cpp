#include "clusters/false_emitters.h"

#include <algorithm>
#include <set>

#include "base/box.h"
#include "base/statistics.h"

namespace relamp {
namespace {

constexpr float sameRadiance = 0.03f, hair = 0.006f;

/// Metres, from a vertex to the middle of a triangle.
Vec3 toMiddle(const Scene& scene, uint32_t vertex, uint32_t triangle) {
    const std::vector<Vec3>& p = scene.mesh.positions;
    const Triangle& corners = scene.mesh.triangles[triangle];
    return (p[corners[0]] + p[corners[1]] + p[corners[2]]) / 3.0f - p[vertex];
}

bool alike(const Rgb& a, const Rgb& b) {
    return maxChannel(glm::abs(a - b)) <= sameRadiance * std::max(maxChannel(a), maxChannel(b));
}

/// At most `most` of the vertices, in an order that does not know the file's.
std::vector<uint32_t> someOf(const Scene& scene, std::vector<uint32_t> vertices, size_t most) {
    std::sort(vertices.begin(), vertices.end(), [&](uint32_t a, uint32_t b) { return scene.rank[a] < scene.rank[b]; });
    if (vertices.size() > most) vertices.resize(most);
    return vertices;
}

Box boxOf(const Scene& scene, const EmitterCluster& cluster) {
    Box box;
    for (uint32_t v : cluster.vertices) box.grow(scene.mesh.positions[v]);
    return box;
}

/// Positions of the cluster's vertices within `reach` of the box.
std::vector<Vec3> within(const Scene& scene, const EmitterCluster& cluster, const Box& box, float reach) {
    std::vector<Vec3> result;
    for (uint32_t v : cluster.vertices) {
        const Vec3 p = scene.mesh.positions[v], outside = glm::max(glm::max(box.min - p, p - box.max), Vec3(0));
        if (maxChannel(outside) <= reach) result.push_back(p);
    }
    return result;
}

/// Whether any two of their vertices are nearer than `reach`.
bool near(const Scene& scene, const EmitterCluster& a, const EmitterCluster& b, float reach) {
    const std::vector<Vec3> some = within(scene, a, boxOf(scene, b), reach),
                            others = within(scene, b, boxOf(scene, a), reach);
    return std::any_of(some.begin(), some.end(), [&](const Vec3& p) {
        return std::any_of(others.begin(), others.end(),
                           [&](const Vec3& q) { return glm::dot(p - q, p - q) < reach * reach; });
    });
}

/// Whether `part` is as small, as dim and of that hue as the blurred rim of `emitter` is.
bool blurred(const EmitterCluster& part, const EmitterCluster& emitter) {
    constexpr float least = 0.4f, largest = 0.1f, sameHue = 0.05f;
    const float own = maxChannel(part.radiance), whole = maxChannel(emitter.radiance);
    return own > least * whole && own < whole && part.area < largest * emitter.area &&
           maxChannel(glm::abs(part.radiance / own - emitter.radiance / whole)) < sameHue;
}

/// `b` becomes part of `a`.
void join(const EmitterCluster& b, EmitterCluster& a) {
    const float whole = std::max(a.area + b.area, 1e-20f);
    a.centroid = (a.area * a.centroid + b.area * b.centroid) / whole;
    const Vec3 normal = a.area * a.normal + b.area * b.normal;
    a.normal = glm::length(normal) > 0.2f * whole ? glm::normalize(normal) : Vec3(0);
    a.area = whole;
    a.vertices.insert(a.vertices.end(), b.vertices.begin(), b.vertices.end());
    a.triangles.insert(a.triangles.end(), b.triangles.begin(), b.triangles.end());
    for (std::vector<uint32_t>* list : {&a.vertices, &a.triangles}) {
        std::sort(list->begin(), list->end());
        list->erase(std::unique(list->begin(), list->end()), list->end());
    }
    a.twoSided |= b.twoSided;
    a.evidence.viewsSeen = std::max(a.evidence.viewsSeen, b.evidence.viewsSeen);
    a.evidence.samples += b.evidence.samples;
}

}  // namespace

void joinSplitEmitters(const Scene& scene, std::vector<EmitterCluster>& emitters) {
    std::stable_sort(emitters.begin(), emitters.end(), [](const EmitterCluster& a, const EmitterCluster& b) {
        return emitterPower(a) > emitterPower(b);
    });
    for (size_t i = 0; i < emitters.size(); ++i)
        for (size_t k = i + 1; k < emitters.size();) {
            const bool one = !emitters[i].unobserved && !emitters[k].unobserved &&
                             alike(emitters[i].radiance, emitters[k].radiance) &&
                             near(scene, emitters[i], emitters[k], hair * scene.diagonal);
            if (!one) {
                ++k;
                continue;
            }
            join(emitters[k], emitters[i]);
            emitters.erase(emitters.begin() + ptrdiff_t(k));
            k = i + 1;  // what is larger now may reach others
        }
}

void joinBlurredParts(const Scene& scene, std::vector<EmitterCluster>& emitters,
                      std::vector<EmitterCluster>& candidates) {
    std::erase_if(candidates, [&](const EmitterCluster& part) {
        if (part.unobserved || part.fitted) return false;
        for (EmitterCluster& e : emitters)
            if (!e.unobserved && !e.fitted && blurred(part, e) && near(scene, e, part, hair * scene.diagonal)) {
                join(part, e);
                return true;
            }
        return false;
    });
}

bool showsEmitterPastEdge(const Scene& scene, const Capture& capture, const RadianceSamples& samples,
                          const EmitterCluster& emitter, const EmitterCluster& patch) {
    constexpr int reach = 8;
    if (emitter.unobserved || patch.unobserved || !alike(emitter.radiance, patch.radiance) ||
        patch.area > 0.25f * emitter.area)
        return false;
    const std::set<uint32_t> triangles(emitter.triangles.begin(), emitter.triangles.end());
    size_t bright = 0, beside = 0;
    for (uint32_t v : patch.vertices)
        for (uint32_t s = samples.start[v]; s < samples.start[v + 1]; ++s) {
            const RadianceSample& r = samples.samples[s];
            if (r.view >= capture.views.size() || r.view >= samples.geometry.size() ||
                !alike(r.radiance, patch.radiance))
                continue;
            const auto pixel = capture.views[r.view].camera.project(DVec3(scene.mesh.positions[v]));
            if (!pixel) continue;
            ++bright;
            const ViewGeometry& g = samples.geometry[r.view];
            bool near = false;
            for (int y = std::max(0, int(pixel->y) - reach);
                 y <= std::min(g.height - 1, int(pixel->y) + reach) && !near; ++y)
                for (int x = std::max(0, int(pixel->x) - reach);
                     x <= std::min(g.width - 1, int(pixel->x) + reach) && !near; ++x)
                    near = triangles.count(g.triangle[size_t(y) * size_t(g.width) + size_t(x)]) > 0;
            beside += near;
        }
    return bright > 0 && double(beside) > 0.9 * double(bright);
}

float albedoBesideEmitters(const Scene& scene, const std::vector<EmitterCluster>& emitters,
                           const EmitterCluster& patch) {
    constexpr size_t mostVertices = 64;
    // In the cosine: what a normal that is 20 degrees off makes of a grazing one; beside a fitted ball normals tell
    // nothing.
    constexpr float usualSlack = 0.35f, noNormals = 2;
    std::vector<float> demanded;
    for (uint32_t v : someOf(scene, patch.vertices, mostVertices)) {
        Rgb lit(0);
        for (const EmitterCluster& emitter : emitters) {
            if (emitter.unobserved || &emitter == &patch ||
                maxChannel(emitter.radiance) < 1.3f * maxChannel(patch.radiance))
                continue;
            float factor = 0;
            const float slack = emitter.fitted ? noNormals : usualSlack;
            for (const uint32_t t : emitter.triangles) {
                const Vec3 to = toMiddle(scene, v, t);
                const float area = scene.mesh.triangleArea(t), squared = std::max(glm::dot(to, to), area),
                            distance = std::sqrt(squared);
                const float at = std::min(1.0f, glm::dot(to, scene.mesh.normals[v]) / distance + slack),
                            from = std::abs(glm::dot(to, scene.mesh.faceNormal(t))) / distance;
                factor += area * std::max(0.0f, at) * from /
                          (pi * squared);  // its hidden side, which no photograph shows, shines as well
            }
            lit += emitter.radiance * std::min(factor, 1.0f);
        }
        float worst = 0;
        for (int c = 0; c < 3; ++c)
            if (patch.radiance[c] > 0.2f * maxChannel(patch.radiance))
                worst = std::max(worst, patch.radiance[c] / std::max(lit[c], 1e-20f));
        demanded.push_back(worst);
    }
    return demanded.empty() ? 1e30f : medianOf(std::move(demanded));
}

bool litByEmitters(const Scene& scene, const std::vector<VertexRadiance>& seen,
                   const std::vector<EmitterCluster>& emitters, const EmitterPatch& part) {
    constexpr size_t mostVertices = 64;
    std::vector<float> demanded;
    std::vector<uint32_t> vertices = part.vertices;
    std::sort(vertices.begin(), vertices.end(), [&](uint32_t a, uint32_t b) { return scene.rank[a] < scene.rank[b]; });
    const size_t step = std::max<size_t>(1, vertices.size() / mostVertices);
    for (size_t i = 0; i < vertices.size(); i += step) {
        const uint32_t v = vertices[i];
        Rgb lit(0);
        for (const EmitterCluster& emitter : emitters) {
            if (emitter.unobserved) continue;  // its radiance is a guess yet
            float factor = 0;                  // form factor; whichever way the surfaces face
            for (const uint32_t t : emitter.triangles) {
                const Vec3 to = toMiddle(scene, v, t);
                const float area = scene.mesh.triangleArea(t), squared = std::max(glm::dot(to, to), area);
                factor += area *
                          std::abs(glm::dot(to, scene.mesh.normals[v]) * glm::dot(to, scene.mesh.faceNormal(t))) /
                          (pi * squared * squared);
            }
            lit += emitter.radiance * std::min(factor, 1.0f);
        }
        demanded.push_back(maxChannel(seen[v].radiance) / std::max(maxChannel(lit), 1e-20f));
    }
    return lowerMedianOf(demanded) < 1.5f;
}

}  // namespace relamp
