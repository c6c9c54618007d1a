// Photographs of a post on the axis of z.
#pragma once
#include <functional>
#include <optional>

#include "support/estimates.h"

namespace relamp::test {

/// Of 120 x 160 pixels, 16 rays each. `shade`: radiance along a ray; `across`: of the post where the ray is nearest to
/// its axis, metres beside it; none where it misses.
inline Image postPhotograph(const Camera& camera, double radius, double height,
                            const std::function<float(const DVec3& ray, std::optional<double> across)>& shade) {
    Image image(120, 160);
    const DVec3 eye = camera.position();
    for (int y = 0; y < 160; ++y)
        for (int x = 0; x < 120; ++x)
            for (int k = 0; k < 16; ++k) {
                const DVec3 ray(camera.rayDirection(
                    Vec2(float(x) + (float(k % 4) + 0.5f) / 4, float(y) + (float(k / 4) + 0.5f) / 4)));
                const glm::dvec2 from(eye), along(ray);
                const double t = -glm::dot(from, along) / glm::dot(along, along), z = eye.z + t * ray.z;
                const glm::dvec2 off = from + t * along;
                const bool hit = glm::length(off) < radius && z < height && z > 0;
                const double across = (off.x * along.y - off.y * along.x) / glm::length(along);
                image.at(x, y) += shade(ray, hit ? std::optional(across) : std::nullopt) * Rgb(1.0f / 16);
            }
    return image;
}

}  // namespace relamp::test
