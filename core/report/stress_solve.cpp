#include "report/stress_solve.h"

#include "pipeline/pipeline.h"

namespace relamp {
namespace {

bool finiteAll(const std::vector<Rgb>& values) {
    return std::all_of(values.begin(), values.end(), [](const Rgb& v) { return isFinite(v); });
}

/// Irradiance of the distant light on the surface orientation `normal`.
DVec3 irradianceOn(const Estimate& estimate, const DVec3& normal) {
    const DirectionGrid grid{estimate.environmentSide};
    DVec3 sum(0);
    for (int c = 0; c < grid.cells(); ++c)
        if (const double cosine = glm::dot(DVec3(grid.direction(c)), normal); cosine > 0)
            sum += DVec3(estimate.environment[size_t(c)]) * cosine;
    return sum * double(grid.cellSolidAngle());
}

double largest(const DVec3& v) { return std::max(v.x, std::max(v.y, v.z)); }

}  // namespace

Estimate solveForStress(const Capture& capture, const EmitterClusters* emitters, bool emittersReversed,
                        const SolveOptions& options, Progress& progress) {
    // The bare solve: a plan, or a figure of quality, would hide what is under stress.
    PipelineOptions pipeline;
    pipeline.solve = options;
    pipeline.meshTriangles = 0;
    pipeline.plan = pipeline.reproduce = false;
    pipeline.texture = 0;
    StageMeter meter(progress);
    Prepared prepared = prepare(capture, pipeline, meter, progress);
    if (emitters) prepared.clusters = *emitters;
    if (emittersReversed) {
        std::reverse(prepared.clusters.emitters.begin(), prepared.clusters.emitters.end());
        std::reverse(prepared.clusters.candidates.begin(), prepared.clusters.candidates.end());
    }
    return solvePrepared(capture, *prepared.scene, prepared, pipeline, meter, progress);
}

bool allFinite(const Estimate& e) {
    bool finite = finiteAll(e.lighting.leafRadiance) && finiteAll(e.lighting.emitterRadiance) &&
                  finiteAll(e.environment) && finiteAll(e.emitterSigma);
    for (const auto& lobe : e.reflectance.weight) finite = finite && finiteAll(lobe);
    for (float value : e.reflectance.confidence) finite = finite && std::isfinite(value);
    for (float value : e.identifiability) finite = finite && std::isfinite(value);
    for (const TimelineEntry& t : e.timeline) finite = finite && std::isfinite(t.objective) && std::isfinite(t.rmse);
    for (const EmitterCluster& c : e.emitters.emitters)
        finite = finite && isFinite(c.radiance) && isFinite(c.centroid) && std::isfinite(c.area);
    return finite && std::isfinite(e.stability.kktResidual) && std::isfinite(e.stability.conditionNumber) &&
           isFinite(e.gauge.scale);
}

AnswerDifference differenceOf(const Estimate& base, const Estimate& variant, const VariantOf& how) {
    AnswerDifference d;
    const size_t count = base.emitters.emitters.size();
    if (count != variant.emitters.emitters.size()) d.emitters = 1;
    double strongest = 0;
    for (const Rgb& r : base.lighting.emitterRadiance)
        strongest = std::max(strongest, double(maxChannel(r * how.radiance)));
    for (size_t e = 0; e < count && d.emitters < 1; ++e) {
        const DVec3 centre = how.scale * (how.turn * DVec3(base.emitters.emitters[e].centroid)) + how.offset;
        double nearest = 1e300;
        size_t match = 0;
        for (size_t k = 0; k < count; ++k) {
            const double distance = glm::length(DVec3(variant.emitters.emitters[k].centroid) - centre);
            if (distance < nearest) nearest = distance, match = k;
        }
        const DVec3 wanted(base.lighting.emitterRadiance[e] * how.radiance),
            found(variant.lighting.emitterRadiance[match]);
        d.emitters = std::max(d.emitters, largest(glm::abs(wanted - found)) / std::max(strongest, 1e-300));
    }
    double brightest = 0, off = 0;
    for (const DVec3& n :
         {DVec3(0, 0, 1), DVec3(0, 0, -1), DVec3(1, 0, 0), DVec3(-1, 0, 0), DVec3(0, 1, 0), DVec3(0, -1, 0)}) {
        const DVec3 wanted = irradianceOn(base, n) * DVec3(how.radiance);
        brightest = std::max(brightest, largest(wanted));
        off = std::max(off, largest(glm::abs(wanted - irradianceOn(variant, how.turn * n))));
    }
    if (off > 0) d.irradiance = off / std::max(brightest, 1e-300);
    double squares = 0, reference = 0;
    for (size_t v = 0; v < base.reflectance.vertexCount(); ++v) {
        const size_t to = how.newIndex.empty() ? v : how.newIndex[v];
        if (base.reflectance.confidence[v] < 0.5f || variant.reflectance.confidence[to] < 0.5f) continue;
        const DVec3 a(base.reflectance.at(v).albedo()), b(variant.reflectance.at(to).albedo());
        squares += glm::dot(a - b, a - b);
        reference += glm::dot(a, a);
    }
    if (squares > 0) d.albedo = std::sqrt(squares / std::max(reference, 1e-300));
    return d;
}

}  // namespace relamp
