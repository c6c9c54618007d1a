// The picture of a LiveScene: everything that light does to a vertex, added up.
#include <string>

#include "base/parallel.h"
#include "relight/live_state.h"

namespace relamp {

Rgb LiveScene::State::albedo(size_t vertex) const {
    const uint32_t origin = vertices.origin[vertex];
    if (origin == EditedBody::none || estimate->reflectance.weight.empty()) return Rgb(0);
    const Rgb w = estimate->reflectance.weight[0][origin];
    return look.neutralMaterials ? Rgb(luminance(w)) : w;
}

void LiveScene::State::makeFrame() {
    auto out = std::make_shared<LiveFrame>();
    out->mesh = vertices.mesh;
    out->emitterOfTriangle = emitterOfTriangle;
    out->distant = distant;
    for (const RelitEmitter& e : geometry.emitters) {
        out->emitterIds.push_back(e.id);
        out->emitterRadiance.push_back(e.radiance);
    }
    const size_t n = vertices.count(), emitters = near.size();
    out->formFactor.resize(emitters);
    for (size_t e = 0; e < emitters; ++e) out->formFactor[e] = near[e].factor;
    out->radiance.resize(n);
    out->distantMatte.resize(n);
    const bool glossy = !gloss.empty();
    parallelFor(n, 2048, [&](size_t v) {
        if (vertices.kind[v] == LiveVertices::emitting) {
            out->radiance[v] = geometry.emitters[size_t(geometry.bodies[vertices.body[v]].emitter)].radiance;
            return;
        }
        if (!vertices.lit(v)) return;
        out->distantMatte[v] = gain * distantMatte[v];
        Rgb matteLight = out->distantMatte[v];
        for (size_t e = 0; e < emitters; ++e) matteLight += near[e].factor[v] * geometry.emitters[e].radiance;
        Rgb sum = albedo(v) * matteLight;
        if (glossy) {
            sum += gain * gloss.distant()[v];
            for (size_t e = 0; e < emitters; ++e)
                sum += gloss.near(e)[v] * geometry.emitters[e].radiance * (gloss.shadowed(e, v) ? 1.0f : near[e].seen(v));
        }
        out->radiance[v] = sum;
    });
    out->refined = finished;
    report.bytesPerVertex = (matte.bytes() + carried.bytes()) / std::max<size_t>(1, n) + emitters * (2 * sizeof(float) + 1);
    report.storeBytes = matte.store().bytes();
    report.termsPerVertex = matte.store().blocks() ? float(matte.store().terms()) / float(matte.store().blocks()) : 0.0f;
    report.device = matte.sums().device();
    report.cpuApplyMs = matte.sums().processorMs();
    report.deviceApplyMs = matte.sums().deviceMs();
    report.leftOut.clear();
    if (!glossy) report.leftOut.push_back({"glossy passes", "no vertex has a glossy lobe"});
    report.glossyOutside = glossy ? gloss.outside() : 0;
    if (report.glossyOutside) report.leftOut.push_back({"glossy light outside the picture", std::to_string(report.glossyOutside) + " vertices face the eye there"});
    if (plain->black()) report.leftOut.push_back({"environment", "it is black"});
    if (near.empty()) report.leftOut.push_back({"near light", "the scene has no emitter"});
    if (carried.count() == 0) report.leftOut.push_back({"visibility of moved surfaces", "no part of the mesh moves"});
    out->report = report;
    frame = std::move(out);
}

}  // namespace relamp
