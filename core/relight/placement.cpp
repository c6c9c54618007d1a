#include "relight/placement.h"

#include <cmath>

namespace relamp {

Mat3 rotationOf(const Vec3& degrees) {
    const Vec3 r = degrees * (pi / 180);
    const float cx = std::cos(r.x), sx = std::sin(r.x), cy = std::cos(r.y), sy = std::sin(r.y), cz = std::cos(r.z),
                sz = std::sin(r.z);
    return Mat3(Vec3(cz, sz, 0), Vec3(-sz, cz, 0), Vec3(0, 0, 1)) *
           Mat3(Vec3(cy, 0, -sy), Vec3(0, 1, 0), Vec3(sy, 0, cy)) *
           Mat3(Vec3(1, 0, 0), Vec3(0, cx, sx), Vec3(0, -sx, cx));
}

Placement placementOf(const Mat4& matrix) {
    Placement p;
    Mat3 m(matrix);
    p.scale = {glm::length(m[0]), glm::length(m[1]), glm::length(m[2])};
    for (int k = 0; k < 3; ++k) p.scale[k] = std::max(p.scale[k], 1e-9f);
    Vec3 x = m[0] / p.scale.x, y = m[1] / p.scale.y;
    y -= x * glm::dot(x, y);
    y /= std::max(glm::length(y), 1e-9f);
    if (glm::determinant(m) < 0) p.scale.z = -p.scale.z;
    const Vec3 z = glm::cross(x, y);
    const float across = std::hypot(x.x, x.y);
    Vec3 r{0, std::atan2(-x.z, across), 0};
    if (across > 1e-5f) {
        r.x = std::atan2(y.z, z.z);
        r.z = std::atan2(x.y, x.x);
    } else {
        r.z = std::atan2(-y.x, y.y);
    }
    p.degrees = r * (180 / pi);
    for (int k = 0; k < 3; ++k)
        if (std::abs(p.degrees[k]) < 5e-4f) p.degrees[k] = 0;
    return p;
}

Vec3 anglesNear(const Vec3& degrees, const Vec3& near) {
    const auto unwrapped = [&](Vec3 angles) {
        for (int k = 0; k < 3; ++k) angles[k] += 360 * std::round((near[k] - angles[k]) / 360);
        return angles;
    };
    const Vec3 plain = unwrapped(degrees);
    const Vec3 other = unwrapped({degrees.x + 180, 180 - degrees.y, degrees.z + 180});
    return glm::distance(other, near) < glm::distance(plain, near) ? other : plain;
}

}  // namespace relamp
