// The unit that lengths are shown and typed in.
#include "length_unit.h"

#include "actions.h"
#include "ui/panels/panel_harness.h"
#include "viewport/gizmo.h"
#include "viewport/transform_gesture.h"

namespace relamp::ui::test {
namespace {

TEST(LengthUnit, lengthsPlacesAndAreasAreSaidInIt) {
    EXPECT_EQ(lengthText(0.254, LengthUnit::metres), "0.254 m");
    EXPECT_EQ(lengthText(0.254, LengthUnit::centimetres), "25.4 cm");
    EXPECT_EQ(lengthText(0.254, LengthUnit::millimetres), "254 mm");
    EXPECT_EQ(lengthText(0.254, LengthUnit::inches), "10.00 in");
    EXPECT_EQ(lengthText(0.3048, LengthUnit::feet), "1.000 ft");
    EXPECT_EQ(placeText({1, -0.5, 0}, LengthUnit::centimetres), "100.0  -50.0  0.0 cm");
    EXPECT_EQ(areaText(0.01, LengthUnit::metres), "100 cm\u00b2");
    EXPECT_EQ(areaText(0.36, LengthUnit::centimetres), "3600 cm\u00b2");
    EXPECT_EQ(areaText(0.3048 * 0.3048, LengthUnit::feet), "1 ft\u00b2");
    for (size_t i = 0; i < lengthUnitCount; ++i)
        EXPECT_EQ(lengthUnitNamed(infoOf(LengthUnit(int(i))).name), LengthUnit(int(i)));
    EXPECT_FALSE(lengthUnitNamed("furlongs"));
}

TEST(LengthUnit, movesAreTypedAndReadInItAndTheWindowRemembersIt) {
    Panels p;
    p.openSolved();
    Editor& editor = *p.editor;
    EXPECT_TRUE(runAction(editor, "view.unit.inches"));
    const std::string id = editor.emitters()[0].id;
    const Vec3 start = editor.emitter(id)->pivot;
    editor.state.selection.emitters = {id};
    const EyeView eye =
        eyeOf(relamp::test::cameraAt({2, -1.5, 1.5}, {0, 0, 0.2}, 80, 60, 80), {0, 0}, {80, 60}, {1, 1}, Vec3(0), 2);
    TransformGesture gesture;
    gesture.begin(editor, GizmoKind::move, GizmoHandle::screen, true, eye, {40, 30}, 80);
    gesture.keys(editor, 'X', "", false, eye);
    gesture.keys(editor, 0, "10", false, eye);
    EXPECT_NE(gesture.readout().find("Move X 10.00 in"), std::string::npos) << gesture.readout();
    gesture.commit(editor);
    EXPECT_NEAR(editor.emitter(id)->pivot.x, start.x + 0.254f, 1e-4f);
    // A turn has no length.
    gesture.begin(editor, GizmoKind::rotate, GizmoHandle::screen, true, eye, {40, 30}, 80);
    gesture.keys(editor, 'Z', "", false, eye);
    gesture.keys(editor, 0, "90", false, eye);
    EXPECT_NE(gesture.readout().find("90"), std::string::npos) << gesture.readout();
    gesture.abandon(editor);

    // A field shows it, and a drag of it is as long on the ground as in metres.
    p.windowSize(320, 640);
    p.frame([&] { drawInspectorPanel(editor); });
    const auto dragged = [&](const char* field) {
        const auto at = p.find(Panels::idOf("test", {field, "##y"}));
        EXPECT_TRUE(at) << field;
        if (!at) return 0.0f;
        const float before = editor.emitter(id)->pivot.y;
        p.mouse(*at);
        p.press(true);
        for (int i = 1; i <= 8; ++i) p.mouse({at->x + 10.0f * float(i), at->y}), p.frames(1);
        p.press(false);
        p.mouse({-1000, -1000});
        p.frames(2);
        return editor.emitter(id)->pivot.y - before;
    };
    const float inInches = dragged("Position (in)");
    EXPECT_GT(inInches, 0.05f);
    EXPECT_TRUE(runAction(editor, "view.unit.metres"));
    EXPECT_NEAR(dragged("Position (m)"), inInches, 0.02f * inInches);

    editor.state.lengthUnit = LengthUnit::centimetres;
    p.editor.reset();
    EditorOptions options;
    options.configFolder = p.folder / "config";
    options.stateFolder = p.folder / "state";
    p.editor = std::make_unique<Editor>(options);
    EXPECT_EQ(p.editor->state.lengthUnit, LengthUnit::centimetres);
}

}  // namespace
}  // namespace relamp::ui::test
