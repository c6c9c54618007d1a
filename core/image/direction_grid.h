// The equal-area octahedral square of directions, aligned with the world or with axes of a capture's own. Every cell
// has the same solid angle, so 2D Haar on the square is orthonormal on the sphere and tripling coefficients are exact.
// Source: equal-area octahedral map of Clarberg 2008 ("Fast equal-area mapping of the (hemi)sphere using SIMD").
#pragma once
#include <vector>

#include "base/math.h"

namespace relamp {

/// A unit direction for a point of the unit square. Upper hemisphere (z > 0) in the inner diamond.
Vec3 squareToSphere(const Vec2& point);
/// Inverse of squareToSphere, in [0,1]^2.
Vec2 sphereToSquare(const Vec3& direction);

/// side x side cells, side a power of two; cell (x, y) has index y * side + x. Directions are the world's; the square
/// lies along `axes`.
struct DirectionGrid {
    int side = 32;
    Mat3 axes{1};  ///< world from the square's own axes: a rotation
    int cells() const { return side * side; }
    /// Steradians of one cell: 4 pi / side^2.
    float cellSolidAngle() const { return 4 * pi / float(cells()); }
    int cellOf(const Vec3& direction) const {
        const Vec2 p = sphereToSquare(direction * axes);
        return std::min(int(p.y * side), side - 1) * side + std::min(int(p.x * side), side - 1);
    }
    /// Direction of the point (u, v) in [0,1]^2 of a cell.
    Vec3 direction(int cell, const Vec2& inside = Vec2(0.5f)) const {
        return axes * squareToSphere((Vec2(float(cell % side), float(cell / side)) + inside) / float(side));
    }
};

/// Interpolated between cell centres. `direction` is a unit vector.
Rgb interpolated(const std::vector<Rgb>& cells, const DirectionGrid& grid, const Vec3& direction);

/// What `cells` of `from` hold, on `to` (any side, any axes): the mean of `points` x `points` points in each cell, of a
/// quarter of them where those differ by less than a twentieth. What is brighter than four times the mean, a sun or a
/// emitter, keeps its energy exactly. With 8, light on surfaces stays the same to about 1e-4; 0.05 to 0.15 s for a side
/// of 256 on two cores.
std::vector<Rgb> turnedCells(const std::vector<Rgb>& cells, const DirectionGrid& from, const DirectionGrid& to,
                             int points = 8);

}  // namespace relamp
