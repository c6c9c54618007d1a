// Shadows of an inexact mesh end at the wrong place: what the light is beside their edges is not known.
#pragma once
#include "scene/scene.h"
#include "solve/gloss/matte.h"
#include "solve/state/irradiance.h"

namespace relamp {

/// `irradiance` with a standard deviation that knows of shadows. Light that fades smoothly is a quadratic over the
/// observed vertices up to three mesh edges away (each 0.6 % of the diagonal at most, 5.7 degrees). With g twice the
/// largest residual of that quadratic, the deviation gains 2 g^2 / (g + irradiance), and 1 % of the median irradiance
/// for what the model leaves out (docs/method.md 5.4). O(mesh edges).
Irradiance unsureAtShadows(const Scene& scene, const MatteObservations& matte, Irradiance irradiance);

}  // namespace relamp
