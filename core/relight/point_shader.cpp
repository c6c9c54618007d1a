#include "relight/point_shader.h"

#include <bit>

namespace relamp {

SceneLights::SceneLights(const RelitScene& scene) : relit(scene), distant(*scene.distant) {
    for (size_t e = 0; e < relit.emitters.size(); ++e) {
        emitters.emplace_back(relit.emitters[e].surface);
        if (!relit.emitters[e].emission.dark() && relit.emitters[e].surface.area() > 0) lit.push_back(e);
    }
    // Surfaces keep their triangles in mesh order, those without area left out.
    std::vector<uint32_t> next(relit.emitters.size(), 0);
    triangleOnEmitter.assign(relit.emitterOfTriangle.size(), 0);
    for (size_t t = 0; t < relit.emitterOfTriangle.size(); ++t) {
        const int e = relit.emitterOfTriangle[t];
        if (e >= 0 && relit.scene.mesh.triangleArea(t) > 0)
            triangleOnEmitter[t] = std::min(
                next[size_t(e)]++, uint32_t(std::max<size_t>(1, relit.emitters[size_t(e)].surface.areas.size()) - 1));
    }
}

PointShader::PointShader(const SceneLights& lights, const FrameOptions& options)
    : lights_(lights),
      relit_(lights.relit),
      options_(options),
      distantProposals_(8),
      proposals_(lights.relit.emitters.size(), nullptr) {
    // The fewer emitters, the more samples for each.
    cuts_.assign(lights.relit.emitters.size(), EmitterSampler::Cuts(lights.lit.size() <= 8 ? 128 : 16));
    emitterSamples_ =
        std::clamp(options.emitterSamples * 4 / int(std::max<size_t>(1, lights.lit.size())), 2, options.emitterSamples);
}

void PointShader::surfaceAt(const Hit& hit, const Vec3& direction, float spread, ShadedPoint& s) const {
    const Scene& scene = relit_.scene;
    s.towardEye = -direction;
    s.position = scene.pointOf(hit);
    s.geometric = scene.mesh.faceNormal(hit.triangle);
    s.normal = scene.normalOf(hit);
    if (glm::dot(s.geometric, s.normal) < 0) s.geometric = -s.geometric;
    const bool back = glm::dot(s.geometric, s.towardEye) < 0;
    if (back) {
        s.geometric = -s.geometric;
        s.normal = -s.normal;
    }
    s.frame = frameAround(s.normal);
    s.eye = glm::transpose(s.frame) * s.towardEye;
    const float b1 = hit.barycentric.x, b2 = hit.barycentric.y, b0 = 1 - b1 - b2;
    s.triangle = hit.triangle;
    s.component = relit_.componentAt(scene.mesh.triangles[hit.triangle][0]);
    s.corners = back ? Vec3(0) : Vec3(b0, b1, b2);
    s.lobes.clear();
    const LobesAtHit weights = relit_.weightsAt(hit);
    for (size_t k = 0; k < weights.size(); ++k) {
        const Rgb value = k == 0 ? relit_.albedoAt(hit, direction, spread) : weights[k];
        if (k == 0) s.albedo = value;
        else if (maxChannel(value) > 1e-4f && s.eye.z > 1e-3f) s.lobes.emplace_back(k, value);
    }
}

const DistantSampler::Proposal* PointShader::distantProposalFor(const Vec3& normal) {
    constexpr float steps = 32;  // of a coordinate: half the diagonal of a step is what prepare() allows
    const Vec3 facing = glm::normalize(glm::round(normal * steps));
    uint64_t hash = 0;
    for (const float x : {facing.x, facing.y, facing.z}) hash = mixBits(hash ^ std::bit_cast<uint32_t>(x));
    DistantSampler::Proposal& p = distantProposals_[hash % distantProposals_.size()];
    if (p.normal != facing) p.normal = Vec3(2);
    return lights_.distant.prepare(facing, p) ? &p : nullptr;
}

void PointShader::gather(const ShadedPoint& s, uint32_t index, uint64_t seed, Gather& gloss, Gather& matte) {
    const float offset = relit_.scene.tracer->surfaceOffset() * 4;
    const Vec3 origin = s.position + s.geometric * offset;
    const bool anything = maxChannel(s.albedo) > 0 || !s.lobes.empty();
    if (!anything) return;
    if (const BouncedLight& bounced = relit_.bounced; !bounced.empty() && s.triangle != Hit::none) {
        const Triangle& t = relit_.scene.mesh.triangles[s.triangle];
        for (int k = 0; k < 3; ++k) {
            const float fraction = s.corners[k];
            matte.world += fraction * bounced.world[t[size_t(k)]];
            for (size_t e : lights_.lit) matte.byEmitter[e] += fraction * bounced.byEmitter[e][t[size_t(k)]];
        }
    }
    addToFactors(s, matte);
    // A metal has nothing but its lobes: the samples a matte part would want go there.
    lobeCount_ = maxChannel(s.albedo) > 1e-3f ? options_.lobeSamples : 4 * options_.lobeSamples;
    distantProposal_ = relit_.distant->black() ? nullptr : distantProposalFor(s.normal);
    distantCount_ = distantProposal_ ? options_.distantSamples : 0;
    // A fraction from the cosine alone: where the bright part of the sky is hidden, the rest is not left to chance.
    cosineCount_ = distantCount_ > 0 && maxChannel(s.albedo) > 0 ? std::max(1, options_.distantSamples / 4) : 0;
    const Vec2 shift = randomShift(seed, 1, 0);
    const uint32_t total = uint32_t(options_.samplesPerPixel * options_.distantSamples);
    for (int i = 0; i < distantCount_; ++i) {
        const uint32_t n = permuted(index, uint32_t(i), total);
        const Vec3 d = lights_.distant.sample(*distantProposal_,
                                              {(float(n) + jitter(seed, n)) / float(total), r2Point(n, shift).y});
        queue(s, origin, d, 1e30f, -1, 0, gloss, matte);
    }
    for (int i = 0; i < cosineCount_; ++i) {
        const Vec3 local =
            cosineHemisphere(r2Point(index * uint32_t(cosineCount_) + uint32_t(i), randomShift(seed, 3, 0)));
        queue(s, origin, s.frame * local, 1e30f, -1, 0, gloss, matte);
    }
    for (size_t e : lights_.lit) {
        const EmitterSampler::Proposal* proposal = relit_.emitters[e].reaches(s.component)
                                                       ? lights_.emitters[e].prepare(s.position, s.normal, cuts_[e])
                                                       : nullptr;
        proposals_[e] = proposal;
        if (!proposal) continue;
        const EmitterSurface& surface = relit_.emitters[e].surface;
        const Vec2 turn = randomShift(seed, 2, e);
        const uint32_t all = uint32_t(options_.samplesPerPixel * emitterSamples_);
        for (int i = 0; i < emitterSamples_; ++i) {
            const uint32_t n = permuted(index, uint32_t(i), all);
            float density = 0;
            size_t t = 0;
            const Vec3 target = lights_.emitters[e].sample(
                *proposal, {(float(n) + jitter(seed + e + 1, n)) / float(all), r2Point(n, turn).y}, density, t);
            const Vec3 to = target - origin;
            const float distance = glm::length(to);
            if (!(distance > 2 * offset)) continue;
            const Vec3 d = to / distance;
            const float facing = -glm::dot(d, surface.normals[t]);
            if ((facing <= 1e-5f && !surface.twoSided) || glm::dot(d, s.normal) <= 0) continue;
            queue(s, origin, d, distance * (1 - 1e-4f) - 2 * offset, int(e),
                  density * distance * distance / std::max(std::abs(facing), 1e-5f), gloss, matte);
        }
    }
    flushShadow(s, gloss, matte);
    for (const auto& [k, w] : s.lobes)
        for (int i = 0; i < lobeCount_; ++i) {
            const Vec3 local = sampleGgx(s.eye, relit_.basis.lobes[k].alpha,
                                         r2Point(index * uint32_t(lobeCount_) + uint32_t(i), randomShift(seed, 4, k)));
            if (local.z > 0) queueClosest(s, origin, s.frame * local, gloss, matte);
        }
    flushClosest(s, gloss, matte);
}

void PointShader::addToFactors(const ShadedPoint& s, Gather& matte) const {
    if (s.triangle == Hit::none) return;
    const Triangle& t = relit_.scene.mesh.triangles[s.triangle];
    for (size_t e : lights_.lit) {
        const std::vector<float>& added = relit_.addedFactor[e];
        if (added.empty() || !relit_.emitters[e].reaches(s.component)) continue;
        const float factor = s.corners[0] * added[t[0]] + s.corners[1] * added[t[1]] + s.corners[2] * added[t[2]];
        matte.byEmitter[e] += factor * relit_.emitters[e].emission.level;
    }
}

void PointShader::whiteAt(uint32_t vertex, ShadedPoint& s) const {
    whiteAt(relit_.scene.mesh.positions[vertex], relit_.scene.mesh.normals[vertex], s);
    s.component = relit_.componentAt(vertex);
}

void PointShader::whiteAt(const Vec3& position, const Vec3& normal, ShadedPoint& s) {
    s = {};
    s.position = position;
    s.normal = s.geometric = s.towardEye = normal;
    s.frame = frameAround(s.normal);
    s.eye = Vec3(0, 0, 1);
    s.albedo = Rgb(1);
}

Rgb PointShader::lobesTimesCosine(const ShadedPoint& s, const Vec3& light) const {
    Rgb f(0);
    if (light.z <= 0) return f;
    for (const auto& [k, w] : s.lobes) f += w * evaluateLobe(relit_.basis.lobes[k], light, s.eye);
    return f * light.z;
}

void PointShader::add(const ShadedPoint& s, const Vec3& light, const Rgb& radiance, float density, Rgb& gloss,
                      Rgb& matte) const {
    // A direction on the rim of its cell may round into a black neighbour, which is never drawn and sends nothing.
    if (!(density > 0) || light.z <= 0) return;
    const Rgb arriving = radiance / density;
    if (!s.lobes.empty()) gloss += lobesTimesCosine(s, light) * arriving;
    matte += arriving * (light.z / pi);
}

float PointShader::lobeDensity(const ShadedPoint& s, const Vec3& light) const {
    float d = 0;
    for (const auto& [k, w] : s.lobes)
        d += float(lobeCount_) * ggxSampleDensity(light, s.eye, relit_.basis.lobes[k].alpha);
    return d;
}

float PointShader::distantDensity(const Vec3& direction, float cosine) const {
    return (distantProposal_ ? float(distantCount_) * lights_.distant.density(*distantProposal_, direction) : 0.0f) +
           float(cosineCount_) * std::max(0.0f, cosine) / pi;
}

void PointShader::queue(const ShadedPoint& s, const Vec3& origin, const Vec3& d, float far, int emitter, float density,
                        Gather& gloss, Gather& matte) {
    if (glm::dot(d, s.geometric) <= 0 || glm::dot(d, s.normal) <= 0 || far <= 0) return;
    rays_[count_] = {origin, d, 0, far};
    emitter_[count_] = emitter;
    density_[count_++] = density;
    if (count_ == 8) flushShadow(s, gloss, matte);
}

void PointShader::flushShadow(const ShadedPoint& s, Gather& gloss, Gather& matte) {
    if (!count_) return;
    const uint32_t blocked = relit_.scene.tracer->occluded8({rays_, size_t(count_)});
    for (int i = 0; i < count_; ++i) {
        // Samples of lobes never meet a sun, and they end at what a light without shadows passes through.
        const bool alone = emitter_[i] >= 0 && byAreaAlone(size_t(emitter_[i]));
        if ((blocked >> i & 1) && (emitter_[i] < 0 || relit_.emitters[size_t(emitter_[i])].shadows)) continue;
        const Vec3 light = glm::transpose(s.frame) * rays_[i].direction;
        const float other = alone ? 0 : lobeDensity(s, light);
        if (emitter_[i] < 0) {
            add(s, light, relit_.distant->radiance(rays_[i].direction),
                distantDensity(rays_[i].direction, light.z) + other, gloss.world, matte.world);
        } else {
            const size_t e = size_t(emitter_[i]);
            add(s, light, emitted(e, rays_[i], rays_[i].far), float(emitterSamples_) * density_[i] + other,
                gloss.byEmitter[e], matte.byEmitter[e]);
        }
    }
    count_ = 0;
}

void PointShader::queueClosest(const ShadedPoint& s, const Vec3& origin, const Vec3& d, Gather& gloss, Gather& matte) {
    if (glm::dot(d, s.geometric) <= 0) return;
    rays_[count_++] = {origin, d, 0, 1e30f};
    if (count_ == 8) flushClosest(s, gloss, matte);
}

void PointShader::flushClosest(const ShadedPoint& s, Gather& gloss, Gather& matte) {
    if (!count_) return;
    Hit hits[8];
    relit_.scene.tracer->closest8({rays_, size_t(count_)}, {hits, size_t(count_)});
    for (int i = 0; i < count_; ++i) {
        const Vec3 light = glm::transpose(s.frame) * rays_[i].direction;
        const float own = lobeDensity(s, light);
        if (!hits[i]) {
            if (!distantCount_) continue;
            add(s, light, relit_.distant->radiance(rays_[i].direction),
                distantDensity(rays_[i].direction, light.z) + own, gloss.world, matte.world);
            continue;
        }
        const int e = relit_.emitterOfTriangle[hits[i].triangle];
        if (e < 0) {
            const BouncedLight& bounced = relit_.bounced;
            if (bounced.empty() || !(own > 0) ||
                glm::dot(relit_.scene.mesh.faceNormal(hits[i].triangle), rays_[i].direction) >= 0)
                continue;
            // Reflections of other surfaces: what these send by reflecting light, as matte ones do.
            const Rgb f = lobesTimesCosine(s, light) / own;
            const Triangle& t = relit_.scene.mesh.triangles[hits[i].triangle];
            const Vec2 b = hits[i].barycentric;
            const float corners[3] = {1 - b.x - b.y, b.x, b.y};
            for (size_t k = 0; k < 3; ++k) {
                gloss.world += f * corners[k] * bounced.outgoingWorld[t[k]];
                for (size_t l : lights_.lit) gloss.byEmitter[l] += f * corners[k] * bounced.outgoingByEmitter[l][t[k]];
            }
            continue;
        }
        const RelitEmitter& emitter = relit_.emitters[size_t(e)];
        if (emitter.emission.dark() || byAreaAlone(size_t(e)) || !emitter.reaches(s.component)) continue;
        const float facing = -glm::dot(relit_.scene.mesh.faceNormal(hits[i].triangle), rays_[i].direction);
        if (facing <= 1e-5f && !emitter.surface.twoSided) continue;
        const EmitterSampler::Proposal* proposal = proposals_[size_t(e)];
        const float area =
            proposal ? lights_.emitters[size_t(e)].areaDensity(*proposal, lights_.triangleOnEmitter[hits[i].triangle],
                                                               rays_[i].origin + hits[i].distance * rays_[i].direction)
                     : 0.0f;
        const float density =
            float(emitterSamples_) * area * hits[i].distance * hits[i].distance / std::max(std::abs(facing), 1e-5f) +
            own;
        add(s, light, emitted(size_t(e), rays_[i], hits[i].distance), density, gloss.byEmitter[size_t(e)],
            matte.byEmitter[size_t(e)]);
    }
    count_ = 0;
}

}  // namespace relamp
