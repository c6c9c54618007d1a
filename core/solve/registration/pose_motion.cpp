#include "solve/registration/pose_motion.h"

namespace relamp {

std::optional<std::array<float, 6>> pixelsByPoint(const Camera& camera, const DVec3& point) {
    const std::optional<Vec2> at = camera.project(point);
    if (!at) return {};
    const double step = 1e-3 * glm::length(point - camera.position());
    std::array<float, 6> result{};
    for (int k = 0; k < 3; ++k) {
        const std::optional<Vec2> moved = camera.project(point + step * DVec3(camera.worldFromCamera[k]));
        if (!moved) return {};
        result[size_t(k)] = (moved->x - at->x) / float(step);
        result[size_t(3 + k)] = (moved->y - at->y) / float(step);
    }
    return result;
}

Eigen::Matrix<double, 2, 6> pixelsByPose(const Camera& camera, const DVec3& point, const std::array<float, 6>& byPoint,
                                         double depth) {
    Eigen::Matrix<double, 2, 3> moves;
    moves << double(byPoint[0]), double(byPoint[1]), double(byPoint[2]), double(byPoint[3]), double(byPoint[4]),
        double(byPoint[5]);
    // The camera turned by w moves the point p by -w x p = p x w, shifted by t by -t.
    const DVec3 p = glm::transpose(glm::dmat3(camera.worldFromCamera)) * (point - camera.position());
    Eigen::Matrix3d cross;
    cross << 0, -p.z, p.y, p.z, 0, -p.x, -p.y, p.x, 0;
    Eigen::Matrix<double, 2, 6> result;
    result << moves * cross, -moves * depth;
    return result;
}

}  // namespace relamp
