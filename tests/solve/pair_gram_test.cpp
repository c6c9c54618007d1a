#include "solve/pair_gram.h"

#include <gtest/gtest.h>

#include "base/parallel.h"
#include "base/random.h"

namespace relamp {
namespace {

struct Problem {
    InfluenceMatrix rows;
    ChannelWeights weights;
};

/// Pairs of rows with a residual b_c B_b - a_c B_a in each channel and a precision between the channels, as the ratio fit has them.
Problem pairsOf(size_t count, size_t columns) {
    Problem p;
    p.rows.rows = count;
    p.rows.columns = columns;
    for (size_t i = 0; i < count * columns; ++i) p.rows.values.push_back(unitFloat(mixBits(i)));
    std::vector<std::vector<std::pair<uint32_t, std::array<float, 6>>>> partners(count);
    const auto add = [&](uint32_t i, uint32_t j, const std::array<float, 6>& w) { partners[i].emplace_back(j, w); };
    for (uint64_t k = 0; k < 3 * count; ++k) {
        const uint32_t a = uint32_t(mixBits(k * 7) % count), b = uint32_t(mixBits(k * 7 + 1) % count);
        if (a == b) continue;
        float ta[3], tb[3];
        for (uint64_t c = 0; c < 3; ++c) ta[c] = 0.5f + unitFloat(mixBits(k * 11 + c)), tb[c] = 0.5f + unitFloat(mixBits(k * 13 + c));
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

Eigen::MatrixXd bruteForce(const Problem& p, bool apart) {
    const Eigen::Index n = Eigen::Index(p.rows.columns);
    Eigen::MatrixXd all = Eigen::MatrixXd::Zero(3 * n, 3 * n);
    for (size_t i = 0; i < p.rows.rows; ++i)
        for (uint32_t e = p.weights.start[i]; e < p.weights.start[i + 1]; ++e)
            for (size_t block = 0; block < (apart ? 3u : 6u); ++block) {
                const auto [c, d] = ChannelWeights::blocks[block];
                const Eigen::Map<const Eigen::VectorXf> mine(p.rows.row(i), n), other(p.rows.row(p.weights.other[e]), n);
                const Eigen::MatrixXd part = double(p.weights.weight[e][block]) * mine.cast<double>() * other.cast<double>().transpose();
                all.block(c * n, d * n, n, n) += part;
                if (c != d) all.block(d * n, c * n, n, n) += part.transpose();
            }
    return all;
}

TEST(PairGram, IsTheSumOverRowsAndPartners) {
    // Widths on either side of a panel, rows on either side of a block.
    for (const auto& [count, columns] : {std::pair{40, 7}, {600, 32}, {513, 71}, {1100, 96}})
        for (const bool apart : {false, true}) {
            const Problem p = pairsOf(size_t(count), size_t(columns));
            Progress progress;
            const Eigen::MatrixXd found = channelGram(p.rows, p.weights, apart, progress), wanted = bruteForce(p, apart);
            ASSERT_EQ(found.rows(), wanted.rows());
            EXPECT_LT((found - wanted).norm(), 2e-6 * wanted.norm()) << count << " x " << columns << (apart ? ", apart" : "");
            EXPECT_EQ((found - found.transpose()).norm(), 0);
        }
}

TEST(PairGram, HasTheSameBitsOnAnyNumberOfThreads) {
    const Problem p = pairsOf(1500, 150);
    Progress progress;
    const Eigen::MatrixXd many = channelGram(p.rows, p.weights, false, progress);
    const ThreadLimit one(1);
    EXPECT_EQ((many - channelGram(p.rows, p.weights, false, progress)).norm(), 0);
}

TEST(PairGram, NoRowsGiveZeros) {
    Problem p;
    p.rows.columns = 5;
    p.weights.start.push_back(0);
    Progress progress;
    EXPECT_EQ(channelGram(p.rows, p.weights, false, progress), Eigen::MatrixXd::Zero(15, 15));
}

TEST(PairGram, Stops) {
    const Problem p = pairsOf(40, 64);
    Progress progress;
    progress.requestStop();
    EXPECT_THROW(channelGram(p.rows, p.weights, false, progress), Cancelled);
}

}  // namespace
}  // namespace relamp
