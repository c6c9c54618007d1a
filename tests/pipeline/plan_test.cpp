// What the planner leaves out, that it leaves out nothing that is needed, and that its stages are those of the solve.
#include "pipeline/plan.h"

#include <gtest/gtest.h>

#include <set>

#include <nlohmann/json.hpp>

#include "clusters/emitter_clusters.h"
#include "pipeline/plan_costs.h"
#include "radiance/gather.h"
#include "report/stress_solve.h"
#include "report/stress_world.h"

namespace relamp {
namespace {

struct Planned {
    Capture capture;
    Scene scene;
    RadianceSamples samples;
    EmitterClusters clusters;
    SolveOptions options = solveOptionsFor("draft");
    SolvePlan plan;

    explicit Planned(const StressScene& world, bool everything = false) {
        Progress progress;
        capture = paintStressScene(world, progress).capture;
        scene = buildScene(capture.mesh, progress);
        samples = gatherRadiance(capture, scene, {}, progress);
        clusters = clusterEmitters(scene, capture, samples, {}, progress);
        plan = planSolve(capture, scene, samples, clusters, options, everything, progress);
    }
    Estimate solve(const SolvePlan& with) const {
        Progress progress;
        SolveOptions planned = options;
        planned.plan = with;
        return solveScene(capture, scene, samples, clusters, planned, progress);
    }
    bool leavesOut(Omission what) const {
        return std::any_of(plan.leftOut.begin(), plan.leftOut.end(),
                           [&](const PlannedOmission& o) { return o.what == what; });
    }
};

StressScene blackWorld() {
    StressScene world;
    world.sky = [](const Vec3&) { return Rgb(0); };
    return world;
}

SolvePlan everything() {
    SolvePlan plan;
    plan.choices = PlanChoices::everything();
    return plan;
}

TEST(Plan, BlackSurroundingsAreNeverBuilt) {
    const Planned p(blackWorld());
    ASSERT_TRUE(p.leavesOut(Omission::distantLight));
    EXPECT_FALSE(p.plan.choices.distantLight);
    const Estimate found = p.solve(p.plan), whole = p.solve(everything());
    EXPECT_EQ(found.lighting.leaves.size(), 1u);
    for (const Rgb& l : found.environment) ASSERT_EQ(l, Rgb(0));
    const AnswerDifference d = differenceOf(whole, found, {});
    EXPECT_LT(d.emitters, 1e-3);
    EXPECT_LT(d.albedo, 0.02);
    for (const PlannedStage& s : found.plan.stages) EXPECT_NE(s.stage, Stage::visibility);
}

TEST(Plan, SurroundingsThatGiveLightStay) {
    const Planned p{StressScene{}};
    EXPECT_FALSE(p.leavesOut(Omission::distantLight));
    EXPECT_TRUE(p.plan.choices.distantLight);
    StressScene dim;  // a hundredth of the usual sky: still more than the photographs' noise
    dim.sky = [](const Vec3&) { return Rgb(0.03f); };
    EXPECT_TRUE(Planned(dim).plan.choices.distantLight);
}

TEST(Plan, WithoutEmittersThereIsNoNearField) {
    StressScene world;
    world.emitters.clear();
    const Planned p(world);
    EXPECT_TRUE(p.leavesOut(Omission::nearFieldEmitters));
    EXPECT_TRUE(p.plan.choices.distantLight);
}

TEST(Plan, LobesAreSoughtWhereTheViewShowsThem) {
    StressScene mirror;
    mirror.specularAlpha = 0.05f;
    const Planned matte{StressScene{}}, shiny(mirror);
    EXPECT_FALSE(matte.plan.choices.matteComponents);
    EXPECT_FALSE(shiny.leavesOut(Omission::glossyLobes));
    EXPECT_TRUE(shiny.leavesOut(Omission::lobesOnMatte));
    EXPECT_GT(shiny.solve(shiny.plan).reflectance.basis.lobes.size(), 1u);
}

TEST(Plan, EverythingLeavesNothingOutAndGivesTheSameAnswer) {
    const Planned all(StressScene{}, true), p{StressScene{}};
    EXPECT_TRUE(all.plan.leftOut.empty());
    EXPECT_TRUE(all.plan.choices.matteComponents && all.plan.choices.unobservedVertices && all.plan.choices.bounce);
    EXPECT_GE(all.plan.predictedSeconds(), p.plan.predictedSeconds() * 0.5);
    const AnswerDifference d = differenceOf(p.solve(all.plan), p.solve(p.plan), {});
    EXPECT_LT(d.worst(), 0.02);
}

TEST(Plan, ItsStagesAreThoseOfTheSolve) {
    StressScene mirror;
    mirror.specularAlpha = 0.05f;
    for (const StressScene& world : {StressScene{}, blackWorld(), mirror}) {
        const Planned p(world);
        for (const PlannedStage& s : p.plan.stages) {
            EXPECT_TRUE(std::isfinite(s.predictedSeconds) && s.predictedSeconds >= 0) << nameOf(s.stage);
            EXPECT_TRUE(std::isfinite(s.predictedMib) && s.predictedMib >= 0) << nameOf(s.stage);
            EXPECT_LT(s.measuredSeconds, 0) << nameOf(s.stage);
        }
        // What runs was foreseen.
        for (const PlannedStage& s : p.solve(p.plan).plan.stages)
            EXPECT_TRUE(s.measuredSeconds < 0.02 || s.predictedSeconds >= 0) << nameOf(s.stage);
    }
}

TEST(Plan, CostsFollowTheCounts) {
    WorkCounts counts;
    counts.vertices = 20000;
    counts.seen = counts.rows = 15000;
    counts.pairs = 100000;
    counts.matteObservations = 3000;
    counts.lobes = 12;
    counts.observationSeconds = 1e-5;
    MachineSpeed speed;
    speed.gramPerColumn = 1e-9;
    speed.gramPerSquare = 1e-11;
    speed.factorPerCube = 1e-9;
    PilotFindings pilot;
    pilot.visibilitySecondsPerRay = 1e-7;
    pilot.bounceSecondsPerRay = 1e-7;
    pilot.rowSecondsPerCell = 1e-9;
    const auto total = [&](const PlanChoices& choices, const SolveOptions& options = {}) {
        double sum = 0;
        for (const StageEstimate& s : predictStages(counts, speed, pilot, options, choices)) sum += s.seconds;
        return sum;
    };
    const double all = total(PlanChoices::everything());
    for (bool PlanChoices::*part : {&PlanChoices::distantLight, &PlanChoices::bounce, &PlanChoices::unobservedVertices,
                                    &PlanChoices::matteComponents}) {
        PlanChoices fewer = PlanChoices::everything();
        fewer.*part = false;
        EXPECT_LT(total(fewer), all);
    }
    SolveOptions finer;
    finer.visibilitySide = 128;
    EXPECT_GT(total(PlanChoices::everything(), finer), all);
}

TEST(Plan, SpeaksInJsonAndInWords) {
    SolvePlan plan;
    plan.stages.push_back({Stage::visibility, 1.5, -1, 20, -1});
    plan.leftOut.push_back({Omission::distantLight, "it is black", 2, 30});
    const nlohmann::json j = planJson(plan);
    EXPECT_EQ(j["stages"][0]["predicted_s"], 1.5);
    EXPECT_TRUE(j["stages"][0]["measured_s"].is_null());
    EXPECT_EQ(j["left_out"][0]["reason"], "it is black");
    EXPECT_EQ(j["saved_s"], 2.0);
    EXPECT_FALSE(j.contains("suspected_light"));
    EXPECT_EQ(planText(plan).find("--find-light"), std::string::npos);
    plan.suspectedLight = SuspectedLight{{1, 2, 3.25}, 0.125, 4, 0.5};
    EXPECT_EQ(planJson(plan)["suspected_light"]["position"], (nlohmann::json{1, 2, 3.25}));
    const std::string text = planText(plan);
    EXPECT_NE(text.find("near 1.00 2.00 3.25: it would give 50 % of the light"), std::string::npos) << text;
    EXPECT_NE(text.find("--find-light"), std::string::npos);
    for (const char* word : {"visibility", "distant light", "it is black"})
        EXPECT_NE(text.find(word), std::string::npos) << word;
}

}  // namespace
}  // namespace relamp
