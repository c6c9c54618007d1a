// An estimate with a look applied: moved geometry, emitters with their radiance, the environment to use. What frames and the
// viewport shade.
#pragma once
#include <memory>

#include "base/progress.h"
#include "relight/distant_light.h"
#include "relight/look.h"
#include "scene/scene.h"
#include "solve/estimate.h"
#include "transport/near_field.h"

namespace relamp {

struct RelitEmitter {
    std::string id;
    EmitterSurface surface;
    Rgb radiance{0};          ///< after power scale; 0 when off
};

struct RelitScene {
    Scene scene;                              ///< with moved and added geometry
    std::vector<int> emitterOfTriangle;       ///< index into emitters, -1: none
    std::vector<RelitEmitter> emitters;       ///< recovered ones in order, then added ones
    std::vector<std::vector<Rgb>> weight;     ///< per lobe, per vertex of `scene`
    BrdfBasis basis;
    std::shared_ptr<const DistantLight> distant;
};

/// `scene` is the capture's. Cost: a rebuild of the ray tracer when something moved (tens of ms). Throws Error naming an
/// unknown emitter id, a part's vertex out of range, or an unreadable environment file.
RelitScene applyLook(const Scene& scene, const Estimate& estimate, const Look& look, Progress& progress);

}  // namespace relamp
