#include "pipeline/flatten_surfaces.h"

#include <algorithm>
#include <cmath>

#include "base/log.h"
#include "pipeline/mend_mesh.h"
#include "pipeline/plan_pilot.h"
#include "radiance/free_space.h"
#include "scene/flat_surface.h"

namespace relamp {
namespace {

constexpr double leastWaves = 1e-4;                            ///< of the diagonal
constexpr double disagreeMore = 0.20, sureOfDisagreement = 3;  ///< of the misfit; standard errors
constexpr double explainWorse = 0.03, sureOfWorse = 4;
constexpr double usualDifference = 0.1;  ///< between observations of one vertex, log luminance

RegistrationFix fixOf(const Flattening& flat) {
    RegistrationFix fix;
    float most = 0;
    for (const float m : flat.move) most = std::max(most, std::abs(m));
    fix.flatStep = most / 10000;
    if (!(fix.flatStep > 0)) return {};
    for (const float m : flat.move) fix.flatSteps.push_back(int(std::lround(m / fix.flatStep)));
    return fix;
}

/// What the photographs of one vertex differ by: the variance of log luminance over the views, bent (Cauchy).
double disagreement(const RadianceSamples& samples, uint32_t v) {
    double sum = 0, squares = 0, count = 0;
    for (uint32_t k = samples.start[v]; k < samples.start[v + 1]; ++k) {
        const double light = double(luminance(samples.samples[k].radiance));
        if (!(light > 0)) continue;
        const double log = std::log(light);
        sum += log;
        squares += log * log;
        count += 1;
    }
    if (count < 2) return 0;
    return std::log1p(std::max(0.0, squares / count - sum * sum / (count * count)) /
                      (usualDifference * usualDifference));
}

/// How much better photographs agree on the vertices of one surface when it is flat.
MisfitFall agreeBetter(const Flattening& flat, int surface, const RadianceSamples& wavy, const RadianceSamples& even) {
    std::vector<double> before, after;
    for (uint32_t v = 0; v < flat.surface.size(); ++v) {
        if (flat.surface[v] != surface) continue;
        before.push_back(disagreement(wavy, v));
        after.push_back(disagreement(even, v));
    }
    return misfitFall(before, after);
}

/// Those of skirts alone, beside `lights`: a skirt lies where the mesher put it, and would tilt the plane of what it
/// hangs on.
std::vector<uint8_t> withSkirts(const Capture& capture, const Scene& scene, const RadianceSamples& samples,
                                std::vector<uint8_t> lights, Progress& progress) {
    const std::vector<uint32_t> free = freeSpaceTriangles(scene, capture, samples, lights, progress);
    std::vector<uint8_t> held(lights.size(), 0), hangs(lights.size(), 0);
    for (uint32_t t = 0, next = 0; t < scene.mesh.triangles.size(); ++t) {
        const bool inFree = next < free.size() && free[next] == t;
        next += inFree;
        for (const uint32_t v : scene.mesh.triangles[t]) (inFree ? hangs : held)[v] = 1;
    }
    for (size_t v = 0; v < lights.size(); ++v)
        if (hangs[v] && !held[v]) lights[v] = 1;
    return lights;
}

/// The flat surfaces whose waves are worth a change; `bentToo`: those as well that a skirt may have bent.
std::vector<FlatSurface> wavySurfaces(const Scene& scene, size_t own, const std::vector<uint8_t>& leftOut,
                                      bool bentToo) {
    const std::vector<FlatSurface> planes = flatSurfaces(scene, leftOut);
    const Flattening flat = flattening(scene, planes, own, leftOut);
    std::vector<FlatSurface> wavy;
    for (size_t s = 0; s < planes.size(); ++s)
        if ((bentToo || flat.isFlat(s)) && flat.waves[s] > leastWaves * double(scene.diagonal))
            wavy.push_back(planes[s]);
    return wavy;
}

}  // namespace

FlattenedSurfaces flattenSurfaces(const Capture& capture, const Scene& scene, const RadianceSamples& samples,
                                  const EmitterClusters& clusters, const GatherOptions& gather,
                                  const SolveOptions& options, Progress& progress) {
    const std::vector<uint8_t> lights = verticesOf(scene, {&clusters.emitters, &clusters.candidates});
    const size_t own = capture.mesh.vertexCount() - capture.proxies.size() * proxyVertices;
    if (wavySurfaces(scene, own, lights, true).empty()) return {};
    const std::vector<uint8_t> leftOut = withSkirts(capture, scene, samples, lights, progress);
    const std::vector<FlatSurface> wavy = wavySurfaces(scene, own, leftOut, false);
    if (wavy.empty()) return {};
    Flattening flat = flattening(scene, wavy, own, leftOut);

    Mesh mesh = scene.mesh;
    applyRegistration(fixOf(flat), mesh);
    Scene even = buildScene(std::move(mesh), progress, scene.axes);
    even.rank = scene.rank;  // the same pairs
    auto seen = std::make_shared<const RadianceSamples>(gatherRadiance(capture, even, gather, progress));
    FlattenedSurfaces result;
    std::vector<FlatSurface> wanted;
    for (size_t s = 0; s < wavy.size(); ++s) {
        const MisfitFall fall = agreeBetter(flat, int(s), samples, *seen);
        const bool relief = fall.reversed().exceeds(disagreeMore, sureOfDisagreement);
        const DVec3 at = wavy[s].point + capture.origin;
        logInfo("a flat surface of {:.2f} m2 at {:.2f} {:.2f} {:.2f} has waves of {:.2f} mm; photographs without: {}{}",
                wavy[s].area, at.x, at.y, at.z, 1000 * flat.waves[s], fall.words(), relief ? ": left as it is" : "");
        if (relief) continue;
        wanted.push_back(wavy[s]);
        result.words.push_back(fmt::format(
            "a surface of {:.2f} m2 is flat but for waves of {:.2f} mm, as reconstructions have them: brought onto its "
            "plane",
            wavy[s].area, 1000 * flat.waves[s]));
    }
    const RatioObservations observed = ratioObservations(scene, samples, lights, options.seed);
    const MisfitFall fall =
        misfitFall(pilotMisfits(scene, samples, clusters, observed.matte, observed.pairs, options, progress),
                   pilotMisfits(even, samples, clusters, observed.matte, observed.pairs, options, progress));
    const bool worse = fall.reversed().exceeds(explainWorse, sureOfWorse);
    logInfo("with flat surfaces: {}{}", fall.words(), worse ? "; left as they are" : "");
    if (worse || wanted.empty()) return {};
    if (wanted.size() < wavy.size()) flat = flattening(scene, wanted, own, leftOut);
    else result.samples = std::move(seen);
    result.fix = fixOf(flat);
    return result;
}

}  // namespace relamp
