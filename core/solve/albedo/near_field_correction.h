// Light of emitters that an inexact mesh gets wrong close to them: a screen that hangs off its wall becomes a bump of
// it, and the light from the gap would be taken for a brighter wall.
#pragma once
#include "base/progress.h"
#include "scene/scene.h"
#include "solve/estimate.h"
#include "solve/gloss/matte.h"
#include "solve/state/irradiance.h"
#include "transport/near_field.h"

namespace relamp {

struct NearFieldCorrectionInput {
    const Scene& scene;
    const MatteObservations& matte;
    const Irradiance& irradiance;
    const NearField& nearField;
    const EmitterClusters& emitters;
    const std::vector<Rgb>& radiance;  ///< of the emitters
    float meshError = 0;               ///< metres
};

/// Form factors are wrong by about the fraction meshError / distance of what the emitter covers. Within that, they are
/// chosen such that log albedo has the least total variation over the mesh: light is smooth where albedo is not, and
/// albedo does not know where the emitters are. Reweighted least squares on the vertices that it may matter for, one
/// emitter each. Empty where the variation falls by less than a fifth. Throws Cancelled. O(v^1.5) for v such vertices.
NearFieldCorrection correctNearField(const NearFieldCorrectionInput& input, Progress& progress);

/// Adds to the irradiance of observations what the correction adds. `levels`: of the emitters in each lighting state;
/// empty: there is one.
void addCorrection(const NearFieldCorrection& correction, const MatteObservations& matte,
                   const std::vector<Rgb>& radiance, const EmitterLevels& levels, Irradiance& irradiance);

}  // namespace relamp
