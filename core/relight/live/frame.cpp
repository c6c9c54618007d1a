// The image of a LiveScene: everything that light does to a vertex, added up.
#include <string>

#include "base/parallel.h"
#include "relight/live/state.h"

namespace relamp {

Rgb LiveScene::State::albedo(size_t vertex) const {
    const uint32_t origin = vertices.origin[vertex];
    if (origin == EditedPart::none) return Rgb(0);
    const Rgb w = estimate->reflectance.at(origin).albedo();
    return look.neutralMaterials ? Rgb(luminance(w)) : w;
}

void LiveScene::State::followBounces(const std::vector<Rgb>& direct) {
    const size_t captured = bounceRays.vertexCount();
    std::vector<Rgb> outgoing(captured, Rgb(0)), passedOn(captured, Rgb(0));
    for (size_t v = 0; v < captured; ++v)
        if (vertices.lit(v)) passedOn[v] = glm::clamp(bouncingAlbedo(v), Rgb(0), Rgb(0.98f));
    bounced.resize(captured, Rgb(0));
    // At rest until nothing moves, while a hand moves something one step an image.
    for (int step = 0; step < (finished ? 30 : 1); ++step) {
        for (size_t v = 0; v < captured; ++v) outgoing[v] = passedOn[v] * (direct[v] + bounced[v]);
        std::vector<Rgb> next = gatherBounce(bounceRays, outgoing);
        float largest = 0, change = 0;
        for (size_t v = 0; v < captured; ++v) {
            largest = std::max(largest, maxChannel(next[v]));
            change = std::max(change, maxChannel(glm::abs(next[v] - bounced[v])));
        }
        bounced = std::move(next);
        if (!(change > 2e-3f * largest)) break;
    }
}

Rgb LiveScene::State::bouncingAlbedo(size_t vertex) const {
    Rgb sum = albedo(vertex);
    const uint32_t origin = vertices.origin[vertex];
    if (origin == EditedPart::none) return sum;
    const LobesAtVertex weights = estimate->reflectance.at(origin);
    for (size_t k = 1; k < weights.size(); ++k) {
        const Rgb w = lobesReflect[k] * weights[k];
        sum += look.neutralMaterials ? Rgb(luminance(w)) : w;
    }
    return sum;
}

std::vector<uint8_t> LiveScene::State::shiningAtEye() const {
    const Mesh& mesh = *vertices.mesh;
    std::vector<uint8_t> shines(mesh.vertexCount(), 0);
    for (size_t t = 0; t < mesh.triangles.size(); ++t) {
        const int e = (*emitterOfTriangle)[t];
        if (e < 0) continue;
        const Vec3 towardEye = eye.orthographic ? -eye.forward : eye.position - mesh.positions[mesh.triangles[t][0]];
        if (geometry.emitters[size_t(e)].surface.twoSided || glm::dot(mesh.faceNormal(t), towardEye) > 0)
            for (const uint32_t v : mesh.triangles[t]) shines[v] = 1;
    }
    return shines;
}

void LiveScene::State::makeFrame() {
    auto out = std::make_shared<LiveFrame>();
    out->mesh = vertices.mesh;
    out->emitterOfTriangle = emitterOfTriangle;
    out->distant = distant;
    for (const RelitEmitter& e : geometry.emitters) {
        out->emitterIds.push_back(e.id);
        out->emitterRadiance.push_back(e.emission.level);
    }
    const size_t n = vertices.count(), emitters = near.size();
    out->formFactor.resize(emitters);
    for (size_t e = 0; e < emitters; ++e) {
        out->formFactor[e].resize(near[e].factor.size());
        parallelFor(near[e].factor.size(), 16384, [&](size_t v) {
            out->formFactor[e][v] = near[e].shape.empty() ? near[e].at(v) : luminance(near[e].light(v));
        });
    }
    out->radiance.resize(n);
    out->distantMatte.resize(n);
    const bool glossy = !gloss.empty(), bouncing = bounceRays.rays > 0;
    std::vector<Rgb> direct(n, Rgb(0));
    parallelFor(n, 2048, [&](size_t v) {
        if (vertices.kind[v] == LiveVertices::emitting || !vertices.lit(v)) return;
        out->distantMatte[v] = gain * distantMatte[v];
        direct[v] = out->distantMatte[v];
        for (size_t e = 0; e < emitters; ++e) direct[v] += near[e].light(v) * geometry.emitters[e].emission.level;
    });
    if (bouncing) followBounces(direct);
    const std::vector<uint8_t> shines = shiningAtEye();
    parallelFor(n, 2048, [&](size_t v) {
        if (vertices.kind[v] == LiveVertices::emitting) {
            const int e = geometry.parts[vertices.part[v]].emitter;
            if (shines[v])
                out->radiance[v] =
                    geometry.emitters[size_t(e)].emission.shown(vertices.mesh->normals[v], vertices.mesh->positions[v]);
            return;
        }
        if (!vertices.lit(v)) return;
        Rgb matteLight = direct[v];
        if (bouncing && vertices.origin[v] != EditedPart::none) matteLight += bounced[vertices.origin[v]];
        Rgb sum = albedo(v) * matteLight;
        if (glossy) {
            sum += gain * gloss.distant()[v];
            for (size_t e = 0; e < emitters; ++e)
                sum += gloss.near(e)[v] * geometry.emitters[e].emission.level *
                       (gloss.shadowed(e, v) ? 1.0f : near[e].seen(v));
        }
        out->radiance[v] = sum;
    });
    out->refined = finished;
    report.bytesPerVertex =
        (matte.bytes() + carried.bytes()) / std::max<size_t>(1, n) + emitters * (2 * sizeof(float) + 1);
    report.storeBytes = matte.store().bytes();
    report.termsPerVertex =
        matte.store().blocks() ? float(matte.store().terms()) / float(matte.store().blocks()) : 0.0f;
    report.device = matte.sums().device();
    report.cpuApplyMs = matte.sums().processorMs();
    report.deviceApplyMs = matte.sums().deviceMs();
    report.nearDevice = nearPlace.device();
    report.cpuNearMs = nearPlace.processorMs();
    report.deviceNearMs = nearPlace.deviceMs();
    report.shadowDevice = matte.place().device();
    report.cpuShadowMs = matte.place().processorMs();
    report.deviceShadowMs = matte.place().deviceMs();
    report.leftOut.clear();
    const auto leaveOut = [this](Omission what, const std::string& why) { report.leftOut.emplace_back(what, why); };
    if (!bouncing) leaveOut(Omission::bouncedLight, "the photographs showed none worth keeping");
    if (!glossy) leaveOut(Omission::glossyPasses, "no vertex has a glossy lobe");
    report.glossyOutside = glossy ? gloss.outside() : 0;
    if (report.glossyOutside)
        leaveOut(Omission::glossOutside, std::to_string(report.glossyOutside) + " vertices face the eye there");
    if (plain->black()) leaveOut(Omission::environment, "it is black");
    if (near.empty()) leaveOut(Omission::nearLight, "the scene has no emitter");
    if (carried.count() == 0) leaveOut(Omission::movedVisibility, "no part of the mesh moves");
    out->report = report;
    frame = std::move(out);
}

}  // namespace relamp
