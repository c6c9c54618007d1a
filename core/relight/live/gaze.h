// What the image of an eye cannot show: a drag leaves its light for later.
#pragma once
#include "base/math.h"

namespace relamp {

/// The cone about an image; the default one misses nothing.
struct Gaze {
    Vec3 position{0}, forward{0, 1, 0};
    float inside = -2;  ///< cosine of half the cone's opening; below -1: there is none

    /// Outside the cone, or a surface that faces away by so much that no triangle at the vertex can be seen.
    bool misses(const Vec3& point, const Vec3& normal) const {
        if (inside < -1) return false;
        const Vec3 to = position - point;
        const float distance = glm::length(to);
        return glm::dot(to, normal) < -0.3f * distance || -glm::dot(to, forward) < inside * distance;
    }
};

}  // namespace relamp
