#include "relight/bounced_light.h"

#include "base/parallel.h"
#include "brdf/layered_albedo.h"
#include "relight/point_shader.h"

namespace relamp {

std::vector<Rgb> bouncingAlbedo(const BrdfBasis& basis, const std::vector<std::vector<Rgb>>& weight,
                                const std::vector<uint8_t>& emitting) {
    std::vector<Rgb> albedo(emitting.size(), Rgb(0));
    const std::vector<float> reflected = hemisphericalAlbedos(basis);
    for (size_t k = 0; k < weight.size(); ++k)
        for (size_t v = 0; v < albedo.size(); ++v)
            if (!emitting[v]) albedo[v] += reflected[k] * weight[k][v];
    return albedo;
}

BouncedLight bouncedLight(const BounceRays& rays, const std::vector<Rgb>& albedo, const std::vector<Rgb>& directWorld,
                          const std::vector<std::vector<Rgb>>& directByEmitter) {
    const auto send = [&](const std::vector<Rgb>& direct, std::vector<Rgb>& bounced, std::vector<Rgb>& outgoing) {
        outgoing.assign(albedo.size(), Rgb(0));
        if (direct.empty()) {
            bounced.assign(albedo.size(), Rgb(0));
            return;
        }
        bounced = bounceOf(rays, albedo, direct);
        for (size_t v = 0; v < outgoing.size(); ++v) outgoing[v] = albedo[v] * (direct[v] + bounced[v]);
    };
    BouncedLight out;
    send(directWorld, out.world, out.outgoingWorld);
    out.byEmitter.resize(directByEmitter.size());
    out.outgoingByEmitter.resize(directByEmitter.size());
    for (size_t e = 0; e < directByEmitter.size(); ++e)
        send(directByEmitter[e], out.byEmitter[e], out.outgoingByEmitter[e]);
    return out;
}

BouncedLight bouncedLightOf(const RelitScene& relit, const BouncedLightOptions& options, Progress& progress) {
    const Scene& scene = relit.scene;
    const size_t n = scene.mesh.vertexCount();
    const BounceRays rays = traceBounce(scene, options.rays, progress);
    std::vector<uint8_t> emitting(n, 0);
    for (size_t t = 0; t < relit.emitterOfTriangle.size(); ++t)
        if (relit.emitterOfTriangle[t] >= 0)
            for (uint32_t v : scene.mesh.triangles[t]) emitting[v] = 1;
    FrameOptions frame;
    frame.samplesPerPixel = options.samples;
    const SceneLights lights(relit);
    std::vector<Rgb> world(n, Rgb(0));
    std::vector<std::vector<Rgb>> byEmitter(relit.emitters.size());
    for (size_t e : lights.lit) byEmitter[e].assign(n, Rgb(0));
    progress.begin("Direct light at the vertices", n);
    parallelBlocks(
        n, 256,
        [&](size_t begin, size_t end) {
            PointShader shader(lights, frame);
            ShadedPoint point;
            Gather gloss, matte;
            gloss.clear(relit.emitters.size());
            for (size_t v = begin; v < end; ++v) {
                if (!scene.referenced[v] || emitting[v]) continue;
                shader.whiteAt(uint32_t(v), point);
                matte.clear(relit.emitters.size());
                for (int i = 0; i < options.samples; ++i)
                    shader.gather(point, uint32_t(i), mixBits(options.rays.seed * 0x51ed + v), gloss, matte);
                const float fraction = 1 / float(options.samples);
                world[v] = fraction * matte.world;
                for (size_t e : lights.lit) byEmitter[e][v] = fraction * matte.byEmitter[e];
            }
        },
        &progress);
    return bouncedLight(rays, bouncingAlbedo(relit.basis, relit.weight, emitting), world, byEmitter);
}

}  // namespace relamp
