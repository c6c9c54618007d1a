// Directions from one vertex that every observation of it shares, whatever the lobe and wherever the eye.
#pragma once
#include <span>

#include "transport/incident.h"

namespace relamp {

/// What a direction from a vertex meets, in one lighting state.
struct MetLight {
    static constexpr uint32_t none = ~0u;
    Vec3 local{0};           ///< the direction, z along the normal
    uint32_t column = none;  ///< leaf or emitter whose light comes from there
    float level = 0;         ///< of that light: the background's shape in the leaf, or the emitter's profile
    float areaDensity = 0;   ///< of samples of the emitter in that direction, all of them together; 0: no emitter
    Rgb outgoing{0};         ///< radiance of other surfaces, by LobeRowOptions::outgoing
};

/// Of one vertex and state. The cosine and the emitters are sampled once for all its observations: of four views three
/// need neither these rays nor what they meet.
struct SharedDirections {
    uint32_t vertex = 0;
    Mat3 frame{1};
    Vec3 origin{0};
    std::vector<float> formFactor;   ///< per emitter, unshadowed
    std::vector<MetLight> emitters;  ///< samples of them that are visible; `level` holds what a sample stands for, too
    std::vector<MetLight> cosine;    ///< directions drawn from the cosine that meet light
};

/// Where rays from a vertex go to, and what they bring.
struct DirectionScene {
    const Scene& scene;
    const std::vector<EmitterSurface>& emitters;
    const std::vector<int>& emitterOfTriangle;
    const LightLeaves& leaves;
};

/// Cost: rows.cosineSamples rays, and rows.emitterSamples an emitter. `shared` is overwritten, so that its memory
/// serves again.
void drawSharedDirections(const DirectionScene& in, uint32_t vertex, const LobeRowOptions& rows,
                          SharedDirections& shared);

/// Light that directions drawn from GGX lobes of these widths (alpha) about the mirrored eye meet, `each` from every
/// one, added to `met` in their order. `eye` is local.
void drawFromLobes(const DirectionScene& in, const SharedDirections& shared, const Vec3& eye,
                   std::span<const float> widths, int each, size_t firstStream, const LobeRowOptions& rows,
                   std::vector<MetLight>& met);

/// glossyInfluence (transport/incident.h) from directions that are drawn already, with the same options.
void glossyInfluence(const DirectionScene& in, const SharedDirections& shared, const Lobe& lobe, const Vec3& towardEye,
                     const LobeRowOptions& options, float* row, Rgb* mirrored = nullptr);

}  // namespace relamp
