// The points and pairs that an unobserved emitter is looked for with, and the light that reaches them.
#include <map>

#include "base/box.h"
#include "base/parallel.h"
#include "base/random.h"
#include "base/statistics.h"
#include "solve/unobserved/unobserved_light_fit.h"
#include "transport/incident.h"

namespace relamp {
namespace {

constexpr double modelError = 0.015;

/// Pairs of points far apart on one component of the mesh and of one hue: probably of one material, and what tells a
/// fall-off over a wall. Their albedo may differ more than that of neighbours.
constexpr double farSpread = 0.1;
constexpr float farWeight = 0.3f;

std::vector<AlbedoPair> farPairs(const Scene& scene, const MatteObservations& matte, uint64_t seed) {
    std::map<uint32_t, std::vector<uint32_t>> components;
    for (uint32_t i = 0; i < matte.vertices.size(); ++i)
        if (matte.componentGlossy[scene.material[matte.vertices[i]]] < 2)
            components[scene.material[matte.vertices[i]]].push_back(i);
    std::vector<AlbedoPair> pairs;
    for (auto& [component, points] : components) {
        std::sort(points.begin(), points.end(), [&](uint32_t a, uint32_t b) {
            return scene.rank[matte.vertices[a]] < scene.rank[matte.vertices[b]];
        });
        for (size_t k = 0; k < points.size(); ++k) {
            const uint32_t i = points[k], j = points[size_t(mixBits(seed * 0x1000003 + scene.rank[matte.vertices[i]]) %
                                                            points.size())];
            const float a = luminance(matte.radiance[i]), b = luminance(matte.radiance[j]);
            if (i == j || !(a > 0) || !(b > 0)) continue;
            // The hue of what lies in the dark cannot be told, and shadows are what is looked for.
            const bool oneDark = std::min(a, b) < 0.15f * std::max(a, b);
            if (!oneDark && glm::length(matte.radiance[i] / a - matte.radiance[j] / b) > 0.1f) continue;
            pairs.push_back({i, j, farWeight});
        }
    }
    return pairs;
}

/// Normals of a mesh that was measured are noisy, and an error of ten degrees is one of a sixth of the light: a mean
/// over three rings, of those that face the same way.
std::vector<Vec3> smoothNormals(const Scene& scene) {
    std::vector<Vec3> normals = scene.mesh.normals;
    for (int round = 0; round < 3; ++round) {
        std::vector<Vec3> next = normals;
        parallelFor(normals.size(), 1024, [&](size_t v) {
            Vec3 sum = normals[v];
            for (uint32_t e = scene.graph.start[v]; e < scene.graph.start[v + 1]; ++e)
                if (const Vec3& n = normals[scene.graph.to[e]]; glm::dot(n, normals[v]) > 0.8f) sum += n;
            next[v] = glm::normalize(sum);
        });
        normals = std::move(next);
    }
    return normals;
}

}  // namespace

UnobservedLightData unobservedLightData(const Scene& measured, const RadianceSamples& samples,
                                        const EmitterClusters& clusters, int level, size_t pairs, uint64_t seed,
                                        Progress& progress) {
    UnobservedLightData data;
    Scene scene = measured;
    scene.mesh.normals = smoothNormals(measured);
    EmitterClusters emitters;
    emitters.emitters = clusters.emitters;
    emitters.emitters.insert(emitters.emitters.end(), clusters.candidates.begin(), clusters.candidates.end());
    indexEmitters(scene, emitters);
    std::vector<uint8_t> skip(scene.mesh.vertexCount(), 0);
    for (size_t v = 0; v < skip.size(); ++v) skip[v] = emitters.emitterOfVertex[v] >= 0;
    const MatteObservations matte = matteObservations(scene, samples, skip);
    PairOptions pairOptions;
    pairOptions.seed = seed;
    // Neighbours along an edge tell little of the light and much of the noise.
    std::vector<AlbedoPair> all = albedoPairs(scene, matte, pairOptions);
    std::erase_if(all, [](const AlbedoPair& p) { return p.edge; });
    const size_t near = all.size();
    const std::vector<AlbedoPair> far = farPairs(scene, matte, seed);
    all.insert(all.end(), far.begin(), far.end());
    const auto wantedOf = [&](size_t k) {
        const uint64_t a = scene.rank[matte.vertices[all[k].a]], b = scene.rank[matte.vertices[all[k].b]];
        const double fraction = 0.5 * double(pairs) / double(std::max<size_t>(1, k < near ? near : far.size()));
        return double(unitFloat(mixBits(mixBits(seed ^ (a << 1)) ^ b))) < fraction;
    };
    std::vector<uint32_t> place(matte.vertices.size(), ~0u), vertices;
    std::vector<uint8_t> only(scene.mesh.vertexCount(), 0);
    const auto pointOf = [&](uint32_t i) {
        if (place[i] != ~0u) return place[i];
        place[i] = uint32_t(vertices.size());
        const uint32_t v = matte.vertices[i];
        vertices.push_back(v);
        only[v] = 1;
        data.positions.push_back(scene.mesh.positions[v]);
        data.normals.push_back(scene.mesh.normals[v]);
        data.radiance.push_back(double(luminance(matte.radiance[i])));
        return place[i];
    };
    Box box;
    for (size_t k = 0; k < all.size(); ++k) {
        if (!wantedOf(k)) continue;
        const AlbedoPair& p = all[k];
        double variance = 2 * modelError * modelError + (k < near ? 0.0 : farSpread * farSpread);
        for (uint32_t i : {p.a, p.b}) {
            const double relative =
                double(luminance(matte.sigma[i])) / std::max(double(luminance(matte.radiance[i])), 1e-30);
            variance += relative * relative;
        }
        const uint32_t a = pointOf(p.a), b = pointOf(p.b);
        data.pairs.push_back({a, b, k < near ? p.weight : farWeight});
        data.variance.push_back(variance);
        data.component.push_back(scene.material[matte.vertices[p.a]]);
        data.far.push_back(k >= near);
        box.grow(data.positions[a]);
    }
    if (data.pairs.empty()) return data;
    // Parts: boxes of a fifth of the scene's extent.
    std::map<int, int> parts;
    const Vec3 size = glm::max(box.size(), Vec3(1e-20f));
    for (const AlbedoPair& p : data.pairs) {
        const glm::ivec3 cell = glm::min(glm::ivec3((data.positions[p.a] - box.min) / size * 5.0f), glm::ivec3(4));
        data.part.push_back(parts.try_emplace(cell.x + 5 * cell.y + 25 * cell.z, int(parts.size())).first->second);
    }
    data.parts = int(parts.size());

    data.leaves = LightLeaves::uniform(level, scene.axes);
    const Visibility visibility =
        computeVisibility(scene, {.gridSide = 16, .only = &only, .axes = scene.axes}, progress);
    NearFieldOptions nearOptions;
    nearOptions.seed = seed;
    nearOptions.only = &only;
    const InfluenceMatrix rows = lambertInfluence(
        scene, visibility, computeNearField(scene, emitters, nearOptions, progress), data.leaves, vertices, progress);
    data.rows.resize(Eigen::Index(rows.rows), Eigen::Index(rows.columns));
    for (size_t r = 0; r < rows.rows; ++r)
        for (size_t c = 0; c < rows.columns; ++c) data.rows(Eigen::Index(r), Eigen::Index(c)) = double(rows.row(r)[c]);

    data.anchors = lightAnchors(samples, emitters, data.leaves);
    for (size_t e = 0; e < emitters.emitters.size(); ++e) {
        data.anchors.emitterRadiance[e] = Rgb(luminance(data.anchors.emitterRadiance[e]));
        data.anchored |= !emitters.emitters[e].unobserved;
    }
    const double middle = medianOf(data.radiance);
    for (LeafAnchor& a : data.anchors.leaves) {
        a.radiance = Rgb(luminance(a.radiance));
        // Black environment tie nothing down.
        data.anchored |= a.seen() && !a.clipped && double(a.radiance.x) > 0.05 * middle;
    }
    // The priors are made for all pairs of the scene.
    const float thinned = float(data.pairs.size()) / float(std::max<size_t>(1, all.size()));
    data.prior.smoothness *= thinned;
    data.prior.backgroundWeight *= thinned;
    data.prior.darkness = float(1e-3 * middle);
    data.start = Eigen::VectorXd::Constant(data.rows.cols(), std::max(middle / 0.3, 1e-9));
    const std::vector<Rgb> first = firstRadiance(emitters);
    for (size_t e = 0; e < first.size(); ++e)
        data.start(Eigen::Index(data.leaves.size() + e)) = double(luminance(first[e]));
    return data;
}

namespace {

/// Eight places that stand for a light of radius 1: the corners of a cube, or of one that shines to one side two
/// squares on a disk across its axis.
std::array<Vec3, 8> placesOver(const EmissionLobe& lobe) {
    std::array<Vec3, 8> places;
    const Mat3 frame = frameAround(lobe.axis);
    for (int k = 0; k < 8; ++k) {
        const float turn = float(k) * pi / 4, out = k & 1 ? 0.9f : 0.45f;
        places[size_t(k)] = lobe.even()
                                ? Vec3(k & 1 ? 0.577f : -0.577f, k & 2 ? 0.577f : -0.577f, k & 4 ? 0.577f : -0.577f)
                                : frame * Vec3(out * std::cos(turn), out * std::sin(turn), 0);
    }
    return places;
}

}  // namespace

Eigen::VectorXd pointLightColumn(const Scene& scene, const UnobservedLightData& data, const Vec3& place, int rays,
                                 const LightShape& shape) {
    const size_t n = data.positions.size();
    Eigen::VectorXd column = Eigen::VectorXd::Zero(Eigen::Index(n));
    // Only ratios count, so the unit is free. Nearer than a hundredth of the scene nothing grows brighter.
    const double nearest = 0.01 * double(scene.diagonal), unit = double(scene.diagonal) * double(scene.diagonal) / piD;
    const std::array<Vec3, 8> over = placesOver(shape.lobe);
    for (size_t i = 0; i < n; ++i) {
        const Vec3 to = place - data.positions[i];
        const double d2 = std::max(double(glm::dot(to, to)), nearest * nearest),
                     cosine = double(glm::dot(to, data.normals[i])) / std::sqrt(d2);
        const double sent = double(shape.lobe.at(-to / float(std::sqrt(d2))));
        if (!(cosine > 0 && sent > 0)) continue;
        const Vec3 origin = rayOrigin(scene, data.positions[i], data.normals[i]);
        float open = 0;
        if (rays == 0) {
            const Vec3 straight = place - origin;
            const float length = glm::length(straight);
            open = length > 0 && scene.tracer->occluded({origin, straight / length, 0, length}) ? 0.0f : 1.0f;
        } else {
            // A ball of two hundredths of the distance: a soft edge, so that a small step of the emitter is a small
            // change.
            const float radius = shape.radius > 0 ? shape.radius : 0.02f * std::sqrt(float(d2));
            Ray bundle[8];
            const int count = std::min(rays, 8);
            for (int k = 0; k < count; ++k) {
                const Vec3 straight = place + radius * over[size_t(k)] - origin;
                const float length = std::max(glm::length(straight), 1e-30f);
                bundle[k] = {origin, straight / length, 0, length};
            }
            const uint32_t blocked = scene.tracer->occluded8({bundle, size_t(count)});
            for (int k = 0; k < count; ++k) open += blocked >> k & 1 ? 0.0f : 1.0f / float(count);
        }
        column(Eigen::Index(i)) = unit * double(open) * sent * cosine / d2;
    }
    return column;
}

}  // namespace relamp
