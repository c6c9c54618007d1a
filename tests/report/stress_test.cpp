// Stiff and extreme cases on the synthetic worlds: all of them, because they are small.
#include "report/stress.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "report/stress_solve.h"
#include "report/stress_variants.h"
#include "report/stress_world.h"
#include "support/stopping.h"

namespace relamp {
namespace {

const StressReport& worlds() {
    static const StressReport report = [] {
        Progress progress;
        return runStress(nullptr, {}, progress);
    }();
    return report;
}

double figure(const StressCase& c, const std::string& name) {
    for (const auto& [key, value] : c.figures)
        if (key == name) return value;
    return -1;
}

const StressCase* named(const std::string& name) {
    for (const StressCase& c : worlds().cases)
        if (c.name == name) return &c;
    return nullptr;
}

TEST(Stress, EveryCaseEndsInFiniteNumbersAndSolvedEquations) {
    EXPECT_GE(worlds().cases.size(), 40u);
    EXPECT_EQ(worlds().finiteFraction(), 1);
    for (const StressCase& c : worlds().cases) {
        EXPECT_TRUE(c.holds()) << c.name;
        EXPECT_TRUE(c.finite) << c.name << ": " << c.reason;
        EXPECT_LE(c.kkt, 1e-6) << c.name << ": " << c.reason;
        EXPECT_EQ(c.reason.find("fault"), std::string::npos) << c.name << ": " << c.reason;
    }
}

TEST(Stress, UnitsOrderAndAxesDoNotMatter) {
    // Powers of two are rounded nowhere: the same bits.
    for (const char* name : {"world: images x 2^-20", "world: lengths x 2^10"}) {
        ASSERT_TRUE(named(name)) << name;
        EXPECT_EQ(figure(*named(name), "difference"), 0) << name;
    }
    for (const char* name :
         {"world: images x 1e-6", "world: images x 1e6", "world: in millimetres", "world: in kilometres",
          "world: far from the origin", "world: views in another order", "world: vertices in another order",
          "world: emitters in another order", "world: turned by 90 degrees", "world: turned by 33 degrees",
          "world: turned about a slanting axis"}) {
        ASSERT_TRUE(named(name)) << name;
        EXPECT_LT(figure(*named(name), "difference"), 1e-4) << name;
    }
}

TEST(Stress, WhatCannotBeSolvedIsRefusedWithASentence) {
    const StressCase* c = named("world: 3 vertices");
    ASSERT_TRUE(c);
    EXPECT_TRUE(c->refused || c->kkt <= 1e-6);
    EXPECT_TRUE(!c->refused || !c->reason.empty());
}

TEST(Stress, ReportsAsJsonAndAsTable) {
    const nlohmann::json j = stressJson(worlds());
    ASSERT_EQ(j.at("cases").size(), worlds().cases.size());
    EXPECT_EQ(j.at("finite_fraction"), 1.0);
    EXPECT_EQ(j.at("finite_share"), 1.0);
    for (const auto& c : j["cases"])
        for (const char* key : {"name", "finite", "kkt", "reason", "figures"}) EXPECT_TRUE(c.contains(key)) << key;
    EXPECT_NE(stressText(worlds()).find("world: near-mirror"), std::string::npos);
}

TEST(Stress, RunsOnlyWhatIsAskedForAndStops) {
    Progress progress;
    StressOptions options;
    options.only = "needle";
    const StressReport report = runStress(nullptr, options, progress);
    ASSERT_EQ(report.cases.size(), 1u);
    EXPECT_EQ(report.cases[0].name, "world: needle triangles");
    test::expectStopsHalfWay([](Progress& p) { runStress(nullptr, {}, p); });
}

TEST(Stress, AnEmitterIsFoundThoughExposuresDiffer) {
    Progress progress;
    const StressScene world;
    const Capture painted = paintStressScene(world, progress).capture;
    for (const uint64_t seed : {1, 2, 3}) {
        const Estimate found =
            solveForStress(withExposures(painted, 0.1f, seed), nullptr, false, solveOptionsFor("draft"), progress);
        ASSERT_EQ(found.emitters.emitters.size(), 1u) << seed;
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(found.lighting.emitterRadiance[0][c] / world.emitters[0].radiance[c], 1, 0.15) << seed;
    }
}

TEST(Stress, AnEmitterFiveTimesAsBrightOnOneSideIsOneEmitterOfItsMean) {
    Progress progress;
    StressScene world;
    world.emitters = {{{0.45f, 0.25f, 1.15f}, 0.4f, Rgb(40, 34, 26), 5}};
    const PaintedWorld painted = paintStressScene(world, progress);
    ASSERT_EQ(painted.emitters.emitters.size(), 8u);
    const Estimate found = solveForStress(painted.capture, nullptr, false, solveOptionsFor("draft"), progress);
    ASSERT_EQ(found.emitters.emitters.size(), 1u);
    const EmitterCluster& emitter = found.emitters.emitters[0];
    EXPECT_LT(glm::distance(emitter.centroid, Vec3(0.45f, 0.25f, 1.15f)), 0.02f);
    EXPECT_GT(emitter.evidence.uniformity, 0.2f);
    for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(found.lighting.emitterRadiance[0][c] / world.emitters[0].radiance[c], 1, 0.08);
    // The floor away from the emitter's shadow: its albedo is what it is.
    std::vector<float> off;
    for (size_t v = 0; v < 19 * 19; ++v)
        if (found.reflectance.confidence[v] > 0.5f) off.push_back(found.reflectance.weight[0][v].y / world.albedo.y);
    ASSERT_GT(off.size(), 100u);
    std::nth_element(off.begin(), off.begin() + ptrdiff_t(off.size() / 2), off.end());
    EXPECT_NEAR(off[off.size() / 2], 1, 0.1);
}

}  // namespace
}  // namespace relamp
