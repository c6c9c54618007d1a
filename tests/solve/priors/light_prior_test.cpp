#include "solve/priors/light_prior.h"

#include <gtest/gtest.h>

#include "tests/solve/small_problem.h"

namespace relamp {
namespace {

Eigen::VectorXd unknowns(const Lighting& light, int c) {
    Eigen::VectorXd x(Eigen::Index(light.leaves.size() + light.emitterRadiance.size()));
    for (size_t i = 0; i < light.leaves.size(); ++i) x(Eigen::Index(i)) = light.leafRadiance[i][c];
    for (size_t e = 0; e < light.emitterRadiance.size(); ++e)
        x(Eigen::Index(light.leaves.size() + e)) = light.emitterRadiance[e][c];
    return x;
}

TEST(LightPrior, DoesNotCareForTheScaleOfUnobservedLight) {
    const test::SmallProblem p = test::smallProblem();
    const LightPrior prior(p.truth.leaves, p.anchors, {});
    const Eigen::VectorXd x = unknowns(p.truth, 0);
    EXPECT_GT(prior.value(x, 0), 0);
    EXPECT_NEAR(prior.value(1e-3 * x, 0), prior.value(x, 0), 1e-9 * prior.value(x, 0));
    EXPECT_NEAR(prior.value(1e3 * x, 0), prior.value(x, 0), 1e-9 * prior.value(x, 0));
}

TEST(LightPrior, LightThatNothingReceivesExcusesNoDifferences) {
    test::SmallProblem p = test::smallProblem();
    const size_t unobserved = 20;
    for (size_t r = 0; r < p.influence.rows; ++r) p.influence.row(r)[unobserved] = 0;
    const LightPrior prior(p.truth.leaves, p.anchors, {}, p.influence);
    Eigen::VectorXd x = unknowns(p.truth, 0);
    x(Eigen::Index(unobserved)) = 0;
    const double before = prior.value(x, 0);
    x(Eigen::Index(unobserved)) = 1e6;
    EXPECT_GT(prior.value(x, 0), before);
}

TEST(LightPrior, DividingABrightLeafDoesNotMakeItsRimDearer) {
    LightPriorOptions options;
    options.darkness = 1;
    const auto valueOf = [&](int level) {
        LightAnchors anchors;
        const LightLeaves leaves = LightLeaves::uniform(level);
        anchors.leaves.resize(leaves.size());
        Eigen::VectorXd x(Eigen::Index(leaves.size()));
        // A square of a quarter of the side, 100 times as bright.
        const int side = 1 << level;
        for (size_t i = 0; i < leaves.size(); ++i) {
            const int cx = leaves[i].x * 16 / side, cy = leaves[i].y * 16 / side;
            x(Eigen::Index(i)) = cx >= 4 && cx < 8 && cy >= 4 && cy < 8 ? 100 : 1;
        }
        return LightPrior(leaves, anchors, options).value(x, 0);
    };
    EXPECT_NEAR(valueOf(5), valueOf(4), 1e-9 * valueOf(4));
    EXPECT_NEAR(valueOf(6), valueOf(4), 1e-9 * valueOf(4));
}

TEST(LightPrior, ItsQuadraticModelHasNoSlopeAlongTheLightItself) {
    test::SmallProblem p = test::smallProblem();
    const Eigen::Index n = Eigen::Index(p.truth.leaves.size());
    p.anchors.emitterRadiance.clear();
    const LightPrior prior(p.truth.leaves, p.anchors, {});
    const Eigen::VectorXd x = unknowns(p.truth, 0).head(n);
    Eigen::MatrixXd q = Eigen::MatrixXd::Zero(n, n);
    Eigen::VectorXd moment = Eigen::VectorXd::Zero(n), lower = Eigen::VectorXd::Zero(n);
    prior.add(x, 0, q, moment, lower);
    EXPECT_NEAR(x.dot(q * x - moment), 0, 1e-6 * prior.value(x, 0));
}

TEST(LightPrior, ItsModelHasTheGradientOfItsValue) {
    test::SmallProblem p = test::smallProblem();
    const Eigen::Index n = Eigen::Index(p.truth.leaves.size());
    p.anchors.emitterRadiance.clear();
    for (size_t i = 0; i < 20; ++i) p.anchors.leaves[i] = {Rgb(0.7f), 0.9f, false};
    LightPriorOptions options;
    options.backgroundWeight = 0;  // its unit is held fixed in the model on purpose
    const LightPrior prior(p.truth.leaves, p.anchors, options);
    const Eigen::VectorXd x = unknowns(p.truth, 2).head(n);
    Eigen::MatrixXd q = Eigen::MatrixXd::Zero(n, n);
    Eigen::VectorXd moment = Eigen::VectorXd::Zero(n), lower = Eigen::VectorXd::Zero(n);
    prior.add(x, 2, q, moment, lower);
    const Eigen::VectorXd slope = 2 * (q * x - moment);
    for (Eigen::Index i = 0; i < n; i += 5) {
        Eigen::VectorXd up = x, down = x;
        up(i) += 1e-5;
        down(i) -= 1e-5;
        EXPECT_NEAR((prior.value(up, 2) - prior.value(down, 2)) / 2e-5, slope(i), 1e-3 * slope.cwiseAbs().maxCoeff())
            << i;
    }
}

TEST(LightPrior, OfTwoEnvironmentsIsTheSumOfBothAndHasTheGradientOfItsValue) {
    test::SmallProblem p = test::smallProblem();
    const Eigen::Index n = Eigen::Index(p.truth.leaves.size());
    p.anchors.emitterRadiance.clear();
    const LightPrior alone(p.truth.leaves, p.anchors, {});
    const Eigen::VectorXd x = unknowns(p.truth, 0).head(n);
    const LightLeaves both = LightLeaves::uniform(3, Mat3(1), {0, 1});
    ASSERT_EQ(Eigen::Index(both.size()), 2 * n);
    LightAnchors anchors = p.anchors;
    anchors.leaves.insert(anchors.leaves.end(), p.anchors.leaves.begin(), p.anchors.leaves.end());
    const LightPrior together(both, anchors, {});
    Eigen::VectorXd two(2 * n);
    two << x, 5 * x.reverse();
    const double value = together.value(two, 0);
    EXPECT_NEAR(value, alone.value(x, 0) + alone.value(x.reverse(), 0), 1e-9 * value) << "each in its own brightness";
    Eigen::MatrixXd q = Eigen::MatrixXd::Zero(2 * n, 2 * n);
    Eigen::VectorXd moment = Eigen::VectorXd::Zero(2 * n), lower = moment;
    together.add(two, 0, q, moment, lower);
    EXPECT_EQ(q.topRightCorner(n, n).cwiseAbs().maxCoeff(), 0);
    const Eigen::VectorXd slope = 2 * (q * two - moment);
    for (Eigen::Index i = 2; i < 2 * n; i += 17) {
        Eigen::VectorXd up = two, down = two;
        up(i) += 1e-5;
        down(i) -= 1e-5;
        EXPECT_NEAR((together.value(up, 0) - together.value(down, 0)) / 2e-5, slope(i),
                    1e-3 * slope.cwiseAbs().maxCoeff())
            << i;
    }
}

TEST(LightPrior, ALeafHasAtLeastWhatIsSeenOfIt) {
    test::SmallProblem p = test::smallProblem();
    p.anchors.leaves[3] = {Rgb(2, 4, 8), 0.75f, false};
    p.anchors.leaves[4] = {Rgb(100), 1.0f, true};
    p.anchors.emitterClipped[0] = 1;
    const LightPrior prior(p.truth.leaves, p.anchors, {});
    const Eigen::VectorXd lowest = prior.lowest(1);
    const Eigen::Index n = Eigen::Index(p.truth.leaves.size());
    ASSERT_EQ(lowest.size(), n + 1);
    EXPECT_DOUBLE_EQ(lowest(3), 3.0);
    EXPECT_DOUBLE_EQ(lowest(4), 100.0);
    EXPECT_DOUBLE_EQ(lowest(5), 0.0);
    EXPECT_DOUBLE_EQ(lowest(n), 10.0);
}

TEST(LightPrior, PullsASeenLeafToWhatWasSeen) {
    test::SmallProblem p = test::smallProblem();
    p.anchors.leaves[10] = {Rgb(5), 1.0f, false};
    p.anchors.leaves[11] = {Rgb(5), 1.0f, true};  // clipped: says nothing here
    const LightPrior prior(p.truth.leaves, p.anchors, {});
    Eigen::VectorXd x = unknowns(p.truth, 0);
    x(10) = 5;
    const double right = prior.value(x, 0);
    x(10) = 2;
    EXPECT_GT(prior.value(x, 0), right + 1000);
}

TEST(LightPrior, HueDoesNotCareForTheBalanceOfTheChannels) {
    const test::SmallProblem p = test::smallProblem();
    const LightPrior prior(p.truth.leaves, p.anchors, {}, p.influence);
    Eigen::VectorXd x[3] = {unknowns(p.truth, 0), unknowns(p.truth, 1), unknowns(p.truth, 2)};
    const double before = prior.hueValue(x);
    EXPECT_GT(before, 0);
    x[0] *= 3;
    x[2] *= 0.2;
    EXPECT_NEAR(prior.hueValue(x), before, 1e-9 * before);
    // Nothing differs in hue where all channels are one image.
    x[1] = 2 * x[0];
    x[2] = 0.5 * x[0];
    EXPECT_NEAR(prior.hueValue(x), 0, 1e-9 * before);
}

TEST(LightPrior, TheModelOfHueHasTheGradientOfItsValue) {
    const test::SmallProblem p = test::smallProblem();
    const LightPrior prior(p.truth.leaves, p.anchors, {}, p.influence);
    Eigen::VectorXd x[3] = {unknowns(p.truth, 0), unknowns(p.truth, 1), unknowns(p.truth, 2)};
    const Eigen::Index n = x[0].size();
    Eigen::MatrixXd q = Eigen::MatrixXd::Zero(3 * n, 3 * n);
    Eigen::VectorXd moment = Eigen::VectorXd::Zero(3 * n), all(3 * n);
    prior.addHue(x, q, moment);
    EXPECT_LT((q - q.transpose()).norm(), 1e-12 * q.norm());
    for (int c = 0; c < 3; ++c) all.segment(c * n, n) = x[c];
    const Eigen::VectorXd slope = 2 * (q * all - moment);
    for (const Eigen::Index k : {Eigen::Index(3), n + 17, 2 * n + 40, n - 2, 3 * n - 2}) {
        const double step = 1e-5, old = x[k / n](k % n);
        x[k / n](k % n) = old + step;
        const double up = prior.hueValue(x);
        x[k / n](k % n) = old - step;
        const double down = prior.hueValue(x);
        x[k / n](k % n) = old;
        EXPECT_NEAR(slope(k), (up - down) / (2 * step), 1e-4 * slope.cwiseAbs().maxCoeff()) << k;
    }
}

}  // namespace
}  // namespace relamp
