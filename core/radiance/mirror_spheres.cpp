#include "radiance/mirror_spheres.h"

#include <algorithm>
#include <cmath>

#include "base/random.h"
#include "base/statistics.h"
#include "radiance/view_spread.h"

namespace relamp {
namespace {

constexpr float mirrorSpread = 0.2f;       ///< relative standard deviation between views, beyond noise
constexpr size_t leastMirroring = 200;     ///< vertices
constexpr size_t mostSphereJudges = 2000;  ///< vertices that a trial's sphere is tried on
constexpr uint64_t sphereTrials = 300;
constexpr double smallestSphere = 0.01, largestSphere = 0.5;  ///< radii, of the diagonal
constexpr float sphereReach = 0.004f;      ///< of the diagonal: how far from its sphere a vertex may lie
constexpr float facesOutwards = 0.8f;      ///< cosine between normal and radius
constexpr float mostOff = 0.0015f;         ///< of the diagonal, robust standard deviation of the distances
constexpr float leastCovered = 0.33f;      ///< of the sphere
constexpr int mostFailures = 3;            ///< spheres of a component that turn out not to mirror
constexpr float roundAlready = 0.999994f;  ///< median cosine between normals and radii: 0.2 degrees

/// viewSpread of each vertex, of lighting states the largest: an emitter that is switched is no change with the view.
std::vector<float> spreadsOf(const RadianceSamples& samples, size_t vertices) {
    std::vector<float> spread(vertices, -1);
    for (uint32_t v = 0; v < vertices; ++v)
        for (uint32_t s = 0; s < samples.states; ++s) spread[v] = std::max(spread[v], viewSpread(samples, v, s));
    return spread;
}

/// The sphere through the meeting point of two vertices' normals; radius 0 where they hardly meet.
MirrorSphere sphereThrough(const Mesh& mesh, uint32_t a, uint32_t b) {
    const DVec3 p(mesh.positions[a]), q(mesh.positions[b]), m(mesh.normals[a]), n(mesh.normals[b]);
    const double mn = glm::dot(m, n), apart = 1 - mn * mn;
    if (apart < 0.1) return {};
    const DVec3 d = q - p;
    const double s = (glm::dot(d, m) - mn * glm::dot(d, n)) / apart, t = (mn * glm::dot(d, m) - glm::dot(d, n)) / apart;
    if (s >= 0 || t >= 0 || std::abs(s - t) > 0.1 * std::abs(s + t)) return {};
    return {0.5 * (p + s * m + q + t * n), -0.5 * (s + t), 0, {}};
}

bool liesOn(const MirrorSphere& sphere, const Mesh& mesh, uint32_t v, float reach) {
    const DVec3 from = DVec3(mesh.positions[v]) - sphere.centre;
    const double distance = glm::length(from);
    return std::abs(distance - sphere.radius) < double(reach) &&
           glm::dot(from, DVec3(mesh.normals[v])) > double(facesOutwards) * distance;
}

/// Least squares on the distances from the sphere, Cauchy weights.
void refineSphere(MirrorSphere& sphere, const Mesh& mesh, const std::vector<uint32_t>& vertices) {
    for (int round = 0; round < 8; ++round) {
        std::vector<double> off;
        for (const uint32_t v : vertices)
            off.push_back(std::abs(glm::length(DVec3(mesh.positions[v]) - sphere.centre) - sphere.radius));
        const double scale = 1.4826 * medianOf(off) + 1e-12 * sphere.radius;
        glm::dmat4 normal(0);
        glm::dvec4 moment(0);
        for (const uint32_t v : vertices) {
            const DVec3 from = DVec3(mesh.positions[v]) - sphere.centre;
            const double distance = glm::length(from), r = distance - sphere.radius, u = r / (2 * scale),
                         w = 1 / (1 + u * u);
            const glm::dvec4 row(from / distance, 1);
            normal += w * glm::outerProduct(row, row);
            moment += w * r * row;
        }
        for (int k = 0; k < 4; ++k) normal[k][k] *= 1 + 1e-9;
        const glm::dvec4 step = glm::inverse(normal) * moment;
        sphere.centre += DVec3(step);
        sphere.radius += step.w;
        sphere.off = float(scale);
    }
}

/// Fraction of the sphere within 15 degrees of a vertex, of 200 even directions.
float coveredFraction(const MirrorSphere& sphere, const Mesh& mesh) {
    constexpr int directions = 200;
    const float near = std::cos(0.26f);
    std::vector<Vec3> even;
    for (int i = 0; i < directions; ++i) {
        const float z = 1 - (2 * float(i) + 1) / directions, around = 2.3999632f * float(i),
                    across = std::sqrt(1 - z * z);
        even.emplace_back(across * std::cos(around), across * std::sin(around), z);
    }
    size_t covered = 0;
    for (const Vec3& direction : even)
        covered += std::any_of(sphere.vertices.begin(), sphere.vertices.end(), [&](uint32_t v) {
            const Vec3 from = Vec3(DVec3(mesh.positions[v]) - sphere.centre);
            return glm::dot(from, direction) > near * glm::length(from);
        });
    return float(covered) / directions;
}

/// Vertices of one component, those that mirror and all that might.
struct SphereSearch {
    const Scene& scene;
    const std::vector<float>& spread;  ///< per vertex
    std::vector<uint32_t> mirroring, all;

