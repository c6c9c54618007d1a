#include <gtest/gtest.h>

#include "relight/live/live_scene.h"
#include "support/estimates.h"

namespace relamp {
namespace {

struct TwoStates {
    std::shared_ptr<const Scene> scene;
    std::shared_ptr<const Estimate> estimate;
};

/// A sheet in two lighting states: the second's environment is red, and both have a panorama.
TwoStates worldOfTwoStates() {
    const auto scene =
        std::make_shared<const Scene>(test::sceneOf(test::sheet({-2, -2, 0}, {4, 0, 0}, {0, 4, 0}, 4, 4)));
    Estimate e = test::matteEstimate(*scene, Rgb(0.5f, 0.4f, 0.3f), Rgb(0.4f, 0.5f, 0.7f));
    e.states = {{"day", {}}, {"dusk", {}, 1}};
    e.otherEnvironments.push_back({std::vector<Rgb>(e.environment.size(), Rgb(2, 0.1f, 0.1f)), {}});
    Image day(64, 32);
    for (int x = 0; x < 64; ++x)
        for (int y = 0; y < 32; ++y) day.at(x, y) = Rgb(float(x) / 64, 1, float(y) / 32);
    e.background = std::make_shared<const Panorama>(day);
    e.otherEnvironments[0].background = std::make_shared<const Panorama>(Image(64, 32, Rgb(2, 0, 0)));
    return {scene, std::make_shared<const Estimate>(std::move(e))};
}

std::shared_ptr<const LiveFrame> frameOf(LiveScene& live, const EnvironmentLook& environment) {
    Look look;
    look.environment = environment;
    live.setLook(look);
    Progress progress;
    while (!live.refine(0.02, progress)) {}
    return live.frame();
}

TEST(LiveEnvironment, IsThatOfAStateAndAMixOfTwo) {
    const TwoStates w = worldOfTwoStates();
    Progress progress;
    LiveScene live(w.scene, w.estimate, {}, progress);
    EnvironmentLook environment;
    environment.state = "dusk";
    const auto middle = [&] { return frameOf(live, environment)->radiance[12]; };
    EXPECT_LT(glm::length(middle() - Rgb(1, 0.04f, 0.03f)), 0.01f);
    environment.state = "day", environment.mixState = "dusk", environment.mix = 0.5f;
    EXPECT_LT(glm::length(middle() - Rgb(0.6f, 0.12f, 0.12f)), 0.01f);
    environment.mix = 0;
    EXPECT_LT(glm::length(middle() - Rgb(0.2f, 0.2f, 0.21f)), 0.01f);
}

TEST(LiveEnvironment, HasTheBackdropThatFramesHave) {
    const TwoStates w = worldOfTwoStates();
    Progress progress;
    LiveScene live(w.scene, w.estimate, {}, progress);
    EnvironmentLook e;
    e.yawDegrees = 70, e.exposureStops = 1, e.tint = Rgb(1, 0.8f, 0.6f), e.sides[4] = Rgb(3, 2, 1);
    for (const char* mixed : {"", "dusk"}) {
        e.mixState = mixed, e.mix = 0.25f;
        const auto frame = frameOf(live, e);
        const auto distant = distantOfLook(*w.estimate, e);
        for (const Vec3& d : {Vec3(1, 0, 0), Vec3(0.6f, 0, 0.8f), Vec3(-0.48f, 0.64f, -0.6f)})
            EXPECT_LT(glm::length(frame->distant->background(d) - distant->background(d)), 1e-3f) << mixed;
    }
    // Turned by 70 degrees, the panorama's middle (+X) lies towards 70 degrees.
    e = {};
    e.yawDegrees = 70;
    const float a = 70 * pi / 180;
    EXPECT_NEAR(distantOfLook(*w.estimate, e)->background({std::cos(a), std::sin(a), 0}).x, 31.5f / 64, 0.01);
}

}  // namespace
}  // namespace relamp
