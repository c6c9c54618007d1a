// Orthonormal 2D Haar transform on a square of side 2^k (non-standard decomposition, Stollnitz et al. 1995).
#pragma once
#include <span>

namespace relamp {

/// In place, side x side values, row-major: value (x, y) at y * side + x. On the octahedral square, multiply cell
/// averages by sqrt(cell solid angle) first and the coefficients are orthonormal on the sphere. Cost O(side^2).
///
/// Layout (Mallat quadrants): coefficient 0 is the scaling coefficient. Level l (0 = coarsest) cuts the square into n x
/// n squares, n = 2^l; square (i, j), i along x and j along y, has its three wavelets at
///     horizontal detail   j * side + (n + i)          +1 on the half with smaller x, -1 on the other
///     vertical detail     (n + j) * side + i          +1 on the half with smaller y, -1 on the other
///     diagonal detail     (n + j) * side + (n + i)    the product of the two signs
/// times 2^l / sqrt(domain area). Throws Error when the side is no power of two or does not fit the span.
void haarForward(std::span<float> square, int side);
void haarInverse(std::span<float> square, int side);

}  // namespace relamp
