// Shadows of an inexact mesh end at the wrong place: what the light is beside their edges is not known.
#pragma once
#include "scene/scene.h"
#include "solve/gloss/matte.h"
#include "solve/state/irradiance.h"

namespace relamp {

/// `irradiance` with a standard deviation that knows of shadows. With g the largest difference of irradiance from that
/// of observed vertices up to three mesh edges away (each 0.6 % of the diagonal at most, 5.7 degrees), it gains
/// 2 g^2 / (g + irradiance), and 1 % of the median irradiance for what the model leaves out. Differences that the
/// surface's turn explains do not count: they are the same under any light (docs/method.md 5.4). O(mesh edges).
Irradiance unsureAtShadows(const Scene& scene, const MatteObservations& matte, Irradiance irradiance);

}  // namespace relamp
