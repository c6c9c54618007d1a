// The whole pipeline on a world whose lighting and reflectance are known.
#include <gtest/gtest.h>

#include <cstdio>

#include "base/parallel.h"
#include "pipeline/pipeline.h"
#include "support/known_world.h"
#include "support/stopping.h"

namespace relamp {
namespace {

struct World {
    test::TemporaryFolder folder;
    test::KnownWorld truth;
    explicit World(bool emitter = true, bool metalBall = false) {
        truth = test::paintKnownWorld(folder.path(), emitter, 10, 24, false, metalBall);
    }
    PipelineResult solve(bool nearField = true, int threads = 0, double budget = 0) const {
        const ThreadLimit limit(threads);
        PipelineOptions options;
        options.solve = solveOptionsFor("draft");
        options.solve.nearField = nearField;
        options.reproduce = false;
        Progress progress;
        progress.setBudget(budget);
        return runPipeline(folder.path(), options, progress);
    }
};

/// The world with its emitter, solved once on four threads: what several tests look at.
struct Solved {
    const World world;
    const PipelineResult result = world.solve(true, 4);
    const Estimate& estimate = result.estimate;
    static const Solved& get() {
        static const Solved one;
        return one;
    }
};

double relative(const Rgb& a, const Rgb& b) { return maxChannel(glm::abs(a - b)) / maxChannel(b); }

/// Largest relative error of the irradiance of the distant light found, over a few orientations that surfaces of the
/// scene have.
double irradianceError(const Estimate& estimate) {
    const DirectionGrid grid{estimate.environmentSide};
    double worst = 0;
    for (const Vec3& n : {Vec3(0, 0, 1), glm::normalize(Vec3(1, 0, 1)), glm::normalize(Vec3(-1, 0, 1)),
                          glm::normalize(Vec3(0, 1, 1)), glm::normalize(Vec3(0, -1, 1))})
        worst = std::max(worst,
                         relative(test::skyIrradiance(
                                      [&](const Vec3& d) { return estimate.environment[size_t(grid.cellOf(d))]; }, n),
                                  test::skyIrradiance(test::KnownWorld::sky, n)));
    return worst;
}

/// Median and 90th percentile of the relative albedo error over the vertices that are well seen.
std::pair<double, double> albedoErrors(const PipelineResult& r, const test::KnownWorld& truth) {
    std::vector<double> off;
    for (size_t v = 0; v < truth.albedo.size(); ++v)
        if (r.estimate.reflectance.observed[v] >= 3 && r.estimate.emitters.emitterOfVertex[v] < 0)
            off.push_back(relative(r.estimate.reflectance.weight[0][v], truth.albedo[v]));
    std::sort(off.begin(), off.end());
    return {off[off.size() / 2], off[off.size() * 9 / 10]};
}

void expectFinite(const Estimate& e) {
    for (const Rgb& l : e.lighting.leafRadiance) ASSERT_TRUE(isFinite(l) && std::min({l.x, l.y, l.z}) >= 0);
    for (const Rgb& l : e.lighting.emitterRadiance) ASSERT_TRUE(isFinite(l) && std::min({l.x, l.y, l.z}) >= 0);
    for (const Rgb& l : e.environment) ASSERT_TRUE(isFinite(l) && std::min({l.x, l.y, l.z}) >= 0);
    for (const auto& lobe : e.reflectance.weight)
        for (const Rgb& w : lobe) ASSERT_TRUE(isFinite(w) && std::min({w.x, w.y, w.z}) >= 0);
}

TEST(KnownWorld, ItsEmitterSkyAndAlbedoAreFound) {
    const World& world = Solved::get().world;
    const PipelineResult& r = Solved::get().result;
    expectFinite(r.estimate);
    ASSERT_EQ(r.estimate.emitters.emitters.size(), 1u);
    const EmitterCluster& emitter = r.estimate.emitters.emitters[0];
    const Rgb radiance = r.estimate.lighting.emitterRadiance[0];
    const auto [median, p90] = albedoErrors(r, world.truth);
    const double irradiance = irradianceError(r.estimate);
    std::printf(
        "light radiance off by %.2f %%, sky irradiance %.1f %%, albedo %.1f %% (median) %.1f %% (90th percentile)\n",
        100 * relative(radiance, world.truth.emitterRadiance), 100 * irradiance, 100 * median, 100 * p90);
    EXPECT_LT(relative(radiance, world.truth.emitterRadiance), 0.01);
    EXPECT_LT(glm::length(emitter.centroid - world.truth.emitterCentre), 0.02f);
    EXPECT_NEAR(emitter.area, world.truth.emitterSide * world.truth.emitterSide, 0.001);
    std::vector<uint32_t> triangles = emitter.triangles;
    std::sort(triangles.begin(), triangles.end());
    EXPECT_EQ(triangles, world.truth.emitterTriangles);
    // Measured 6 %, 4 % and 8 % at draft quality.
    EXPECT_LT(irradiance, 0.10);
    EXPECT_LT(median, 0.07);
    EXPECT_LT(p90, 0.15);
    EXPECT_EQ(r.estimate.mode, "near-field");
    EXPECT_FALSE(r.estimate.timeline.empty());
    EXPECT_FALSE(r.estimate.cancelled);
}

TEST(KnownWorld, HoldsNoBouncedLightWhereNoneWasPainted) {
    const Estimate& estimate = Solved::get().estimate;
    EXPECT_FALSE(estimate.interreflection);
    EXPECT_EQ(estimate.bouncedFraction, 0);
}

TEST(KnownWorld, BouncedLightInARoomIsSeenAndAlbedoSaved) {
    test::TemporaryFolder folder;
    const test::KnownWorld truth = test::paintKnownWorld(folder.path(), true, 10, 24, true);
    const auto solve = [&](SolveOptions::Bounce bounce) {
        PipelineOptions options;
        options.solve = solveOptionsFor("draft");
        options.solve.bounce = bounce;
        options.reproduce = options.registration = options.photometric = false;
        options.texture = 0;
        Progress progress;
        return runPipeline(folder.path(), options, progress);
    };
    const PipelineResult kept = solve(SolveOptions::Bounce::automatic), off = solve(SolveOptions::Bounce::off);
    EXPECT_TRUE(kept.estimate.interreflection);
    EXPECT_FALSE(off.estimate.interreflection);
    const double with = albedoErrors(kept, truth).first, without = albedoErrors(off, truth).first;
    std::printf("bounced share %.1f %%, albedo off by %.1f %% with it, %.1f %% without\n",
                100 * double(kept.estimate.bouncedFraction), 100 * with, 100 * without);
    EXPECT_GT(kept.estimate.bouncedFraction, 0.1f);
    EXPECT_LT(with, 0.5 * without);
    EXPECT_LT(with, 0.07);
}

TEST(KnownWorld, AMetalBallIsFoundAndMirrorsWithItsOwnColour) {
    const World world(false, true);
    const PipelineResult r = world.solve();
    const Reflectance& reflectance = r.estimate.reflectance;
    ASSERT_EQ(reflectance.basis.lobes.size(), 2u);
    const size_t v = (world.truth.ballBegin + world.truth.ballEnd) / 2;
    EXPECT_EQ(maxChannel(reflectance.weight[0][v]), 0.0f);
    EXPECT_LT(relative(reflectance.weight[1][v], world.truth.ballTint), 0.12);
    EXPECT_NE(r.estimate.gauge.kind, "assumed");
    EXPECT_LT(albedoErrors(r,
                           [&] {
                               test::KnownWorld t = world.truth;
                               for (size_t i = t.ballBegin; i < t.ballEnd; ++i)
                                   t.albedo[i] = reflectance.weight[0][i] + Rgb(1e-6f);
                               return t;
                           }())
                  .first,
              0.12);
}

TEST(KnownWorld, SaysHowSureItIs) {
    const World& world = Solved::get().world;
    const Estimate& e = Solved::get().estimate;
    ASSERT_EQ(e.reflectance.sigma.size(), world.truth.albedo.size());
    ASSERT_EQ(e.environmentSigma.size(), e.environment.size());
    size_t within = 0, counted = 0;
    for (size_t v = 0; v < world.truth.albedo.size(); ++v) {
        if (e.reflectance.observed[v] < 1 || e.emitters.emitterOfVertex[v] >= 0) continue;
        within += relative(e.reflectance.weight[0][v], world.truth.albedo[v]) < 2 * double(e.reflectance.sigma[v]);
        ++counted;
    }
    EXPECT_GT(double(within), 0.85 * double(counted));
    EXPECT_FALSE(e.stability.weakest.empty());
    EXPECT_GT(e.stability.weakestSigma, 0);
    EXPECT_NEAR(e.gauge.fromEmitters.y + e.gauge.fromBackground.y + e.gauge.fromGloss.y + e.gauge.fromBounces.y, 1,
                1e-3);
    EXPECT_GT(e.gauge.sigma.y, 0.04f);
    EXPECT_LT(e.gauge.sigma.y, 0.2f);
}

TEST(KnownWorld, WithoutItsEmitterHasNoEmitter) {
    const World world(false);
    const PipelineResult r = world.solve();
    expectFinite(r.estimate);
    EXPECT_EQ(r.estimate.emitters.emitters.size(), 0u);
    const auto [median, p90] = albedoErrors(r, world.truth);
    const double irradiance = irradianceError(r.estimate);
    std::printf("sky irradiance off by %.1f %%, albedo %.1f %% (median) %.1f %% (90th percentile)\n", 100 * irradiance,
                100 * median, 100 * p90);
    // Without an emitter only the sky that is seen ties light to albedo; measured 15 % and 18 % at draft quality.
    EXPECT_LT(irradiance, 0.22);
    EXPECT_LT(median, 0.25);
}

TEST(KnownWorld, SolvedDistantOnlyHasNoEmitterAndFitsWorse) {
    const World& world = Solved::get().world;
    const PipelineResult& near = Solved::get().result;
    const PipelineResult distant = world.solve(false);
    expectFinite(distant.estimate);
    EXPECT_EQ(distant.estimate.mode, "distant-only");
    EXPECT_EQ(distant.estimate.emitters.emitters.size(), 0u);
    EXPECT_GT(albedoErrors(distant, world.truth).first, 1.5 * albedoErrors(near, world.truth).first);
}

TEST(KnownWorld, HasTheSameBitsOnOneAndManyThreads) {
    const Estimate one = Solved::get().world.solve(true, 1).estimate;
    const Estimate& four = Solved::get().estimate;
    EXPECT_EQ(one.environment, four.environment);
    EXPECT_EQ(one.lighting.leafRadiance, four.lighting.leafRadiance);
    EXPECT_EQ(one.lighting.emitterRadiance, four.lighting.emitterRadiance);
    EXPECT_EQ(one.reflectance.weight, four.reflectance.weight);
    EXPECT_EQ(one.reflectance.confidence, four.reflectance.confidence);
    EXPECT_EQ(one.reflectance.observed, four.reflectance.observed);
    EXPECT_EQ(one.emitters.emitterOfTriangle, four.emitters.emitterOfTriangle);
    EXPECT_EQ(one.emitterSigma, four.emitterSigma);
    EXPECT_EQ(one.identifiability, four.identifiability);
    EXPECT_EQ(one.stability.conditionNumber, four.stability.conditionNumber);
    ASSERT_EQ(one.timeline.size(), four.timeline.size());
    for (size_t i = 0; i < one.timeline.size(); ++i) {
        EXPECT_EQ(one.timeline[i].objective, four.timeline[i].objective) << i;
        EXPECT_EQ(one.timeline[i].rmse, four.timeline[i].rmse) << i;
    }
}

TEST(KnownWorld, StopsInEachStageWhenAsked) {
    const test::TemporaryFolder world;
    test::paintSmallWorld(world.path());
    PipelineOptions options;
    options.solve = solveOptionsFor("draft");
    // Every stage that a whole run announces.
    std::vector<std::string> stages;
    {
        Progress progress;
        progress.setListener([&](const std::string& label, double) {
            if (std::find(stages.begin(), stages.end(), label) == stages.end()) stages.push_back(label);
        });
        runPipeline(world.path(), options, progress);
    }
    ASSERT_GT(stages.size(), 6u);
    for (const std::string& stage : stages) {
        Progress progress;
        std::chrono::steady_clock::time_point asked{};
        progress.setListener([&](const std::string& label, double) {
            if (label != stage || progress.stopRequested()) return;
            asked = std::chrono::steady_clock::now();
            progress.requestStop();
        });
        bool cancelled = false;
        try {
            runPipeline(world.path(), options, progress);
        } catch (const Cancelled&) { cancelled = true; }
        EXPECT_TRUE(cancelled) << stage;
        EXPECT_LT(std::chrono::duration<double>(std::chrono::steady_clock::now() - asked).count(),
                  test::stopBoundSeconds)
            << stage;
    }
}

TEST(KnownWorld, StopsHalfWayWhenAskedFromAnotherThread) {
    const World world;
    PipelineOptions options;
    options.solve = solveOptionsFor("draft");
    test::expectStopsHalfWay([&](Progress& progress) { runPipeline(world.folder.path(), options, progress); },
                             "Visibility");
}

TEST(KnownWorld, KeepsTheBestAnswerSoFarWhenTheTimeIsUp) {
    const World& world = Solved::get().world;
    const PipelineResult r = world.solve(true, 0, 1e-3);
    expectFinite(r.estimate);
    EXPECT_TRUE(r.estimate.cancelled);
    EXPECT_EQ(r.estimate.reflectance.weight[0].size(), world.truth.albedo.size());
    EXPECT_LT(r.estimate.timeline.size(), Solved::get().estimate.timeline.size());
}

}  // namespace
}  // namespace relamp
