#include "wavelet/coefficients.h"

#include <gtest/gtest.h>

#include "haar_reference.h"

namespace relamp {
namespace {
using test::coefsOfCells;
using test::randomValues;

TEST(Coefficients, FullFractionKeepsEveryNonZeroInOrder) {
    const std::vector<float> dense{0, -3, 0, 2, 1e-20f, 0};
    const SparseCoefs coefs = sparsify(dense);
    EXPECT_EQ(coefs.index, (std::vector<uint32_t>{1, 3, 4}));
    EXPECT_EQ(coefs.value, (std::vector<float>{-3, 2, 1e-20f}));
}

TEST(Coefficients, FractionKeepsTheFewestLargestTermsThatReachIt) {
    const std::vector<float> dense{1, -3, 0, 2, 1};  // squared norm 15
    EXPECT_EQ(sparsify(dense, 0.59f).index, (std::vector<uint32_t>{1}));
    EXPECT_EQ(sparsify(dense, 0.61f).index, (std::vector<uint32_t>{1, 3}));
    EXPECT_EQ(sparsify(dense, 0.90f).index, (std::vector<uint32_t>{0, 1, 3}));
    EXPECT_EQ(sparsify(dense, 0.0f).size(), 0u);
}

TEST(Coefficients, CapKeepsTheLargestAndOfEqualOnesTheFirst) {
    const std::vector<float> dense{1, -3, 0, 2, -1};
    EXPECT_EQ(sparsify(dense, 1, 3).index, (std::vector<uint32_t>{0, 1, 3}));
    EXPECT_EQ(sparsify(dense, 0.99f, 1).index, (std::vector<uint32_t>{1}));
    EXPECT_EQ(sparsify(dense, 1, 99).size(), 4u);
}

TEST(Coefficients, ZerosAndNothingGiveNoTerms) {
    EXPECT_EQ(sparsify(std::vector<float>(16, 0.0f), 0.9f, 4).size(), 0u);
    EXPECT_EQ(sparsify({}).size(), 0u);
}

TEST(Coefficients, ScatterPutsTermsBackAndClearsTheRest) {
    const std::vector<float> before = randomValues(64, 5);
    std::vector<float> after(64, 99.0f);
    scatter(sparsify(before), after);
    EXPECT_EQ(after, before);
    scatter(SparseCoefs{{3}, {2.0f}}, after);
    EXPECT_EQ(after[3], 2);
    EXPECT_EQ(after[4], 0);
}

TEST(Coefficients, DoubleProductIsTheIntegralOfTheProductOverTheGrid) {
    const int side = 16;
    const double area = 4 * piD;
    const std::vector<float> a = randomValues(256, 1), b = randomValues(256, 2);
    double integral = 0, size = 0;
    for (size_t k = 0; k < 256; ++k) {
        integral += double(a[k]) * double(b[k]) * area / 256;
        size += std::abs(double(a[k]) * double(b[k])) * area / 256;
    }
    const SparseCoefs coefsA = coefsOfCells(a, side, area), coefsB = coefsOfCells(b, side, area);
    std::vector<float> denseB(256);
    scatter(coefsB, denseB);
    EXPECT_NEAR(dot(coefsA, coefsB), integral, 1e-6 * size);
    EXPECT_NEAR(dot(coefsA, denseB), integral, 1e-6 * size);
}

TEST(Coefficients, DoubleProductCountsOnlySharedIndices) {
    const SparseCoefs a{{0, 5, 9}, {1, 2, 3}}, b{{5, 7, 9, 40}, {10, 100, -1, 7}};
    EXPECT_EQ(dot(a, b), 17);
    EXPECT_EQ(dot(b, a), 17);
    EXPECT_EQ(dot(a, SparseCoefs{}), 0);
}

}  // namespace
}  // namespace relamp
