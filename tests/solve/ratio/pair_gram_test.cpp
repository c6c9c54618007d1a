#include "solve/ratio/pair_gram.h"

#include <gtest/gtest.h>

#include "base/parallel.h"

#include "tests/solve/random_pairs.h"

namespace relamp {
namespace {

Eigen::MatrixXd bruteForce(const test::PairProblem& p, bool apart) {
    const Eigen::Index n = Eigen::Index(p.rows.columns);
    Eigen::MatrixXd all = Eigen::MatrixXd::Zero(3 * n, 3 * n);
    for (size_t i = 0; i < p.rows.rows; ++i)
        for (uint32_t e = p.weights.start[i]; e < p.weights.start[i + 1]; ++e)
            for (size_t block = 0; block < (apart ? 3u : 6u); ++block) {
                const auto [c, d] = ChannelWeights::blocks[block];
                const Eigen::Map<const Eigen::VectorXf> mine(p.rows.row(i), n),
                    other(p.rows.row(p.weights.other[e]), n);
                const Eigen::MatrixXd part =
                    double(p.weights.weight[e][block]) * mine.cast<double>() * other.cast<double>().transpose();
                all.block(c * n, d * n, n, n) += part;
                if (c != d) all.block(d * n, c * n, n, n) += part.transpose();
            }
    return all;
}

TEST(PairGram, IsTheSumOverRowsAndPartners) {
    // Widths on either side of a panel, rows on either side of a block.
    for (const auto& [count, columns] : {std::pair{40, 7}, {600, 32}, {513, 71}, {1100, 96}})
        for (const bool apart : {false, true}) {
            const test::PairProblem p = test::randomPairs(size_t(count), size_t(columns));
            Progress progress;
            const Eigen::MatrixXd found = channelGram(p.rows, p.weights, apart, progress),
                                  wanted = bruteForce(p, apart);
            ASSERT_EQ(found.rows(), wanted.rows());
            EXPECT_LT((found - wanted).norm(), 2e-6 * wanted.norm())
                << count << " x " << columns << (apart ? ", apart" : "");
            EXPECT_EQ((found - found.transpose()).norm(), 0);
        }
}

TEST(PairGram, HasTheSameBitsOnAnyNumberOfThreads) {
    const test::PairProblem p = test::randomPairs(1500, 150);
    Progress progress;
    const Eigen::MatrixXd many = channelGram(p.rows, p.weights, false, progress);
    const ThreadLimit one(1);
    EXPECT_EQ((many - channelGram(p.rows, p.weights, false, progress)).norm(), 0);
}

TEST(PairGram, NoRowsGiveZeros) {
    test::PairProblem p;
    p.rows.columns = 5;
    p.weights.start.push_back(0);
    Progress progress;
    EXPECT_EQ(channelGram(p.rows, p.weights, false, progress), Eigen::MatrixXd::Zero(15, 15));
}

TEST(PairGram, Stops) {
    const test::PairProblem p = test::randomPairs(40, 64);
    Progress progress;
    progress.requestStop();
    EXPECT_THROW(channelGram(p.rows, p.weights, false, progress), Cancelled);
}

}  // namespace
}  // namespace relamp
