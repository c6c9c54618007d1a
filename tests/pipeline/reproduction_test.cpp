// How well an estimate explains its photographs, on a world that is known, and what is said where it does not.
#include "pipeline/reproduction.h"

#include <gtest/gtest.h>

#include "base/parallel.h"
#include "pipeline/pipeline.h"
#include "support/known_world.h"

namespace relamp {
namespace {

struct Solved {
    test::TemporaryFolder folder;
    PipelineResult result;
    Solved() {
        test::paintKnownWorld(folder.path(), true, 8, 16);
        PipelineOptions options;
        options.solve = solveOptionsFor("draft");
        Progress progress;
        result = runPipeline(folder.path(), options, progress);
    }
};

const PipelineResult& solved() {
    static const Solved one;
    return one.result;
}

Reproduction measured(const Estimate& estimate, int threads = 0) {
    const ThreadLimit limit(threads);
    Progress progress;
    return measureReproduction(solved().capture, *solved().scene, estimate, *solved().scene, *solved().samples,
                               {800, true}, progress);
}

TEST(Reproduction, ASolveOfAKnownWorldExplainsItsPhotographs) {
    const Reproduction& r = solved().estimate.reproduction;
    ASSERT_EQ(r.views.size(), 8u);
    EXPECT_GT(r.median, 28);
    EXPECT_LE(r.views[r.worst()].psnr, r.median);
    EXPECT_FALSE(r.poor());
    EXPECT_EQ(r.cause, MisfitCause::none);
    EXPECT_EQ(r.advice, "");
    EXPECT_EQ(std::count_if(r.views.begin(), r.views.end(), [](const ViewReproduction& v) { return v.heldOut > 0; }),
              2);
    EXPECT_NEAR(r.heldOut, r.median, 6);
    EXPECT_NE(toText(r).find(fmt::format("{:.1f} dB", r.median)), std::string::npos);
}

TEST(Reproduction, HasTheSameBitsOnOneAndManyThreads) {
    const Reproduction one = measured(solved().estimate, 1), many = measured(solved().estimate);
    ASSERT_EQ(one.views.size(), many.views.size());
    for (size_t i = 0; i < one.views.size(); ++i) {
        EXPECT_EQ(one.views[i].psnr, many.views[i].psnr);
        EXPECT_EQ(one.views[i].observed, many.views[i].observed);
    }
}

TEST(Reproduction, OfSurfacesTooDarkIsPoorAndTheModelIsNamedNotThePhotographs) {
    Estimate dark = solved().estimate;
    dark.reflectance.texture = nullptr;  // it would know better
    for (Rgb& albedo : dark.reflectance.weight[0]) albedo *= 0.1f;
    const Reproduction r = measured(dark);
    EXPECT_TRUE(r.poor());
    EXPECT_EQ(r.cause, MisfitCause::model);
    EXPECT_FALSE(r.advice.empty());
}

TEST(Reproduction, IsOfKnownSizeForAKnownError) {
    // Twice the radiance everywhere: the error in display values is known from the photographs alone.
    Estimate bright = solved().estimate;
    for (Rgb& l : bright.environment) l *= 2;
    for (Rgb& l : bright.lighting.emitterRadiance) l *= 2;
    const double was = measured(solved().estimate).median, now = measured(bright).median;
    EXPECT_LT(now, was - 10);
    EXPECT_GT(now, 6);
    EXPECT_LT(now, 20);
}

TEST(Reproduction, OfACaptureWithoutPhotographsIsNotMeasured) {
    Capture bare = solved().capture;
    for (View& v : bare.views) v.image = {};
    Progress progress;
    EXPECT_FALSE(
        measureReproduction(bare, *solved().scene, solved().estimate, *solved().scene, *solved().samples, {}, progress)
            .measured());
}

TEST(Reproduction, CausesHaveNamesThatComeBack) {
    for (int k = 0; k <= int(MisfitCause::model); ++k) EXPECT_EQ(causeNamed(causeName(MisfitCause(k))), MisfitCause(k));
    EXPECT_FALSE(causeNamed("weather").has_value());
}

}  // namespace
}  // namespace relamp
