#include "wavelet/haar.h"

#include <algorithm>
#include <bit>
#include <vector>

#include "base/error.h"

namespace relamp {
namespace {

void checkSquare(std::span<const float> square, int side) {
    if (side < 1 || !std::has_single_bit(unsigned(side)))
        throw Error("haar: side is {}, expected a power of two", side);
    if (square.size() != size_t(side) * size_t(side))
        throw Error("haar: {} values, expected {} x {}", square.size(), side, side);
}

}  // namespace

void haarForward(std::span<float> square, int side) {
    checkSquare(square, side);
    const size_t stride = size_t(side);
    std::vector<float> averages(square.begin(), square.end()), coarser(square.size() / 4);
    for (size_t n = stride / 2; n >= 1; n /= 2) {  // n x n squares of 2 x 2 values each
        for (size_t j = 0; j < n; ++j) {
            const float* upper = &averages[2 * j * 2 * n];
            const float* lower = upper + 2 * n;
            for (size_t i = 0; i < n; ++i) {
                const float a = upper[2 * i], b = upper[2 * i + 1], c = lower[2 * i], d = lower[2 * i + 1];
                coarser[j * n + i] = 0.5f * ((a + b) + (c + d));
                square[j * stride + n + i] = 0.5f * ((a - b) + (c - d));
                square[(n + j) * stride + i] = 0.5f * ((a + b) - (c + d));
                square[(n + j) * stride + n + i] = 0.5f * ((a - b) - (c - d));
            }
        }
        averages.swap(coarser);
    }
    square[0] = averages[0];
}

void haarInverse(std::span<float> square, int side) {
    checkSquare(square, side);
    const size_t stride = size_t(side);
    std::vector<float> averages(square.size()), finer(square.size());
    averages[0] = square[0];
    for (size_t n = 1; n < stride; n *= 2) {
        for (size_t j = 0; j < n; ++j) {
            float* upper = &finer[2 * j * 2 * n];
            float* lower = upper + 2 * n;
            for (size_t i = 0; i < n; ++i) {
                const float s = averages[j * n + i], h = square[j * stride + n + i];
                const float v = square[(n + j) * stride + i], d = square[(n + j) * stride + n + i];
                upper[2 * i] = 0.5f * ((s + h) + (v + d));
                upper[2 * i + 1] = 0.5f * ((s - h) + (v - d));
                lower[2 * i] = 0.5f * ((s + h) - (v + d));
                lower[2 * i + 1] = 0.5f * ((s - h) - (v - d));
            }
        }
        averages.swap(finer);
    }
    std::copy(averages.begin(), averages.end(), square.begin());
}

}  // namespace relamp
