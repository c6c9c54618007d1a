// Where a light is, as people say it: rotation in degrees and scale out of a matrix.
#pragma once
#include "base/math.h"

namespace relamp {

/// Rotation and scale of a matrix without shear: degrees about x, then y, then z.
struct Placement {
    Vec3 degrees{0}, scale{1};
};
Placement placementOf(const Mat4& matrix);
Mat3 rotationOf(const Vec3& degrees);
/// The same rotation by the angles that lie nearest to `near`: whole turns and the other set of three are tried.
Vec3 anglesNear(const Vec3& degrees, const Vec3& near);

}  // namespace relamp
