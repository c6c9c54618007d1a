// Pairs of random rows and their weights, for the normal equations' tests.
#pragma once
#include "base/random.h"
#include "solve/ratio/pair_gram.h"

namespace relamp::test {

struct PairProblem {
    InfluenceMatrix rows;
    ChannelWeights weights;
};

/// Pairs of rows with a residual b_c B_b - a_c B_a in each channel and a precision between the channels, as the ratio
/// fit has them.
inline PairProblem randomPairs(size_t count, size_t columns) {
    PairProblem p;
    p.rows.rows = count;
    p.rows.columns = columns;
    for (size_t i = 0; i < count * columns; ++i) p.rows.values.push_back(unitFloat(mixBits(i)));
    std::vector<std::vector<std::pair<uint32_t, std::array<float, 6>>>> partners(count);
    const auto add = [&](uint32_t i, uint32_t j, const std::array<float, 6>& w) { partners[i].emplace_back(j, w); };
    for (uint64_t k = 0; k < 3 * count; ++k) {
        const uint32_t a = uint32_t(mixBits(k * 7) % count), b = uint32_t(mixBits(k * 7 + 1) % count);
        if (a == b) continue;
        float ta[3], tb[3];
        for (uint64_t c = 0; c < 3; ++c)
            ta[c] = 0.5f + unitFloat(mixBits(k * 11 + c)), tb[c] = 0.5f + unitFloat(mixBits(k * 13 + c));
        std::array<float, 6> aa, ab, ba, bb;
        for (size_t block = 0; block < 6; ++block) {
            const auto [c, d] = ChannelWeights::blocks[block];
            const float precision = c == d ? 1.0f : -0.3f;
            aa[block] = precision * ta[c] * ta[d];
            ab[block] = -precision * ta[c] * tb[d];
            ba[block] = -precision * tb[c] * ta[d];
            bb[block] = precision * tb[c] * tb[d];
        }
        add(a, a, aa);
        add(a, b, ab);
        add(b, a, ba);
        add(b, b, bb);
    }
    p.weights.start.push_back(0);
    for (const auto& row : partners) {
        for (const auto& [other, w] : row) {
            p.weights.other.push_back(other);
            p.weights.weight.push_back(w);
        }
        p.weights.start.push_back(uint32_t(p.weights.other.size()));
    }
    return p;
}

}  // namespace relamp::test
