// What a first look for an emitter that no photograph shows finds (unobserved_light.h).
#pragma once
#include <string>

#include "base/math.h"

namespace relamp {

/// A place from which a small light would explain shading.
struct SuspectedLight {
    DVec3 position{0};     ///< metres, in the capture's own coordinates
    double gain = 0;       ///< fraction of the misfit of shading that it explains
    double certainty = 0;  ///< of the gain, in standard errors
    double fraction = 0;   ///< of the light on the surfaces
};

/// "A light that no photograph shows may stand near 0.17 0.02 0.72: ...", a sentence.
std::string inWords(const SuspectedLight& light);

}  // namespace relamp
