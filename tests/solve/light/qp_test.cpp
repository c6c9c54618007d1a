#include "solve/light/qp.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <random>

#include "base/dense.h"
#include "base/parallel.h"

namespace relamp {
namespace {

struct Problem {
    Eigen::MatrixXd a;
    Eigen::VectorXd b;
};

Problem randomProblem(int rows, int columns, unsigned seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    Problem p{Eigen::MatrixXd(rows, columns), Eigen::VectorXd(rows)};
    for (int i = 0; i < rows; ++i) {
        for (int j = 0; j < columns; ++j) p.a(i, j) = normal(random);
        p.b(i) = normal(random);
    }
    return p;
}

/// The best of all choices of free variables.
double bruteForce(const Eigen::MatrixXd& q, const Eigen::VectorXd& c) {
    const int n = int(c.size());
    double best = 0;
    for (int mask = 1; mask < 1 << n; ++mask) {
        std::vector<int> index;
        for (int i = 0; i < n; ++i)
            if (mask >> i & 1) index.push_back(i);
        Eigen::MatrixXd sub(index.size(), index.size());
        Eigen::VectorXd rhs(index.size());
        for (size_t i = 0; i < index.size(); ++i) {
            rhs(Eigen::Index(i)) = c(index[i]);
            for (size_t j = 0; j < index.size(); ++j) sub(Eigen::Index(i), Eigen::Index(j)) = q(index[i], index[j]);
        }
        const Eigen::VectorXd x = solveSymmetric(sub, rhs);
        if (x.minCoeff() < -1e-9) continue;
        best = std::min(best, x.dot(sub * x) - 2 * rhs.dot(x));
    }
    return best;
}

TEST(BoundedQp, FindsTheBestOfAllActiveSets) {
    for (unsigned seed = 1; seed <= 20; ++seed) {
        const Problem p = randomProblem(12, 8, seed);
        const Eigen::MatrixXd q = transposedProduct(p.a, p.a);
        const Eigen::VectorXd c = transposedProduct(p.a, p.b);
        const QpResult r = solveBoundedQp(q, c, Eigen::VectorXd::Zero(8));
        ASSERT_TRUE(r.converged) << r.reason;
        EXPECT_GE(r.x.minCoeff(), 0);
        EXPECT_NEAR(r.x.dot(q * r.x) - 2 * c.dot(r.x), bruteForce(q, c), 1e-8) << seed;
        EXPECT_LT(r.kktResidual, 1e-8);
    }
}

TEST(BoundedQp, HoldsLowerBoundsOtherThanZero) {
    const Eigen::MatrixXd q = Eigen::Vector2d(2, 3).asDiagonal();
    const QpResult r = solveBoundedQp(q, Eigen::Vector2d(1, -5), Eigen::Vector2d(2, -1));
    EXPECT_NEAR(r.x(0), 2, 1e-12);   // free minimum 0.5 lies below the bound
    EXPECT_NEAR(r.x(1), -1, 1e-12);  // free minimum -5/3 lies below the bound
}

TEST(BoundedQp, StaysFiniteWithDuplicatedAndEmptyColumns) {
    Problem p = randomProblem(40, 10, 7);
    p.a.col(3) = p.a.col(2);
    p.a.col(9).setZero();
    const QpResult r =
        solveBoundedQp(transposedProduct(p.a, p.a), transposedProduct(p.a, p.b), Eigen::VectorXd::Zero(10));
    EXPECT_TRUE(r.x.allFinite());
    EXPECT_LT(r.kktResidual, 1e-6);
    EXPECT_EQ(r.x(9), 0);
}

TEST(BoundedQp, ScalesExactlyOverTwentyFourDecades) {
    const Problem p = randomProblem(60, 12, 3);
    const Eigen::MatrixXd q = transposedProduct(p.a, p.a);
    const Eigen::VectorXd c = transposedProduct(p.a, p.b), zero = Eigen::VectorXd::Zero(12);
    const Eigen::VectorXd x = solveBoundedQp(q, c, zero).x;
    for (const double s : {1e-12, 1e12}) {
        const Eigen::VectorXd scaled = solveBoundedQp(q, c * s, zero).x;
        EXPECT_LT((scaled / s - x).norm(), 1e-9 * x.norm()) << s;
    }
}

TEST(BoundedQp, GivesTheSameAnswerFromAnyGuess) {
    const Problem p = randomProblem(90, 30, 11);
    const Eigen::MatrixXd q = transposedProduct(p.a, p.a);
    const Eigen::VectorXd c = transposedProduct(p.a, p.b), zero = Eigen::VectorXd::Zero(30),
                          ones = Eigen::VectorXd::Ones(30);
    EXPECT_LT((solveBoundedQp(q, c, zero).x - solveBoundedQp(q, c, zero, &ones).x).norm(), 1e-9);
}

TEST(BoundedQp, ReportsNumbersThatAreNotFiniteInsteadOfThrowing) {
    Eigen::MatrixXd q = Eigen::MatrixXd::Identity(2, 2);
    q(0, 0) = std::numeric_limits<double>::quiet_NaN();
    const QpResult r = solveBoundedQp(q, Eigen::Vector2d(1, 1), Eigen::Vector2d::Zero());
    EXPECT_FALSE(r.converged);
    EXPECT_FALSE(r.reason.empty());
    EXPECT_TRUE(r.x.allFinite());
}

TEST(BoundedQp, EndsExactlyOnLargeStiffProgramsOnAnyNumberOfThreads) {
    // A smooth kernel on columns of 1 : 100, and half of the variables at their bound.
    constexpr int n = 600;
    Eigen::MatrixXd q(n, n);
    Eigen::VectorXd truth(n);
    for (int i = 0; i < n; ++i) {
        truth(i) = i % 97 < 40 ? 0.0 : 1 + std::sin(i * 0.05);
        for (int j = 0; j < n; ++j)
            q(i, j) = std::exp(-0.1 * (i - j) * (i - j)) * std::pow(10.0, (i % 3 - 1) + (j % 3 - 1));
    }
    const Eigen::VectorXd c = q * truth - Eigen::VectorXd::LinSpaced(n, 0, 0.5).cwiseMax(0.0),
                          zero = Eigen::VectorXd::Zero(n);
    QpResult one;
    {
        const ThreadLimit limit(1);
        one = solveBoundedQp(q, c, zero);
    }
    EXPECT_TRUE(one.converged) << one.reason;
    EXPECT_LT(one.kktResidual, 1e-6);
    EXPECT_EQ(one.x, solveBoundedQp(q, c, zero).x);
}

TEST(BoundedQp, EndsWhereAFactorInDoubleEndsHoweverStiffALargeProgramIs) {
    // Large programs are factored in single precision first; a diagonal of 1 to 1e-12 beside neighbours that pull on
    // each other is too stiff for that.
    constexpr int n = 700;
    for (const double weakest : {1e-2, 1e-6, 1e-9}) {
        Eigen::MatrixXd q = Eigen::MatrixXd::Zero(n, n);
        for (int i = 0; i < n; ++i) {
            q(i, i) += weakest;
            if (i + 1 < n) {
                q(i, i) += 1;
                q(i + 1, i + 1) += 1;
                q(i, i + 1) = q(i + 1, i) = -1;
            }
        }
        const Eigen::VectorXd truth = Eigen::VectorXd::LinSpaced(n, 1, 2), c = q * truth,
                              zero = Eigen::VectorXd::Zero(n);
        const QpResult r = solveBoundedQp(q, c, zero);
        EXPECT_TRUE(r.converged) << r.reason;
        EXPECT_LT(r.kktResidual, 1e-12) << weakest;
        const Eigen::VectorXd wanted = solveSymmetric(q, c);
        EXPECT_LT((r.x - wanted).norm(), 3e-12 / weakest * wanted.norm()) << weakest;  // a ridge of 1e-12
    }
}

TEST(BoundedQp, TellsPointsThatKeepTheBoundsAndStopsInside) {
    const Problem p = randomProblem(1500, 1200, 2);
    const Eigen::MatrixXd q = transposedProduct(p.a, p.a);
    const Eigen::VectorXd c = transposedProduct(p.a, p.b), lower = Eigen::VectorXd::Constant(1200, -0.01);
    Progress progress;
    QpWatch watch;
    watch.progress = &progress;
    int heard = 0;
    watch.each = [&](const Eigen::VectorXd& x) {
        EXPECT_GE((x - lower).minCoeff(), 0);
        if (++heard == 4) progress.requestStop();
    };
    EXPECT_THROW(solveBoundedQp(q, c, lower, nullptr, watch), Cancelled);
    EXPECT_EQ(heard, 4);
}

}  // namespace
}  // namespace relamp
