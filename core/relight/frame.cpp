#include "relight/frame.h"

#include "base/parallel.h"
#include "base/random.h"

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

class Shader {
public:
    Shader(const RelitScene& relit, const FrameOptions& options) : relit_(relit), options_(options) {
        for (size_t e = 0; e < relit.emitters.size(); ++e)
            if (maxChannel(relit.emitters[e].radiance) > 0 && relit.emitters[e].surface.area() > 0) lit_.push_back(e);
    }

    bool surfaceAt(const Hit& hit, const Vec3& direction, Surface& s) const {
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
        return true;
    }

    /// Light of sample `index` of the pixel with the given shift.
    void gather(const Surface& s, uint32_t index, uint64_t seed, Gather& out) const {
        const float offset = relit_.scene.tracer->surfaceOffset() * 4;
        const Vec3 origin = s.position + s.geometric * offset;
        count_ = 0;
        const DistantLight& distant = *relit_.distant;
        const bool matte = maxChannel(s.albedo) > 0;
        const int fromDistant = distant.black() ? 0 : options_.distantSamples;
        const int fromCosine = matte ? options_.lobeSamples : 0;
        // Towards the environment.
        for (int i = 0; i < fromDistant; ++i) {
            const Vec3 d = distant.sample(r2Point(index * uint32_t(fromDistant) + uint32_t(i), randomShift(seed, 1, 0)));
            queue(s, origin, d, 1e30f, -1, out);
        }
        // Towards each emitter, by area.
        for (size_t e : lit_) {
            const EmitterSurface& surface = relit_.emitters[e].surface;
            for (int i = 0; i < options_.emitterSamples; ++i) {
                const uint32_t n = index * uint32_t(options_.emitterSamples) + uint32_t(i);
                const Vec2 u = r2Point(n, randomShift(seed, 2, e));
                const uint32_t total = uint32_t(options_.samplesPerPixel * options_.emitterSamples);
                const float pick = (float(n) + unitFloat(mixBits(seed ^ (e * 977 + 5)))) / float(total);
                const float area = (pick - std::floor(pick)) * surface.area();
                const size_t t = std::min(size_t(std::upper_bound(surface.cumulativeArea.begin(), surface.cumulativeArea.end(), area) - surface.cumulativeArea.begin()), surface.areas.size() - 1);
                const float root = std::sqrt(u.x);
                const auto& c = surface.corners[t];
                const Vec3 target = (1 - root) * c[0] + root * (1 - u.y) * c[1] + root * u.y * c[2];
                const Vec3 to = target - origin;
                const float distance = glm::length(to);
                if (!(distance > 2 * offset)) continue;
                const Vec3 d = to / distance;
                const float facing = -glm::dot(d, surface.normals[t]);
                if (facing <= 1e-5f && !surface.twoSided) continue;
                if (glm::dot(d, s.normal) <= 0) continue;
                areaDensity_ = distance * distance / (std::max(std::abs(facing), 1e-5f) * surface.area());
                queue(s, origin, d, distance * (1 - 1e-4f) - 2 * offset, int(e), out);
            }
        }
        flushShadow(s, out);
        // From the reflectance itself.
        for (int i = 0; i < fromCosine; ++i) {
            const Vec3 local = cosineHemisphere(r2Point(index * uint32_t(fromCosine) + uint32_t(i), randomShift(seed, 3, 0)));
            queueClosest(s, origin, s.frame * local, out);
        }
        for (const auto& [k, w] : s.lobes)
            for (int i = 0; i < options_.lobeSamples; ++i) {
                const Vec3 local = sampleGgx(s.eye, relit_.basis.lobes[k].alpha, r2Point(index * uint32_t(options_.lobeSamples) + uint32_t(i), randomShift(seed, 4, k)));
                if (local.z > 0) queueClosest(s, origin, s.frame * local, out);
            }
        flushClosest(s, out);
    }

private:
    const RelitScene& relit_;
    const FrameOptions& options_;
    std::vector<size_t> lit_;
    // A packet being filled; one shader a thread.
    mutable Ray rays_[8];
    mutable int emitter_[8];
    mutable float areaOf_[8];
    mutable int count_ = 0;
    mutable float areaDensity_ = 0;

