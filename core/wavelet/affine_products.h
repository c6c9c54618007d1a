// Double and triple product integrals of Haar trees of which one is carried by an affine map [Sun09]: a planar
// emitter's square of radiance seen from a surface point is scaled, sheared and shifted on the plane of directions
// parallel to it. Not used in relighting, because area sampling is cheaper there: tests/bench/PRT.md has the figures.
#pragma once
#include <optional>

#include "base/math.h"
#include "wavelet/coefficients.h"

namespace relamp {

/// A function on the unit square, constant on side x side cells, unpacked for walks: per square of its quadtree the
/// mean, which is the scaling coefficient there, and whether all wavelets in and below it are zero. 5/3 side^2 x 4
/// bytes.
class HaarTree {
public:
    /// A square of the tree: i along x, j along y, 2^level a side.
    struct Node {
        int level = 0, i = 0, j = 0;
        double size() const { return 1.0 / double(1 << level); }
        Node child(int k) const { return {level + 1, 2 * i + (k & 1), 2 * j + (k >> 1)}; }
    };
    /// `cells`: mean value per cell, (x, y) at y * side + x. Throws Error when side is no power of two or does not fit.
    /// O(side^2).
    HaarTree(std::span<const float> cells, int side);
    /// From coefficients in the layout of haar.h, orthonormal on the unit square (domain area 1).
    HaarTree(const SparseCoefs& coefs, int side);

    float mean(const Node& n) const { return mean_[at(n)]; }
    bool constant(const Node& n) const { return constant_[at(n)]; }

private:
    std::vector<float> mean_;
    std::vector<uint8_t> constant_;
    size_t at(const Node& n) const {
        return ((size_t(1) << 2 * n.level) - 1) / 3 + (size_t(n.j) << n.level) + size_t(n.i);
    }
};

/// q = origin + p.x alongX + p.y alongY: from the moved function's unit square to the plane whose unit square holds the
/// still one.
struct AffineMap {
    glm::dvec2 origin{0}, alongX{1, 0}, alongY{0, 1};
};

/// Area that the parallelogram, the map's image of the unit square, shares with the square [low, low + size]^2. Exact
/// (clipped polygon).
double sharedArea(const AffineMap& map, const glm::dvec2& low, double size);

/// Integral over the unit square of still(q) moved(map^-1 q) dq, moved being 0 outside its square. Walks both
/// quadtrees: pairs of squares that do not meet end at once, and so do those of which one lies within a constant square
/// of the other; what is left are pairs of constant squares across an edge, taken with their shared area. Exact but for
/// rounding (sums in double). Cost O(squares along the edges of either function), for a constant emitter O(side), 10 to
/// 100 ns a square. 0 when the map flattens the square; throws Error when it is not finite. Source: affine double
/// product integral [Sun09]. They tabulate coefficients for scale and shift; shared areas are the same numbers for
/// scaling functions, need no table and allow shear.
double affineDoubleProduct(const HaarTree& still, const HaarTree& moved, const AffineMap& map);

/// Integral over the unit square of a(q) b(q) moved(map^-1 q) dq, as above: visibility, reflectance and emitter. Inside
/// the emitter only squares in which neither a nor b is constant are opened.
double affineTripleProduct(const HaarTree& a, const HaarTree& b, const HaarTree& moved, const AffineMap& map);

/// The parallelogram (corner, edgeU, edgeV; metres) as `point` sees it: its map onto the plane of directions parallel
/// to it. That plane lies at distance 1; `towards` is unit, at right angles to the emitter and points to its plane;
/// `axisX` is unit and at right angles to it. Direction towards + x axisX + y cross(towards, axisX) lies at (x, y), and
/// [-reach, reach]^2 of the plane is the unit square: atan(reach) is as far as it sees, an emitter beyond is cut off. A
/// solid angle there is dx dy / (1 + x^2 + y^2)^(3/2). Empty unless the plane lies ahead of the point.
std::optional<AffineMap> planarEmitterMap(const Vec3& point, const Vec3& towards, const Vec3& axisX, const Vec3& corner,
                                          const Vec3& edgeU, const Vec3& edgeV, float reach);

}  // namespace relamp
