#include "viewport/placement_drag.h"

#include "ui/editor_session.h"
#include "viewport/click_tasks.h"
#include "viewport/overlays.h"
#include "viewport/picking.h"

namespace relamp::ui {
namespace {

/// An estimate seen from the first photograph's camera, its light selected.
struct Placing : Session {
    EyeView eye;
    Placing() {
        openEstimated();
        settle();
        eye = eyeOf(editor->state.document.capture->views[0].camera, {0, 0}, {400, 300}, {1, 1}, Vec3(0),
                    editor->state.document.scene->diagonal);
        until([&] { return bool(editor->liveFrame()); });
        editor->state.selection.emitters = {"emitter-1"};
    }
    const std::shared_ptr<const Mesh>& mesh() const { return editor->liveFrame()->mesh; }
    const EmitterState& light() const { return *editor->emitter("emitter-1"); }
    /// A screen position with floor under it; `count` tells them apart.
    Vec2 floorAt(int count) const {
        for (int i = 0; i < 1200; ++i) {
            const Vec2 at(float(i % 40) * 10 + 5, float(i / 40) * 10 + 5);
            const auto point = pickSurface(*mesh(), eye.rayAt(at));
            if (point && point->position.z < 1e-3f && count-- == 0) return at;
        }
        ADD_FAILURE() << "no floor is seen";
        return {};
    }
};

TEST(PlacementDrag, theLightFollowsThePointerAsOneEdit) {
    Placing p;
    Editor& editor = *p.editor;
    EXPECT_FALSE(PlacementDrag::fits(editor));
    editor.state.viewport.clickTask = ClickTask::illuminate;
    ASSERT_TRUE(PlacementDrag::fits(editor));
    const size_t entries = editor.history().entries().size();
    const Vec3 before = p.light().pivot;
    PlacementDrag drag;
    drag.begin(editor, p.mesh(), {});
    ASSERT_TRUE(drag.running());
    Vec3 last(0);
    for (const int at : {0, 60, 140}) {
        const Ray ray = p.eye.rayAt(p.floorAt(at));
        const Vec3 floor = pickSurface(*p.mesh(), ray)->position;
        drag.follow(editor, ray, p.eye);
        // Straight above what it lights, as far from it as it was.
        EXPECT_LT(glm::length(Vec2(p.light().pivot - floor)), 1e-3f);
        EXPECT_NEAR(p.light().pivot.z, glm::length(before - floor), 1e-3f);
        EXPECT_GT(glm::length(p.light().pivot - last), 0.05f);
        last = p.light().pivot;
    }
    // Past the surface it stays.
    drag.follow(editor, Ray{p.eye.position, {0, 0, 1}}, p.eye);
    EXPECT_EQ(p.light().pivot, last);
    drag.commit(editor);
    EXPECT_FALSE(drag.running());
    EXPECT_EQ(editor.history().entries().size(), entries + 1);
    EXPECT_EQ(editor.history().entries().back().label, "Place by its light Light 1");
    EXPECT_EQ(editor.state.viewport.clickTask, ClickTask::none);
    editor.undo();
    EXPECT_EQ(p.light().pivot, before);
}

TEST(PlacementDrag, givenUpOrPastEverySurfaceItChangesNothing) {
    Placing p;
    Editor& editor = *p.editor;
    editor.state.viewport.clickTask = ClickTask::aim;
    const size_t entries = editor.history().entries().size();
    const Look before = editor.look();
    PlacementDrag drag;
    drag.begin(editor, p.mesh(), {});
    drag.follow(editor, p.eye.rayAt(p.floorAt(3)), p.eye);
    drag.abandon(editor);
    EXPECT_EQ(editor.history().entries().size(), entries);
    EXPECT_TRUE(editor.look() == before);
    EXPECT_EQ(editor.state.viewport.clickTask, ClickTask::aim) << "still armed";
    drag.begin(editor, p.mesh(), {});
    drag.follow(editor, Ray{p.eye.position, {0, 0, 1}}, p.eye);
    drag.commit(editor);
    EXPECT_EQ(editor.history().entries().size(), entries);
    EXPECT_FALSE(editor.inGesture());
}

TEST(PlacementDrag, theLightItselfIsNotHit) {
    Placing p;
    Editor& editor = *p.editor;
    const auto onScreen = p.eye.toScreen(p.light().pivot);
    ASSERT_TRUE(onScreen);
    const auto hit = pickSurface(*p.mesh(), p.eye.rayAt(*onScreen));
    ASSERT_TRUE(hit);
    ASSERT_EQ(emitterOfTriangle(editor, hit->triangle), "emitter-1");
    editor.state.viewport.clickTask = ClickTask::illuminate;
    const Vec3 before = p.light().pivot;
    PlacementDrag drag;
    drag.begin(editor, p.mesh(), {});
    drag.follow(editor, p.eye.rayAt(*onScreen), p.eye);
    const float distance = glm::length(p.light().pivot - before);
    EXPECT_TRUE(distance == 0 || distance > 0.2f) << "it went to what lies behind it, or nothing does";
    drag.abandon(editor);
}

TEST(ClickTasks, aLightTakesTheColourOfASurfaceAndStaysAsBright) {
    Placing p;
    Editor& editor = *p.editor;
    const Vec2 at = p.floorAt(30);
    const auto point = pickSurface(*p.mesh(), p.eye.rayAt(at));
    const Rgb seen = *radianceAlong(*editor.liveFrame(), p.eye.rayAt(at)), before = p.light().radiance;
    editor.state.viewport.clickTask = ClickTask::takeColour;
    EXPECT_TRUE(runClickTask(editor, std::nullopt, p.eye)) << "past the surface: still armed";
    EXPECT_EQ(editor.state.viewport.clickTask, ClickTask::takeColour);
    EXPECT_TRUE(runClickTask(editor, point, p.eye));
    EXPECT_EQ(editor.state.viewport.clickTask, ClickTask::none);
    const Rgb now = p.light().radiance;
    EXPECT_NEAR(luminance(now), luminance(before), 1e-3f * luminance(before));
    EXPECT_LT(glm::distance(now / luminance(now), seen / luminance(seen)), 1e-3f);
    EXPECT_GT(glm::distance(now / luminance(now), before / luminance(before)), 1e-2f);
    EXPECT_EQ(editor.history().entries().back().label, "Take the colour for Light 1");
}

TEST(ClickTasks, anObjectIsLeftOutOfALightAsOneEditThatUndoTakesBack) {
    Placing p;
    Editor& editor = *p.editor;
    const auto point = pickSurface(*p.mesh(), p.eye.rayAt(p.floorAt(30)));
    const auto& component = editor.state.document.scene->component;
    for (const auto& [task, only] : {std::pair(ClickTask::leaveOut, false), std::pair(ClickTask::lightOnly, true)}) {
        editor.state.viewport.clickTask = task;
        EXPECT_TRUE(runClickTask(editor, point, p.eye));
        EXPECT_EQ(editor.state.viewport.clickTask, ClickTask::none);
        ASSERT_EQ(p.light().link.parts.size(), 1u);
        EXPECT_EQ(component[p.light().link.parts[0]], component[point->vertex]);
        EXPECT_EQ(p.light().link.only, only);
        // The same object at another place: no edit, but a word.
        const size_t entries = editor.history().entries().size();
        PickedPoint beside = *point;
        beside.vertex = editor.state.document.scene->mesh.triangles[point->triangle][0] == point->vertex
                            ? editor.state.document.scene->mesh.triangles[point->triangle][1]
                            : editor.state.document.scene->mesh.triangles[point->triangle][0];
        editor.state.viewport.clickTask = task;
        EXPECT_TRUE(runClickTask(editor, beside, p.eye));
        EXPECT_EQ(editor.history().entries().size(), entries);
        EXPECT_NE(editor.state.message.find("as it is"), std::string::npos);
        editor.undo();
        EXPECT_TRUE(p.light().link.everything());
    }
}

TEST(BoxSelect, takesTheLightsWhoseMarksLieInside) {
    Placing p;
    const Vec2 at = *p.eye.toScreen(p.light().pivot);
    Canvas canvas;
    canvas.editor = p.editor.get();
    canvas.eye = &p.eye;
    EXPECT_EQ(emitterMarksIn(canvas, at - Vec2(10), at + Vec2(10)), std::vector<std::string>{"emitter-1"});
    EXPECT_EQ(emitterMarksIn(canvas, at + Vec2(10), at - Vec2(10)).size(), 1u) << "drawn the other way round";
    EXPECT_TRUE(emitterMarksIn(canvas, at + Vec2(5), at + Vec2(20)).empty());
}

}  // namespace
}  // namespace relamp::ui
