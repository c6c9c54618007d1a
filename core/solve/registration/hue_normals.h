// Normals that the hue of the light tells: where a red emitter and a blue sky light a surface of one colour, its hue
// says how it is turned.
#pragma once
#include <vector>

#include "base/math.h"
#include "scene/scene.h"

namespace relamp {

/// A vertex as it looks with the mesh's normal.
struct HueSample {
    uint32_t vertex = 0;
    Rgb albedo{0};     ///< radiance over irradiance, above 0
    float sigma = 0;   ///< of the photographs: relative standard deviation of a channel
    Vec3 tangents[2];  ///< unit, at right angles to the normal and each other
    Rgb change[2];     ///< of the logarithm of irradiance as the normal leans towards either, per radian

    /// Logarithm of what albedo is with the normal leant, over what it is without.
    Rgb after(const Vec2& lean) const { return -lean.x * change[0] - lean.y * change[1]; }
};

/// By how much normals lean towards their tangents, radians, per sample. Hue, the differences of two channels'
/// logarithms, is h = a + J d: that of the surface, smooth but for borders of materials, and what the lean d makes of
/// it. Without d, whose deviation is 3 degrees, a is found by reweighted least squares (Gauss-Seidel), and d is the
/// mean of what is left. Leans are those of relief that a reconstruction has smoothed away, so over 2 % of the diagonal
/// their mean is none. O(samples x neighbours).
std::vector<Vec2> hueLeans(const Scene& scene, const std::vector<HueSample>& samples);

}  // namespace relamp
