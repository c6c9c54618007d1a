// The axes along which points spread.
#pragma once
#include <vector>

#include "base/math.h"

namespace relamp {

/// Principal axes of points, longest first, right-handed. O(points).
glm::dmat3 principalAxes(const std::vector<DVec3>& points);

}  // namespace relamp
