#include "panels/light_presets.h"

#include "ui/editor_session.h"

namespace relamp::ui {
namespace {

TEST(LightPresets, aLightIsKeptAndComesBackWithAllItIs) {
    Session s;
    s.openEstimated();
    Editor& editor = *s.editor;
    EXPECT_TRUE(lightPresets(editor).empty());
    AddedEmitter spot;
    spot.shape = EmitterShape::spot;
    spot.size = Vec2(0.07f);
    spot.radiance = Rgb(90, 60, 20);
    spot.shaping.coneDegrees = 35;
    spot.name = "Key/left";
    spot.shadows = false;
    std::string id;
    editor.edit("Add", [&](Look& look) { id = addEmitter(look, *editor.estimate(), spot); });
    editor.state.selection.emitters = {id};
    saveLightPreset(editor);
    saveLightPreset(editor);
    EXPECT_EQ(lightPresets(editor), (std::vector<std::string>{"Key-left", "Key-left 2"}));
    editor.undo();
    ASSERT_TRUE(editor.look().added.empty());
    addLightPreset(editor, "Key-left");
    ASSERT_EQ(editor.look().added.size(), 1u);
    const AddedEmitter& back = editor.look().added[0];
    EXPECT_EQ(back.shape, spot.shape);
    EXPECT_EQ(back.size, spot.size);
    EXPECT_EQ(back.radiance, spot.radiance);
    EXPECT_EQ(back.shaping.coneDegrees, spot.shaping.coneDegrees);
    EXPECT_FALSE(back.shadows);
    EXPECT_EQ(editor.state.selection.emitters.size(), 1u);
    EXPECT_EQ(editor.history().entries().back().label, "Add Key-left");
    deleteLightPreset(editor, "Key-left");
    EXPECT_EQ(lightPresets(editor), (std::vector<std::string>{"Key-left 2"}));
    EXPECT_TRUE(editor.state.notices.empty());
}

TEST(LightPresets, aRecoveredLightIsADiskAndABrokenFileIsNamed) {
    Session s;
    s.openEstimated();
    Editor& editor = *s.editor;
    editor.state.selection.emitters = {"emitter-1"};
    saveLightPreset(editor);
    ASSERT_EQ(lightPresets(editor).size(), 1u);
    addLightPreset(editor, lightPresets(editor)[0]);
    ASSERT_EQ(editor.look().added.size(), 1u);
    EXPECT_EQ(editor.look().added[0].shape, EmitterShape::disk);
    const size_t entries = editor.history().entries().size();
    s.folder.write("config/lights/broken.json", "{\"added_emitters\": 3}");
    addLightPreset(editor, "broken");
    ASSERT_EQ(editor.state.notices.size(), 1u);
    EXPECT_NE(editor.state.notices[0].text.find("broken.json"), std::string::npos) << editor.state.notices[0].text;
    EXPECT_EQ(editor.history().entries().size(), entries);
}

}  // namespace
}  // namespace relamp::ui
