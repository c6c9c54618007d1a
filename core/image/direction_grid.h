// The one global, world-aligned, equal-area octahedral square of directions. Every cell has the same solid angle, so
// 2D Haar on the square is orthonormal on the sphere and tripling coefficients are exact.
// Source: equal-area octahedral map of Clarberg 2008 ("Fast equal-area mapping of the (hemi)sphere using SIMD").
#pragma once
#include <vector>

#include "base/math.h"

namespace relamp {

/// A unit direction for a point of the unit square. Upper hemisphere (z > 0) in the inner diamond.
Vec3 squareToSphere(const Vec2& point);
/// Inverse of squareToSphere, in [0,1]^2.
Vec2 sphereToSquare(const Vec3& direction);

/// side x side cells, side a power of two; cell (x, y) has index y * side + x.
struct DirectionGrid {
    int side = 32;
    int cells() const { return side * side; }
    /// Steradians of one cell: 4 pi / side^2.
    float cellSolidAngle() const { return 4 * pi / float(cells()); }
    int cellOf(const Vec3& direction) const {
        const Vec2 p = sphereToSquare(direction);
        return std::min(int(p.y * side), side - 1) * side + std::min(int(p.x * side), side - 1);
    }
    /// Direction of the point (u, v) in [0,1]^2 of a cell.
    Vec3 direction(int cell, const Vec2& inside = Vec2(0.5f)) const {
        return squareToSphere((Vec2(float(cell % side), float(cell / side)) + inside) / float(side));
    }
};

}  // namespace relamp
