// Axes that turn with a capture and with nothing else.
#include "capture/own_axes.h"

#include <gtest/gtest.h>

#include <glm/gtc/quaternion.hpp>

namespace relamp {
namespace {

/// Four cameras about a table, looking down at it, each turned a little about its axis of sight.
Capture table() {
    Capture capture;
    for (int i = 0; i < 4; ++i) {
        View view;
        view.name = "image" + std::to_string(i);
        const DVec3 at(2 * std::cos(1.1 * i), 2 * std::sin(1.1 * i), 1 + 0.1 * i),
            back = glm::normalize(at), tilted = glm::normalize(DVec3(0.02 * i, 0.03, 1));
        const DVec3 right = glm::normalize(glm::cross(tilted, back));
        view.camera.worldFromCamera =
            DMat4(glm::dvec4(right, 0), glm::dvec4(glm::cross(back, right), 0), glm::dvec4(back, 0), glm::dvec4(at, 1));
        capture.views.push_back(view);
    }
    return capture;
}

double apart(const Mat3& a, const Mat3& b) {
    double most = 0;
    for (int i = 0; i < 3; ++i) most = std::max(most, double(glm::distance(a[i], b[i])));
    return most;
}

void turn(Capture& capture, const glm::dmat3& by, double scale = 1, const DVec3& offset = DVec3(0)) {
    for (View& view : capture.views)
        for (int k = 0; k < 4; ++k)
            view.camera.worldFromCamera[k] =
                glm::dvec4(k < 3 ? by * DVec3(view.camera.worldFromCamera[k])
                                 : scale * (by * DVec3(view.camera.worldFromCamera[k])) + offset,
                           k == 3);
}

TEST(OwnAxes, AreARotationWithUpwardsZ) {
    const Mat3 axes = ownAxes(table());
    EXPECT_LT(apart(glm::transpose(axes) * axes, Mat3(1)), 1e-6);
    EXPECT_NEAR(glm::determinant(axes), 1, 1e-6);
    EXPECT_GT(axes[2].z, 0.9f);
    EXPECT_LT(axes[0].x, -0.9f);  // where the first one looks
}

TEST(OwnAxes, TurnWithTheCaptureAlone) {
    const Mat3 axes = ownAxes(table());
    const glm::dmat3 by = glm::mat3_cast(glm::angleAxis(2.1, glm::normalize(DVec3(1, -2, 0.5))));
    Capture turned = table();
    turn(turned, by, 300, {7, 8, 9});
    EXPECT_LT(apart(ownAxes(turned), Mat3(by) * axes), 1e-6);
    Capture reversed = table();
    std::reverse(reversed.views.begin(), reversed.views.end());
    EXPECT_LT(apart(ownAxes(reversed), axes), 1e-7);
}

TEST(OwnAxes, AreDefinedWhateverTheCamerasDo) {
    EXPECT_EQ(ownAxes({}), Mat3(1));
    // One that looks straight down, and two that are upside down to each other.
    Capture down = table(), opposed = table();
    down.views.resize(1);
    down.views[0].camera.worldFromCamera = DMat4(1.0);
    opposed.views.resize(2);
    opposed.views[1].camera.worldFromCamera =
        opposed.views[0].camera.worldFromCamera * DMat4(glm::mat4_cast(glm::angleAxis(piD, DVec3(0, 0, 1))));
    for (const Capture& capture : {down, opposed}) {
        const Mat3 axes = ownAxes(capture);
        EXPECT_LT(apart(glm::transpose(axes) * axes, Mat3(1)), 1e-6);
        EXPECT_NEAR(glm::determinant(axes), 1, 1e-6);
    }
}

}  // namespace
}  // namespace relamp
