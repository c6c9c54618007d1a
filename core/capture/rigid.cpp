#include "capture/rigid.h"

#include <fmt/format.h>

namespace relamp {

std::string makeRigid(DMat4& matrix, double& scale) {
    for (int column = 0; column < 4; ++column)
        for (int row = 0; row < 3; ++row)
            if (const double x = matrix[column][row]; !(std::abs(x) <= 1e12))
                return fmt::format("row {} column {} is {}, which is too large; expected at most 1e12", row, column, x);
    for (int column = 0; column < 4; ++column)
        if (!(std::abs(matrix[column][3] - (column == 3)) <= 1e-6)) return "has a last row other than 0 0 0 1";
    const glm::dmat3 rotation(matrix);
    const double determinant = glm::determinant(rotation);
    scale = std::cbrt(std::abs(determinant));
    if (!(scale > 1e-9)) return "is singular, expected a rotation and a translation";
    if (determinant < 0) return "mirrors the world, expected a rotation and a translation";
    for (int a = 0; a < 3; ++a)
        for (int b = a; b < 3; ++b) {
            const double dot = glm::dot(rotation[a], rotation[b]) / (scale * scale);
            if (std::abs(dot - (a == b)) > 1e-3) return "is not rigid, expected a rotation and a translation";
        }
    const DVec3 x = glm::normalize(rotation[0]);
    const DVec3 y = glm::normalize(rotation[1] - x * glm::dot(x, rotation[1]));
    matrix[0] = glm::dvec4(x, 0);
    matrix[1] = glm::dvec4(y, 0);
    matrix[2] = glm::dvec4(glm::cross(x, y), 0);
    return "";
}

}  // namespace relamp
