// The view transform that the window takes where the artist chose none.
#include "settings.h"
#include "ui/panels/panel_harness.h"
#include "viewport/navigation.h"

namespace relamp::ui::test {
namespace {

TEST(DisplayChoice, keepsTheHueOfLightsUnlessOneIsChosen) {
    Panels p;
    Editor& editor = *p.editor;
    EXPECT_EQ(displayViewOf(editor), "Standard");
    p.openSolved();
    EXPECT_EQ(displayViewOf(editor), "Soft highlights");
    editor.state.viewport.displayView = "ACES 1.0 SDR";
    EXPECT_EQ(displayViewOf(editor), "ACES 1.0 SDR");
    editor.state.viewport.displayView = "of another configuration";
    EXPECT_EQ(displayViewOf(editor), "Soft highlights");
    // Photographs of eight bits, nothing estimated: nothing is brighter than the screen.
    editor.state.viewport.displayView.clear();
    p.openCapture();
    EXPECT_EQ(displayViewOf(editor), "Soft highlights") << "photographs without a clip level";
    auto clipped = std::make_shared<Capture>(*editor.state.document.capture);
    for (View& view : clipped->views) view.saturation = 1;
    editor.state.document.capture = clipped;
    EXPECT_EQ(displayViewOf(editor), "Standard");
}

TEST(DisplayChoice, isRememberedAndTheStandardOfOlderVersionsWasNoChoice) {
    const TemporaryFolder folder;
    const auto read = [&](const std::string& settings) {
        folder.write("settings.json", settings);
        EditorState state;
        loadSettings(folder.path(), state);
        return state.viewport.displayView;
    };
    EXPECT_EQ(read(R"({"display_view": "Standard"})"), "");
    EXPECT_EQ(read(R"({"display_view": "ACES 1.0 SDR"})"), "ACES 1.0 SDR");
    EXPECT_EQ(read(R"({"view_transform": "Standard", "display_view": "Raw"})"), "Standard");
    EditorState state;
    state.viewport.displayView = "Standard";
    saveSettings(folder.path(), state);
    EditorState again;
    loadSettings(folder.path(), again);
    EXPECT_EQ(again.viewport.displayView, "Standard");
}

}  // namespace
}  // namespace relamp::ui::test
