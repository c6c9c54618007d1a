// The circle in which a shade ends: place, tilt and radii, from where photographs show its edges.
#pragma once
#include <optional>

#include "capture/capture.h"
#include "scene/revolution_surface.h"

namespace relamp {

/// The circle near `start` that agrees best with the steps that photographs show across it: Gauss-Newton on distances
/// in pixels (Huber). Views that look into the opening tell its inner edge, all others the outer one. `low`: the rim is
/// the surface's lower end. `floor`: radiance that counts as dark. A radius of which fewer than 20 places tell is 0.
/// None where fewer than 40 places show a step, or where the median distance is not less than at the start. O(views x
/// places).
std::optional<RimCircle> fitRimCircle(const Capture& capture, const Scene& scene, const RimCircle& start, bool low,
                                      float floor);

}  // namespace relamp