    bool plausible(const MirrorSphere& sphere) const {
        const double size = sphere.radius / double(scene.diagonal);
        return size > smallestSphere && size < largestSphere;
    }

    /// The sphere with most mirroring vertices; radius 0: none.
    MirrorSphere best() const {
        const Mesh& mesh = scene.mesh;
        const float diagonal = scene.diagonal;
        MirrorSphere found;
        const std::vector<uint32_t> judges(mirroring.begin(),
                                           mirroring.begin() + long(std::min(mirroring.size(), mostSphereJudges)));
        size_t most = judges.size() / 20;
        for (uint64_t trial = 0; trial < sphereTrials; ++trial) {
            const auto drawn = [&](uint64_t k) {
                return judges[size_t(unitFloat(mixBits(2 * trial + k)) * float(judges.size()))];
            };
            const MirrorSphere sphere = sphereThrough(mesh, drawn(0), drawn(1));
            if (!plausible(sphere)) continue;
            const auto on = size_t(std::count_if(judges.begin(), judges.end(), [&](uint32_t v) {
                return liesOn(sphere, mesh, v, 2 * sphereReach * diagonal);
            }));
            if (on <= most) continue;
            most = on;
            found = sphere;
        }
        if (!(found.radius > 0)) return {};
        for (int round = 0; round < 3; ++round) {
            std::vector<uint32_t> on;
            for (const uint32_t v : all)
                if (liesOn(found, mesh, v, (round ? 1 : 2) * sphereReach * diagonal)) on.push_back(v);
            if (on.size() < leastMirroring) return {};
            refineSphere(found, mesh, on);
        }
        const float reach = std::clamp(3 * found.off, 0.25f * sphereReach * diagonal, sphereReach * diagonal);
        for (const uint32_t v : all)
            if (liesOn(found, mesh, v, reach)) found.vertices.push_back(v);
        std::sort(found.vertices.begin(), found.vertices.end());
        return found;
    }

    /// Half of it changes with the view, and twice as much as the median of all else: where exposures differ, or
    /// cameras are off, everything does.
    bool mirrors(const MirrorSphere& sphere) const {
        if (!plausible(sphere) || sphere.vertices.size() < leastMirroring || sphere.off > mostOff * scene.diagonal)
            return false;
        std::vector<float> here, elsewhere;
        for (uint32_t v = 0; v < spread.size(); ++v) {
            const bool on = std::binary_search(sphere.vertices.begin(), sphere.vertices.end(), v);
            if (spread[v] >= 0) (on ? here : elsewhere).push_back(spread[v]);
        }
        const float changes = lowerMedianOf(std::move(here));
        return changes > std::max(mirrorSpread, 2 * medianOf(std::move(elsewhere))) &&
               coveredFraction(sphere, scene.mesh) > leastCovered;
    }
};

}  // namespace

std::vector<MirrorSphere> mirrorSpheres(const Scene& scene, const RadianceSamples& samples,
                                        const std::vector<uint8_t>& leftOut) {
    const size_t n = scene.mesh.vertexCount();
    std::vector<float> spread = spreadsOf(samples, n);
    std::vector<uint32_t> order;
    for (uint32_t v = 0; v < n; ++v) {
        if (leftOut[v] || !scene.referenced[v]) spread[v] = -1;
        else order.push_back(v);
    }
    std::sort(order.begin(), order.end(),
              [&](uint32_t a, uint32_t b) { return std::pair(scene.rank[a], a) < std::pair(scene.rank[b], b); });
    std::vector<SphereSearch> searches(scene.components, SphereSearch{scene, spread, {}, {}});
    for (const uint32_t v : order) {
        SphereSearch& search = searches[scene.component[v]];
        search.all.push_back(v);
        if (spread[v] > mirrorSpread) search.mirroring.push_back(v);
    }
    std::vector<MirrorSphere> found;
    for (SphereSearch& search : searches)
        for (int failed = 0; failed < mostFailures && search.mirroring.size() >= leastMirroring;) {
            MirrorSphere sphere = search.best();
            if (sphere.vertices.empty()) break;
            const auto onIt = [&](uint32_t v) {
                return liesOn(sphere, scene.mesh, v, 2 * sphereReach * scene.diagonal);
            };
            std::erase_if(search.mirroring, onIt);
            std::erase_if(search.all, onIt);
            if (search.mirrors(sphere)) found.push_back(std::move(sphere));
            else ++failed;
        }
    return found;
}

std::vector<uint8_t> verticesOfSpheres(const std::vector<MirrorSphere>& spheres, size_t count) {
    std::vector<uint8_t> marked(count, 0);
    for (const MirrorSphere& sphere : spheres)
        for (const uint32_t v : sphere.vertices) marked[v] = 1;
    return marked;
}

RoundedSphere roundedSphere(const MirrorSphere& sphere, const Mesh& mesh) {
    RoundedSphere rounded;
    std::vector<float> cosines;
    for (const uint32_t v : sphere.vertices) {
        const DVec3 outwards = glm::normalize(DVec3(mesh.positions[v]) - sphere.centre);
        cosines.push_back(float(glm::dot(outwards, DVec3(mesh.normals[v]))));
        rounded.moved.push_back({v, Vec3(sphere.centre + sphere.radius * outwards)});
        rounded.turned.push_back({v, Vec3(outwards)});
    }
    return medianOf(std::move(cosines)) < roundAlready ? rounded : RoundedSphere{};
}

}  // namespace relamp
