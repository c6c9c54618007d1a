// Which surfaces a vertex sees: what light bounced once is made of (docs/method.md 8).
#pragma once
#include <vector>

#include "base/progress.h"
#include "scene/scene.h"

namespace relamp {

/// Cosine-distributed rays from each vertex and the vertices of the surfaces they met. A matte vertex of albedo a shows
/// a x (1 / rays) x sum of the senders' radiance of light that other surfaces send it.
struct BounceRays {
    uint32_t rays = 0;             ///< traced from each vertex, those that met nothing included
    std::vector<uint32_t> start;   ///< senders of vertex v: sender[start[v]] ... sender[start[v + 1] - 1]
    std::vector<uint32_t> sender;  ///< vertices: of the triangle that was met one corner, drawn by the point's weights
    /// Vertices that share their rays with v, v itself left out: neighbours that face the same way and are much nearer
    /// than what the rays met, where light from other surfaces hardly changes [Ward88].
    std::vector<uint32_t> sharedStart, shared;
    size_t vertexCount() const { return start.empty() ? 0 : start.size() - 1; }
    /// Fraction of the cosine-weighted hemisphere that other surfaces fill, in [0, 1].
    float enclosure(uint32_t v) const { return rays ? float(start[v + 1] - start[v]) / float(rays) : 0.0f; }
};

struct BounceOptions {
    uint32_t rays = 256;  ///< fewer on large meshes: at most 2^25 in all, at least 32 a vertex
    uint64_t seed = 1;
    const std::vector<uint8_t>* only =
        nullptr;  ///< per vertex: 0 leaves it out, it then meets nothing; null: every vertex
};

/// Rays from every vertex that a triangle uses. Backs of surfaces send nothing. Cost: 256 closest-hit rays a vertex,
/// 0.1 ms; 4 B a ray that meets something. Throws Cancelled.
BounceRays traceBounce(const Scene& scene, const BounceOptions& options, Progress& progress);

/// Per vertex the mean of what its senders send over all its rays, and those of the vertices it shares rays with,
/// twice: what a white matte surface shows of it. `outgoing`: radiance, a value a vertex.
std::vector<Rgb> gatherBounce(const BounceRays& rays, const std::vector<Rgb>& outgoing);

/// Light that went from surface to surface any number of times, given the direct one: the fixed point of b = F (albedo
/// x (direct + b)), by iteration until nothing changes by more than 1e-3 of the largest, at most 30 times. All per
/// vertex, as shown by a white matte surface.
std::vector<Rgb> bounceOf(const BounceRays& rays, const std::vector<Rgb>& albedo, const std::vector<Rgb>& direct);

}  // namespace relamp
