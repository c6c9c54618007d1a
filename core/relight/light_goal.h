// Lights from what they shall do (docs/method.md 7, [Schoeneman93]): an artist says how bright some points are to be,
// and powers and colours of chosen lights are solved for. The transport is known, so this is a small linear problem.
#pragma once
#include <vector>

#include "base/math.h"

namespace relamp {

/// Points with the radiance they are to have, and what lights send to the eye there now. One entry a point.
struct LightGoal {
    std::vector<float> weight;               ///< how much the point counts, 0 or more
    std::vector<Rgb> target;                 ///< radiance wanted
    std::vector<Rgb> rest;                   ///< radiance from all that may not change
    std::vector<std::vector<Rgb>> response;  ///< per light that may change: radiance from it at scale 1
    std::vector<Rgb> present;                ///< per light: the scale that it has now

    size_t points() const { return weight.size(); }
    size_t lights() const { return response.size(); }
};

struct LightGoalOptions {
    bool colour = true;  ///< channels by themselves; false: each light keeps its colour
    /// How much a light stays as it is: the squared error that a change of its scale by 1 costs, in parts of what its
    /// own light at the points adds up to.
    float keep = 1e-3f;
};

struct LightGoalAnswer {
    std::vector<Rgb> scale;  ///< per light, 0 or more
    /// Error over wanted radiance, root of the weighted mean square.
    float before = 0, after = 0;
    /// Fractions of the weight that stay too dark, and too bright, by more than a tenth and 0.02 of the mean target.
    float tooDark = 0, tooBright = 0;
};

/// Non-negative least squares of relative errors, by the normal equations. Cost: points x
/// lights^2. Throws Error when the lists differ in length or nothing counts.
LightGoalAnswer reachGoal(const LightGoal& goal, const LightGoalOptions& options = {});

}  // namespace relamp
