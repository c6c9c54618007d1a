// Haar basis functions written down from their definition, cell by cell, to hold the fast code against.
#pragma once
#include <cmath>
#include <cstdint>
#include <vector>

#include "base/random.h"
#include "wavelet/coefficients.h"
#include "wavelet/haar.h"

namespace relamp::test {

/// Value of basis function `index` in cell (x, y) of a side x side square of the given area.
inline double haarValue(uint32_t index, int x, int y, int side, double area) {
    const double unit = 1 / std::sqrt(area);
    if (index == 0) return unit;
    const int column = int(index) % side, row = int(index) / side;
    int n = 1;
    while (2 * n <= std::max(column, row)) n *= 2;
    const int width = side / n;  // cells along one square of this level
    const bool alongX = column >= n, alongY = row >= n;
    const int left = (alongX ? column - n : column) * width, top = (alongY ? row - n : row) * width;
    if (x < left || x >= left + width || y < top || y >= top + width) return 0;
    double sign = 1;
    if (alongX && x >= left + width / 2) sign = -sign;
    if (alongY && y >= top + width / 2) sign = -sign;
    return sign * n * unit;
}

/// Deterministic numbers in [-1, 1).
inline std::vector<float> randomValues(size_t count, uint64_t seed) {
    std::vector<float> values(count);
    for (size_t k = 0; k < count; ++k) values[k] = 2 * unitFloat(mixBits(mixBits(seed) ^ k)) - 1;
    return values;
}

/// Coefficients of a function given by its values in the cells.
inline SparseCoefs coefsOfCells(std::vector<float> cells, int side, double area) {
    for (float& value : cells) value *= float(std::sqrt(area) / side);
    haarForward(cells, side);
    return sparsify(cells);
}

/// Values in the cells of the function with these coefficients.
inline std::vector<double> cellsOfCoefs(const SparseCoefs& coefs, int side, double area) {
    std::vector<double> cells(size_t(side) * size_t(side), 0.0);
    for (size_t t = 0; t < coefs.size(); ++t)
        for (int y = 0; y < side; ++y)
            for (int x = 0; x < side; ++x)
                cells[size_t(y * side + x)] += double(coefs.value[t]) * haarValue(coefs.index[t], x, y, side, area);
    return cells;
}

}  // namespace relamp::test
