#include "wavelet/affine_products.h"

#include <gtest/gtest.h>

#include "base/error.h"
#include "haar_reference.h"

namespace relamp {
namespace {
using test::coefsOfCells;
using test::randomValues;
using DVec2 = glm::dvec2;

/// Value of a function given by cells at a point; 0 outside its square.
double valueAt(const std::vector<float>& cells, int side, const DVec2& p) {
    if (p.x < 0 || p.y < 0 || p.x >= 1 || p.y >= 1) return 0;
    return double(cells[size_t(int(p.y * side) * side + int(p.x * side))]);
}

/// Where a point of the plane comes from.
DVec2 before(const AffineMap& m, const DVec2& q) {
    const double determinant = m.alongX.x * m.alongY.y - m.alongX.y * m.alongY.x;
    const DVec2 d = q - m.origin;
    return DVec2(d.x * m.alongY.y - d.y * m.alongY.x, m.alongX.x * d.y - m.alongX.y * d.x) / determinant;
}

/// Sums over points of the unit square: n a side.
double bruteForce(const std::vector<float>& a, const std::vector<float>& b, int side, const std::vector<float>& moved,
                  int movedSide, const AffineMap& map, int n) {
    double sum = 0;
    for (int y = 0; y < n; ++y)
        for (int x = 0; x < n; ++x) {
            const DVec2 q((x + 0.5) / n, (y + 0.5) / n);
            sum +=
                valueAt(a, side, q) * (b.empty() ? 1 : valueAt(b, side, q)) * valueAt(moved, movedSide, before(map, q));
        }
    return sum / (double(n) * n);
}

const AffineMap maps[] = {
    {{0, 0}, {1, 0}, {0, 1}},                        // as it stands
    {{0.25, 0.5}, {0.25, 0}, {0, 0.5}},              // scaled and shifted onto cells
    {{0.21, 0.13}, {0.37, 0}, {0, 0.61}},            // ... and across them
    {{0.9, 0.2}, {-0.5, 0}, {0, 0.3}},               // mirrored
    {{0.3, 0.1}, {0.5, 0.2}, {-0.15, 0.4}},          // turned and sheared
    {{0.7, 0.8}, {0, -0.55}, {-0.6, 0}},             // a quarter turn
    {{-0.8, -0.3}, {2.3, 0.4}, {-0.2, 1.9}},         // larger than the square, clipped
    {{0.6181, 0.4142}, {0.003, 0.001}, {0, 0.004}},  // inside one cell
};

TEST(AffineProducts, EqualSumsOverPoints) {
    const int side = 16, movedSide = 8;
    const std::vector<float> a = randomValues(256, 1), b = randomValues(256, 2), f = randomValues(64, 3);
    const HaarTree treeA(a, side), treeB(b, side), treeF(f, movedSide);
    for (const AffineMap& map : maps) {
        const double area = std::abs(map.alongX.x * map.alongY.y - map.alongX.y * map.alongY.x);
        // Sums err where cells' edges cross the points: less than their length over the points a side.
        const double slack = 2e-3 * std::sqrt(std::min(area, 1.0)) + 1e-6;
        EXPECT_NEAR(affineDoubleProduct(treeA, treeF, map), bruteForce(a, {}, side, f, movedSide, map, 2048), slack);
        EXPECT_NEAR(affineTripleProduct(treeA, treeB, treeF, map), bruteForce(a, b, side, f, movedSide, map, 2048),
                    slack);
    }
}

TEST(AffineProducts, AreTheDotProductOfCoefficientsWhereNothingMoves) {
    const int side = 32;
    const SparseCoefs a = coefsOfCells(randomValues(1024, 5), side, 1),
                      b = coefsOfCells(randomValues(1024, 6), side, 1);
    EXPECT_NEAR(affineDoubleProduct(HaarTree(a, side), HaarTree(b, side), {}), dot(a, b), 1e-5);
}

TEST(AffineProducts, DoNotDependOnWhichFunctionIsCarriedBack) {
    const HaarTree a(randomValues(256, 7), 16), b(randomValues(256, 8), 16);
    const AffineMap map{{0.3, 0.1}, {0.5, 0.2}, {-0.15, 0.4}};  // wholly inside, so that nothing is cut off
    const DVec2 zero = before(map, {0, 0});
    const AffineMap back{zero, before(map, {1, 0}) - zero, before(map, {0, 1}) - zero};
    EXPECT_NEAR(affineDoubleProduct(a, b, map), affineDoubleProduct(b, a, back) * (0.5 * 0.4 + 0.2 * 0.15), 1e-9);
}

TEST(AffineProducts, SharedAreasOfKnownFigures) {
    EXPECT_DOUBLE_EQ(sharedArea({{0.5, 0.5}, {1, 0}, {0, 1}}, {0, 0}, 1), 0.25);
    EXPECT_DOUBLE_EQ(sharedArea({{2, 0}, {1, 0}, {0, 1}}, {0, 0}, 1), 0);
    // A square on its corner, half a diagonal of 1/2: wholly inside, and cut in half.
    EXPECT_NEAR(sharedArea({{0.5, 0}, {0.5, 0.5}, {-0.5, 0.5}}, {0, 0}, 1), 0.5, 1e-12);
    EXPECT_NEAR(sharedArea({{0, -0.5}, {0.5, 0.5}, {-0.5, 0.5}}, {0, -1}, 2), 0.25, 1e-12);
    // Clipped at all four corners: 1 less four right triangles of legs 0.25.
    EXPECT_NEAR(sharedArea({{0.5, -0.25}, {0.75, 0.75}, {-0.75, 0.75}}, {0, 0}, 1), 1 - 4 * 0.5 * 0.0625, 1e-12);
}

TEST(AffineProducts, FlatMapsGiveNothingAndBadNumbersAreNamed) {
    const HaarTree one(std::vector<float>{1}, 1);
    EXPECT_EQ(affineDoubleProduct(one, one, {{0.1, 0.1}, {0.5, 0.5}, {0.2, 0.2}}), 0);
    EXPECT_THROW(affineDoubleProduct(one, one, {{0.1, 0.1}, {NAN, 0.5}, {0.2, 0.2}}), Error);
    EXPECT_THROW(HaarTree(std::vector<float>{1, 2, 3}, 2), Error);
    EXPECT_THROW(HaarTree(std::vector<float>(9), 3), Error);
}

/// cosine / (pi r^4) per cell of the plane at distance 1, [-reach, reach]^2, for a Lambert patch whose normal is (n.x,
/// n.y, n.z) there: what sums to a form factor. Sixteen points a cell.
std::vector<float> lambertOnPlane(int side, float reach, const Vec3& n) {
    std::vector<float> cells(size_t(side) * size_t(side));
    for (int c = 0; c < side * side; ++c) {
        double sum = 0;
        for (int k = 0; k < 16; ++k) {
            const double x = ((c % side + (k % 4 + 0.5) / 4) / side * 2 - 1) * double(reach),
                         y = ((c / side + (k / 4 + 0.5) / 4) / side * 2 - 1) * double(reach);
            const double r2 = 1 + x * x + y * y;
            sum += std::max(0.0, x * double(n.x) + y * double(n.y) + double(n.z)) / (piD * r2 * r2) / 16;
        }
        cells[size_t(c)] = float(sum * 4 * double(reach) * double(reach));
    }
    return cells;
}

TEST(AffineProducts, SquareAboveAPatchHasItsKnownFormFactor) {
    const HaarTree lambert(lambertOnPlane(128, 4, {0, 0, 1}), 128), one(std::vector<float>{1}, 1);
    const auto factor = [&](const Vec3& point, float side, float height) {
        const Vec3 corner(-side / 2, -side / 2, height);
        const auto map = planarEmitterMap(point, {0, 0, 1}, {1, 0, 0}, corner, {side, 0, 0}, {0, side, 0}, 4);
        return map ? affineDoubleProduct(lambert, one, *map) : 0;
    };
    // Middle of a square of 2 m at 1 m: 4 / pi atan(1 / sqrt 2) / sqrt 2 = 0.554133.
    EXPECT_NEAR(factor({0, 0, 0}, 2, 1), 0.554133, 2e-4);
    // Below its corner: a / (pi sqrt(a^2 + 1)) atan(a / sqrt(a^2 + 1)), a = side / height.
    EXPECT_NEAR(factor({1, 1, 0}, 2, 1), 2 / (piD * std::sqrt(5.0)) * std::atan(2 / std::sqrt(5.0)), 2e-4);
    // Small against the cells: area / (pi d^2) less 1.3 %. The cell at its edge is one mean, which costs 0.3 %.
    EXPECT_NEAR(factor({0, 0, 0}, 1, 5), 0.012565, 6e-5);
    EXPECT_EQ(factor({0, 0, 2}, 2, 1), 0);
}

TEST(AffineProducts, HalfTheSkyHiddenHidesHalfTheSquare) {
    const int side = 128;
    std::vector<float> seen(size_t(side * side));
    for (int c = 0; c < side * side; ++c) seen[size_t(c)] = c % side < side / 2;
    const HaarTree visibility(seen, side), lambert(lambertOnPlane(side, 4, {0, 0, 1}), side),
        one(std::vector<float>{1}, 1);
    const auto map = planarEmitterMap({0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {-1, -1, 1}, {2, 0, 0}, {0, 2, 0}, 4);
    EXPECT_NEAR(affineTripleProduct(visibility, lambert, one, *map), 0.554133 / 2, 1e-4);
    EXPECT_NEAR(affineDoubleProduct(visibility, one, *map), 0.5 * 4 / 64, 1e-9);  // half of 2 x 2 in a window of 8 x 8
}

}  // namespace
}  // namespace relamp
