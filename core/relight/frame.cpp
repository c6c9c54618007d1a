#include "relight/frame.h"

#include "base/parallel.h"
#include "base/random.h"
#include "relight/light_sampler.h"

namespace relamp {
namespace {

/// A shaded surface point.
struct Surface {
    Vec3 position, normal, geometric, towardEye;
    Mat3 frame;
    Vec3 eye;               // towardEye in the frame
    Rgb albedo;
    std::vector<std::pair<size_t, Rgb>> lobes;  // glossy lobes present
};

struct Gather {
    Rgb world;
    std::vector<Rgb> byEmitter;
};

/// What all threads share.
struct Lights {
    const RelitScene& relit;
    DistantSampler distant;
    std::vector<EmitterSampler> emitters;
    std::vector<size_t> lit;                       // emitters that shine
    std::vector<uint32_t> triangleOnEmitter;       // mesh triangle -> index on its emitter's surface
    explicit Lights(const RelitScene& scene) : relit(scene), distant(*scene.distant) {
        for (size_t e = 0; e < relit.emitters.size(); ++e) {
            emitters.emplace_back(relit.emitters[e].surface);
            if (maxChannel(relit.emitters[e].radiance) > 0 && relit.emitters[e].surface.area() > 0) lit.push_back(e);
        }
        // Surfaces keep their triangles in mesh order, those without area left out.
        std::vector<uint32_t> next(relit.emitters.size(), 0);
        triangleOnEmitter.assign(relit.emitterOfTriangle.size(), 0);
        for (size_t t = 0; t < relit.emitterOfTriangle.size(); ++t) {
            const int e = relit.emitterOfTriangle[t];
            if (e >= 0 && relit.scene.mesh.triangleArea(t) > 0) triangleOnEmitter[t] = std::min(next[size_t(e)]++, uint32_t(std::max<size_t>(1, relit.emitters[size_t(e)].surface.areas.size()) - 1));
        }
    }
};

class Shader {
public:
    Shader(const Lights& lights, const FrameOptions& options)
        : lights_(lights), relit_(lights.relit), options_(options), emitterProposal_(lights.relit.emitters.size()) {
        // The fewer lamps, the more samples for each.
        emitterSamples_ = std::clamp(options.emitterSamples * 4 / int(std::max<size_t>(1, lights.lit.size())), 2, options.emitterSamples);
    }

    void surfaceAt(const Hit& hit, const Vec3& direction, Surface& s) const {
        const Scene& scene = relit_.scene;
        s.towardEye = -direction;
        s.position = scene.pointOf(hit);
        s.geometric = scene.mesh.faceNormal(hit.triangle);
        s.normal = scene.normalOf(hit);
        if (glm::dot(s.geometric, s.normal) < 0) s.geometric = -s.geometric;
        if (glm::dot(s.geometric, s.towardEye) < 0) {
            s.geometric = -s.geometric;
            s.normal = -s.normal;
        }
        s.frame = frameAround(s.normal);
        s.eye = glm::transpose(s.frame) * s.towardEye;
        const Triangle& t = scene.mesh.triangles[hit.triangle];
        const float b1 = hit.barycentric.x, b2 = hit.barycentric.y, b0 = 1 - b1 - b2;
        s.lobes.clear();
        for (size_t k = 0; k < relit_.weight.size(); ++k) {
            const auto& w = relit_.weight[k];
            const Rgb value = b0 * w[t[0]] + b1 * w[t[1]] + b2 * w[t[2]];
            if (k == 0) s.albedo = value;
            else if (maxChannel(value) > 1e-4f && s.eye.z > 1e-3f) s.lobes.emplace_back(k, value);
        }
    }

