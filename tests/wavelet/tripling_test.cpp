#include "wavelet/tripling.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "base/error.h"
#include "haar_reference.h"

namespace relamp {
namespace {
using test::cellsOfCoefs;
using test::coefsOfCells;
using test::haarValue;
using test::randomValues;

const double sphere = 4 * piD;

struct Integral {
    double value = 0, size = 0;  ///< of the product, and of its absolute value
};

Integral bruteForce(const SparseCoefs& a, const SparseCoefs& b, const SparseCoefs& c, int side, double area) {
    const auto x = cellsOfCoefs(a, side, area), y = cellsOfCoefs(b, side, area), z = cellsOfCoefs(c, side, area);
    Integral sum;
    for (size_t k = 0; k < x.size(); ++k) {
        sum.value += x[k] * y[k] * z[k] * area / double(x.size());
        sum.size += std::abs(x[k] * y[k] * z[k]) * area / double(x.size());
    }
    return sum;
}

/// A few coefficients anywhere on the tree, the scaling function or not.
SparseCoefs randomSparse(int side, size_t terms, uint64_t seed) {
    std::vector<float> dense(size_t(side * side), 0.0f);
    const std::vector<float> values = randomValues(terms, seed);
    for (size_t t = 0; t < terms; ++t) dense[mixBits(mixBits(seed + 99) ^ t) % dense.size()] = values[t];
    return sparsify(dense);
}

TEST(Tripling, CoefficientsAreTheIntegralsOfThreeBasisFunctions) {
    const int side = 8;
    const uint32_t count = 64;
    std::vector<std::vector<double>> basis(count, std::vector<double>(count));
    for (uint32_t k = 0; k < count; ++k)
        for (int cell = 0; cell < 64; ++cell)
            basis[k][size_t(cell)] = haarValue(k, cell % side, cell / side, side, sphere);
    size_t nonZero = 0;
    for (uint32_t k = 0; k < count; ++k)
        for (uint32_t l = 0; l < count; ++l)
            for (uint32_t m = 0; m < count; ++m) {
                double integral = 0;
                for (size_t cell = 0; cell < count; ++cell)
                    integral += basis[k][cell] * basis[l][cell] * basis[m][cell];
                integral *= sphere / count;
                const float coefficient = triplingCoefficient(k, l, m, side, float(sphere));
                ASSERT_NEAR(coefficient, integral, 1e-6) << k << " " << l << " " << m;
                nonZero += coefficient != 0;
            }
    // 1 of case 1; three orders of a wavelet twice and the scaling function or one of its 3 l ancestors; six orders a
    // square.
    EXPECT_EQ(nonZero, 1u + 3 * (3 * 1 + 12 * 4 + 48 * 7) + 6 * 21);
}

TEST(Tripling, ThreeScalingFunctionsGiveOneOverRootFourPi) {
    EXPECT_FLOAT_EQ(triplingCoefficient(0, 0, 0, 32, 4 * pi), 0.28209479f);
}

TEST(Tripling, TripleProductOfDenseFunctionsIsTheGridSum) {
    for (const int side : {2, 4, 16, 32})
        for (uint64_t seed = 0; seed < 3; ++seed) {
            const size_t cells = size_t(side * side);
            const SparseCoefs a = coefsOfCells(randomValues(cells, 3 * seed), side, sphere);
            const SparseCoefs b = coefsOfCells(randomValues(cells, 3 * seed + 1), side, sphere);
            const SparseCoefs c = coefsOfCells(randomValues(cells, 3 * seed + 2), side, sphere);
            const Integral expected = bruteForce(a, b, c, side, sphere);
            ASSERT_NEAR(tripleProduct(a, b, c, side, float(sphere)), expected.value, 1e-6 * expected.size) << side;
        }
}

TEST(Tripling, TripleProductOfPositiveFunctionsIsTheGridSumToOnePartInAHundredThousand) {
    const int side = 32;
    std::vector<SparseCoefs> coefs;
    for (uint64_t seed = 10; seed < 13; ++seed) {
        std::vector<float> cells = randomValues(1024, seed);
        for (float& value : cells) value = (value + 1) * (value + 1);
        coefs.push_back(coefsOfCells(cells, side, sphere));
    }
    const double expected = bruteForce(coefs[0], coefs[1], coefs[2], side, sphere).value;
    EXPECT_NEAR(tripleProduct(coefs[0], coefs[1], coefs[2], side, float(sphere)) / expected, 1, 1e-5);
}

TEST(Tripling, TripleProductOfSparseCoefficientsIsTheGridSumAndTheSumOverTriplingCoefficients) {
    const int side = 16;
    for (uint64_t seed = 0; seed < 40; ++seed) {
        const SparseCoefs a = randomSparse(side, 5 + seed, 3 * seed), b = randomSparse(side, 30, 3 * seed + 1),
                          c = randomSparse(side, 45 - seed, 3 * seed + 2);
        const float product = tripleProduct(a, b, c, side, float(sphere));
        const Integral expected = bruteForce(a, b, c, side, sphere);
        ASSERT_NEAR(product, expected.value, 1e-5 * expected.size) << seed;
        double sum = 0;
        for (size_t r = 0; r < a.size(); ++r)
            for (size_t s = 0; s < b.size(); ++s)
                for (size_t t = 0; t < c.size(); ++t)
                    sum += double(triplingCoefficient(a.index[r], b.index[s], c.index[t], side, float(sphere))) *
                           double(a.value[r]) * double(b.value[s]) * double(c.value[t]);
        ASSERT_NEAR(product, sum, 1e-5 * std::max(1e-3, std::abs(sum))) << seed;
    }
}

TEST(Tripling, TripleProductOfDisjointSupportsIsZero) {
    const int side = 32;
    std::vector<float> left = randomValues(1024, 1), right = randomValues(1024, 2);
    for (size_t k = 0; k < 1024; ++k) (k % 32 < 11 ? right : left)[k] = 0;
    const SparseCoefs a = coefsOfCells(left, side, sphere), b = coefsOfCells(right, side, sphere);
    const SparseCoefs c = coefsOfCells(randomValues(1024, 3), side, sphere);
    const double scale = bruteForce(a, a, c, side, sphere).size;
    EXPECT_NEAR(tripleProduct(a, b, c, side, float(sphere)), 0, 1e-6 * scale);
    EXPECT_NEAR(tripleProduct(a, c, b, side, float(sphere)), 0, 1e-6 * scale);
}

TEST(Tripling, WaveletsOnDisjointSquaresGiveExactlyZero) {
    const int side = 8;  // level 2 diagonals of squares (0, 0), (3, 3) and (0, 3)
    const SparseCoefs a{{4 * 8 + 4}, {1}}, b{{7 * 8 + 7}, {1}}, c{{7 * 8 + 4}, {1}};
    EXPECT_EQ(tripleProduct(a, b, c, side, 1), 0);
    EXPECT_EQ(tripleProduct(a, a, b, side, 1), 0);
}

TEST(Tripling, TripleProductDoesNotDependOnTheOrderOfTheFunctions) {
    const int side = 16;
    SparseCoefs f[3] = {randomSparse(side, 20, 71), randomSparse(side, 60, 72), randomSparse(side, 120, 73)};
    const float expected = tripleProduct(f[0], f[1], f[2], side, 1);
    ASSERT_NE(expected, 0);
    int order[3] = {0, 1, 2};
    do EXPECT_NEAR(tripleProduct(f[order[0]], f[order[1]], f[order[2]], side, 1), expected, 1e-6 * std::abs(expected));
    while (std::next_permutation(order, order + 3));
}

TEST(Tripling, ConstantOneAsThirdFunctionGivesTheDoubleProduct) {
    const int side = 32;
    const SparseCoefs a = coefsOfCells(randomValues(1024, 21), side, sphere);
    const SparseCoefs b = coefsOfCells(randomValues(1024, 22), side, sphere);
    const SparseCoefs one{{0}, {std::sqrt(4 * pi)}};
    const float expected = dot(a, b);
    EXPECT_NEAR(tripleProduct(a, b, one, side, 4 * pi), expected, 1e-5 * std::abs(expected));
    EXPECT_NEAR(tripleProduct(one, a, b, side, 4 * pi), expected, 1e-5 * std::abs(expected));
    EXPECT_NEAR(tripleProduct(one, one, one, side, 4 * pi), 4 * pi, 1e-5);
}

TEST(Tripling, EmptyFunctionGivesZeroAndLeavesNothingBehind) {
    const SparseCoefs a = randomSparse(16, 50, 81), b = randomSparse(16, 50, 82), c = randomSparse(16, 50, 83);
    const float before = tripleProduct(a, b, c, 16, 1);
    EXPECT_EQ(tripleProduct(a, SparseCoefs{}, c, 16, 1), 0);
    tripleProduct(randomSparse(64, 300, 84), randomSparse(64, 300, 85), randomSparse(64, 300, 86), 64, 1);
    EXPECT_EQ(tripleProduct(a, b, c, 16, 1), before);
}

TEST(Tripling, IndexOutsideTheSquareIsAnError) {
    const SparseCoefs inside{{0}, {1}}, outside{{64}, {1}};
    EXPECT_THROW(tripleProduct(inside, inside, outside, 8, 1), Error);
    EXPECT_EQ(tripleProduct(inside, inside, inside, 8, 1), 1);
}

TEST(Tripling, ProductCoefsAreThoseOfTheCellwiseProduct) {
    const int side = 16;
    const SparseCoefs a = randomSparse(side, 40, 31), b = randomSparse(side, 90, 32);
    const auto x = cellsOfCoefs(a, side, sphere), y = cellsOfCoefs(b, side, sphere);
    std::vector<float> cells(256);
    for (size_t k = 0; k < 256; ++k) cells[k] = float(x[k] * y[k]);
    std::vector<float> expected(256);
    scatter(coefsOfCells(cells, side, sphere), expected);
    const std::vector<float> product = productCoefs(a, b, side, float(sphere));
    ASSERT_EQ(product.size(), 256u);
    for (size_t k = 0; k < 256; ++k) ASSERT_NEAR(product[k], expected[k], 2e-6) << k;
}

TEST(Tripling, ProductCoefsDottedWithAThirdFunctionAreTheTripleProduct) {
    const int side = 16;
    const SparseCoefs a = randomSparse(side, 40, 41), b = randomSparse(side, 90, 42), c = randomSparse(side, 200, 43);
    const float expected = tripleProduct(a, b, c, side, float(sphere));
    const double size = bruteForce(a, b, c, side, sphere).size;
    EXPECT_NEAR(dot(c, productCoefs(a, b, side, float(sphere))), expected, 1e-6 * size);
}

}  // namespace
}  // namespace relamp
