// A straight round tube: what holds an emitter up.
#pragma once
#include "base/math.h"

namespace relamp {

struct StraightTube {
    DVec3 through{0};         ///< on its axis, metres
    glm::dmat3 axes{1};       ///< the first along it
    double radius = 0;        ///< metres
    double from = 0, to = 0;  ///< where it begins and ends: metres along it from `through`

    double at(const DVec3& p) const { return glm::dot(p - through, axes[0]); }
    /// Distance of a point from the axis, metres.
    double off(const DVec3& p) const { return glm::length(p - through - at(p) * axes[0]); }
    DVec3 onAxis(double along) const { return through + along * axes[0]; }
    /// Of the surface, at an angle around the axis.
    DVec3 onSurface(double along, double turn) const {
        return onAxis(along) + radius * (std::cos(turn) * axes[1] + std::sin(turn) * axes[2]);
    }
};

}  // namespace relamp
