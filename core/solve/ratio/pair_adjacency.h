// The pairs of each observation.
#pragma once
#include <vector>

#include "solve/ratio/pairs.h"

namespace relamp {

/// For each observation its partners: (pair, other end).
struct Adjacency {
    std::vector<uint32_t> start, pair, other;

    Adjacency(size_t n, const std::vector<AlbedoPair>& pairs)
        : start(n + 1, 0), pair(2 * pairs.size()), other(2 * pairs.size()) {
        for (const AlbedoPair& p : pairs) {
            ++start[p.a + 1];
            ++start[p.b + 1];
        }
        for (size_t i = 0; i < n; ++i) start[i + 1] += start[i];
        std::vector<uint32_t> fill(start.begin(), start.end() - 1);
        for (uint32_t k = 0; k < pairs.size(); ++k) {
            const AlbedoPair& p = pairs[k];
            pair[fill[p.a]] = k;
            other[fill[p.a]++] = p.b;
            pair[fill[p.b]] = k;
            other[fill[p.b]++] = p.a;
        }
    }
};

}  // namespace relamp
