// Lighting states with environments of their own as edits: shown, mixed, told apart, and what files say of them.
#include "edit/state_edits.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "relight/look_track.h"
#include "relight/relit_scene.h"
#include "relight/state_look.h"
#include "support/known_world.h"

namespace relamp {
namespace {

/// By day, in the evening, in the dark, and by day once more; a lamp shines in the two in between.
Estimate fourStates() {
    Estimate e;
    e.environmentSide = 2;
    e.environment.assign(4, Rgb(1));
    e.otherEnvironments.push_back({std::vector<Rgb>(4, Rgb(0.2f, 0.1f, 0)), {}});
    e.states = {{"day", {}, 0}, {"evening", {}, 1}, {"dark", {}, -1}, {"noon", {}, 0}};
    EmitterCluster lamp;
    lamp.id = "emitter-1";
    lamp.inState = {0, 1, 1, 0};
    e.emitters.emitters.push_back(lamp);
    return e;
}

Rgb skyOf(const Estimate& e, const Look& look) { return distantOfLook(e, look.environment)->cells()[0]; }

TEST(StateEdits, AStateBringsItsEnvironmentAndIsKnownByIt) {
    const Estimate e = fourStates();
    Look look;
    look.environment.yawDegrees = 30;
    showState(look, e, 1);
    EXPECT_EQ(look.environment.state, "evening");
    EXPECT_EQ(look.environment.yawDegrees, 30) << "its turn stays";
    EXPECT_EQ(shownState(look, e), 1u);
    look.environment.state = "dark";
    EXPECT_EQ(shownState(look, e), 2u) << "the same lamps, another sky";
    showState(look, e, 0);
    EXPECT_EQ(look.environment.state, "") << "the estimate's own needs no name";
    EXPECT_EQ(shownState(look, e), 0u);
    look.environment.state = "noon";
    EXPECT_EQ(shownState(look, e), 0u) << "noon has the same light";
    look.environment.source = EnvironmentLook::Source::none;
    EXPECT_FALSE(shownState(look, e));
}

TEST(StateEdits, AMixGoesEvenlyBetweenLampsAndEnvironments) {
    const Estimate e = fourStates();
    Look look;
    showMix(look, e, 0, 1, 0.25f);
    EXPECT_NEAR(skyOf(e, look).y, 0.75f + 0.25f * 0.1f, 1e-6f);
    EXPECT_EQ(look.emitters[0].powerScale, Rgb(0.25f));
    EXPECT_NEAR(shownMix(look, e, 0, 1), 0.25f, 1e-6f);
    EXPECT_FALSE(shownState(look, e));
    showMix(look, e, 2, 1, 0.4f);  // the lamp stays on
    EXPECT_NEAR(skyOf(e, look).x, 0.4f * 0.2f, 1e-6f);
    EXPECT_NEAR(shownMix(look, e, 2, 1), 0.4f, 1e-6f);
    showMix(look, e, 2, 1, 1);
    EXPECT_EQ(shownState(look, e), 1u);
    EXPECT_EQ(shownMix(look, e, 2, 1), 1);
    showMix(look, e, 0, 3, 0.5f);
    EXPECT_TRUE(look.environment.mixState.empty()) << "both have one sky";
}

TEST(StateEdits, AStateUnderALookLeavesAnEnvironmentThatItNames) {
    const Estimate e = fourStates();
    EXPECT_EQ(inState({}, e, 2).environment.state, "dark");
    EXPECT_EQ(skyOf(e, inState({}, e, 2)), Rgb(0));
    EXPECT_EQ(skyOf(e, inState({}, e, 3)), Rgb(1));
    Look named;
    named.environment.state = "evening";
    EXPECT_EQ(inState(named, e, 2).environment.state, "evening");
    Estimate shared = e;
    for (LightingState& state : shared.states) state.environment = 0;
    EXPECT_EQ(inState({}, shared, 3).environment, EnvironmentLook{});
    EXPECT_FALSE(environmentsDiffer(shared));
}

TEST(StateEdits, FilesKeepTheStateAndSayWhatIsWrong) {
    const Estimate e = fourStates();
    Look look;
    showMix(look, e, 1, 2, 0.5f);
    const Look again = lookFromJson(lookToJson(look), {});
    EXPECT_EQ(again.environment, look.environment);
    const auto errorOf = [&](const char* text) {
        try {
            distantOfLook(e, lookFromJson(nlohmann::json::parse(text), {}).environment);
        } catch (const Error& error) { return std::string(error.what()); }
        return std::string();
    };
    EXPECT_EQ(errorOf(R"({"environment": {"state": "dusk"}})"),
              "environment.state: no lighting state of the photographs is called dusk");
    EXPECT_EQ(errorOf(R"({"environment": {"mix_state": "dusk"}})"),
              "environment.mix_state: no lighting state of the photographs is called dusk");
    EXPECT_EQ(errorOf(R"({"environment": {"mix": 1.5}})"), "environment.mix: is 1.5, expected 0 to 1");
}

TEST(StateEdits, KeysGoEvenlyFromOneSkyToAnother) {
    const Estimate e = fourStates();
    const LookPivots pivots{[](const std::string&) { return Vec3(0); }, [](uint32_t) { return Vec3(0); }};
    const auto between = [&](const Look& a, const Look& b, float t) { return skyOf(e, blendLooks(a, b, t, pivots)); };
    Look day, evening, mixed;
    showState(evening, e, 1);
    showMix(mixed, e, 0, 1, 0.5f);
    EXPECT_NEAR(between(day, evening, 0.25f).x, 0.75f + 0.05f, 1e-6f);
    EXPECT_NEAR(between(evening, day, 0.25f).x, 0.25f + 0.15f, 1e-6f);
    EXPECT_NEAR(between(day, mixed, 0.5f).x, 0.75f + 0.05f, 1e-6f);
    EXPECT_NEAR(between(mixed, day, 0.5f).x, 0.75f + 0.05f, 1e-6f);
}

}  // namespace
}  // namespace relamp
