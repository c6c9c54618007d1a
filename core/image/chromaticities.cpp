#include "image/chromaticities.h"

namespace relamp {
namespace {

using DMat3 = glm::dmat3;

DVec3 xyzOf(double x, double y) { return {x / y, 1.0, (1 - x - y) / y}; }

/// CIE XYZ (white has Y = 1) from linear RGB with these primaries.
DMat3 xyzFromRgb(const Chromaticities& c) {
    const DMat3 primaries(xyzOf(c[0], c[1]), xyzOf(c[2], c[3]), xyzOf(c[4], c[5]));
    const DVec3 scale = glm::inverse(primaries) * xyzOf(c[6], c[7]);
    return DMat3(primaries[0] * scale.x, primaries[1] * scale.y, primaries[2] * scale.z);
}

/// Adapts XYZ seen under one white to another (Bradford cone responses).
DMat3 adaptWhite(const DVec3& from, const DVec3& to) {
    const DMat3 cone = glm::transpose(DMat3(0.8951, 0.2664, -0.1614, -0.7502, 1.7135, 0.0367, 0.0389, -0.0685, 1.0296));
    const DVec3 gain = (cone * to) / (cone * from);
    return glm::inverse(cone) * DMat3(gain.x, 0, 0, 0, gain.y, 0, 0, 0, gain.z) * cone;
}

}  // namespace

bool isRec709(const Chromaticities& c) {
    for (size_t i = 0; i < c.size(); ++i)
        if (!(std::abs(c[i] - rec709Chromaticities[i]) < 1e-3f)) return false;
    return true;
}

std::optional<Mat3> rec709From(const Chromaticities& c) {
    for (const size_t y : {1, 3, 5, 7})
        if (!(std::abs(c[y]) > 1e-6f)) return std::nullopt;
    const DMat3 result = glm::inverse(xyzFromRgb(rec709Chromaticities)) *
                         adaptWhite(xyzOf(c[6], c[7]), xyzOf(rec709Chromaticities[6], rec709Chromaticities[7])) *
                         xyzFromRgb(c);
    for (int column = 0; column < 3; ++column)
        if (!isFinite(Vec3(result[column]))) return std::nullopt;
    return Mat3(result);
}

}  // namespace relamp
