// Small vectors (GLM) and the few scalars everything uses. Directions are unit vectors in world space, Z up.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include <glm/glm.hpp>

namespace relamp {

using Vec2 = glm::vec2;
using Vec3 = glm::vec3;
using Vec4 = glm::vec4;
using Mat3 = glm::mat3;
using Mat4 = glm::mat4;
using DVec3 = glm::dvec3;
using DMat4 = glm::dmat4;
using Rgb = glm::vec3;  ///< linear Rec.709 radiance, or a reflectance per channel

inline constexpr float pi = std::numbers::pi_v<float>;
inline constexpr double piD = std::numbers::pi_v<double>;

/// Rec.709 luminance of a linear colour.
inline float luminance(const Rgb& c) { return 0.2126f * c.x + 0.7152f * c.y + 0.0722f * c.z; }
inline float maxChannel(const Rgb& c) { return std::max(c.x, std::max(c.y, c.z)); }
inline bool isFinite(const Vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

/// An orthonormal frame with the given unit z axis (Duff et al. 2017, branchless).
inline Mat3 frameAround(const Vec3& z) {
    const float sign = std::copysign(1.0f, z.z);
    const float a = -1.0f / (sign + z.z), b = z.x * z.y * a;
    return Mat3(Vec3(1.0f + sign * z.x * z.x * a, sign * b, -sign * z.x), Vec3(b, sign + z.y * z.y * a, -z.y), z);
}
/// The same, which turns with `axes`.
inline Mat3 frameAround(const Vec3& z, const Mat3& axes) { return axes * frameAround(z * axes); }

}  // namespace relamp
