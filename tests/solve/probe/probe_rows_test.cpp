#include "solve/probe/probe_rows.h"

#include <gtest/gtest.h>

#include "tests/solve/small_problem.h"

namespace relamp {
namespace {

ProbeAnchor probeOfTruth(const test::SmallProblem& p, float exposure, float noise, float gainSigma) {
    ProbeAnchor anchor;
    for (const Rgb& l : p.truth.leafRadiance) anchor.radiance.push_back(exposure * l);
    anchor.held.assign(p.truth.leaves.size(), 1);
    anchor.noise = noise;
    anchor.gainSigma = gainSigma;
    return anchor;
}

Eigen::VectorXd lightOf(const test::SmallProblem& p, double scale) {
    Eigen::VectorXd x(Eigen::Index(p.truth.leafRadiance.size()));
    for (Eigen::Index i = 0; i < x.size(); ++i)
        x(i) = scale * double(p.truth.leafRadiance[size_t(i)].x) * (1 + 0.05 * std::sin(3.0 * double(i)));
    return x;
}

TEST(ProbeRows, TheirModelHasTheSlopeOfTheirValue) {
    const test::SmallProblem p = test::smallProblem();
    const Eigen::VectorXd fraction = Eigen::VectorXd::Constant(64, 1.0 / 64);
    for (const float gainSigma : {0.0f, 0.02f}) {
        const ProbeAnchor anchor = probeOfTruth(p, 0.9f, 0.1f, gainSigma);
        const ProbeRows rows(anchor, fraction);
        const Eigen::VectorXd x = lightOf(p, 1);
        Eigen::MatrixXd q = Eigen::MatrixXd::Zero(64, 64);
        Eigen::VectorXd moment = Eigen::VectorXd::Zero(64);
        rows.add(x, 0, q, moment);
        const Eigen::VectorXd slope = 2 * (q * x - moment);
        for (Eigen::Index i = 0; i < 64; i += 7) {
            Eigen::VectorXd more = x, less = x;
            const double step = 1e-4 * x(i);
            more(i) += step;
            less(i) -= step;
            const double numeric = (rows.value(more, 0) - rows.value(less, 0)) / (2 * step);
            EXPECT_NEAR(slope(i), numeric, 0.02 * slope.cwiseAbs().maxCoeff()) << gainSigma << " " << i;
        }
    }
}

TEST(ProbeRows, AGainThatNothingTellsSaysNothingOfTheScale) {
    const test::SmallProblem p = test::smallProblem();
    const Eigen::VectorXd fraction = Eigen::VectorXd::Constant(64, 1.0 / 64);
    const ProbeAnchor anchor = probeOfTruth(p, 0.4f, 0.05f, 0);
    const ProbeRows rows(anchor, fraction);
    const Eigen::VectorXd exact = lightOf(p, 1);
    EXPECT_NEAR(rows.gain(exact, 0), 2.5, 0.05);
    EXPECT_NEAR(rows.gain(3 * exact, 0), 7.5, 0.15);
    Eigen::VectorXd truth(64);
    for (Eigen::Index i = 0; i < 64; ++i) truth(i) = p.truth.leafRadiance[size_t(i)].x;
    EXPECT_NEAR(rows.value(5 * truth, 0), 0, 1e-6);
}

/// Nothing ties the scale of the light but the probe.
TEST(ProbeRows, TieTheScaleOfAFit) {
    test::SmallProblem p = test::smallProblem(400, 0.01f);
    p.anchors = {};
    p.anchors.leaves.resize(p.truth.leaves.size());
    p.anchors.emitterRadiance = {Rgb(0)};
    p.anchors.emitterSigma = {1e-3f};
    p.anchors.emitterClipped = {1};
    p.anchors.probes = {probeOfTruth(p, 1, 0.03f, 0.01f)};
    Lighting lighting = p.start;
    Progress progress;
    AlbedoFreeOptions options;
    options.iterations = 30;
    solveAlbedoFree(p.influence, p.matte, p.pairs, p.anchors, nullptr, options, lighting, progress, {});
    for (int c = 0; c < 3; ++c) {
        double found = 0, truth = 0;
        for (size_t i = 0; i < p.truth.leaves.size(); ++i) {
            found += double(lighting.leafRadiance[i][c]);
            truth += double(p.truth.leafRadiance[i][c]);
        }
        EXPECT_NEAR(found / truth, 1, 0.01) << c;
    }
}

/// One that is wrong in a quarter of the directions loses its say there.
TEST(ProbeRows, OutliersLoseTheirWeight) {
    const test::SmallProblem p = test::smallProblem();
    const Eigen::VectorXd fraction = Eigen::VectorXd::Constant(64, 1.0 / 64);
    ProbeAnchor anchor = probeOfTruth(p, 1, 0.05f, 0.02f);
    for (size_t i = 0; i < 16; ++i) anchor.radiance[i] *= 4.0f;
    const ProbeRows rows(anchor, fraction);
    EXPECT_NEAR(rows.gain(lightOf(p, 1), 0), 1, 0.03);
    Eigen::MatrixXd q = Eigen::MatrixXd::Zero(64, 64);
    Eigen::VectorXd moment = Eigen::VectorXd::Zero(64);
    rows.add(lightOf(p, 1), 0, q, moment);
    EXPECT_LT(q(3, 3) * std::pow(anchor.radiance[3].x, 2), 0.2 * q(40, 40) * std::pow(anchor.radiance[40].x, 2));
}

}  // namespace
}  // namespace relamp
