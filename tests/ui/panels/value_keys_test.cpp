// Keys of single values by the right button, and the view of curves.
#include "actions.h"
#include "edit/value_key_edits.h"
#include "panels/curve_values.h"
#include "panels/curve_view.h"
#include "panels/emitter_controls.h"
#include "ui/panels/panel_harness.h"

namespace relamp::ui::test {
namespace {

const KeyedOf yawOfEnvironment{KeyedValue::yaw, {}};

struct Keyed : Panels {
    Keyed() {
        openSolved();
        editor->state.time.first = 1, editor->state.time.last = 21;
    }
    std::vector<int> framesOf(const KeyedOf& what) const {
        std::vector<int> frames;
        if (const ValueCurve* curve = curveOf(editor->look(), what))
            for (const ValueKey& key : curve->keys) frames.push_back(key.frame);
        return frames;
    }
    void rightClick(const ImVec2& at) {
        mouse(at);
        frames(2);
        press(true, 1);
        press(false, 1);
        frames(2);
    }
    /// An item of the menu that is open.
    void choose(const char* item) {
        const auto& open = ImGui::GetCurrentContext()->OpenPopupStack;
        ASSERT_FALSE(open.empty()) << item;
        const auto at = find(ImHashStr(item, 0, open[0].Window->ID), 4);
        ASSERT_TRUE(at) << item;
        click(*at);
    }
    void setYaw(int atFrame, float degrees) {
        editor->goToFrame(atFrame);
        editor->edit("Turn", [&](Look& look) { look.environment.yawDegrees = degrees; });
    }
    size_t entries() const { return editor->history().index(); }
};

TEST(ValueKeyMenu, aRightClickKeysAValueAndEveryEditOfItAfter) {
    Keyed t;
    t.windowSize(320, 690);
    t.frame([&] { drawEnvironmentPanel(*t.editor); });
    const auto yaw = t.find(t.idOf("test", {"##yaw"}));
    ASSERT_TRUE(yaw);
    t.rightClick(*yaw);
    const size_t before = t.entries();
    t.choose("Set key");
    EXPECT_EQ(t.framesOf(yawOfEnvironment), std::vector<int>{1});
    EXPECT_EQ(t.entries(), before + 1);
    t.setYaw(11, 40);
    EXPECT_EQ(t.framesOf(yawOfEnvironment), (std::vector<int>{1, 11}));
    t.editor->goToFrame(6);
    EXPECT_NEAR(t.editor->look().environment.yawDegrees, 20, 1e-4);
    t.rightClick(*yaw);
    t.choose("Next key");
    EXPECT_EQ(t.editor->state.time.frame, 11);
    t.rightClick(*yaw);
    t.choose("Delete key");
    EXPECT_EQ(t.framesOf(yawOfEnvironment), std::vector<int>{1});
    t.editor->undo();
    EXPECT_EQ(t.framesOf(yawOfEnvironment), (std::vector<int>{1, 11}));
    // A drag shows what is dragged, and is one entry and one key.
    t.editor->goToFrame(6);
    const size_t entry = t.entries();
    t.mouse(*yaw);
    t.press(true);
    t.mouse({yaw->x + 60, yaw->y});
    t.frames(2);
    EXPECT_GT(t.editor->look().environment.yawDegrees, 21);
    t.press(false);
    t.frames(2);
    EXPECT_EQ(t.entries(), entry + 1);
    EXPECT_EQ(t.framesOf(yawOfEnvironment), (std::vector<int>{1, 6, 11}));
    t.rightClick(*yaw);
    t.choose("Delete all its keys");
    EXPECT_TRUE(t.editor->look().curves.empty());
    EXPECT_GT(t.editor->look().environment.yawDegrees, 21) << "it stays as it was shown";
}

TEST(ValueKeyMenu, arrowsGoThroughItEnterChoosesAndEscClosesIt) {
    Keyed t;
    t.windowSize(320, 690);
    t.frame([&] { drawEnvironmentPanel(*t.editor); });
    const auto yaw = t.find(t.idOf("test", {"##yaw"}));
    ASSERT_TRUE(yaw);
    const auto open = [] { return ImGui::GetCurrentContext()->OpenPopupStack.Size > 0; };
    t.rightClick(*yaw);
    ASSERT_TRUE(open());
    t.key(int(keyEscape));
    EXPECT_FALSE(open());
    t.key(int(keyEnter));
    EXPECT_TRUE(t.framesOf(yawOfEnvironment).empty()) << "keys go through open menus alone";
    t.rightClick(*yaw);
    t.key(int(keyDown));
    t.key(int(keyEnter));
    t.frames(2);
    EXPECT_FALSE(open());
    EXPECT_EQ(t.framesOf(yawOfEnvironment), std::vector<int>{1}) << "the first item";
    t.rightClick(*yaw);
    t.key(int(keyDown));
    t.key(int(keyDown));
    t.key(int(keyEnter));
    t.frames(2);
    EXPECT_FALSE(open());
    EXPECT_TRUE(t.editor->look().curves.empty()) << "the second: the key is deleted";
}

TEST(ValueKeyMenu, theInspectorKeysALightsExposureWithoutItsPlace) {
    Keyed t;
    const std::string id = t.editor->emitters()[0].id;
    t.editor->state.selection.emitters = {id};
    t.windowSize(340, 690);
    t.frame([&] { drawInspectorPanel(*t.editor); });
    ImGuiID stops = 0;
    // The exposure stands in a section of its own; the pointer finds what sets a key of it.
    for (float y = 4; y < 690 && !stops; y += 8) {
        t.mouse({220, y});
        t.frames(2);
        if (ImGui::GetCurrentContext()->HoveredId == 0) continue;
        t.rightClick({220, y});
        const auto& open = ImGui::GetCurrentContext()->OpenPopupStack;
        if (open.empty()) continue;
        t.choose("Set key");
        if (!t.framesOf({KeyedValue::powerScale, id}).empty()) stops = 1;
        else t.editor->undo();
    }
    ASSERT_TRUE(stops);
    t.editor->goToFrame(21);
    t.editor->edit("Brighter", [&](Look& look) {
        setRadiance(look, *t.editor->estimate(), id, 4.0f * t.editor->emitter(id)->radiance);
        moveEmitter(look, id, relamp::test::translation({0, 0, 1}));
    });
    t.editor->goToFrame(11);
    ASSERT_EQ(t.editor->look().emitters.size(), 1u);
    EXPECT_NEAR(t.editor->look().emitters[0].powerScale.x, 2, 1e-4);
    EXPECT_EQ(t.editor->look().emitters[0].matrix[3].z, 1) << "in every frame";
}

struct Curves : Keyed {
    ImVec2 corner{0, 0};
    Curves() {
        editor->goToFrame(1);
        editor->setValueKeys({yawOfEnvironment});
        setYaw(11, 40);
        setYaw(21, 0);
        editor->goToFrame(1);
        windowSize(900, 220);
        frame([this] { drawCurveView(*editor); });
        frames(2);
        const auto at = find(idOf("test", {"##curves"}));
        EXPECT_TRUE(at);
        corner = at.value_or(ImVec2(0, 0));
    }
    /// Where a key is drawn: what a click there selects tells.
    std::optional<ImVec2> keyAt(int frameNumber, float fraction) {
        for (float x = 200; x < 890; x += 4)
            for (float dy = -8; dy <= 8; dy += 4) {
                const ImVec2 at{x, 8 + (1 - fraction) * 204 + dy};
                click(at);
                const auto& chosen = editor->state.time.handles;
                if (chosen.size() == 1 && chosen[0].key.frame == frameNumber) return at;
            }
        return {};
    }
    float yawAt(int frameNumber) { return valueAt(*curveOf(editor->look(), yawOfEnvironment), frameNumber).x; }
};

TEST(CurveView, keysAreDraggedInTimeAndValueAsOneEntry) {
    Curves t;
    const float top = 46.0f / 52;  // of its span with 15 % air
    const auto middle = t.keyAt(11, top);
    ASSERT_TRUE(middle);
    const size_t before = t.entries();
    t.mouse(*middle);
    t.press(true);
    for (int i = 1; i <= 6; ++i) t.mouse({middle->x + 15 * float(i), middle->y + 10 * float(i)}), t.frames(1);
    EXPECT_TRUE(t.editor->inGesture());
    EXPECT_LT(t.yawAt(21), 1);
    t.press(false);
    t.frames(2);
    EXPECT_FALSE(t.editor->inGesture());
    EXPECT_EQ(t.entries(), before + 1);
    const std::vector<int> moved = t.framesOf(yawOfEnvironment);
    ASSERT_EQ(moved.size(), 3u);
    EXPECT_GT(moved[1], 11);
    EXPECT_LT(t.yawAt(moved[1]), 35);
    EXPECT_GT(t.yawAt(moved[1]), 10);
    ASSERT_EQ(t.editor->state.time.handles.size(), 1u);
    EXPECT_EQ(t.editor->state.time.handles[0].key.frame, moved[1]) << "it stays selected";
    t.editor->undo();
    EXPECT_EQ(t.framesOf(yawOfEnvironment), (std::vector<int>{1, 11, 21}));
    t.frames(2);
    EXPECT_TRUE(t.editor->state.time.handles.empty() || t.editor->state.time.handles[0].key.frame == 11);
    // Esc takes a drag back.
    t.mouse(*middle);
    t.press(true);
    t.mouse({middle->x + 80, middle->y + 40});
    t.frames(2);
    EXPECT_TRUE(t.editor->inGesture());
    t.key(int(keyEscape));
    EXPECT_FALSE(t.editor->inGesture());
    t.press(false);
    EXPECT_EQ(t.framesOf(yawOfEnvironment), (std::vector<int>{1, 11, 21}));
}

TEST(CurveView, aBoxSelectsSeveralThatAreEasedAndDeletedTogether) {
    Curves t;
    t.mouse({t.corner.x - 3, t.corner.y});
    t.frames(2);
    t.press(true);
    for (const float x : {400.0f, 600.0f, 780.0f}) t.mouse({x, 214}), t.frames(1);
    t.press(false);
    t.frames(2);
    std::vector<int> chosen;
    for (const CurveHandle& handle : t.editor->state.time.handles) chosen.push_back(handle.key.frame);
    EXPECT_EQ(chosen, (std::vector<int>{1, 11}));
    t.rightClick({500, 100});
    t.choose("Hold");
    EXPECT_EQ(t.yawAt(10), 0);
    EXPECT_EQ(t.yawAt(20), 40);
    t.rightClick({500, 100});
    t.choose("Delete keys");
    EXPECT_EQ(t.framesOf(yawOfEnvironment), std::vector<int>{21});
    t.editor->undo();
    EXPECT_EQ(t.framesOf(yawOfEnvironment).size(), 3u);
    // The key Del, where the curves were clicked last.
    t.mouse({500, 10});
    t.frames(2);
    t.press(true);
    t.mouse({780, 214}), t.frames(2);
    t.press(false);
    t.frames(2);
    EXPECT_TRUE(t.editor->state.time.takesDelete);
    t.editor->state.selection.emitters = {t.editor->emitters()[0].id};
    EXPECT_FALSE(runAction(*t.editor, "light.delete")) << "not the light's";
    t.editor->state.selection.emitters.clear();
    const size_t before = t.entries();
    input().pressed = keyDelete;
    t.frames(2);
    EXPECT_EQ(t.entries(), before + 1);
    EXPECT_EQ(t.framesOf(yawOfEnvironment).size(), 2u);
    EXPECT_FALSE(t.editor->state.time.takesDelete);
    t.editor->undo();
    t.frames(2);
    // Another light's selection: nothing of it has curves.
    t.editor->state.selection.emitters = {t.editor->emitters()[0].id};
    t.frames(2);
    EXPECT_TRUE(t.editor->state.time.handles.empty());
}

TEST(CurveAxis, ShowsWhatTheInspectorShows) {
    Keyed t;
    Editor& editor = *t.editor;
    const EmitterState light = editor.emitters()[0];
    const auto words = [&](KeyedValue value, int component, const CurveSpan& span) {
        std::vector<std::string> list;
        for (const AxisTick& tick :
             axisTicks(editor, {value, value == KeyedValue::yaw ? "" : light.id}, component, span, 5))
            list.push_back(tick.words);
        return list;
    };
    using Words = std::vector<std::string>;
    EXPECT_EQ(words(KeyedValue::yaw, 0, {-6, 46}), (Words{"0", "20", "40\u00b0"}));
    EXPECT_EQ(words(KeyedValue::powerScale, 0, {-1.2f, 1.2f}), (Words{"-1.0", "-0.5", "0.0", "0.5", "1.0 stops"}));
    EXPECT_EQ(words(KeyedValue::enabled, 0, {-0.5f, 1.5f}), (Words{"off", "on"}));
    EXPECT_TRUE(words(KeyedValue::yaw, 0, {1, 1}).empty());
    // Places in the world, in the window's unit, though keys count from where the light was captured.
    editor.state.lengthUnit = LengthUnit::centimetres;
    const float x = light.pivot.x + float(editor.state.document.capture->origin.x);
    for (const AxisTick& tick : axisTicks(editor, {KeyedValue::position, light.id}, 0, {-0.5f, 0.5f}, 6))
        EXPECT_NEAR(std::stod(tick.words), 100 * (tick.drawn + x), 0.01) << tick.words;
    EXPECT_EQ(words(KeyedValue::position, 0, {-0.5f, 0.5f})
                  .back()
                  .substr(words(KeyedValue::position, 0, {-0.5f, 0.5f}).back().size() - 3),
              " cm");
    t.frame([] {});
    EXPECT_EQ(frameStep(47, 800), 5);
    EXPECT_EQ(frameStep(10000, 800), 1000);
    // Of a copy they count in the stops that its field shows.
    editor.state.selection.emitters = {light.id};
    editor.setValueKeys({{KeyedValue::powerScale, light.id}});
    duplicateEmitters(editor, {light.id});
    const std::string copy = editor.state.selection.active();
    const ValueCurve* curve = curveOf(editor.look(), {KeyedValue::radiance, copy});
    ASSERT_TRUE(curve);
    const EmitterState* state = editor.emitter(copy);
    EXPECT_EQ(valueWords(editor, *curve, curve->keys[0].value), fmt::format("{:+.2f} stops", stopsOf(editor, *state)));
}

}  // namespace
}  // namespace relamp::ui::test
