#include "solve/uncertainty.h"

#include <gtest/gtest.h>

#include "base/random.h"
#include "tests/solve/small_problem.h"

namespace relamp {
namespace {

std::vector<Rgb> litBy(const test::SmallProblem& p, const Lighting& light) {
    std::vector<Rgb> lit(p.influence.rows, Rgb(0));
    for (size_t r = 0; r < lit.size(); ++r) {
        for (size_t i = 0; i < light.leaves.size(); ++i) lit[r] += p.influence.row(r)[i] * light.leafRadiance[i];
        for (size_t e = 0; e < light.emitterRadiance.size(); ++e)
            lit[r] += p.influence.row(r)[light.leaves.size() + e] * light.emitterRadiance[e];
    }
    return lit;
}

LightUncertainty solved(const test::SmallProblem& p, const AlbedoFreeOptions& o, const UncertaintyOptions& u,
                        Lighting& found) {
    Progress progress;
    const AlbedoFreeReport report =
        solveAlbedoFree(p.influence, p.matte, p.pairs, p.anchors, nullptr, o, found, progress, nullptr);
    return lightUncertainty(report.information, p.influence, litBy(p, found), found, {"lamp-1"}, u, progress);
}

UncertaintyOptions bare() {
    UncertaintyOptions u;
    u.widening = 1;
    u.scaleFloor = 0;
    return u;
}

TEST(LightUncertainty, AnEmitterSeenDirectlyFixesTheScaleAndNothingSeenLeavesItOpen) {
    test::SmallProblem p = test::smallProblem();
    Lighting found = p.start;
    const LightUncertainty sure = solved(p, {}, bare(), found);
    EXPECT_LT(maxChannel(sure.scaleSigma), 0.05f);
    EXPECT_GT(sure.fromEmitters.y, 0.9f);
    p.anchors.emitterRadiance.clear();  // an emitter that no photograph shows
    p.anchors.emitterSigma.clear();
    p.anchors.emitterClipped.clear();
    test::SmallProblem without = p;
    const size_t leaves = p.start.leaves.size();
    without.influence.columns = leaves;
    without.influence.values.clear();
    for (size_t r = 0; r < p.influence.rows; ++r)
        without.influence.values.insert(without.influence.values.end(), p.influence.row(r),
                                        p.influence.row(r) + leaves);
    without.start.emitterRadiance.clear();
    Lighting open = without.start;
    EXPECT_GT(solved(without, {}, bare(), open).scaleSigma.y, 1.0f);
}

TEST(LightUncertainty, GrowsWithTheNoise) {
    AlbedoFreeOptions o;
    o.mismatch = 1e-3f;
    Lighting a, b;
    test::SmallProblem quiet = test::smallProblem(400), loud = quiet;
    for (size_t i = 0; i < quiet.matte.sigma.size(); ++i) {
        quiet.matte.sigma[i] = 0.005f * quiet.matte.radiance[i];
        loud.matte.sigma[i] = 0.05f * quiet.matte.radiance[i];
    }
    a = quiet.start;
    b = loud.start;
    EXPECT_GT(solved(loud, o, bare(), b).scaleSigma.y, 3 * solved(quiet, o, bare(), a).scaleSigma.y);
}

TEST(LightUncertainty, ItsDirectionsSumToTheVarianceOfTheFullCovariance) {
    const test::SmallProblem p = test::smallProblem();
    Lighting found = p.start, again = p.start;
    UncertaintyOptions few = bare(), all = bare();
    all.directions = 100000;
    few.directions = 48;
    const LightUncertainty some = solved(p, {}, few, found), whole = solved(p, {}, all, again);
    double kept = 0, sum = 0;
    for (size_t r = 0; r < whole.litSigma.size(); ++r) {
        EXPECT_LE(some.litSigma[r].y, whole.litSigma[r].y * 1.02f + 1e-6f);
        kept += double(some.litSigma[r].y) * some.litSigma[r].y;
        sum += double(whole.litSigma[r].y) * whole.litSigma[r].y;
    }
    EXPECT_GT(kept, 0.8 * sum);
}

}  // namespace
}  // namespace relamp
