// Resection: a camera, or a projector, from points in space and the pixels where it has them.
#pragma once
#include <optional>
#include <string>

#include "base/progress.h"
#include "capture/camera.h"

namespace relamp {

struct SeenPoint {
    DVec3 point;       ///< metres
    glm::dvec2 pixel;  ///< the first pixel's centre at (0.5, 0.5)
};

struct Resection {
    std::optional<Camera> camera;  ///< with OpenCV's k1 k2 p1 p2; none: see `reason`
    std::string reason;
    size_t points = 0;       ///< that fit within three standard deviations
    double median = 0;       ///< distance between pixel and projected point, pixels
    double rms = 0;          ///< of the points that fit
    DVec3 positionSigma{0};  ///< metres
};

/// Direct linear transform [HartleyZisserman04], repeated without what fits badly; then Levenberg-Marquardt steps on
/// focal lengths, principal point, distortion, and pose, with Huber's weights. Lens terms are held near those of a
/// usual lens where the points do not tell them. At most 6000 points are used, evenly spread. Points in a plane, in a
/// line, behind the camera, or too few are reasons, not errors. Cost: 0.1 s. Throws Cancelled.
Resection resect(const std::vector<SeenPoint>& points, int width, int height, Progress& progress);

}  // namespace relamp
