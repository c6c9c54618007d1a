#include "solve/light/lighting_step.h"

#include <gtest/gtest.h>

#include "tests/solve/small_problem.h"

namespace relamp {
namespace {

TEST(LightingStep, FindsTheLightWhenTheReflectanceIsKnown) {
    const test::SmallProblem p = test::smallProblem();
    Lighting found = p.start;
    const LightPrior prior(p.truth.leaves, p.anchors, {});
    const std::vector<Rgb> litSigma(p.influence.rows, Rgb(0));
    Progress progress;
    LightingStepReport report;
    for (int i = 0; i < 4; ++i)
        report = lightingStep(p.influence, p.matte, p.albedo, litSigma, prior, {}, found, progress);
    EXPECT_LT(test::litDifference(p, found, p.truth), 0.01);
    EXPECT_LT(report.kktResidual, 1e-6);
}

TEST(LightingStep, NeverLetsItsObjectiveRise) {
    test::SmallProblem p = test::smallProblem(300, 0.3f);
    for (Rgb& a : p.albedo) a *= 0.5f;
    Lighting found = p.start;
    const LightPrior prior(p.truth.leaves, p.anchors, {});
    const std::vector<Rgb> litSigma(p.influence.rows, Rgb(0.01f));
    Progress progress;
    double last = 1e300;
    for (int i = 0; i < 5; ++i) {
        const LightingStepReport report =
            lightingStep(p.influence, p.matte, p.albedo, litSigma, prior, {}, found, progress);
        EXPECT_LE(report.after, report.before);
        EXPECT_LE(report.before, last * (1 + 1e-4));
        last = report.after;
    }
}

TEST(LightingStep, KeepsTheLightNonNegative) {
    test::SmallProblem p = test::smallProblem();
    for (size_t i = 0; i < 32; ++i) p.truth.leafRadiance[i] = Rgb(0);
    Lighting found = p.start;
    const LightPrior prior(p.truth.leaves, p.anchors, {});
    const std::vector<Rgb> litSigma(p.influence.rows, Rgb(0));
    Progress progress;
    lightingStep(p.influence, p.matte, p.albedo, litSigma, prior, {}, found, progress);
    for (const Rgb& l : found.leafRadiance)
        for (int c = 0; c < 3; ++c) EXPECT_GE(l[c], 0);
}

}  // namespace
}  // namespace relamp
