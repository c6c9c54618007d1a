#include "wavelet/haar.h"

#include <gtest/gtest.h>

#include "base/error.h"
#include "haar_reference.h"

namespace relamp {
namespace {
using test::haarValue;
using test::randomValues;

TEST(Haar, ReferenceBasisIsOrthonormal) {
    const int side = 8;
    const double area = 4 * piD;
    for (uint32_t k = 0; k < 64; ++k)
        for (uint32_t l = 0; l < 64; ++l) {
            double inner = 0;
            for (int y = 0; y < side; ++y)
                for (int x = 0; x < side; ++x) inner += haarValue(k, x, y, side, area) * haarValue(l, x, y, side, area);
            ASSERT_NEAR(inner * area / 64, k == l ? 1 : 0, 1e-12) << k << " " << l;
        }
}

TEST(Haar, ForwardOfEachBasisFunctionIsOneAtItsIndexInTheStatedLayout) {
    const int side = 16;
    for (uint32_t k = 0; k < 256; ++k) {
        std::vector<float> square(256);
        for (int y = 0; y < side; ++y)
            for (int x = 0; x < side; ++x) square[size_t(y * side + x)] = float(haarValue(k, x, y, side, 1) / side);
        haarForward(square, side);
        for (uint32_t l = 0; l < 256; ++l) ASSERT_NEAR(square[l], k == l ? 1 : 0, 1e-6) << k << " " << l;
    }
}

TEST(Haar, InverseUndoesForward) {
    for (const int side : {1, 2, 4, 32, 64}) {
        const std::vector<float> before = randomValues(size_t(side * side), 7);
        std::vector<float> after = before;
        haarForward(after, side);
        haarInverse(after, side);
        for (size_t k = 0; k < before.size(); ++k) ASSERT_NEAR(after[k], before[k], 2e-6) << "side " << side;
    }
}

TEST(Haar, KeepsTheSquaredNorm) {
    std::vector<float> square = randomValues(32 * 32, 3);
    const auto norm2 = [&] {
        double sum = 0;
        for (const float v : square) sum += double(v) * double(v);
        return sum;
    };
    const double before = norm2();
    haarForward(square, 32);
    EXPECT_NEAR(norm2() / before, 1, 1e-6);
}

TEST(Haar, ConstantOneOnTheSphereHasScalingCoefficientRootFourPiAndNothingElse) {
    const int side = 32;
    std::vector<float> square(side * side, std::sqrt(4 * pi / (side * side)));
    haarForward(square, side);
    EXPECT_NEAR(square[0], std::sqrt(4 * pi), 1e-5);
    for (size_t k = 1; k < square.size(); ++k) ASSERT_EQ(square[k], 0) << k;
}

TEST(Haar, SquareThatIsNoPowerOfTwoOrDoesNotFitIsAnError) {
    std::vector<float> square(36);
    EXPECT_THROW(haarForward(square, 6), Error);
    EXPECT_THROW(haarInverse(square, 4), Error);
    EXPECT_THROW(haarForward(std::span<float>(), 0), Error);
}

}  // namespace
}  // namespace relamp
