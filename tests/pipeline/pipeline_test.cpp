// The one way from a capture to an estimate: its halves, what it puts right, its shots, and the time it has yet to go.
#include "pipeline/pipeline.h"

#include <gtest/gtest.h>

#include "pipeline/shot_of.h"
#include "pipeline/time_left.h"
#include "support/known_world.h"
#include "support/shaken_sheet.h"

namespace relamp {
namespace {

struct Painted {
    test::TemporaryFolder folder;
    Capture capture;
    PipelineOptions options;
    Progress progress;
    StageMeter meter{progress};
    Painted() {
        test::paintSmallWorld(folder / "room");
        capture = loadCapture(folder / "room", {}, progress);
        options.solve = solveOptionsFor("draft");
    }
};

TEST(Pipeline, ItsHalvesGiveWhatTheWholeGives) {
    Painted p;
    const PipelineResult whole = runPipeline(p.folder / "room", p.options, p.progress);
    Prepared prepared = prepare(p.capture, p.options, p.meter, p.progress);
    const Corrections done = correctCapture(p.options, p.capture, prepared, p.meter, p.progress);
    EXPECT_TRUE(done.photometric == whole.corrections.photometric);
    EXPECT_EQ(done.smoothedNormals, whole.corrections.smoothedNormals);
    SolvePlan heard;
    SolveExtras extras;
    extras.planned = [&](const SolvePlan& plan) { heard = plan; };
    const Estimate found = solvePrepared(p.capture, *prepared.scene, prepared, p.options, p.meter, p.progress, extras);
    EXPECT_FALSE(heard.stages.empty());
    EXPECT_EQ(found.environment, whole.estimate.environment);
    EXPECT_EQ(found.reflectance.weight, whole.estimate.reflectance.weight);
    EXPECT_TRUE(found.reproduction.measured());
}

TEST(Pipeline, GivenEmittersTakeTheFoundOnesPlace) {
    Painted p;
    p.options.plan = p.options.reproduce = false;
    Prepared prepared = prepare(p.capture, p.options, p.meter, p.progress);
    ASSERT_FALSE(prepared.clusters.emitters.empty());
    prepared.clusters.emitters.clear();
    prepared.clusters.candidates.clear();
    const Estimate found = solvePrepared(p.capture, *prepared.scene, prepared, p.options, p.meter, p.progress);
    EXPECT_TRUE(found.emitters.emitters.empty());
    EXPECT_FALSE(found.reproduction.measured());
    for (const PlannedStage& s : found.plan.stages) EXPECT_LT(s.predictedSeconds, 0) << nameOf(s.stage);
}

TEST(Pipeline, ExposuresThatDifferArePutRightOnce) {
    Painted p;
    for (Rgb& pixel : p.capture.views[1].image.pixels) pixel *= 1.5f;
    p.capture.views[1].saturation *= 1.5f;
    Prepared prepared = prepare(p.capture, p.options, p.meter, p.progress);
    const Corrections done = correctCapture(p.options, p.capture, prepared, p.meter, p.progress);
    ASSERT_FALSE(done.photometric.empty());
    const Rgb off = done.photometric.gainOf(p.capture.views[1].name) / done.photometric.gainOf(p.capture.views[0].name);
    EXPECT_NEAR(off.y, 1.5f, 0.05f);
    // What is told already is not asked again.
    p.options.load.fix.photometric = done.photometric;
    const Capture before = p.capture;
    EXPECT_TRUE(correctCapture(p.options, p.capture, prepared, p.meter, p.progress).photometric == done.photometric);
    EXPECT_EQ(p.capture.views[1].image.pixels, before.views[1].image.pixels);
    PipelineOptions untouched;
    untouched.photometric = false;
    EXPECT_TRUE(correctCapture(untouched, p.capture, prepared, p.meter, p.progress).photometric.empty());
}

TEST(Pipeline, CamerasThatAreOffArePutRightOnce) {
    test::ShakenSheet sheet;
    const Capture truth = sheet.capture;
    sheet.shake();
    const double apart = sheet.apartFrom(truth);
    Capture& capture = sheet.capture;
    PipelineOptions options;
    Progress progress;
    StageMeter meter{progress};
    Prepared prepared = prepare(capture, options, meter, progress);
    options.registration = false;
    EXPECT_TRUE(correctCapture(options, capture, prepared, meter, progress).registration.empty());
    options.registration = true;
    const DMat4 given = capture.views[0].camera.worldFromCamera;
    const Corrections done = correctCapture(options, capture, prepared, meter, progress);
    ASSERT_EQ(done.registration.poses.size(), capture.views.size());
    EXPECT_LT(sheet.apartFrom(truth), 0.1 * apart);
    const DMat4 found = capture.views[0].camera.worldFromCamera;
    EXPECT_NE(found, given);
    // What is told already is not asked again.
    options.load.fix.registration = done.registration;
    EXPECT_TRUE(correctCapture(options, capture, prepared, meter, progress).registration == done.registration);
    EXPECT_EQ(capture.views[0].camera.worldFromCamera, found);
}

TEST(Pipeline, CamerasThatAreFarOffAreOneCorrection) {
    test::ShakenSheet sheet;
    sheet.shake(3);
    Capture& capture = sheet.capture;
    const std::vector<View> given = capture.views;
    Progress progress;
    StageMeter meter{progress};
    Prepared prepared = prepare(capture, {}, meter, progress);
    const Corrections done = correctCapture({}, capture, prepared, meter, progress);
    ASSERT_EQ(done.registration.poses.size(), given.size());
    EXPECT_TRUE(std::any_of(capture.notes.begin(), capture.notes.end(),
                            [](const std::string& n) { return n.find("cameras stand") == 0; }));
    for (size_t i = 0; i < given.size(); ++i)
        EXPECT_EQ(corrected(given[i].camera, done.registration.poses[i]).worldFromCamera,
                  capture.views[i].camera.worldFromCamera);
}

TEST(Pipeline, TheFingerprintHoldsWhatTheAnswerRestsOn) {
    Painted p;
    const uint64_t usual = fingerprintOf(p.capture, p.options);
    EXPECT_EQ(fingerprintOf(p.capture, p.options), usual);
    PipelineOptions other = p.options;
    other.registration = false;
    EXPECT_NE(fingerprintOf(p.capture, other), usual);
    other = p.options;
    other.meshTriangles = 1000;
    EXPECT_NE(fingerprintOf(p.capture, other), usual);
    other = p.options;
    chooseBasis("wide", "", other.solve);
    EXPECT_EQ(other.solve.mostLobes, 3u);
    EXPECT_NE(fingerprintOf(p.capture, other), usual);
    EXPECT_THROW(chooseBasis("narrow", "", other.solve), Error);
    EXPECT_THROW(chooseBasis("built-in", p.folder / "none", other.solve), Error);
    p.capture.views[0].image.pixels[0].x += 1;
    EXPECT_NE(fingerprintOf(p.capture, p.options), usual);
}

TEST(Pipeline, AShotSaysWhereItsEstimateComesFrom) {
    PipelineResult result;
    result.capture.origin = {1, 2, 3};
    result.capture.proxies.push_back({DVec3(1, 0, 0), 0.1f, Vec3(0), true});
    result.corrections.smoothedNormals = 2;
    result.corrections.photometric.falloff2 = -0.1f;
    CaptureFix asked;
    asked.up = "y";
    ShotSource source = sourceOf(result, "room", asked, "draft", 5);
    source.resources.threads = 3;
    Estimate estimate;
    estimate.mode = "near-field";
    Look look;
    look.environment.yawDegrees = 30;
    const Shot shot = shotOf(std::move(estimate), source, look);
    EXPECT_EQ(shot.captureFolder, "room");
    EXPECT_EQ(shot.fix.up, "y");
    EXPECT_EQ(shot.fix.smoothNormals, 2);
    EXPECT_EQ(shot.fix.photometric.falloff2, -0.1f);
    ASSERT_EQ(shot.fix.proxies.size(), 1u);
    EXPECT_EQ(shot.fix.proxies[0].centre, DVec3(2, 2, 3)) << "in the files' own coordinates";
    EXPECT_EQ(shot.capture.origin, DVec3(1, 2, 3));
    EXPECT_EQ(shot.estimate.mode, "near-field");
    EXPECT_EQ(shot.look.environment.yawDegrees, 30);
    EXPECT_EQ(shot.quality, "draft");
    EXPECT_EQ(shot.seed, 5u);
    EXPECT_EQ(shot.resources.threads, 3);
}

TEST(TimeLeft, IsWhatThePlanHasYetToCome) {
    SolvePlan plan;
    EXPECT_EQ(secondsLeft(plan, 0), 0);
    plan.stages.push_back({Stage::visibility, 10, -1, 0, -1});
    plan.stages.push_back({Stage::coarseLight, 20, -1, 0, -1});
    plan.stages.push_back({Stage::closing, 5, -1, 0, -1});
    EXPECT_DOUBLE_EQ(secondsLeft(plan, 0), 35);
    EXPECT_DOUBLE_EQ(secondsLeft(plan, 5), 30);
    EXPECT_DOUBLE_EQ(secondsLeft(plan, 100), 0);
    // A finished stage that took what was foreseen, and one that runs.
    plan.stages[0].measuredSeconds = 10;
    plan.stages[1].measuredSeconds = 5;
    EXPECT_DOUBLE_EQ(secondsLeft(plan, 0), 20);
    // All takes longer here: the others will, too.
    plan.stages[0].measuredSeconds = 40;
    EXPECT_NEAR(secondsLeft(plan, 0), 20 * 50.0 / 20, 1e-9);
}

TEST(TimeLeft, StagesThatTakeTurnsAreNotOver) {
    SolvePlan plan;
    plan.stages.push_back({Stage::surfaces, 3, 3, 0, 0});
    plan.stages.push_back({Stage::glossLight, 10, 5, 0, 0});
    plan.stages.push_back({Stage::glossSurfaces, 4, 2, 0, 0});
    EXPECT_DOUBLE_EQ(secondsLeft(plan, 0), 7);
}

TEST(Names, StagesAndOmissionsComeBackByTheirNames) {
    for (int i = 0; i < int(Stage::other); ++i) EXPECT_EQ(stageNamed(fileNameOf(Stage(i))), Stage(i));
    EXPECT_STREQ(nameOf(Stage::observations), "observations");
    EXPECT_STREQ(fileNameOf(Stage::observations), "look-ups");
    EXPECT_EQ(stageNamed("of another version"), Stage::other);
    for (int i = 0; i < int(Omission::other); ++i) EXPECT_EQ(omissionNamed(nameOf(Omission(i))), Omission(i));
    EXPECT_EQ(omissionNamed("of another version"), Omission::other);
    EXPECT_EQ(LeftOut("interreflection", "").what, Omission::interreflection);
}

}  // namespace
}  // namespace relamp
