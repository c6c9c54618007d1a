// Albedo as it stands, and the prior it is solved with.
#pragma once
#include "solve/albedo/albedo_step.h"
#include "solve/albedo/palette.h"

namespace relamp {

struct SurfaceState {
    AlbedoResult albedo;
    AlbedoPrior prior;
    Palette palette;  ///< empty without one
    PriorStrength smoothness;

    void take(const PriorStrength& strength, const AlbedoPrior& usual) {
        prior.step = usual.step / std::sqrt(strength.factor);
        smoothness = strength;
    }
};

}  // namespace relamp
