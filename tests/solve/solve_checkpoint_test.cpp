// A solve that is put aside after any of its steps and gone on with ends in the same bits.
#include "solve/solve_checkpoint.h"

#include <gtest/gtest.h>

#include "clusters/emitter_clusters.h"
#include "radiance/gather.h"
#include "report/stress_world.h"
#include "solve/solve.h"
#include "solve/steps/solve_run.h"

namespace relamp {
namespace {

struct Problem {
    Capture capture;
    Scene scene;
    RadianceSamples samples;
    EmitterClusters clusters;
    SolveOptions options = solveOptionsFor("draft");

    explicit Problem(const StressScene& world = {}) {
        Progress progress;
        capture = paintStressScene(world, progress).capture;
        scene = buildScene(capture.mesh, progress);
        samples = gatherRadiance(capture, scene, {}, progress);
        clusters = clusterEmitters(scene, capture, samples, {}, progress);
        options.startIterations = 6;
    }
    Estimate solve(const SolveListener* listener = nullptr, const SolveCheckpoint* resume = nullptr,
                   double budget = 0) const {
        Progress progress;
        progress.setBudget(budget);
        return solveScene(capture, scene, samples, clusters, options, progress, listener, resume);
    }
};

const Problem& glossyProblem() {
    static const Problem problem = [] {
        StressScene world;
        world.specularAlpha = 0.05f;
        return Problem(world);
    }();
    return problem;
}

std::vector<SolveCheckpoint> checkpointsOf(const Problem& problem, Estimate* answer = nullptr) {
    std::vector<SolveCheckpoint> found;
    SolveListener listener;
    listener.checkpoint = [&](const SolveCheckpoint& c) { found.push_back(c); };
    listener.checkpointSeconds = 1e9;  // between steps only
    const Estimate estimate = problem.solve(&listener);
    if (answer) *answer = estimate;
    return found;
}

void expectSameBits(const Estimate& a, const Estimate& b, const std::string& where) {
    EXPECT_EQ(a.lighting.leafRadiance, b.lighting.leafRadiance) << where;
    EXPECT_EQ(a.lighting.emitterRadiance, b.lighting.emitterRadiance) << where;
    EXPECT_EQ(a.environment, b.environment) << where;
    EXPECT_EQ(a.reflectance.weight, b.reflectance.weight) << where;
    EXPECT_EQ(a.reflectance.confidence, b.reflectance.confidence) << where;
    EXPECT_EQ(a.identifiability, b.identifiability) << where;
    ASSERT_EQ(a.timeline.size(), b.timeline.size()) << where;
    for (size_t i = 0; i < a.timeline.size(); ++i)
        EXPECT_EQ(a.timeline[i].objective, b.timeline[i].objective) << where << ", entry " << i;
    ASSERT_EQ(a.leftOut.size(), b.leftOut.size()) << where;
    for (size_t i = 0; i < a.leftOut.size(); ++i) EXPECT_EQ(a.leftOut[i].why, b.leftOut[i].why) << where;
}

/// All that a checkpoint keeps but for how long it took.
void expectSameCheckpoint(SolveCheckpoint a, SolveCheckpoint b, const std::string& where) {
    for (SolveCheckpoint* c : {&a, &b}) {
        c->seconds = 0;
        c->plan.stages.clear();
        for (TimelineEntry& entry : c->timeline) entry.seconds = 0;
    }
    EXPECT_TRUE(checkpointBytes(a) == checkpointBytes(b)) << where;
}

// From each step only as far as the next one, whose checkpoint has to be the uninterrupted solve's; all the way from
// the first, through all the others, and from the last.
TEST(SolveCheckpoint, EveryStepCanBeGoneOnFromWithTheSameBits) {
    Estimate whole;
    const std::vector<SolveCheckpoint> checkpoints = checkpointsOf(glossyProblem(), &whole);
    ASSERT_EQ(checkpoints.size(), stepsOf(glossyProblem().options).size());
    for (size_t k = 0; k < checkpoints.size(); ++k) {
        const SolveCheckpoint read = checkpointFromBytes(checkpointBytes(checkpoints[k]));
        EXPECT_TRUE(read.between);
        const bool allTheWay = k == 0 || k + 1 == checkpoints.size();
        size_t next = k + 1;
        SolveListener listener;
        listener.checkpointSeconds = 1e9;
        listener.checkpoint = [&](const SolveCheckpoint& c) {
            ASSERT_LT(next, checkpoints.size());
            expectSameCheckpoint(c, checkpoints[next], fmt::format("from step {} to {}", k + 1, next + 1));
            ++next;
            if (!allTheWay) throw Cancelled{};
        };
        if (allTheWay) {
            expectSameBits(glossyProblem().solve(&listener, &read), whole, fmt::format("after {} steps", read.step));
            EXPECT_EQ(next, checkpoints.size());
        } else {
            EXPECT_THROW(glossyProblem().solve(&listener, &read), Cancelled);
            EXPECT_EQ(next, k + 2);
        }
    }
}

TEST(SolveCheckpoint, TheSameWithLightBetweenSurfaces) {
    Problem problem;
    problem.options.bounce = SolveOptions::Bounce::on;
    Estimate whole;
    const std::vector<SolveCheckpoint> checkpoints = checkpointsOf(problem, &whole);
    ASSERT_TRUE(whole.interreflection);
    for (const size_t i : {size_t(4), size_t(6), checkpoints.size() - 1}) {
        const SolveCheckpoint read = checkpointFromBytes(checkpointBytes(checkpoints[i]));
        EXPECT_TRUE(read.bounceKept);
        expectSameBits(problem.solve(nullptr, &read), whole, fmt::format("after {} steps", read.step));
    }
}

TEST(SolveCheckpoint, InsideLongStepsTheLightSoFarIsKept) {
    std::vector<SolveCheckpoint> inside;
    SolveListener listener;
    listener.checkpoint = [&](const SolveCheckpoint& c) {
        if (!c.between) inside.push_back(c);
    };
    listener.checkpointSeconds = 0;  // at every iteration
    const Estimate whole = glossyProblem().solve(&listener);
    ASSERT_GT(inside.size(), 4u);
    const SolveCheckpoint read = checkpointFromBytes(checkpointBytes(inside.back()));
    const Estimate again = glossyProblem().solve(nullptr, &read);
    EXPECT_EQ(again.emitters.emitters.size(), whole.emitters.emitters.size());
    for (size_t e = 0; e < whole.lighting.emitterRadiance.size(); ++e)
        EXPECT_LT(maxChannel(glm::abs(again.lighting.emitterRadiance[e] - whole.lighting.emitterRadiance[e])),
                  1e-2f * maxChannel(whole.lighting.emitterRadiance[e]));
}

TEST(SolveCheckpoint, BytesThatEndEarlyOrGoOnAreRefused) {
    const std::string bytes = checkpointBytes(checkpointsOf(glossyProblem()).back());
    for (const size_t kept : {size_t(0), size_t(3), bytes.size() / 3, bytes.size() - 1})
        EXPECT_THROW(checkpointFromBytes(bytes.substr(0, kept)), Error) << kept;
    EXPECT_THROW(checkpointFromBytes(bytes + "x"), Error);
    EXPECT_NO_THROW(checkpointFromBytes(bytes));
}

TEST(SolveCheckpoint, LeavesThatDoNotCoverTheSquareAreRefused) {
    LightLeaves leaves = LightLeaves::uniform(2);
    leaves.split(5);
    std::vector<Leaf> list;
    for (size_t i = 0; i < leaves.size(); ++i) list.push_back(leaves[i]);
    const LightLeaves again = LightLeaves::of(list);
    for (int k = 0; k < 200; ++k) {
        const Vec3 d = squareToSphere(Vec2(float(k % 20) + 0.5f, float(k / 20) + 0.5f) / Vec2(20, 10));
        EXPECT_EQ(again.leafOf(d), leaves.leafOf(d));
    }
    EXPECT_THROW(LightLeaves::of({list.begin() + 1, list.end()}), Error);
    list.push_back(list.front());
    EXPECT_THROW(LightLeaves::of(list), Error);
}

TEST(TimeBudget, WhateverTheBudgetTheAnswerIsFiniteAndMarked) {
    // Used up before anything was fitted: the coarse light and the albedo are there all the same.
    const Estimate none = glossyProblem().solve(nullptr, nullptr, 1e-9), whole = glossyProblem().solve();
    EXPECT_TRUE(none.cancelled);
    EXPECT_FALSE(whole.cancelled);
    for (const auto& lobe : none.reflectance.weight)
        for (const Rgb& w : lobe) ASSERT_TRUE(isFinite(w));
    ASSERT_FALSE(none.timeline.empty());
    EXPECT_LT(none.timeline.size(), whole.timeline.size());
    EXPECT_EQ(none.emitters.emitters.size(), whole.emitters.emitters.size());
}

TEST(TimeBudget, RunningOutInAnyStepLeavesAnAnswerThatIsNoWorse) {
    // The budget is used up at the k-th entry of the timeline: what was found by then is kept.
    double first = 0;
    for (const size_t at : {size_t(5), size_t(8), size_t(12)}) {
        Progress progress;
        SolveListener listener;
        size_t heard = 0;
        listener.entry = [&](const TimelineEntry&) {
            if (++heard == at) progress.setBudget(1e-9);
        };
        const Problem& p = glossyProblem();
        const Estimate e = solveScene(p.capture, p.scene, p.samples, p.clusters, p.options, progress, &listener);
        EXPECT_TRUE(e.cancelled);
        const double error = e.timeline.back().rmse;
        ASSERT_TRUE(std::isfinite(error));
        if (first == 0) first = error;
        EXPECT_LE(error, 1.05 * first) << at;
    }
}

TEST(TimeBudget, ACutAnswerHasLobesAndKnowsItsScale) {
    // Cut in the first fit after the first answer: that one's lobes are kept, and what fixed its light.
    Progress progress;
    SolveListener listener;
    listener.entry = [&](const TimelineEntry& entry) {
        if (entry.stage == "light from ratios") progress.setBudget(1e-9);
    };
    const Problem& p = glossyProblem();
    progress.setBudget(1e6);
    const Estimate cut = solveScene(p.capture, p.scene, p.samples, p.clusters, p.options, progress, &listener),
                   whole = p.solve();
    ASSERT_TRUE(cut.cancelled);
    ASSERT_GT(whole.reflectance.basis.lobes.size(), 1u);
    EXPECT_GT(cut.reflectance.basis.lobes.size(), 1u);
    EXPECT_LT(cut.lighting.leaves.size(), whole.lighting.leaves.size());
    EXPECT_EQ(cut.gauge.kind, whole.gauge.kind);
    EXPECT_GT(cut.gauge.sigma.y, 0);
}

TEST(TimeBudget, TheObjectiveOfAStageNeverRises) {
    for (const bool mirror : {false, true}) {
        const Estimate e = mirror ? glossyProblem().solve() : Problem().solve();
        size_t compared = 0;
        for (size_t i = 1; i < e.timeline.size(); ++i) {
            const TimelineEntry &a = e.timeline[i - 1], &b = e.timeline[i];
            if (a.stage != b.stage || b.iteration != a.iteration + 1) continue;
            EXPECT_LE(b.objective, a.objective) << b.stage << " " << b.iteration;
            ++compared;
        }
        EXPECT_GT(compared, 3u);
    }
}

}  // namespace
}  // namespace relamp
