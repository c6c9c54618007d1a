// How places move in a photograph as they or its camera move.
#pragma once
#include <Eigen/Core>
#include <array>
#include <optional>

#include "capture/camera.h"

namespace relamp {

/// Change of the position in the photograph, x then y, as a world point moves along the camera's axes, pixels per
/// metre. None where the camera does not see the point.
std::optional<std::array<float, 6>> pixelsByPoint(const Camera& camera, const DVec3& point);

/// The same as the camera turns (radians) and shifts (in units of `depth`, metres) along its axes. `byPoint`: see
/// pixelsByPoint.
Eigen::Matrix<double, 2, 6> pixelsByPose(const Camera& camera, const DVec3& point, const std::array<float, 6>& byPoint,
                                         double depth);

}  // namespace relamp
