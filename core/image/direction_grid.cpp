#include "image/direction_grid.h"

namespace relamp {

Vec3 squareToSphere(const Vec2& point) {
    const float u = 2 * point.x - 1, v = 2 * point.y - 1;
    const float d = 1 - (std::abs(u) + std::abs(v)), r = 1 - std::abs(d);
    const float phi = r == 0 ? 0 : (std::abs(v) - std::abs(u)) / r * (pi / 4) + pi / 4;
    const float f = r * std::sqrt(std::max(0.0f, 2 - r * r));
    return {std::copysign(f * std::cos(phi), u), std::copysign(f * std::sin(phi), v), std::copysign(1 - r * r, d)};
}

Vec2 sphereToSquare(const Vec3& direction) {
    const float x = std::abs(direction.x), y = std::abs(direction.y), z = std::abs(direction.z);
    const float r = std::sqrt(std::max(0.0f, 1 - z));
    float phi = std::atan2(y, x) * (2 / pi);
    float v = phi * r, u = r - v;
    if (direction.z < 0) {
        const float swap = u;
        u = 1 - v;
        v = 1 - swap;
    }
    u = std::copysign(u, direction.x);
    v = std::copysign(v, direction.y);
    const auto unit = [](float t) { return std::clamp(t * 0.5f + 0.5f, 0.0f, 1.0f); };
    return {unit(u), unit(v)};
}

}  // namespace relamp
