#include "solve/ratio/albedo_free.h"

#include <gtest/gtest.h>

#include "base/parallel.h"

#include "tests/solve/small_problem.h"

namespace relamp {
namespace {

AlbedoFreeOptions manyIterations() {
    AlbedoFreeOptions o;
    o.iterations = 40;
    o.tolerance = 1e-6f;
    return o;
}

TEST(AlbedoFree, FindsTheAbsoluteLightFromRatiosAndOneEmitterOfKnownRadiance) {
    const test::SmallProblem p = test::smallProblem();
    Lighting found = p.start;
    Progress progress;
    solveAlbedoFree(p.influence, p.matte, p.pairs, p.anchors, nullptr, manyIterations(), found, progress, nullptr);
    EXPECT_LT(test::litDifference(p, found, p.truth), 0.02);
    EXPECT_NEAR(found.emitterRadiance[0].x, 20, 0.05);
    EXPECT_NEAR(found.emitterRadiance[0].z, 4, 0.02);
}

TEST(AlbedoFree, BouncedLightAloneFixesTheScale) {
    test::SmallProblem p = test::smallProblem();
    // No emitter is known, nothing is seen directly; every vertex gets some light from surfaces whose radiance the
    // photographs show.
    std::vector<Rgb> bounce;
    for (size_t i = 0; i < p.matte.radiance.size(); ++i) {
        bounce.push_back(Rgb(0.02f, 0.03f, 0.01f) * (1 + float(i * 7 % 13)));
        p.matte.radiance[i] += p.albedo[i] * bounce[i];
        p.matte.sigma[i] = 0.01f * p.matte.radiance[i];
    }
    p.anchors.emitterSigma = {1e3f};
    AlbedoFreeOptions o = manyIterations();
    o.light.emitterWeight = 0;
    o.light.smoothness = 0.1f;
    o.bounce = &bounce;
    for (const float start : {0.3f, 3.0f}) {
        Lighting found = p.start;
        for (Rgb& l : found.leafRadiance) l = Rgb(start);
        found.emitterRadiance[0] = Rgb(start * 10);
        Progress progress;
        solveAlbedoFree(p.influence, p.matte, p.pairs, p.anchors, nullptr, o, found, progress, nullptr);
        EXPECT_LT(test::litDifference(p, found, p.truth), 0.05) << start;
    }
}

TEST(AlbedoFree, EndsAtTheSameLightFromADarkAndABrightStart) {
    const test::SmallProblem p = test::smallProblem(400, 0.02f);
    Lighting dark = p.start, bright = p.start;
    for (Rgb& l : dark.leafRadiance) l = Rgb(0.01f);
    for (Rgb& l : bright.leafRadiance) l = Rgb(200);
    Progress progress;
    solveAlbedoFree(p.influence, p.matte, p.pairs, p.anchors, nullptr, manyIterations(), dark, progress, nullptr);
    solveAlbedoFree(p.influence, p.matte, p.pairs, p.anchors, nullptr, manyIterations(), bright, progress, nullptr);
    EXPECT_LT(test::litDifference(p, dark, bright), 0.01);
}

TEST(AlbedoFree, CurvatureOnFoldedLeavesEndsAtTheSameLight) {
    test::SmallProblem p = test::smallProblem(400, 0.02f);
    // Leaves in fours that the rows hardly tell apart.
    for (size_t r = 0; r < p.influence.rows; ++r) {
        float* row = p.influence.row(r);
        Rgb before(0), after(0);
        for (size_t i = 0; i < 64; ++i) before += row[i] * p.truth.leafRadiance[i];
        for (size_t i = 0; i < 64; i += 4) {
            const float mean = (row[i] + row[i + 1] + row[i + 2] + row[i + 3]) / 4;
            for (size_t k = i; k < i + 4; ++k) row[k] = 0.8f * mean + 0.2f * row[k];
        }
        for (size_t i = 0; i < 64; ++i) after += row[i] * p.truth.leafRadiance[i];
        p.matte.radiance[r] += p.albedo[r] * (after - before);
    }
    AlbedoFreeOptions o = manyIterations(), folded = manyIterations();
    folded.iterations = 80;
    folded.foldedRows = p.influence.rows;
    for (uint32_t k = 0; k < p.influence.columns; ++k) folded.fold.push_back(k / 4);
    Lighting whole = p.start, found = p.start;
    Progress progress;
    const AlbedoFreeReport a =
        solveAlbedoFree(p.influence, p.matte, p.pairs, p.anchors, nullptr, o, whole, progress, nullptr);
    const AlbedoFreeReport b =
        solveAlbedoFree(p.influence, p.matte, p.pairs, p.anchors, nullptr, folded, found, progress, nullptr);
    EXPECT_LT(test::litDifference(p, found, whole), 2e-3);
    EXPECT_NEAR(b.objective, a.objective, 2e-3 * a.objective);
}

TEST(AlbedoFree, EndsEarlyWhereAnIterationGainsTooLittle) {
    const test::SmallProblem p = test::smallProblem(400, 0.02f);
    AlbedoFreeOptions o = manyIterations(), rough = manyIterations();
    rough.leastGain = 0.01f;
    Lighting whole = p.start, found = p.start;
    Progress progress;
    const AlbedoFreeReport a =
        solveAlbedoFree(p.influence, p.matte, p.pairs, p.anchors, nullptr, o, whole, progress, nullptr);
    const AlbedoFreeReport b =
        solveAlbedoFree(p.influence, p.matte, p.pairs, p.anchors, nullptr, rough, found, progress, nullptr);
    EXPECT_LT(b.iterations, a.iterations);
    EXPECT_LT(b.objective, 1.02 * a.objective);
}

TEST(AlbedoFree, NeverLetsItsObjectiveRise) {
    const test::SmallProblem p = test::smallProblem(300, 0.1f);
    Lighting found = p.start;
    AlbedoFreeOptions o = manyIterations();
    o.anneal = false;
    std::vector<double> objectives;
    Progress progress;
    solveAlbedoFree(p.influence, p.matte, p.pairs, p.anchors, nullptr, o, found, progress,
                    [&](int, double objective, double) { objectives.push_back(objective); });
    ASSERT_GT(objectives.size(), 3u);
    for (size_t i = 1; i < objectives.size(); ++i) EXPECT_LE(objectives[i], objectives[i - 1] * (1 + 1e-5)) << i;
    EXPECT_LT(objectives.back(), 0.5 * objectives.front());
}

TEST(AlbedoFree, ScalesExactlyWithThePhotographs) {
    const test::SmallProblem p = test::smallProblem();
    Progress progress;
    Lighting plain = p.start;
    solveAlbedoFree(p.influence, p.matte, p.pairs, p.anchors, nullptr, manyIterations(), plain, progress, nullptr);
    for (const float s : {1e-6f, 1e6f}) {
        test::SmallProblem q = p;
        for (Rgb& y : q.matte.radiance) y *= s;
        for (Rgb& y : q.matte.sigma) y *= s;
        for (Rgb& e : q.anchors.emitterRadiance) e *= s;
        Lighting found = p.start;
        for (Rgb& l : found.leafRadiance) l *= s;
        for (Rgb& l : found.emitterRadiance) l *= s;
        solveAlbedoFree(q.influence, q.matte, q.pairs, q.anchors, nullptr, manyIterations(), found, progress, nullptr);
        for (Rgb& l : found.leafRadiance) l /= s;
        for (Rgb& l : found.emitterRadiance) l /= s;
        EXPECT_LT(test::litDifference(p, found, plain), 1e-3) << s;
    }
}

TEST(AlbedoFree, StaysFiniteWhereVerticesAreBlack) {
    test::SmallProblem p = test::smallProblem();
    for (size_t r = 0; r < 100; ++r) {
        p.matte.radiance[r] = Rgb(0);
        p.matte.sigma[r] = Rgb(1e-4f);
    }
    Lighting found = p.start;
    Progress progress;
    const AlbedoFreeReport report =
        solveAlbedoFree(p.influence, p.matte, p.pairs, p.anchors, nullptr, manyIterations(), found, progress, nullptr);
    EXPECT_TRUE(std::isfinite(report.objective));
    for (const Rgb& l : found.leafRadiance) EXPECT_TRUE(isFinite(l));
}

TEST(AlbedoFree, KeepsAClippedEmitterAtOrAboveWhatWasSeen) {
    test::SmallProblem p = test::smallProblem();
    p.anchors.emitterRadiance[0] = {8, 4, 1.6f};  // clipped: the truth is 20 10 4
    p.anchors.emitterClipped[0] = 1;
    Lighting found = p.start;
    found.emitterRadiance = p.anchors.emitterRadiance;
    Progress progress;
    solveAlbedoFree(p.influence, p.matte, p.pairs, p.anchors, nullptr, manyIterations(), found, progress, nullptr);
    for (int c = 0; c < 3; ++c) EXPECT_GE(found.emitterRadiance[0][c], p.anchors.emitterRadiance[0][c] * 0.999f);
}

TEST(AlbedoFree, KeepsTheLightUpWhenNothingFixesItsScale) {
    test::SmallProblem p = test::smallProblem();
    // Distant light only, and none of it seen: right up to one scale a channel, never black.
    const size_t leaves = p.truth.leaves.size();
    InfluenceMatrix distant{p.influence.rows, leaves, {}};
    for (size_t r = 0; r < p.influence.rows; ++r)
        distant.values.insert(distant.values.end(), p.influence.row(r), p.influence.row(r) + leaves);
    p.influence = distant;
    p.truth.emitterRadiance.clear();
    p.start.emitterRadiance.clear();
    p.anchors.emitterRadiance.clear();
    p.anchors.emitterSigma.clear();
    p.anchors.emitterClipped.clear();
    for (size_t r = 0; r < p.influence.rows; ++r) {
        Rgb y(0);
        for (size_t i = 0; i < leaves; ++i) y += p.influence.row(r)[i] * p.truth.leafRadiance[i];
        p.matte.radiance[r] = y * p.albedo[r];
        p.matte.sigma[r] = 0.01f * p.matte.radiance[r];
    }
    Lighting found = p.start;
    Progress progress;
    solveAlbedoFree(p.influence, p.matte, p.pairs, p.anchors, nullptr, manyIterations(), found, progress, nullptr);
    for (int c = 0; c < 3; ++c) {
        double mean = 0, truth = 0;
        for (size_t i = 0; i < leaves; ++i) {
            mean += found.leafRadiance[i][c];
            truth += p.truth.leafRadiance[i][c];
        }
        EXPECT_NEAR(mean / double(leaves), 3, 0.3) << "where it started";
        for (Rgb& l : found.leafRadiance) l[c] *= float(truth / mean);
    }
    EXPECT_LT(test::litDifference(p, found, p.truth), 0.03);
}

TEST(AlbedoFree, GivesTheSameBitsOnOneAndFourThreads) {
    const test::SmallProblem p = test::smallProblem(700, 0.05f);
    std::vector<Lighting> found(2, p.start);
    for (int k = 0; k < 2; ++k) {
        const ThreadLimit limit(k ? 4 : 1);
        Progress progress;
        solveAlbedoFree(p.influence, p.matte, p.pairs, p.anchors, nullptr, {}, found[size_t(k)], progress, nullptr);
    }
    for (size_t i = 0; i < p.truth.leaves.size(); ++i)
        EXPECT_EQ(found[0].leafRadiance[i], found[1].leafRadiance[i]) << i;
}

}  // namespace
}  // namespace relamp
