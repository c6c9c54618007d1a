#include "solve/light/folded_gram.h"

#include <gtest/gtest.h>

#include <Eigen/Core>

#include "base/dense.h"
#include "base/parallel.h"

#include "tests/solve/random_pairs.h"

namespace relamp {
namespace {

/// Columns 0 to 3 and 4 to 7 are groups, all others stand alone.
std::vector<uint32_t> twoQuads(size_t columns) {
    std::vector<uint32_t> group;
    for (uint32_t k = 0; k < columns; ++k) group.push_back(k < 8 ? k / 4 : k);
    return group;
}

void makeQuadsProportional(InfluenceMatrix& rows) {
    constexpr float fraction[4] = {0.1f, 0.2f, 0.3f, 0.4f};
    for (size_t i = 0; i < rows.rows; ++i)
        for (size_t quad = 0; quad < 2; ++quad) {
            const float sum = rows.row(i)[4 * quad];
            for (size_t k = 0; k < 4; ++k) rows.row(i)[4 * quad + k] = fraction[k] * sum;
        }
}

TEST(FoldedGram, IsTheWholeOneWhereTheColumnsOfAGroupAreProportional) {
    test::PairProblem p = test::randomPairs(600, 40);
    makeQuadsProportional(p.rows);
    Progress progress;
    for (const bool apart : {false, true}) {
        const FoldedColumns fold = foldColumns(p.rows, p.rows.rows, twoQuads(40));
        ASSERT_EQ(fold.folded.columns, 34u);
        EXPECT_NEAR(fold.fraction(6), 0.3, 1e-6);
        const Eigen::MatrixXd wanted = channelGram(p.rows, p.weights, apart, progress),
                              found = foldedGram(fold, p.rows, p.weights, apart, progress);
        EXPECT_LT((found - wanted).norm(), 1e-5 * wanted.norm());
        EXPECT_LT((found - found.transpose()).norm(), 1e-12 * wanted.norm());
    }
}

TEST(FoldedGram, LeavesEmptyColumnsOutAndChangesNothing) {
    test::PairProblem p = test::randomPairs(300, 40);
    for (size_t i = 0; i < p.rows.rows; ++i)
        for (size_t k = 5; k < 25; ++k) p.rows.row(i)[k] = 0;
    Progress progress;
    const FoldedColumns fold = foldColumns(p.rows, p.rows.rows, {});
    EXPECT_EQ(fold.folded.columns, 20u);
    const Eigen::MatrixXd wanted = channelGram(p.rows, p.weights, false, progress),
                          found = foldedGram(fold, p.rows, p.weights, false, progress);
    EXPECT_LT((found - wanted).norm(), 2e-6 * wanted.norm());
}

TEST(FoldedGram, IsNeverNegativeAndHoldsWhatTheFoldingLeftOut) {
    const test::PairProblem p = test::randomPairs(600, 24);
    Progress progress;
    const Eigen::MatrixXd whole = channelGram(p.rows, p.weights, false, progress),
                          found = foldedGram(foldColumns(p.rows, p.rows.rows, twoQuads(24)), p.rows, p.weights, false,
                                             progress);
    const Eigen::VectorXd values = eigenOf(found, false).values;
    EXPECT_GT(values(0), -1e-6 * values(values.size() - 1));
    // Brothers against each other, in one channel: what the shares alone would call free.
    Eigen::VectorXd apart = Eigen::VectorXd::Zero(whole.rows());
    apart(0) = 1;
    apart(1) = -1;
    const double exact = apart.dot(whole * apart), folded = apart.dot(found * apart);
    EXPECT_GT(folded, 0.5 * exact);
    EXPECT_LT(folded, 2 * exact);
    // And what stands alone is as it was.
    EXPECT_LT((found.block(8, 8, 16, 16) - whole.block(8, 8, 16, 16)).norm(), 2e-6 * whole.norm());
}

TEST(FoldedGram, TakesTheRowsBehindAsTheyAre) {
    // Two worlds, one behind the other, without a weight between them; the first has proportional quads.
    test::PairProblem p = test::randomPairs(300, 40), behind = test::randomPairs(130, 40);
    makeQuadsProportional(p.rows);
    const uint32_t rows = uint32_t(p.rows.rows), weights = uint32_t(p.weights.other.size());
    p.rows.values.insert(p.rows.values.end(), behind.rows.values.begin(), behind.rows.values.end());
    p.rows.rows += behind.rows.rows;
    for (size_t i = 1; i < behind.weights.start.size(); ++i)
        p.weights.start.push_back(behind.weights.start[i] + weights);
    for (const uint32_t other : behind.weights.other) p.weights.other.push_back(other + rows);
    p.weights.weight.insert(p.weights.weight.end(), behind.weights.weight.begin(), behind.weights.weight.end());
    Progress progress;
    const Eigen::MatrixXd wanted = channelGram(p.rows, p.weights, false, progress),
                          found =
                              foldedGram(foldColumns(p.rows, rows, twoQuads(40)), p.rows, p.weights, false, progress);
    EXPECT_LT((found - wanted).norm(), 1e-5 * wanted.norm());
}

TEST(FoldedGram, HasTheSameBitsOnAnyNumberOfThreads) {
    const test::PairProblem p = test::randomPairs(900, 80);
    Progress progress;
    const auto gram = [&] {
        return foldedGram(foldColumns(p.rows, 900, twoQuads(80)), p.rows, p.weights, false, progress);
    };
    const Eigen::MatrixXd many = gram();
    const ThreadLimit one(1);
    EXPECT_EQ((many - gram()).norm(), 0);
}

}  // namespace
}  // namespace relamp
