// Vertices that writers split because of their texture coordinates: at one place and with one normal.
#pragma once
#include <algorithm>
#include <array>
#include <bit>
#include <numeric>
#include <vector>

#include "base/math.h"

namespace relamp {

/// Per number below `count` the first one with the same `key`, which `<` orders. O(n log n).
template <class Key>
std::vector<uint32_t> firstOfEqual(size_t count, const Key& key) {
    std::vector<uint32_t> order(count), first(count);
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
        const auto ka = key(a), kb = key(b);
        return ka != kb ? ka < kb : a < b;
    });
    for (size_t i = 0; i < order.size(); ++i)
        first[order[i]] = i > 0 && key(order[i]) == key(order[i - 1]) ? first[order[i - 1]] : order[i];
    return first;
}

/// Per vertex the first one with the same position and normal. What is no number equals itself. O(n log n).
template <class Position>
std::vector<uint32_t> firstEqualVertex(const std::vector<Position>& positions, const std::vector<Vec3>& normals) {
    return firstOfEqual(positions.size(), [&](uint32_t v) {
        std::array<uint64_t, 6> bits;
        for (int c = 0; c < 3; ++c) {
            bits[size_t(c)] = std::bit_cast<uint64_t>(double(positions[v][c]) + 0.0);  // -0 is 0
            bits[size_t(3 + c)] = std::bit_cast<uint64_t>(double(normals[v][c]) + 0.0);
        }
        return bits;
    });
}

}  // namespace relamp