    /// Light at position `index` of the pixel's samplesPerPixel; sample numbers are stratified over the whole pixel.
    void gather(const Surface& s, uint32_t index, uint64_t seed, Gather& out) {
        const float offset = relit_.scene.tracer->surfaceOffset() * 4;
        const Vec3 origin = s.position + s.geometric * offset;
        const bool anything = maxChannel(s.albedo) > 0 || !s.lobes.empty();
        if (!anything) return;
        // A metal has nothing but its lobes: the samples a matte part would want go there.
        lobeCount_ = maxChannel(s.albedo) > 1e-3f ? options_.lobeSamples : 4 * options_.lobeSamples;
        distantCount_ = !relit_.distant->black() && lights_.distant.prepare(s.normal, proposal_) ? options_.distantSamples : 0;
        // A share from the cosine alone: where the bright part of the sky is hidden, the rest is not left to chance.
        cosineCount_ = distantCount_ > 0 && maxChannel(s.albedo) > 0 ? std::max(1, options_.distantSamples / 4) : 0;
        const Vec2 shift = randomShift(seed, 1, 0);
        const uint32_t total = uint32_t(options_.samplesPerPixel * options_.distantSamples);
        for (int i = 0; i < distantCount_; ++i) {
            const uint32_t n = permuted(index, uint32_t(i), total);
            const Vec3 d = lights_.distant.sample(proposal_, {(float(n) + jitter(seed, n)) / float(total), r2Point(n, shift).y});
            queue(s, origin, d, 1e30f, -1, 0, out);
        }
        for (int i = 0; i < cosineCount_; ++i) {
            const Vec3 local = cosineHemisphere(r2Point(index * uint32_t(cosineCount_) + uint32_t(i), randomShift(seed, 3, 0)));
            queue(s, origin, s.frame * local, 1e30f, -1, 0, out);
        }
        for (size_t e : lights_.lit) {
            if (!lights_.emitters[e].prepare(s.position, s.normal, emitterProposal_[e])) continue;
            const EmitterSurface& surface = relit_.emitters[e].surface;
            const Vec2 turn = randomShift(seed, 2, e);
            const uint32_t all = uint32_t(options_.samplesPerPixel * emitterSamples_);
            for (int i = 0; i < emitterSamples_; ++i) {
                const uint32_t n = permuted(index, uint32_t(i), all);
                float density = 0;
                size_t t = 0;
                const Vec3 target = lights_.emitters[e].sample(emitterProposal_[e], {(float(n) + jitter(seed + e + 1, n)) / float(all), r2Point(n, turn).y}, density, t);
                const Vec3 to = target - origin;
                const float distance = glm::length(to);
                if (!(distance > 2 * offset)) continue;
                const Vec3 d = to / distance;
                const float facing = -glm::dot(d, surface.normals[t]);
                if ((facing <= 1e-5f && !surface.twoSided) || glm::dot(d, s.normal) <= 0) continue;
                queue(s, origin, d, distance * (1 - 1e-4f) - 2 * offset, int(e), density * distance * distance / std::max(std::abs(facing), 1e-5f), out);
            }
        }
        flushShadow(s, out);
        for (const auto& [k, w] : s.lobes)
            for (int i = 0; i < lobeCount_; ++i) {
                const Vec3 local = sampleGgx(s.eye, relit_.basis.lobes[k].alpha, r2Point(index * uint32_t(lobeCount_) + uint32_t(i), randomShift(seed, 4, k)));
                if (local.z > 0) queueClosest(s, origin, s.frame * local, out);
            }
        flushClosest(s, out);
    }

private:
    const Lights& lights_;
    const RelitScene& relit_;
    const FrameOptions& options_;
    int emitterSamples_ = 1, distantCount_ = 0, cosineCount_ = 0, lobeCount_ = 0;
    DistantSampler::Proposal proposal_;
    std::vector<EmitterSampler::Proposal> emitterProposal_;
    // A packet being filled.
    Ray rays_[8];
    int emitter_[8];
    float density_[8];
    int count_ = 0;

    /// Number of sample i of position `index` among all of the pixel: positions take every samplesPerPixel-th one.
    uint32_t permuted(uint32_t index, uint32_t i, uint32_t total) const { return (i * uint32_t(options_.samplesPerPixel) + index) % total; }
    static float jitter(uint64_t seed, uint32_t n) { return unitFloat(mixBits(seed * 0x2545f491 + n)); }

