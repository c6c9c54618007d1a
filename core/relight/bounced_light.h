// Light that surfaces send each other in an edited scene, by where it came from first (docs/method.md 8).
#pragma once
#include "base/progress.h"
#include "brdf/basis.h"
#include "transport/bounce.h"

namespace relamp {

struct RelitScene;

/// Per vertex, radiance: `world`, `byEmitter` as a white matte surface there shows it; `outgoing...` what the vertex
/// itself sends by reflection, direct light included. Every source apart, so that light groups add up.
struct BouncedLight {
    std::vector<Rgb> world, outgoingWorld;
    std::vector<std::vector<Rgb>> byEmitter, outgoingByEmitter;
    bool empty() const { return world.empty(); }
};

/// Albedo by which a vertex passes light on: its matte part and what its lobes reflect of even light
/// (hemisphericalAlbedo). Emitters only emit.
std::vector<Rgb> bouncingAlbedo(const BrdfBasis& basis, const std::vector<std::vector<Rgb>>& weight,
                                const std::vector<uint8_t>& emitting);

/// All bounces from the direct light of each source (`directByEmitter` may have empty entries: emitters that are off).
BouncedLight bouncedLight(const BounceRays& rays, const std::vector<Rgb>& albedo, const std::vector<Rgb>& directWorld,
                          const std::vector<std::vector<Rgb>>& directByEmitter);

struct BouncedLightOptions {
    int samples = 4;  ///< positions of the sample pattern a vertex, each towards the environment and every emitter
    BounceOptions rays;
};

/// The same for a whole edited scene: direct light is sampled at every vertex. Cost: about 0.1 ms a vertex and core.
/// Throws Cancelled.
BouncedLight bouncedLightOf(const RelitScene& relit, const BouncedLightOptions& options, Progress& progress);

}  // namespace relamp
