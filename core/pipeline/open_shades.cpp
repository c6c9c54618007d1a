#include "pipeline/open_shades.h"

#include <algorithm>

#include "base/log.h"
#include "pipeline/light_obstacles.h"
#include "pipeline/mend_mesh.h"
#include "pipeline/plan_pilot.h"

namespace relamp {
namespace {

constexpr double leastWidth = 0.4;  ///< of the narrower end, of the length: fluorescent tubes have ends
constexpr double leastFall = 0.002, leastErrors = 4;  ///< of the misfit, with the ends of a tube open; standard errors
constexpr double leastRise = 0.01, sureOfRise = 3;    ///< the same of a cone

/// Vertices of the scene from `first` up to `last`.
struct VertexRange {
    uint32_t first = 0, last = 0;
    bool holds(uint32_t v) const { return v >= first && v < last; }
};

bool mayBeOpen(const EmitterReplacement& r) {
    if (!r.body.round || r.open || std::count(r.dark.begin(), r.dark.end(), 1) > 0) return false;
    const double narrow = std::min(r.body.radiusAt(-r.body.half.x), r.body.radiusAt(r.body.half.x));
    return narrow > leastWidth * r.body.half.x;
}

VertexRange endsOf(const EmitterReplacement& r) {
    std::vector<Vec3> positions;
    std::vector<Triangle> triangles;
    const std::vector<uint32_t> sides = r.body.surface(positions, triangles);
    return {r.first + sides[1], r.first + uint32_t(positions.size())};
}

/// Light passes the ends.
Scene without(const Scene& scene, const VertexRange& ends) {
    std::vector<uint32_t> triangles;
    for (uint32_t t = 0; t < scene.mesh.triangles.size(); ++t)
        if (ends.holds(scene.mesh.triangles[t][0])) triangles.push_back(t);
    return withoutShadowOf(scene, triangles);
}

/// The sides alone shine, to both sides.
EmitterClusters asSheet(const Scene& scene, const EmitterClusters& clusters, const VertexRange& ends,
                        const VertexRange& body) {
    EmitterClusters open = clusters;
    for (EmitterCluster& e : open.emitters) {
        const bool its = std::any_of(e.vertices.begin(), e.vertices.end(), [&](uint32_t v) { return body.holds(v); });
        if (!its) continue;
        std::erase_if(e.vertices, [&](uint32_t v) { return ends.holds(v); });
        std::erase_if(e.triangles, [&](uint32_t t) { return ends.holds(scene.mesh.triangles[t][0]); });
        measureTriangles(scene, e);
        e.twoSided = true;
    }
    indexEmitters(scene, open);
    return open;
}

}  // namespace

bool openShadeEnds(const Scene& scene, const RadianceSamples& samples, const EmitterClusters& clusters,
                   const SolveOptions& options, std::vector<EmitterReplacement>& bodies, Progress& progress) {
    if (std::none_of(bodies.begin(), bodies.end(), mayBeOpen)) return false;
    const RatioObservations observed =
        ratioObservations(scene, samples, verticesOf(scene, {&clusters.emitters, &clusters.candidates}), options.seed);
    if (observed.pairs.size() < 1000) return false;
    const auto misfits = [&](const Scene& of, const EmitterClusters& emitters) {
        return pilotMisfits(of, samples, emitters, observed.matte, observed.pairs, options, progress);
    };
    const std::vector<double> closed = misfits(scene, clusters);
    bool any = false;
    for (EmitterReplacement& r : bodies) {
        if (!mayBeOpen(r)) continue;
        const VertexRange ends = endsOf(r);
        const MisfitFall fall =
            misfitFall(closed, misfits(without(scene, ends), asSheet(scene, clusters, ends, {r.first, ends.last})));
        logInfo("{}, if it is open at its ends and shines to both sides: {}", wordsOf(r.body), fall.words());
        r.open =
            r.body.taper != 0 ? !fall.reversed().exceeds(leastRise, sureOfRise) : fall.exceeds(leastFall, leastErrors);
        any |= r.open;
    }
    return any;
}

}  // namespace relamp
