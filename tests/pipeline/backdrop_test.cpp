// Background beside a scene without a light: the light itself, or a backdrop that cannot be what lights the scene.
#include <gtest/gtest.h>

#include "pipeline/pipeline.h"
#include "support/known_world.h"

namespace relamp {
namespace {

/// What tells the scale where all that is seen beside the surfaces is `factor` as bright as the light.
std::string evidenceBefore(float factor) {
    const test::TemporaryFolder folder;
    const test::KnownWorld world = test::paintKnownWorld(folder / "capture", false, 6, 14);
    Progress progress;
    Capture capture = loadCapture(folder / "capture", {}, progress);
    const Scene scene = test::sceneOf(world.mesh);
    for (View& view : capture.views)
        for (size_t p = 0; p < view.image.pixels.size(); ++p) {
            const Vec2 pixel(float(p % size_t(view.image.width)) + 0.5f, float(p / size_t(view.image.width)) + 0.5f);
            const Ray ray{Vec3(view.camera.position()), view.camera.rayDirection(pixel), 0, 1e30f};
            if (!scene.tracer->closest(ray)) view.image.pixels[p] *= factor;
        }
    PipelineOptions options;
    options.solve = solveOptionsFor("draft");
    options.texture = 0;
    options.solve.bounce = SolveOptions::Bounce::off;  // its surfaces do not light each other
    options.reproduce = options.registration = options.photometric = false;
    StageMeter meter{progress};
    const Prepared prepared = prepare(capture, options, meter, progress);
    return solvePrepared(capture, *prepared.scene, prepared, options, meter, progress).gauge.evidence;
}

TEST(Backdrop, TheLightItselfIsNone) {
    const std::string evidence = evidenceBefore(1);
    EXPECT_NE(evidence.find("of the light is seen directly"), std::string::npos) << evidence;
}

TEST(Backdrop, WhatSurfacesCannotBeLitByTellsNoScale) {
    for (const float factor : {0.05f, 50.0f}) {
        const std::string evidence = evidenceBefore(factor);
        EXPECT_EQ(evidence.find("nothing of the light is seen"), 0u) << factor << ": " << evidence;
    }
}

}  // namespace
}  // namespace relamp
