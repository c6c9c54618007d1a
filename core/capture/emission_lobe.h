// How the radiance of an emitter depends on the direction it leaves in.
#pragma once
#include <cmath>

#include "base/math.h"

namespace relamp {

/// A power of the cosine to an axis, 1 along it and 0 behind. On a flat surface Lambert's own cosine comes besides.
struct EmissionLobe {
    Vec3 axis{0, 0, -1};  ///< unit, world
    float power = 0;      ///< 0: alike in all directions
    bool even() const { return !(power > 0); }
    /// Into the unit direction `away` from the emitter.
    float at(const Vec3& away) const {
        if (even()) return 1;
        const float cosine = glm::dot(axis, away);
        return cosine > 0 ? std::pow(cosine, power) : 0.0f;
    }
    /// Half the angle of the cone outside which it sends less than half of its brightest radiance, degrees.
    float halfDegrees() const { return even() ? 180 : std::acos(std::pow(0.5f, 1 / power)) * (180 / pi); }
    bool operator==(const EmissionLobe&) const = default;
};

}  // namespace relamp
