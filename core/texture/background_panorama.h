// The distant environment as photographs show it behind the scene, as fine as they do.
#pragma once
#include <memory>

#include "base/progress.h"
#include "capture/capture.h"
#include "image/panorama.h"
#include "radiance/samples.h"

namespace relamp {

/// Mosaic of what the views see past the mesh. Each direction is the view's that sees it farthest from its own edges
/// and from the mesh, blended where that changes; where no view sees it, what lies around goes over into `cells` (mean
/// radiance, on `grid`), which are evened out over some degrees.
/// Where a photograph is clipped the cells count if they are brighter. Views of other environments are left out.
/// `environment`: its number (RadianceSamples::environmentOf). Null where fewer than one direction in a thousand is
/// seen. Width: a pixel a texel, at most `mostWidth`. Cost: 0.1 to 1 s, 28 B a texel. Throws Cancelled.
std::shared_ptr<const Panorama> backgroundPanorama(const Capture& capture, const RadianceSamples& samples,
                                                  int environment, const std::vector<Rgb>& cells,
                                                  const DirectionGrid& grid, Progress& progress, int mostWidth = 4096);

}  // namespace relamp