    Rgb reflectanceTimesCosine(const Surface& s, const Vec3& light) const {
        if (light.z <= 0) return Rgb(0);
        Rgb f = s.albedo / pi;
        for (const auto& [k, w] : s.lobes) f += w * evaluateLobe(relit_.basis.lobes[k], light, s.eye);
        return f * light.z;
    }
    /// Sum of count x density of the sampling of the reflectance.
    float reflectanceDensity(const Surface& s, const Vec3& light) const {
        float d = maxChannel(s.albedo) > 0 ? float(options_.lobeSamples) * std::max(0.0f, light.z) / pi : 0.0f;
        for (const auto& [k, w] : s.lobes) d += float(options_.lobeSamples) * ggxSampleDensity(light, s.eye, relit_.basis.lobes[k].alpha);
        return d;
    }
    void queue(const Surface& s, const Vec3& origin, const Vec3& d, float far, int emitter, Gather& out) const {
        if (glm::dot(d, s.geometric) <= 0 || far <= 0) return;
        rays_[count_] = {origin, d, 0, far};
        emitter_[count_] = emitter;
        areaOf_[count_++] = areaDensity_;
        if (count_ == 8) flushShadow(s, out);
    }
    void flushShadow(const Surface& s, Gather& out) const {
        if (!count_) return;
        const uint32_t blocked = relit_.scene.tracer->occluded8({rays_, size_t(count_)});
        for (int i = 0; i < count_; ++i) {
            if (blocked >> i & 1) continue;
            const Vec3 light = glm::transpose(s.frame) * rays_[i].direction;
            const Rgb f = reflectanceTimesCosine(s, light);
            const float other = reflectanceDensity(s, light);
            if (emitter_[i] < 0) {
                out.world += f * relit_.distant->radiance(rays_[i].direction) / (float(options_.distantSamples) * relit_.distant->density(rays_[i].direction) + other);
            } else {
                const RelitEmitter& e = relit_.emitters[size_t(emitter_[i])];
                out.byEmitter[size_t(emitter_[i])] += f * e.radiance / (float(options_.emitterSamples) * areaOf_[i] + other);
            }
        }
        count_ = 0;
    }
    void queueClosest(const Surface& s, const Vec3& origin, const Vec3& d, Gather& out) const {
        if (glm::dot(d, s.geometric) <= 0) return;
        rays_[count_++] = {origin, d, 0, 1e30f};
        if (count_ == 8) flushClosest(s, out);
    }
    void flushClosest(const Surface& s, Gather& out) const {
        if (!count_) return;
        Hit hits[8];
        relit_.scene.tracer->closest8({rays_, size_t(count_)}, {hits, size_t(count_)});
        for (int i = 0; i < count_; ++i) {
            const Vec3 light = glm::transpose(s.frame) * rays_[i].direction;
            if (!hits[i]) {
                if (relit_.distant->black()) continue;
                const float density = float(options_.distantSamples) * relit_.distant->density(rays_[i].direction) + reflectanceDensity(s, light);
                if (density > 0) out.world += reflectanceTimesCosine(s, light) * relit_.distant->radiance(rays_[i].direction) / density;
                continue;
            }
            const int e = relit_.emitterOfTriangle[hits[i].triangle];
            if (e < 0 || maxChannel(relit_.emitters[size_t(e)].radiance) <= 0) continue;
            const RelitEmitter& emitter = relit_.emitters[size_t(e)];
            const float facing = -glm::dot(relit_.scene.mesh.faceNormal(hits[i].triangle), rays_[i].direction);
            if (facing <= 1e-5f && !emitter.surface.twoSided) continue;
            const float area = hits[i].distance * hits[i].distance / (std::max(std::abs(facing), 1e-5f) * emitter.surface.area());
            const float density = float(options_.emitterSamples) * area + reflectanceDensity(s, light);
            out.byEmitter[size_t(e)] += reflectanceTimesCosine(s, light) * emitter.radiance / density;
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
    progress.begin("Frame", size_t(frame.height));
    parallelBlocks(size_t(frame.height), 2, [&](size_t begin, size_t end) {
        const Shader shader(relit, options);
        Surface surface;
        Gather gather;
        for (size_t y = begin; y < end; ++y)
            for (int x = 0; x < frame.width; ++x) {
                const size_t p = y * size_t(frame.width) + size_t(x);
                const uint64_t seed = mixBits(options.seed * 0x9e37 + p);
                gather.world = Rgb(0);
                gather.byEmitter.assign(emitters, Rgb(0));
                for (int i = 0; i < options.samplesPerPixel; ++i) {
                    const Vec2 inside = r2Point(uint32_t(i), randomShift(seed, 0, 0));
                    const Vec3 d = camera.rayDirection(Vec2(float(x), float(y)) + inside);
                    const Hit hit = relit.scene.tracer->closest({origin, d, 0, 1e30f});
                    if (!hit) {
                        if (options.background) gather.world += relit.distant->radiance(d);
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
