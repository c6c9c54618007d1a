#include "viewport/light_stroke.h"

#include "ui/editor_session.h"

namespace relamp::ui {
namespace {

/// An estimate seen from the first photograph's camera.
struct Painted : Session {
    EyeView eye;
    Canvas canvas;
    Painted() {
        openEstimated();
        settle();
        const Scene& scene = *editor->state.document.scene;
        eye =
            eyeOf(editor->state.document.capture->views[0].camera, {0, 0}, {400, 300}, {1, 1}, Vec3(0), scene.diagonal);
        canvas.editor = editor.get();
        canvas.eye = &eye;
        canvas.size = {400, 300};
        until([&] { return bool(editor->liveFrame()); });
        settle();
    }
    float brightness() const {
        float sum = 0;
        for (const EmitterState& e : editor->emitters()) sum += e.enabled ? luminance(e.radiance) : 0;
        return sum;
    }
    void stroke(bool invert = false) {
        LightStroke stroke;
        stroke.begin({120, 150});
        for (int x = 120; x < 280; x += 10) stroke.follow(canvas, {float(x), 150});
        EXPECT_TRUE(stroke.running());
        stroke.end(canvas, invert);
        EXPECT_FALSE(stroke.running());
    }
};

TEST(LightStroke, isOneEditThatBrightensAndOneThatDarkens) {
    Painted p;
    p.editor->state.viewport.brush.brush.stillness = 0;
    p.editor->state.selection.emitters = {"spot-1"};  // one that an undo took away
    const size_t entries = p.editor->history().entries().size();
    const float before = p.brightness();
    p.stroke();
    ASSERT_EQ(p.editor->history().entries().size(), entries + 1);
    EXPECT_EQ(p.editor->history().entries().back().label, "Paint brighter");
    EXPECT_GT(p.brightness(), 1.1f * before);
    EXPECT_NE(p.editor->state.message.find("stops"), std::string::npos) << p.editor->state.message;
    p.editor->undo();
    EXPECT_EQ(p.brightness(), before);
    p.settle();
    p.stroke(true);
    EXPECT_LT(p.brightness(), 0.9f * before);
}

TEST(LightStroke, changesNothingWhereNoSurfaceIsAndWithoutALight) {
    Painted p;
    const size_t entries = p.editor->history().entries().size();
    LightStroke beside;
    beside.begin({-500, -500});
    beside.end(p.canvas, false);
    EXPECT_EQ(p.editor->history().entries().size(), entries);
    EXPECT_EQ(p.editor->state.message, "No surface was painted");
    for (const EmitterState& e : std::vector<EmitterState>(p.editor->emitters()))
        p.editor->edit("off", [&](Look& look) { setEnabled(look, e.id, false); });
    p.settle();
    p.stroke();
    EXPECT_EQ(p.editor->state.message, "No light shines that could change");
}

}  // namespace
}  // namespace relamp::ui