    Rgb reflectanceTimesCosine(const Surface& s, const Vec3& light) const {
        if (light.z <= 0) return Rgb(0);
        Rgb f = s.albedo / pi;
        for (const auto& [k, w] : s.lobes) f += w * evaluateLobe(relit_.basis.lobes[k], light, s.eye);
        return f * light.z;
    }
    /// Sum of count x density of the samples drawn from the lobes.
    float lobeDensity(const Surface& s, const Vec3& light) const {
        float d = 0;
        for (const auto& [k, w] : s.lobes) d += float(lobeCount_) * ggxSampleDensity(light, s.eye, relit_.basis.lobes[k].alpha);
        return d;
    }
    /// Sum of count x density of the samples drawn for the environment.
    float distantDensity(const Vec3& direction, float cosine) const {
        return float(distantCount_) * lights_.distant.density(proposal_, direction) + float(cosineCount_) * std::max(0.0f, cosine) / pi;
    }
    void queue(const Surface& s, const Vec3& origin, const Vec3& d, float far, int emitter, float density, Gather& out) {
        if (glm::dot(d, s.geometric) <= 0 || glm::dot(d, s.normal) <= 0 || far <= 0) return;
        rays_[count_] = {origin, d, 0, far};
        emitter_[count_] = emitter;
        density_[count_++] = density;
        if (count_ == 8) flushShadow(s, out);
    }
    void flushShadow(const Surface& s, Gather& out) {
        if (!count_) return;
        const uint32_t blocked = relit_.scene.tracer->occluded8({rays_, size_t(count_)});
        for (int i = 0; i < count_; ++i) {
            if (blocked >> i & 1) continue;
            const Vec3 light = glm::transpose(s.frame) * rays_[i].direction;
            const Rgb f = reflectanceTimesCosine(s, light);
            const float other = lobeDensity(s, light);
            const float own = emitter_[i] < 0 ? distantDensity(rays_[i].direction, light.z) : float(emitterSamples_) * density_[i];
            // A direction on the rim of its cell may round into a black neighbour, which is never drawn and sends nothing.
            if (!(own + other > 0)) continue;
            if (emitter_[i] < 0) out.world += f * relit_.distant->radiance(rays_[i].direction) / (own + other);
            else out.byEmitter[size_t(emitter_[i])] += f * relit_.emitters[size_t(emitter_[i])].radiance / (own + other);
        }
        count_ = 0;
    }
    void queueClosest(const Surface& s, const Vec3& origin, const Vec3& d, Gather& out) {
        if (glm::dot(d, s.geometric) <= 0) return;
        rays_[count_++] = {origin, d, 0, 1e30f};
        if (count_ == 8) flushClosest(s, out);
    }
    void flushClosest(const Surface& s, Gather& out) {
        if (!count_) return;
        Hit hits[8];
        relit_.scene.tracer->closest8({rays_, size_t(count_)}, {hits, size_t(count_)});
        for (int i = 0; i < count_; ++i) {
            const Vec3 light = glm::transpose(s.frame) * rays_[i].direction;
            const float own = lobeDensity(s, light);
            if (!hits[i]) {
                if (!distantCount_) continue;
                const float density = distantDensity(rays_[i].direction, light.z) + own;
                if (density > 0) out.world += reflectanceTimesCosine(s, light) * relit_.distant->radiance(rays_[i].direction) / density;
                continue;
            }
            const int e = relit_.emitterOfTriangle[hits[i].triangle];
            if (e < 0 || maxChannel(relit_.emitters[size_t(e)].radiance) <= 0) continue;
            const RelitEmitter& emitter = relit_.emitters[size_t(e)];
            const float facing = -glm::dot(relit_.scene.mesh.faceNormal(hits[i].triangle), rays_[i].direction);
            if (facing <= 1e-5f && !emitter.surface.twoSided) continue;
            const float area = lights_.emitters[size_t(e)].areaDensity(emitterProposal_[size_t(e)], lights_.triangleOnEmitter[hits[i].triangle]);
            const float density = float(emitterSamples_) * area * hits[i].distance * hits[i].distance / std::max(std::abs(facing), 1e-5f) + own;
            if (density > 0) out.byEmitter[size_t(e)] += reflectanceTimesCosine(s, light) * emitter.radiance / density;
        }
        count_ = 0;
    }
};

}  // namespace

Frame renderFrame(const RelitScene& relit, const Camera& camera, const FrameOptions& options, Progress& progress) {
    Frame frame;
    frame.width = camera.width;
    frame.height = camera.height;
    const size_t pixels = size_t(frame.width) * frame.height, emitters = relit.emitters.size();
    frame.beauty.assign(pixels, Rgb(0));
    frame.alpha.assign(pixels, 0);
    frame.world.assign(pixels, Rgb(0));
    frame.byEmitter.assign(emitters, std::vector<Rgb>(pixels, Rgb(0)));
    frame.albedo.assign(pixels, Rgb(0));
    frame.normal.assign(pixels, Vec3(0));
    frame.position.assign(pixels, Vec3(0));
    frame.depth.assign(pixels, 1e30f);
    const Vec3 origin(camera.position());
    const float share = 1 / float(options.samplesPerPixel);
    const Lights lights(relit);
    progress.begin("Frame", size_t(frame.height));
    parallelBlocks(size_t(frame.height), 2, [&](size_t begin, size_t end) {
        Shader shader(lights, options);
        Surface surface;
        Gather gather;
        for (size_t y = begin; y < end; ++y)
            for (int x = 0; x < frame.width; ++x) {
                if (x % 64 == 0) progress.check();
                const size_t p = y * size_t(frame.width) + size_t(x);
                const uint64_t seed = mixBits(options.seed * 0x9e37 + p);
                gather.world = Rgb(0);
                gather.byEmitter.assign(emitters, Rgb(0));
                for (int i = 0; i < options.samplesPerPixel; ++i) {
                    const Vec2 inside = r2Point(uint32_t(i), randomShift(seed, 0, 0));
                    const Vec3 d = camera.rayDirection(Vec2(float(x), float(y)) + inside);
                    const Hit hit = relit.scene.tracer->closest({origin, d, 0, 1e30f});
                    if (!hit) {
                        if (options.background) gather.world += relit.distant->smoothRadiance(d);
                        continue;
                    }
                    frame.alpha[p] += share;
                    const int e = relit.emitterOfTriangle[hit.triangle];
                    if (e >= 0) {
                        if (relit.emitters[size_t(e)].surface.twoSided || glm::dot(relit.scene.mesh.faceNormal(hit.triangle), d) < 0) gather.byEmitter[size_t(e)] += relit.emitters[size_t(e)].radiance;
                        continue;
                    }
                    shader.surfaceAt(hit, d, surface);
                    frame.albedo[p] += surface.albedo * share;
                    shader.gather(surface, uint32_t(i), seed, gather);
                }
                const Hit centre = relit.scene.tracer->closest({origin, camera.rayDirection(Vec2(x + 0.5f, y + 0.5f)), 0, 1e30f});
                if (centre) {
                    frame.position[p] = relit.scene.pointOf(centre);
                    frame.normal[p] = relit.scene.normalOf(centre);
                    frame.depth[p] = float(camera.depthOf(DVec3(frame.position[p])));
                }
                frame.world[p] = gather.world * share;
                frame.beauty[p] = frame.world[p];
                for (size_t e = 0; e < emitters; ++e) {
                    frame.byEmitter[e][p] = gather.byEmitter[e] * share;
                    frame.beauty[p] += frame.byEmitter[e][p];
                }
            }
        progress.advance(end - begin);
    });
    return frame;
}

}  // namespace relamp
