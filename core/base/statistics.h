// Order statistics of small and large samples. Each rule of selection has a name, because results must stay the same
// bit for bit: for an even count the "middle" differs between them.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace relamp {

/// The value that would stand at `rank` (from 0, below the count) if the values were sorted. Reorders them.
template <class T>
T selectRank(std::vector<T>& values, size_t rank) {
    const auto at = values.begin() + std::ptrdiff_t(rank);
    std::nth_element(values.begin(), at, values.end());
    return *at;
}

/// Rank floor(fraction x (count - 1)); 0 without values. Reorders them.
template <class T>
T selectQuantile(std::vector<T>& values, double fraction) {
    return values.empty() ? T(0) : selectRank(values, size_t(fraction * double(values.size() - 1)));
}

/// selectQuantile of a copy, or of what is moved in.
template <class T>
T quantileOf(std::vector<T> values, double fraction) {
    return selectQuantile(values, fraction);
}

/// The quantile of the nearest rank: floor(fraction x (count - 1) + 1/2); 0 without values.
template <class T>
T nearestQuantileOf(std::vector<T> values, double fraction) {
    return values.empty() ? T(0) : selectRank(values, size_t(std::floor(double(values.size() - 1) * fraction + 0.5)));
}

/// The middle value, of an even count the upper of the two; 0 without values.
template <class T>
T medianOf(std::vector<T> values) {
    return values.empty() ? T(0) : selectRank(values, values.size() / 2);
}

/// The middle value, of an even count the lower of the two; 0 without values.
template <class T>
T lowerMedianOf(std::vector<T> values) {
    return quantileOf(std::move(values), 0.5);
}

/// The middle value, of an even count the mean of the two; 0 without values.
template <class T>
T meanMedianOf(std::vector<T> values) {
    if (values.empty()) return T(0);
    const size_t half = values.size() / 2;
    const T upper = selectRank(values, half);
    if (values.size() % 2) return upper;
    return T(0.5) * (*std::max_element(values.begin(), values.begin() + std::ptrdiff_t(half)) + upper);
}

}  // namespace relamp
