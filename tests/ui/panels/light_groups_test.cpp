// Groups of lights by their rows and commands.
#include "actions.h"
#include "panels/emitter_controls.h"
#include "ui/panels/panel_harness.h"

namespace relamp::ui::test {
namespace {

/// The recovered light and a disk, both selected, as a group.
struct Grouped : Panels {
    std::string first, disk;
    Grouped() {
        openSolved();
        first = editor->emitters()[0].id;
        addNewEmitter(*editor, EmitterShape::disk);
        disk = editor->emitters().back().id;
        selectEmitter(*editor, first, true, false);
        windowSize(520, 300);
        frame([this] { drawEmittersPanel(*editor); });
        EXPECT_TRUE(runKey(*editor, {'G', true}));
        frames(2);
    }
    const LightGroup& group() const { return editor->look().groups.at(0); }
    void clickOn(const char* control) {
        const auto at = find(idOf("test", {"##groups", group().name.c_str(), control}));
        ASSERT_TRUE(at) << control;
        click(*at);
    }
};

TEST(GroupRows, switchAndSoloGoToAllMembersAndUndoRestores) {
    Grouped t;
    ASSERT_EQ(t.editor->look().groups.size(), 1u);
    EXPECT_EQ(t.group().members.size(), 2u);
    const size_t entries = t.editor->history().entries().size();
    t.clickOn("##mute");
    EXPECT_EQ(t.editor->history().entries().size(), entries + 1);
    for (const EmitterState& e : t.editor->emitters()) EXPECT_TRUE(e.enabled && !e.shines()) << e.id;
    t.editor->undo();
    for (const EmitterState& e : t.editor->emitters()) EXPECT_TRUE(e.shines()) << e.id;
    t.clickOn("##solo");
    EXPECT_EQ(t.editor->state.viewport.solo, t.group().members);
    t.clickOn("##solo");
    EXPECT_TRUE(t.editor->state.viewport.solo.empty());
    EXPECT_EQ(t.editor->history().index(), entries - 1) << "solo is no edit";
}

TEST(GroupRows, standUnderTheColumnsOfTheLights) {
    Grouped t;
    for (const float width : {340.0f, 980.0f}) {
        t.windowSize(width, 300);
        t.frames(3);
        for (const char* control : {"##mute", "##stops"}) {
            const auto ofLight = t.find(t.idOf("test", {"##emitters", t.first.c_str(), control}));
            const auto ofGroup = t.find(t.idOf("test", {"##groups", t.group().name.c_str(), control}));
            ASSERT_TRUE(ofLight && ofGroup) << control << " at " << width;
            EXPECT_EQ(ofLight->x, ofGroup->x) << control << " at " << width;
        }
    }
}

TEST(GroupRows, aDragOfTheExposureIsOneEntryForAll) {
    Grouped t;
    const size_t entries = t.editor->history().entries().size();
    const auto at = t.find(t.idOf("test", {"##groups", t.group().name.c_str(), "##stops"}));
    ASSERT_TRUE(at);
    t.mouse(*at);
    t.press(true);
    for (int i = 1; i <= 10; ++i) t.mouse({at->x + 10.0f * float(i), at->y}), t.frames(1);
    t.press(false);
    t.frames(2);
    EXPECT_EQ(t.editor->history().entries().size(), entries + 1);
    EXPECT_GT(t.group().powerScale.x, 2);
    const EmitterState& recovered = *t.editor->emitter(t.first);
    EXPECT_EQ(recovered.radiance, recovered.recoveredRadiance) << "its own light stays";
    EXPECT_EQ(recovered.groupFactor, t.group().powerScale);
}

TEST(GroupRows, aClickSelectsTheLightsAndDissolvingLeavesThem) {
    Grouped t;
    const std::vector<std::string> members = t.group().members;
    t.editor->state.selection.emitters.clear();
    t.clickOn("###group");
    EXPECT_EQ(t.editor->state.selection.emitters, members);
    EXPECT_TRUE(runKey(*t.editor, {'G', true, true}));
    EXPECT_TRUE(t.editor->look().groups.empty());
    EXPECT_EQ(t.editor->emitters().size(), 2u);
    EXPECT_FALSE(runKey(*t.editor, {'G', true, true})) << "there is none left";
}

}  // namespace
}  // namespace relamp::ui::test
