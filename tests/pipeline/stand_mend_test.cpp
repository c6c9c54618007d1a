// The stands of lights in photographs.
#include "pipeline/stand_mend.h"

#include <gtest/gtest.h>

#include "support/post_photograph.h"

namespace relamp {
namespace {

constexpr double postRadius = 0.008;

/// A post of 8 mm radius and 20 cm before an even background, or none; 3 mm are a pixel.
Capture photographs(bool post) {
    Capture capture;
    for (int i = 0; i < 6; ++i) {
        const double turn = 2 * piD * i / 6;
        View view;
        // Not all with the axis between the same two pixels.
        const DVec3 target(0.003 * i, 0.002 * (i % 2), 0.15);
        view.camera = test::cameraAt({std::cos(turn), std::sin(turn), 0.5}, target, 120, 160, 330);
        view.image =
            test::postPhotograph(view.camera, post ? postRadius : 0, 0.2,
                                 [](const DVec3&, std::optional<double> across) { return across ? 0.3f : 1.0f; });
        capture.views.push_back(std::move(view));
    }
    return capture;
}

HeldLight shadeAbove() {
    EmitterBody shade;
    shade.round = true;
    shade.half = {0.06, 0.07, 0.07};
    shade.axes = glm::dmat3(DVec3(0, 0, 1), DVec3(1, 0, 0), DVec3(0, 1, 0));
    shade.centre = {0.002, -0.001, 0.26};
    return HeldLight::of(shade);
}

TEST(StandMend, AShadeWhosePostTheMeshLacksStandsOnTheOneThatPhotographsShow) {
    Progress progress;
    const Mesh floor = test::sheet({-0.5f, -0.5f, 0}, {1, 0, 0}, {0, 1, 0}, 20, 20);
    const Scene scene = test::sceneOf(floor);
    const MendedStands found = mendStands(floor, {}, {shadeAbove()}, false, photographs(true), scene, 1e-3f, progress);
    ASSERT_EQ(found.surfaces.size(), 1u);
    ASSERT_EQ(found.words.size(), 1u);
    EXPECT_NE(found.words[0].find("is a tube of"), std::string::npos) << found.words[0];
    EXPECT_TRUE(found.replaced.empty());
    float lowest = 1, highest = 0;
    for (const Vec3& p : found.surfaces[0].positions) {
        EXPECT_NEAR(glm::length(Vec2(p)), postRadius, 6e-4);
        lowest = std::min(lowest, p.z);
        highest = std::max(highest, p.z);
    }
    EXPECT_LT(lowest, 0);
    EXPECT_GT(highest, 0.2f);
    EXPECT_TRUE(
        mendStands(floor, {}, {shadeAbove()}, false, photographs(false), scene, 1e-3f, progress).surfaces.empty());
}

}  // namespace
}  // namespace relamp
