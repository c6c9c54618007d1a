// The post of a lamp, which a mesh has bent and too thick, as its photographs show it.
#include "solve/registration/tube_fit.h"

#include <gtest/gtest.h>

#include "support/post_photograph.h"

namespace relamp {
namespace {

StraightTube post(double radius) {
    StraightTube tube;
    tube.axes = glm::dmat3(DVec3(0, 0, -1), DVec3(1, 0, 0), DVec3(0, -1, 0));
    tube.through = DVec3(0, 0, 0.3);
    tube.radius = radius;
    tube.to = 0.25;
    return tube;
}

/// A post of 10 mm, lit from one side, before stripes; 3 mm are a pixel. `contrast`: of post and stripes.
Capture photographs(float contrast) {
    Capture capture;
    for (int i = 0; i < 6; ++i) {
        const double turn = 2 * piD * i / 6;
        View view;
        view.camera =
            test::cameraAt({std::cos(turn), std::sin(turn), 0.5 + 0.1 * (i % 3)}, {0, 0, 0.15}, 120, 160, 330);
        view.image = test::postPhotograph(view.camera, 0.01, 0.3, [&](const DVec3& ray, std::optional<double> across) {
            const float stripes = 1 + 0.3f * float(std::sin(9 * ray.x + 7 * ray.z));
            return across ? 1 - contrast * (0.7f + 20 * float(*across)) : stripes;
        });
        capture.views.push_back(std::move(view));
    }
    return capture;
}

/// As the mesh has it: thicker, and bent aside by most of its radius.
StraightTube inMesh() {
    StraightTube tube = post(0.0118);
    tube.through += DVec3(0.004, -0.003, 0);
    tube.axes[0] = glm::normalize(DVec3(0.02, 0.015, -1));
    tube.axes[1] = glm::normalize(DVec3(1, 0, 0.02));
    tube.axes[2] = glm::cross(tube.axes[0], tube.axes[1]);
    return tube;
}

TEST(TubeFit, FindsThePostThatPhotographsShow) {
    Progress progress;
    const Scene scene = test::sceneOf(test::sheet({-0.2f, -0.2f, -0.01f}, {0.4f, 0, 0}, {0, 0.4f, 0}, 4, 4));
    const auto found = fitTube(photographs(1), scene, inMesh(), 1e-3f, progress);
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->radius, 0.01, 0.0003);  // a tenth of a pixel
    for (const double along : {0.02, 0.23}) EXPECT_LT(post(0.01).off(found->onAxis(along)), 0.0003) << along;
}

TEST(TubeFit, FindsAPostOfWhichAMeshMadeShredsFourTimesAsThick) {
    Progress progress;
    const Scene scene = test::sceneOf(test::sheet({-0.2f, -0.2f, -0.01f}, {0.4f, 0, 0}, {0, 0.4f, 0}, 4, 4));
    StraightTube shreds = inMesh();
    shreds.radius = 0.04;
    const auto found = fitTube(photographs(1), scene, shreds, 1e-3f, progress);
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->radius, 0.01, 0.0005);
}

TEST(TubeFit, WhatPhotographsDoNotShowStaysAsItIs) {
    Progress progress;
    const Scene scene = test::sceneOf(test::sheet({-0.2f, -0.2f, -0.01f}, {0.4f, 0, 0}, {0, 0.4f, 0}, 4, 4));
    Capture even = photographs(1);
    for (View& view : even.views) std::fill(view.image.pixels.begin(), view.image.pixels.end(), Rgb(0.5f));
    EXPECT_FALSE(fitTube(even, scene, inMesh(), 1e-3f, progress));
    // Hidden from every camera.
    const Scene hidden = test::sceneOf(test::box({-0.1f, -0.1f, -0.1f}, {0.1f, 0.1f, 0.4f}, 2));
    EXPECT_FALSE(fitTube(photographs(1), hidden, inMesh(), 1e-3f, progress));
}

TEST(TubeFit, EndsWhenItIsCancelled) {
    const Scene scene = test::sceneOf(test::sheet({-0.2f, -0.2f, -0.01f}, {0.4f, 0, 0}, {0, 0.4f, 0}, 4, 4));
    Progress progress;
    progress.requestStop();
    EXPECT_THROW(fitTube(photographs(1), scene, inMesh(), 1e-3f, progress), Cancelled);
}

}  // namespace
}  // namespace relamp
