// The door of room 3: photographs and geometry become observations.
#pragma once
#include "base/progress.h"
#include "capture/capture.h"
#include "radiance/samples.h"
#include "scene/scene.h"

namespace relamp {

struct GatherOptions {
    float grazingCosine = 0.12f;   ///< looks at a steeper grazing angle are dropped
    bool ownEnvironments = false;  ///< each lighting state has a distant light of its own, whatever the capture says
};

/// For each vertex and view: projected, tested for occlusion, looked up among the pixels that see the same surface,
/// over as much of the vertex's footprint as looks alike (docs/method.md 3). Pixels that see no geometry observe the
/// environment. The noise level is estimated from pixel differences. Cost: one ray a pixel and one a vertex and view.
RadianceSamples gatherRadiance(const Capture& capture, const Scene& scene, const GatherOptions& options,
                               Progress& progress);

}  // namespace relamp
