#include "edit/light_brush.h"

#include <gtest/gtest.h>

#include "base/error.h"
#include "edit/emitter_edits.h"
#include "support/estimates.h"

namespace relamp {
namespace {

/// A plane of albedo 0.5 under a weak sky and two small lights, left and right.
struct TwoLights {
    std::shared_ptr<const Scene> scene =
        std::make_shared<const Scene>(test::sceneOf(test::sheet({-2, -1, 0}, {4, 0, 0}, {0, 2, 0}, 40, 20)));
    std::shared_ptr<const Estimate> estimate =
        std::make_shared<const Estimate>(test::matteEstimate(*scene, Rgb(0.5f), Rgb(0.05f)));
    Look look;
    Progress progress;
    LiveScene live{scene, estimate, {}, progress};

    TwoLights() {
        for (const float x : {-1.0f, 1.0f}) {
            AddedEmitter light;
            light.shape = EmitterShape::disk;
            light.id = x < 0 ? "left" : "right";
            light.matrix = test::translation({x, 0, 0.6f});
            light.size = Vec2(0.1f);
            light.radiance = Rgb(20);
            look.added.push_back(light);
        }
    }
    std::shared_ptr<const LiveFrame> frame() {
        live.setLook(look);
        while (!live.refine(0.5, progress)) {}
        return live.frame();
    }
    /// The vertices within 40 cm of a point of the plane.
    std::vector<PaintedVertex> around(float x) const {
        std::vector<PaintedVertex> out;
        for (uint32_t v = 0; v < scene->mesh.vertexCount(); ++v)
            if (glm::distance(scene->mesh.positions[v], Vec3(x, 0, 0)) < 0.4f) out.push_back({v, 1});
        return out;
    }
    float meanAt(const LiveFrame& frame, float x) const {
        float sum = 0;
        const auto painted = around(x);
        for (const PaintedVertex& p : painted) sum += luminance(frame.radiance[p.vertex]);
        return sum / float(painted.size());
    }
};

TEST(LightBrush, BrightensWhatIsPaintedAndLeavesTheRest) {
    TwoLights w;
    const auto before = w.frame();
    LightBrush brush;
    brush.stops = 1;
    const LightGoal goal = brushedGoal(*before, *w.estimate, w.look, w.around(-1), brush, {{0, 1}, true});
    const LightGoalAnswer answer = reachGoal(goal, {false});
    scaleLights(w.look, *w.estimate, {"left", "right"}, true, answer.scale);
    const auto after = w.frame();
    EXPECT_NEAR(w.meanAt(*after, -1) / w.meanAt(*before, -1), 2, 0.25);
    EXPECT_NEAR(w.meanAt(*after, 1) / w.meanAt(*before, 1), 1, 0.15);
    EXPECT_EQ(answer.tooDark + answer.tooBright < 0.3f, true) << answer.tooDark << " " << answer.tooBright;
}

TEST(LightBrush, DarkensByTheChosenLightAlone) {
    TwoLights w;
    const auto before = w.frame();
    LightBrush brush;
    brush.kind = LightBrush::Kind::darker;
    brush.stops = 6;
    brush.stillness = 0;
    const LightGoalAnswer answer =
        reachGoal(brushedGoal(*before, *w.estimate, w.look, w.around(1), brush, {{1}, false}), {false});
    scaleLights(w.look, *w.estimate, {"right"}, false, answer.scale);
    EXPECT_FALSE(w.look.added[1].enabled && luminance(w.look.added[1].radiance) > 0.2f);
    EXPECT_EQ(w.look.added[0].radiance, Rgb(20));
    EXPECT_GT(answer.tooBright, 0.9f) << "the sky stays";
    EXPECT_NE(wordsOf(answer, {"right"}, false).find("too bright"), std::string::npos);
}

TEST(LightBrush, GivesTheColourThatIsPainted) {
    TwoLights w;
    const auto before = w.frame();
    LightBrush brush;
    brush.kind = LightBrush::Kind::colour;
    brush.colour = Rgb(1, 0.5f, 0.25f);
    const LightGoalAnswer answer =
        reachGoal(brushedGoal(*before, *w.estimate, w.look, w.around(-1), brush, {{0, 1}, false}));
    scaleLights(w.look, *w.estimate, {"left", "right"}, false, answer.scale);
    const auto after = w.frame();
    Rgb sum(0);
    for (const PaintedVertex& p : w.around(-1)) sum += after->radiance[p.vertex];
    EXPECT_NEAR(sum.y / sum.x, 0.5, 0.06);
    EXPECT_NEAR(sum.z / sum.x, 0.25, 0.06);
    EXPECT_NEAR(w.meanAt(*after, -1) / w.meanAt(*before, -1), 1, 0.08);
}

TEST(LightBrush, ScalesTheEnvironmentInStopsAndTintAndSwitchesOff) {
    TwoLights w;
    scaleLights(w.look, *w.estimate, {"left"}, true, {Rgb(0), Rgb(2, 1, 0.5f)});
    EXPECT_FALSE(w.look.added[0].enabled);
    EXPECT_EQ(w.look.added[0].radiance, Rgb(20));
    const Rgb gain = w.look.environment.tint * std::exp2(w.look.environment.exposureStops);
    EXPECT_LT(glm::distance(gain, Rgb(2, 1, 0.5f)), 1e-5f);
    scaleLights(w.look, *w.estimate, {}, true, {Rgb(0)});
    EXPECT_EQ(w.look.environment.source, EnvironmentLook::Source::none);
}

TEST(LightBrush, OnWhatDoesNotExistIsRefused) {
    TwoLights w;
    const auto frame = w.frame();
    const std::vector<PaintedVertex> nowhere{{1u << 30, 1}};
    EXPECT_THROW(brushedGoal(*frame, *w.estimate, w.look, nowhere, {}, {{0}, false}), Error);
    EXPECT_THROW(brushedGoal(*frame, *w.estimate, w.look, w.around(0), {}, {{7}, false}), Error);
}

}  // namespace
}  // namespace relamp
