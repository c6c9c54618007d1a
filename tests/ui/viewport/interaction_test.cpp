// Mouse and keys over the image, without a graphics context: what lies over it, the probe, dividers, gestures.
#include "viewport/interaction.h"

#include "actions.h"
#include "ui/panels/panel_harness.h"
#include "viewport/picking.h"

namespace relamp::ui::test {
namespace {

/// A solved scene under a viewport of 400 x 300 that shows no pixels.
struct OverImage : Panels {
    Interaction interaction;
    EyeView eye;
    std::vector<uint8_t> visible;
    int drawn = 0;  ///< vertices over the image in the last frame

    OverImage() : Panels(600, 400) {
        openSolved();
        until([&] { return bool(editor->liveFrame()); });
        eye = eyeOf(editor->state.document.capture->views[0].camera, {0, 0}, {400, 300}, {1, 1}, Vec3(0),
                    editor->state.document.scene->diagonal);
        editor->state.selection.emitters = {editor->emitters()[0].id};
        frame([this] { show(); });
        frames(2);
    }
    void show() {
        ImGui::SetCursorScreenPos({0, 0});
        ImGui::InvisibleButton("image", {400, 300});
        const bool hovered = ImGui::IsItemHovered(), active = ImGui::IsItemActive();
        Canvas canvas;
        canvas.list = ImGui::GetWindowDrawList();
        canvas.editor = editor.get();
        canvas.eye = &eye;
        canvas.size = {400, 300};
        const std::vector<Strip> strips = stripsOf(*editor);
        const std::shared_ptr<const Mesh> mesh = editor->liveFrame()->mesh;
        const ShownImage image{strips, mesh, visible};
        interaction.act(*editor, canvas, image, hovered, active);
        const int before = canvas.list->VtxBuffer.Size;
        interaction.draw(canvas, image);
        drawn = canvas.list->VtxBuffer.Size - before;
        if (ImGui::GetIO().MousePos.y > 300) drawn = 0;
    }
    /// From `a` to `b` with the left button held.
    void drag(const ImVec2& a, const ImVec2& b) {
        mouse(a);
        frames(2);
        press(true);
        for (int i = 1; i <= 10; ++i) {
            mouse({a.x + (b.x - a.x) * 0.1f * float(i), a.y + (b.y - a.y) * 0.1f * float(i)});
            frames(1);
        }
        press(false);
        frames(2);
    }
};

TEST(Interaction, theProbeIsTheRadianceUnderThePointer) {
    OverImage p;
    const auto& probe = p.editor->state.probe;
    EXPECT_FALSE(probe) << "the pointer is elsewhere";
    int hits = 0;
    for (float y = 35; y < 300; y += 45)
        for (float x = 35; x < 400; x += 45) {
            p.mouse({x, y});
            p.frames(1);
            const auto expected = radianceAlong(*p.editor->liveFrame(), p.eye.rayAt({x, y}));
            ASSERT_EQ(probe.has_value(), expected.has_value());
            if (probe) { EXPECT_EQ(*probe, *expected); }
            hits += probe.has_value();
        }
    EXPECT_GT(hits, 10);
    p.mouse({200, 200});
    p.frames(1);
    ASSERT_TRUE(probe);
    p.editor->state.viewport.exposureStops = 3;
    p.editor->state.message.clear();  // a long one leaves no room
    const std::string words = p.wordsOf([&] { drawStatusBar(*p.editor); });
    const float stops = std::log2(std::max(luminance(*probe), 1e-9f) / 0.18f) + 3;
    EXPECT_NE(words.find(fmt::format("{:+.1f} stops", stops)), std::string::npos) << words;
    p.frame([&p] { p.show(); });
    p.mouse({500, 350});
    p.frames(2);
    EXPECT_FALSE(probe) << "beside the image";
    p.editor->state.viewport.mode = ViewMode::albedo;
    p.mouse({200, 200});
    p.frames(2);
    EXPECT_FALSE(probe) << "albedo is no radiance";
}

TEST(Interaction, oneSwitchTakesAllOverlaysAway) {
    OverImage p;
    p.mouse({200, 200});
    p.frames(2);
    const int with = p.drawn;
    EXPECT_GT(with, 50) << "marks and axes";
    ASSERT_TRUE(runAction(*p.editor, "view.overlays"));
    p.frames(2);
    EXPECT_EQ(p.drawn, 0);
    // What is not shown cannot be hit: neither a light's mark nor the axes.
    p.editor->state.selection.emitters.clear();
    const Vec2 mark = *p.eye.toScreen(p.editor->emitters()[0].pivot);
    Canvas canvas;
    canvas.editor = p.editor.get();
    canvas.eye = &p.eye;
    EXPECT_FALSE(emitterMarkAt(canvas, mark).empty());
    p.drag(toIm(mark - Vec2(30)), toIm(mark + Vec2(30)));
    EXPECT_TRUE(p.editor->state.selection.emitters.empty()) << "no box either";
    ASSERT_TRUE(runAction(*p.editor, "view.overlays"));
    p.frames(2);
    p.drag(toIm(mark - Vec2(30)), toIm(mark + Vec2(30)));
    EXPECT_EQ(p.editor->state.selection.emitters.size(), 1u);
}

TEST(Interaction, keysThatMeanSomethingAreToldWhileALightIsTransformed) {
    OverImage p;
    const size_t entries = p.editor->history().entries().size();
    p.mouse({200, 150});
    p.frames(2);
    EXPECT_EQ(p.editor->state.keyHints, "");
    for (const auto& [key, amount] : {std::pair('G', "metres"), {'R', "degrees"}, {'S', "a factor"}}) {
        p.key(key);
        for (const std::string& word :
             {std::string("X Y Z"), std::string("Ctrl"), std::string("Shift"), std::string(amount), std::string("Esc")})
            EXPECT_NE(p.editor->state.keyHints.find(word), std::string::npos) << key << p.editor->state.keyHints;
        const std::string hints = p.editor->state.keyHints, bar = p.wordsOf([&] { drawStatusBar(*p.editor); });
        EXPECT_NE(bar.find(hints.substr(0, 12)), std::string::npos) << bar;
        p.frame([&p] { p.show(); });
        p.key(keyEscape);
        p.frames(2);
        EXPECT_EQ(p.editor->state.keyHints, "") << key;
        EXPECT_FALSE(p.editor->inGesture());
    }
    EXPECT_EQ(p.editor->history().entries().size(), entries);
}

TEST(Interaction, dividersOfTheWipeFollowThePointerAndPushTheOther) {
    OverImage p;
    ViewportState& viewport = p.editor->state.viewport;
    viewport.mode = ViewMode::wipe;
    p.frames(2);
    const size_t entries = p.editor->history().entries().size();
    p.drag({400 * viewport.wipeLeft, 150}, {100, 150});
    EXPECT_NEAR(viewport.wipeLeft, 0.25f, 0.01f);
    EXPECT_NEAR(viewport.wipeRight, 2.0f / 3, 0.01f);
    p.drag({100, 150}, {360, 150});
    EXPECT_NEAR(viewport.wipeLeft, 0.9f, 0.01f);
    EXPECT_GE(viewport.wipeRight, viewport.wipeLeft);
    p.drag({360, 150}, {-50, 150});
    EXPECT_GT(std::min(viewport.wipeLeft, viewport.wipeRight), 0) << "it can be taken hold of again";
    EXPECT_EQ(p.editor->history().entries().size(), entries) << "no edit";
    EXPECT_FALSE(p.editor->state.selection.emitters.empty()) << "the selection stays";
}

TEST(Interaction, shiftIsATenthOfTheWayAndCtrlGoesInSteps) {
    OverImage p;
    Editor& editor = *p.editor;
    const std::string id = editor.emitters()[0].id;
    const Vec3 start = editor.emitter(id)->pivot;
    const auto moved = [&](bool control, bool shift) {
        TransformGesture gesture;
        gesture.begin(editor, GizmoKind::move, GizmoHandle::x, true, p.eye, {100, 150}, 80);
        gesture.follow(editor, p.eye, {160, 150}, control, shift);
        gesture.commit(editor);
        const float by = editor.emitter(id)->pivot.x - start.x;
        editor.undo();
        return by;
    };
    const float plain = moved(false, false), fine = moved(false, true), steps = moved(true, false);
    EXPECT_GT(std::abs(plain), 0.05f);
    EXPECT_NEAR(fine, 0.1f * plain, 0.03f * std::abs(plain));
    EXPECT_NE(steps, plain);
    const float step = 0.1f, at = (start.x + steps) / step;
    EXPECT_NEAR(at, std::round(at), 1e-3f) << "on the decimetres of the world";
}

}  // namespace
}  // namespace relamp::ui::test
