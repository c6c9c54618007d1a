// The panels that edit the light, with a mouse: the table of lights, the inspector, the environment.
#include "actions.h"
#include "panels/emitter_controls.h"
#include "panels/inspector.h"
#include "panels/panels.h"
#include "ui/panels/panel_harness.h"

namespace relamp::ui::test {
namespace {

/// The table of emitters alone, 520 pixels wide.
struct Table : Panels {
    std::string id;
    Table() {
        openSolved();
        id = editor->emitters()[0].id;
        windowSize(640, 300);
        frame([this] { drawEmittersPanel(*editor); });
        frames(2);
    }
    ImGuiID control(const char* name) { return idOf("test", {"##emitters", id.c_str(), name}); }
};

TEST(EmitterTable, namesStayReadableInANarrowColumn) {
    Table t;
    t.windowSize(em(13), 300);
    t.frames(2);
    EXPECT_FALSE(t.find(t.control("##stops"))) << "the inspector has it";
    const auto at = t.find(t.control("##mute"));
    ASSERT_TRUE(at);
    EXPECT_GT(at->x, em(6));
}

TEST(EmitterTable, draggingStopsIsOneEntryAndUndoRestores) {
    Table t;
    const Look before = t.editor->look();
    const size_t entries = t.editor->history().entries().size();
    const auto at = t.find(t.control("##stops"));
    ASSERT_TRUE(at);
    t.mouse(*at);
    t.press(true);
    for (int i = 1; i <= 10; ++i) {
        t.mouse({at->x + 10.0f * float(i), at->y});
        t.frames(1);
    }
    EXPECT_TRUE(t.editor->inGesture());
    EXPECT_EQ(t.editor->history().entries().size(), entries);
    t.press(false);
    t.frames(2);
    EXPECT_FALSE(t.editor->inGesture());
    ASSERT_EQ(t.editor->history().entries().size(), entries + 1);
    EXPECT_EQ(t.editor->history().entries().back().label, "Exposure of " + t.editor->emitter(t.id)->name);
    // 0.02 stops a pixel, less the few pixels before a drag begins.
    const EmitterState& now = *t.editor->emitter(t.id);
    EXPECT_GT(now.radiance.x, 2 * now.recoveredRadiance.x);
    EXPECT_NEAR(now.radiance.y / now.radiance.x, now.recoveredRadiance.y / now.recoveredRadiance.x, 1e-4);
    t.editor->undo();
    EXPECT_EQ(t.editor->look(), before);
}

TEST(EmitterTable, escDuringADragLeavesNoEntryAndDoesNotStartAgain) {
    Table t;
    const Look before = t.editor->look();
    const size_t entries = t.editor->history().entries().size();
    const auto at = t.find(t.control("##stops"));
    ASSERT_TRUE(at);
    t.mouse(*at);
    t.press(true);
    for (int i = 1; i <= 5; ++i) t.mouse({at->x + 10.0f * float(i), at->y}), t.frames(1);
    ASSERT_TRUE(t.editor->inGesture());
    t.key(keyEscape);
    EXPECT_FALSE(t.editor->inGesture());
    for (int i = 6; i <= 9; ++i) t.mouse({at->x + 10.0f * float(i), at->y}), t.frames(1);
    EXPECT_FALSE(t.editor->inGesture());
    t.press(false);
    t.frames(2);
    EXPECT_EQ(t.editor->history().entries().size(), entries);
    EXPECT_EQ(t.editor->look(), before);
}

TEST(EmitterTable, aClickWithoutADragChangesNothing) {
    Table t;
    const size_t entries = t.editor->history().entries().size();
    const auto at = t.find(t.control("##stops"));
    ASSERT_TRUE(at);
    t.click(*at);
    EXPECT_EQ(t.editor->history().entries().size(), entries);
    EXPECT_FALSE(t.editor->inGesture());
}

TEST(EmitterTable, theMuteButtonSwitchesOffAndOn) {
    Table t;
    const auto at = t.find(t.control("##mute"));
    ASSERT_TRUE(at);
    t.click(*at);
    EXPECT_FALSE(t.editor->emitter(t.id)->enabled);
    t.click(*at);
    EXPECT_TRUE(t.editor->emitter(t.id)->enabled);
}

TEST(EmitterTable, soloIsNotAnEdit) {
    Table t;
    const size_t entries = t.editor->history().entries().size();
    const auto at = t.find(t.control("##solo"));
    ASSERT_TRUE(at);
    t.click(*at);
    EXPECT_EQ(t.editor->state.viewport.solo, std::vector<std::string>{t.id});
    t.click(*at);
    EXPECT_TRUE(t.editor->state.viewport.solo.empty());
    EXPECT_EQ(t.editor->history().entries().size(), entries);
}

TEST(EmitterTable, anEditGoesToAllSelectedAsOneEntry) {
    Table t;
    addNewEmitter(*t.editor, EmitterShape::disk);
    const std::string added = t.editor->emitters().back().id;
    EXPECT_EQ(t.editor->state.selection.emitters, std::vector<std::string>{added});
    selectEmitter(*t.editor, t.id, true, false);
    ASSERT_EQ(t.editor->state.selection.emitters.size(), 2u);
    t.frames(2);
    const size_t entries = t.editor->history().entries().size();
    const auto at = t.find(t.control("##mute"));
    ASSERT_TRUE(at);
    t.click(*at);
    EXPECT_EQ(t.editor->history().entries().size(), entries + 1);
    for (const EmitterState& e : t.editor->emitters()) EXPECT_FALSE(e.enabled) << e.id;
    const float before = luminance(t.editor->emitter(added)->radiance);
    const auto stops = t.find(t.control("##stops"));
    ASSERT_TRUE(stops);
    t.mouse(*stops);
    t.press(true);
    for (int i = 1; i <= 6; ++i) t.mouse({stops->x + 10.0f * float(i), stops->y}), t.frames(1);
    t.press(false);
    EXPECT_EQ(t.editor->history().entries().size(), entries + 2);
    const EmitterState& first = *t.editor->emitter(t.id);
    EXPECT_NEAR(luminance(t.editor->emitter(added)->radiance) / before,
                luminance(first.radiance) / luminance(first.recoveredRadiance), 1e-3);
}

TEST(EmitterTable, shiftExtendsAndCtrlToggles) {
    Table t;
    addNewEmitter(*t.editor, EmitterShape::disk);
    addNewEmitter(*t.editor, EmitterShape::sphere);
    const auto& all = t.editor->emitters();
    selectEmitter(*t.editor, all.front().id, false, false);
    selectEmitter(*t.editor, all.back().id, false, true);
    EXPECT_EQ(t.editor->state.selection.emitters.size(), all.size());
    EXPECT_EQ(t.editor->state.selection.active(), all.front().id);
    selectEmitter(*t.editor, all.front().id, true, false);
    EXPECT_EQ(t.editor->state.selection.emitters.size(), all.size() - 1);
    selectEmitter(*t.editor, all.front().id, false, false);
    EXPECT_EQ(t.editor->state.selection.emitters, std::vector<std::string>{all.front().id});
}

TEST(EmitterTable, kelvinKeepsTheBrightness) {
    Table t;
    const auto at = t.find(t.control("##kelvin"));
    ASSERT_TRUE(at);
    const float before = luminance(t.editor->emitter(t.id)->radiance);
    t.mouse(*at);
    t.press(true);
    for (int i = 1; i <= 8; ++i) t.mouse({at->x + 10.0f * float(i), at->y}), t.frames(1);
    t.press(false);
    const EmitterState& now = *t.editor->emitter(t.id);
    EXPECT_NEAR(luminance(now.radiance) / before, 1, 1e-3);
    EXPECT_GT(now.radiance.z / now.radiance.x, now.recoveredRadiance.z / now.recoveredRadiance.x);
}

TEST(EmitterControls, newLightsFaceWhatTheCameraLooksAt) {
    Panels p;
    p.openSolved();
    p.editor->state.viewport.camera.target = {0.1f, 0, 0.2f};
    const AddedEmitter added = newEmitter(*p.editor, EmitterShape::rectangle);
    const Vec3 place(added.matrix[3]), facing = -Vec3(added.matrix[2]);
    EXPECT_GT(glm::dot(facing, glm::normalize(p.editor->state.viewport.camera.target - place)), 0.999f);
    EXPECT_NEAR(added.size.x, p.editor->state.document.scene->diagonal / 16, 1e-4);
    EXPECT_NEAR(luminance(added.radiance), referenceBrightness(*p.editor), 1e-4);
}

TEST(EmitterControls, aLightThatAnUndoTakesAwayIsSelectedNoMore) {
    Panels p;
    p.openSolved();
    addNewEmitter(*p.editor, EmitterShape::disk);
    ASSERT_EQ(p.editor->state.selection.emitters.size(), 1u);
    p.editor->undo();
    EXPECT_TRUE(p.editor->state.selection.emitters.empty());
}

TEST(EmitterControls, aNewSpotHasAConeAndThePowerThatIsLeft) {
    Panels p;
    p.openSolved();
    addNewEmitter(*p.editor, EmitterShape::spot);
    const std::string id = p.editor->emitters().back().id;
    const auto shape = [&](const std::function<void(LightShaping&)>& change) {
        p.editor->edit("Shape", [&](Look& look) { shapeEmitter(look, id, change); });
    };
    shape([](LightShaping& s) { s.coneSoftness = 0; });
    EXPECT_EQ(p.editor->look().added.back().shaping.coneDegrees, 30);
    const float cone = powerOf(*p.editor, *p.editor->emitter(id));
    shape([](LightShaping& s) { s.coneDegrees = 180; });
    // A cosine-weighted hemisphere sends the sine squared of 30 degrees within 30 degrees.
    EXPECT_NEAR(cone / powerOf(*p.editor, *p.editor->emitter(id)), 0.25, 0.01);
}

TEST(EmitterControls, powerFollowsTheAreaOfAFlatLight) {
    Panels p;
    p.openSolved();
    addNewEmitter(*p.editor, EmitterShape::rectangle);
    const EmitterState before = p.editor->emitters().back();
    p.editor->edit("Scale", [&](Look& look) {
        Mat4 twice(2);
        twice[3] = Vec4(before.pivot - 2.0f * before.pivot, 1);
        moveEmitter(look, before.id, twice);
    });
    EXPECT_NEAR(powerOf(*p.editor, p.editor->emitters().back()) / powerOf(*p.editor, before), 4, 1e-2);
    EXPECT_NEAR(stopsOf(*p.editor, before), 0, 1e-4);
}

TEST(Inspector, positionRotationAndScaleComeBackFromAMatrix) {
    for (const Vec3& degrees : {Vec3(0), Vec3(10, 20, 30), Vec3(-120, 45, 170), Vec3(5, -80, 0), Vec3(0, 0, 90)}) {
        const Vec3 scale(0.5f, 1, 3);
        Mat3 m = rotationOf(degrees);
        for (int k = 0; k < 3; ++k) m[k] *= scale[k];
        const Placement back = placementOf(Mat4(m));
        EXPECT_LT(glm::distance(back.scale, scale), 1e-4f);
        const Mat3 again = rotationOf(back.degrees);
        for (int k = 0; k < 3; ++k)
            EXPECT_LT(glm::distance(again[k], m[k] / scale[k]), 1e-4f)
                << degrees.x << " " << degrees.y << " " << degrees.z;
    }
}

/// The inspector alone, 320 pixels wide, with the first emitter selected. Its id.
std::string inspectFirstEmitter(Panels& p) {
    p.openSolved();
    const std::string id = p.editor->emitters()[0].id;
    selectEmitter(*p.editor, id, false, false);
    p.windowSize(320, 690);
    p.frame([&p] { drawInspectorPanel(*p.editor); });
    return id;
}

TEST(Inspector, aTypedNameIsOneEntryAndIsShownEverywhere) {
    Panels p;
    const std::string id = inspectFirstEmitter(p);
    const size_t entries = p.editor->history().entries().size();
    runAction(*p.editor, "light.rename");
    p.frames(3);
    p.type("Key");
    p.key(keyEnter);
    p.frames(2);
    ASSERT_EQ(p.editor->history().entries().size(), entries + 1);
    EXPECT_EQ(p.editor->history().entries().back().label, "Rename Light 1 to Key");
    EXPECT_EQ(p.editor->emitter(id)->name, "Key");
    EXPECT_EQ(p.editor->namesOf({id}), "Key");
    // Escape leaves it as it is.
    runAction(*p.editor, "light.rename");
    p.frames(3);
    p.type("Other");
    p.key(keyEscape);
    p.frames(2);
    EXPECT_EQ(p.editor->history().entries().size(), entries + 1);
    EXPECT_EQ(p.editor->emitter(id)->name, "Key");
    p.editor->undo();
    EXPECT_EQ(p.editor->emitter(id)->name, "Light 1");
}

TEST(Inspector, draggingThePositionMovesTheLightAsOneEntry) {
    Panels p;
    const std::string id = inspectFirstEmitter(p);
    const Vec3 before = p.editor->emitter(id)->pivot;
    const size_t entries = p.editor->history().entries().size();
    const auto at = p.find(Panels::idOf("test", {"Position (m)", "##y"}));
    ASSERT_TRUE(at);
    p.mouse(*at);
    p.press(true);
    for (int i = 1; i <= 8; ++i) p.mouse({at->x + 10.0f * float(i), at->y}), p.frames(1);
    p.press(false);
    EXPECT_EQ(p.editor->history().entries().size(), entries + 1);
    const Vec3 now = p.editor->emitter(id)->pivot;
    EXPECT_NEAR(now.x, before.x, 1e-4);
    EXPECT_GT(now.y, before.y + 0.05f);
    p.editor->undo();
    EXPECT_LT(glm::distance(p.editor->emitter(id)->pivot, before), 1e-6f);
}

TEST(EnvironmentPanel, draggingThePanoramaTurnsItWithTheHand) {
    Panels p;
    p.openSolved();
    p.windowSize(300, 500);
    p.frame([&] { drawEnvironmentPanel(*p.editor); });
    const auto at = p.find(Panels::idOf("test", {"##recovered"}));
    ASSERT_TRUE(at);
    const size_t entries = p.editor->history().entries().size();
    p.mouse(*at);
    p.press(true);
    for (int i = 1; i <= 5; ++i) p.mouse({at->x + 8.0f * float(i), at->y}), p.frames(1);
    p.press(false);
    EXPECT_EQ(p.editor->history().entries().size(), entries + 1);
    // To the right runs from +Y to -Y: clockwise from above.
    EXPECT_LT(p.editor->look().environment.yawDegrees, -50);
    p.editor->undo();
    EXPECT_EQ(p.editor->look().environment.yawDegrees, 0);
}

TEST(EnvironmentPanel, noneAndBackAgain) {
    Panels p;
    p.openSolved();
    p.windowSize(300, 500);
    p.frame([&] { drawEnvironmentPanel(*p.editor); });
    const auto none = p.find(Panels::idOf("test", {"None"}));
    ASSERT_TRUE(none);
    p.click(*none);
    EXPECT_EQ(p.editor->look().environment.source, EnvironmentLook::Source::none);
    const auto back = p.find(Panels::idOf("test", {"Recovered"}));
    ASSERT_TRUE(back);
    p.click(*back);
    EXPECT_EQ(p.editor->look().environment.source, EnvironmentLook::Source::recovered);
}

}  // namespace
}  // namespace relamp::ui::test
