// What a coated component shows of its matte part, once its coating is known: each observation less what the coating
// reflects in it.
#pragma once
#include "solve/gloss/gloss.h"

namespace relamp {

struct MatteUnderGlossOptions {
    float doubt =
        0.15f;  ///< relative error of what the coating is said to reflect: observations with much of it count less
    LobeRowOptions rows;
};

/// Replaces radiance and sigma of the observations on `gloss.component` by those of the observations less the coating's
/// part, gloss.weight x (lobe . light). What the lowest observations hold of the coating is else taken for albedo: 0.04
/// of a bright room is much on a dark colour. Observations of which nothing is left (median below a twentieth of what
/// was seen) stay as they are. Cost: one lobe row an observation.
void matteUnderGloss(const Capture& capture, const Scene& scene, const RadianceSamples& samples,
                     const std::vector<EmitterSurface>& emitters, const std::vector<int>& emitterOfTriangle,
                     const Lighting& lighting, const ComponentGloss& gloss, const MatteUnderGlossOptions& options,
                     MatteObservations& matte, Progress& progress);

}  // namespace relamp
