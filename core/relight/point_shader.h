// Light that reaches one surface point and leaves it towards the eye: sampled directions, weighted by multiple
// importance sampling. What frames and bounced light are made of.
#pragma once
#include "base/random.h"
#include "relight/distant_sampler.h"
#include "relight/emitter_sampler.h"
#include "relight/frame.h"

namespace relamp {

/// A shaded surface point.
struct ShadedPoint {
    Vec3 position, normal, geometric, towardEye;
    Mat3 frame;
    Vec3 eye;  ///< towardEye in the frame
    Rgb albedo;
    std::vector<std::pair<size_t, Rgb>> lobes;  ///< glossy lobes present
    uint32_t triangle = Hit::none;  ///< with the barycentric weights of its corners: where bounced light is read
    Vec3 corners{0};                ///< all 0 on the back of a surface: none is known there
    uint32_t component = EditedPart::none;  ///< as RelitScene::component
};

/// Radiance by where it came from.
struct Gather {
    Rgb world{0};
    std::vector<Rgb> byEmitter;
    void clear(size_t emitters) {
        world = Rgb(0);
        byEmitter.assign(emitters, Rgb(0));
    }
};

/// The lights of a scene with their samplers: what all threads share.
struct SceneLights {
    const RelitScene& relit;
    DistantSampler distant;
    std::vector<EmitterSampler> emitters;
    std::vector<size_t> lit;                  ///< emitters that shine
    std::vector<uint32_t> triangleOnEmitter;  ///< mesh triangle -> index on its emitter's surface
    explicit SceneLights(const RelitScene& scene);
};

/// Shades points; one a thread.
class PointShader {
public:
    PointShader(const SceneLights& lights, const FrameOptions& options);

    /// The point that a ray along `direction` met, ready for gather(). `spread`: as RelitScene::albedoAt has it.
    void surfaceAt(const Hit& hit, const Vec3& direction, float spread, ShadedPoint& s) const;

    /// A white matte point at a vertex of the scene, and one anywhere.
    void whiteAt(uint32_t vertex, ShadedPoint& s) const;
    static void whiteAt(const Vec3& position, const Vec3& normal, ShadedPoint& s);

    /// Light at position `index` of the pixel's samplesPerPixel; sample numbers are stratified over the whole pixel.
    /// Adds to `gloss` what lobes reflect, and to `matte` what a white matte surface would: times s.albedo it is the
    /// rest.
    void gather(const ShadedPoint& s, uint32_t index, uint64_t seed, Gather& gloss, Gather& matte);

private:
    const SceneLights& lights_;
    const RelitScene& relit_;
    const FrameOptions& options_;
    int emitterSamples_ = 1, distantCount_ = 0, cosineCount_ = 0, lobeCount_ = 0;
    std::vector<DistantSampler::Proposal> distantProposals_;     ///< found again by their normals
    const DistantSampler::Proposal* distantProposal_ = nullptr;  ///< of the point; null: no light arrives
    std::vector<EmitterSampler::Cuts> cuts_;                     ///< by emitter
    std::vector<const EmitterSampler::Proposal*> proposals_;     ///< of the point, by emitter; null: no light arrives
    // A packet being filled.
    Ray rays_[8];
    int emitter_[8];
    float density_[8];
    int count_ = 0;

    /// Number of sample i of position `index` among all of the pixel: positions take every samplesPerPixel-th one.
    uint32_t permuted(uint32_t index, uint32_t i, uint32_t total) const {
        return (i * uint32_t(options_.samplesPerPixel) + index) % total;
    }
    static float jitter(uint64_t seed, uint32_t n) { return unitFloat(mixBits(seed * 0x2545f491 + n)); }

    /// For a normal within a degree and a half; it depends on the normal alone. Null: no light can arrive.
    const DistantSampler::Proposal* distantProposalFor(const Vec3& normal);
    /// Samples of its surface alone bring its light; those of lobes do not.
    bool byAreaAlone(size_t emitter) const {
        return relit_.emitters[emitter].sunDegrees > 0 || !relit_.emitters[emitter].shadows;
    }
    /// Radiance of an emitter that `ray` meets after `distance`.
    Rgb emitted(size_t emitter, const Ray& ray, float distance) const {
        return relit_.emitters[emitter].emission.radiance(-ray.direction, ray.origin + distance * ray.direction);
    }
    /// Adds light of `radiance` that samples of this density bring from the direction `light`.
    void add(const ShadedPoint& s, const Vec3& light, const Rgb& radiance, float density, Rgb& gloss, Rgb& matte) const;
    /// What the emitters' form factors lack at the point.
    void addToFactors(const ShadedPoint& s, Gather& matte) const;
    Rgb lobesTimesCosine(const ShadedPoint& s, const Vec3& light) const;
    /// Sum of count x density of the samples drawn from the lobes.
    float lobeDensity(const ShadedPoint& s, const Vec3& light) const;
    /// Sum of count x density of the samples drawn for the environment.
    float distantDensity(const Vec3& direction, float cosine) const;
    void queue(const ShadedPoint& s, const Vec3& origin, const Vec3& d, float far, int emitter, float density,
               Gather& gloss, Gather& matte);
    void flushShadow(const ShadedPoint& s, Gather& gloss, Gather& matte);
    void queueClosest(const ShadedPoint& s, const Vec3& origin, const Vec3& d, Gather& gloss, Gather& matte);
    void flushClosest(const ShadedPoint& s, Gather& gloss, Gather& matte);
};

}  // namespace relamp
