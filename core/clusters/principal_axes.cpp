#include "clusters/principal_axes.h"

#include <algorithm>

namespace relamp {
namespace {

/// Unit vector that the matrix stretches most; the matrix is symmetric and not negative.
DVec3 longestAxis(glm::dmat3 m) {
    for (int i = 0; i < 24; ++i) {
        double largest = 0;
        for (int c = 0; c < 3; ++c) largest = std::max(largest, glm::length(m[c]));
        if (!(largest > 0)) return {1, 0, 0};
        m /= largest;
        m = m * m;
    }
    const int c = glm::length(m[0]) > glm::length(m[1]) ? (glm::length(m[0]) > glm::length(m[2]) ? 0 : 2)
                                                        : (glm::length(m[1]) > glm::length(m[2]) ? 1 : 2);
    return glm::length(m[c]) > 0 ? glm::normalize(m[c]) : DVec3(1, 0, 0);
}

glm::dmat3 axesFrom(const DVec3& first, const DVec3& second) {
    const DVec3 third = glm::normalize(glm::cross(first, second));
    return glm::dmat3(first, glm::cross(third, first), third);
}

}  // namespace

glm::dmat3 principalAxes(const std::vector<DVec3>& points) {
    DVec3 mean(0);
    for (const DVec3& p : points) mean += p / double(points.size());
    glm::dmat3 moments(0);
    for (const DVec3& p : points) moments += glm::outerProduct(p - mean, p - mean);
    const DVec3 first = longestAxis(moments);
    const glm::dmat3 across = glm::dmat3(1) - glm::outerProduct(first, first);
    DVec3 second = longestAxis(across * moments * across);
    second -= glm::dot(second, first) * first;
    if (!(glm::length(second) > 1e-6)) second = DVec3(frameAround(Vec3(first))[0]);
    return axesFrom(first, glm::normalize(second));
}

}  // namespace relamp
