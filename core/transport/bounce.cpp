#include "transport/bounce.h"

#include <algorithm>

#include "base/parallel.h"
#include "base/random.h"
#include "transport/visibility.h"

namespace relamp {

BounceRays traceBounce(const Scene& scene, const BounceOptions& options, Progress& progress) {
    const size_t n = scene.mesh.vertexCount();
    BounceRays out;
    out.rays =
        std::clamp(uint32_t((size_t(1) << 25) / std::max<size_t>(1, n)), std::min(32u, options.rays), options.rays);
    constexpr size_t block = 64;
    std::vector<std::vector<uint32_t>> found((n + block - 1) / block);
    out.start.assign(n + 1, 0);
    std::vector<float> reach(n, 1e30f);  // harmonic mean of the distances met
    progress.begin("Surfaces that light each other", n);
    parallelBlocks(
        n, block,
        [&](size_t begin, size_t end) {
            std::vector<uint32_t>& senders = found[begin / block];
            for (size_t v = begin; v < end; ++v) {
                if (!scene.referenced[v] || (options.only && !(*options.only)[v])) continue;
                const Vec3 normal = scene.mesh.normals[v], origin = rayOrigin(scene, scene.mesh.positions[v], normal);
                const Mat3 frame = frameAround(normal, scene.axes);
                const Vec2 shift = randomShift(options.seed, 11, scene.rank[v]);
                const size_t before = senders.size();
                double nearness = 0;
                Ray rays[8];
                Hit hits[8];
                for (uint32_t first = 0; first < out.rays; first += 8) {
                    const uint32_t count = std::min(8u, out.rays - first);
                    for (uint32_t i = 0; i < count; ++i)
                        rays[i] = {origin, frame * cosineHemisphere(r2Point(first + i, shift)), 0, 1e30f};
                    scene.cameraTracer->closest8({rays, count}, {hits, count});
                    for (uint32_t i = 0; i < count; ++i) {
                        if (!hits[i] || glm::dot(scene.mesh.faceNormal(hits[i].triangle), rays[i].direction) >= 0)
                            continue;
                        const Triangle& t = scene.mesh.triangles[hits[i].triangle];
                        const float draw = unitFloat(mixBits(mixBits(options.seed ^ scene.rank[v]) + first + i));
                        const Vec2 b = hits[i].barycentric;
                        nearness += 1 / std::max(hits[i].distance, 1e-20f);
                        senders.push_back(draw < b.x ? t[1] : draw < b.x + b.y ? t[2] : t[0]);
                    }
                }
                std::sort(senders.begin() + ptrdiff_t(before), senders.end());
                out.start[v + 1] = uint32_t(senders.size() - before);
                if (nearness > 0) reach[v] = float(out.rays / nearness);
            }
        },
        &progress);
    for (size_t v = 0; v < n; ++v) out.start[v + 1] += out.start[v];
    out.sender.reserve(out.start[n]);
    for (const std::vector<uint32_t>& senders : found)
        out.sender.insert(out.sender.end(), senders.begin(), senders.end());
    out.sharedStart.assign(n + 1, 0);
    for (uint32_t v = 0; v < n; ++v) {
        for (uint32_t e = scene.graph.start[v]; e < scene.graph.start[v + 1]; ++e) {
            const uint32_t w = scene.graph.to[e];
            if (options.only && (!(*options.only)[v] || !(*options.only)[w])) continue;
            const float apart = glm::length(scene.mesh.positions[v] - scene.mesh.positions[w]);
            if (glm::dot(scene.mesh.normals[v], scene.mesh.normals[w]) > 0.9f &&
                apart < 0.3f * std::min(reach[v], reach[w]))
                out.shared.push_back(w);
        }
        out.sharedStart[v + 1] = uint32_t(out.shared.size());
    }
    return out;
}

std::vector<Rgb> gatherBounce(const BounceRays& rays, const std::vector<Rgb>& outgoing) {
    std::vector<Rgb> out(rays.vertexCount(), Rgb(0));
    parallelFor(out.size(), 256, [&](size_t v) {
        Rgb sum(0);
        for (uint32_t i = rays.start[v]; i < rays.start[v + 1]; ++i) sum += outgoing[rays.sender[i]];
        out[v] = sum / float(std::max(1u, rays.rays));
    });
    for (int pass = 0; pass < 2; ++pass) {
        std::vector<Rgb> mean(out.size());
        parallelFor(out.size(), 1024, [&](size_t v) {
            Rgb sum = out[v];
            for (uint32_t i = rays.sharedStart[v]; i < rays.sharedStart[v + 1]; ++i) sum += out[rays.shared[i]];
            mean[v] = sum / float(1 + rays.sharedStart[v + 1] - rays.sharedStart[v]);
        });
        out = std::move(mean);
    }
    return out;
}

std::vector<Rgb> bounceOf(const BounceRays& rays, const std::vector<Rgb>& albedo, const std::vector<Rgb>& direct) {
    std::vector<Rgb> bounced(direct.size(), Rgb(0)), outgoing(direct.size());
    for (int round = 0; round < 30; ++round) {
        // Albedo a hair above 1 would never come to rest.
        for (size_t v = 0; v < outgoing.size(); ++v)
            outgoing[v] = glm::clamp(albedo[v], Rgb(0), Rgb(0.98f)) * (direct[v] + bounced[v]);
        std::vector<Rgb> next = gatherBounce(rays, outgoing);
        float largest = 0, change = 0;
        for (size_t v = 0; v < next.size(); ++v) {
            largest = std::max(largest, maxChannel(next[v]));
            change = std::max(change, maxChannel(glm::abs(next[v] - bounced[v])));
        }
        bounced = std::move(next);
        if (!(change > 1e-3f * largest)) break;
    }
    return bounced;
}

}  // namespace relamp
