// What leaves an emitter, by direction and place: the one function that frames and the viewport ask for emitted
// radiance.
#pragma once
#include "base/math.h"

namespace relamp {

/// Constant today: every emitter is Lambertian and even. A spot's cone or an IES profile belongs into `radiance`; the
/// viewport, which multiplies form factors with `level`, must then weigh them too (relight/live/near).
struct EmissionProfile {
    Rgb level{0};  ///< radiance where the profile is 1, after power scale; 0 when off
    /// Radiance from `point` of the surface, scene units, into the unit direction `away` from it.
    Rgb radiance(const Vec3& away, const Vec3& point) const {
        static_cast<void>(away), static_cast<void>(point);
        return level;
    }
    bool dark() const { return !(maxChannel(level) > 0); }
};

}  // namespace relamp
