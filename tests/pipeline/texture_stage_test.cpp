#include "pipeline/texture_stage.h"

#include <gtest/gtest.h>

#include "pipeline/plan.h"
#include "support/estimates.h"

namespace relamp {
namespace {

/// A sheet of `cuts` squares a side, 2 m wide, seen from 2 m by a camera of 100 pixels of focal length: a metre is 50
/// pixels.
struct SeenSheet {
    Scene scene;
    Capture capture;
    RadianceSamples samples;

    explicit SeenSheet(int cuts) : scene(test::sceneOf(test::sheet({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, cuts, cuts))) {
        View view;
        view.camera = test::cameraAt({0, 0, 2}, {0, 0, 0}, 100, 100, 100, {0, 1, 0});
        view.image = Image(100, 100, Rgb(0.5f));
        capture.views = {view};
        capture.mesh = scene.mesh;
        samples.start.push_back(0);
        for (size_t v = 0; v < scene.mesh.vertexCount(); ++v) {
            samples.samples.push_back({0, Rgb(0.5f), 1, false});
            samples.start.push_back(uint32_t(v + 1));
        }
    }
    SolvePlan plan(std::optional<int> side = {}, bool everything = false) const {
        SolvePlan plan;
        planTexture(capture, scene, samples, side, everything, plan);
        return plan;
    }
};

bool planned(const SolvePlan& plan) {
    EXPECT_EQ(plan.stages.size() + plan.leftOut.size(), 1u);
    return !plan.stages.empty();
}

TEST(TextureStage, IsLeftOutWhereTheMeshIsAsFineAsThePhotographs) {
    const SolvePlan coarse = SeenSheet(20).plan(), fine = SeenSheet(300).plan();  // 5 pixels, 0.4 pixels
    EXPECT_TRUE(planned(coarse));
    EXPECT_EQ(coarse.stages[0].stage, Stage::texture);
    EXPECT_GT(coarse.stages[0].predictedSeconds, 0);
    ASSERT_FALSE(planned(fine));
    EXPECT_EQ(fine.leftOut[0].what, Omission::texture);
    EXPECT_NE(fine.leftOut[0].reason.find("0.4 pixels"), std::string::npos) << fine.leftOut[0].reason;
    EXPECT_GT(fine.leftOut[0].savedSeconds, 0);
}

TEST(TextureStage, FollowsTheArtistsWord) {
    EXPECT_FALSE(planned(SeenSheet(20).plan(0)));
    EXPECT_TRUE(planned(SeenSheet(300).plan(1024)));
    EXPECT_TRUE(planned(SeenSheet(300).plan({}, true)));
}

TEST(TextureStage, SaysWhyTheMeshsOwnTexcoordsAreNotUsed) {
    SeenSheet sheet(20);
    std::vector<TexturedFace> faces;
    for (const Triangle& t : sheet.scene.mesh.triangles) faces.push_back({t, {Vec2(0, 0), Vec2(1, 0), Vec2(0, 1)}});
    sheet.capture.texcoords = std::make_shared<const std::vector<TexturedFace>>(faces);
    const SolvePlan plan = sheet.plan();
    ASSERT_EQ(plan.leftOut.size(), 1u);
    EXPECT_EQ(plan.leftOut[0].what, Omission::ownTexcoords);
    EXPECT_EQ(plan.leftOut[0].reason, "triangles lie on one another in the image");
    EXPECT_EQ(plan.stages.size(), 1u);
}

TEST(TextureStage, WithoutTimeThereIsNone) {
    const SeenSheet sheet(20);
    Estimate estimate = test::matteEstimate(sheet.scene, Rgb(0.5f), Rgb(1));
    estimate.surfaceLight.white = {std::vector<Rgb>(sheet.scene.mesh.vertexCount(), Rgb(1))};
    estimate.surfaceLight.coating = {std::vector<Rgb>(sheet.scene.mesh.vertexCount(), Rgb(0))};
    Progress progress;
    progress.setBudget(1e-9);
    addTexture(sheet.capture, sheet.scene, {}, estimate, progress);
    EXPECT_FALSE(estimate.reflectance.texture);
    EXPECT_TRUE(estimate.surfaceLight.empty());
    ASSERT_EQ(estimate.leftOut.size(), 1u);
    EXPECT_EQ(estimate.leftOut[0].what, Omission::texture);
}

}  // namespace
}  // namespace relamp
