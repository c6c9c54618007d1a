// The bar above the image folds into a menu instead of a second row.
#include "viewport/toolbar.h"

#include "ui/panels/panel_harness.h"

namespace relamp::ui::test {
namespace {

TEST(Toolbar, foldsIntoAMenuThatHasAllTheRest) {
    Panels p(1600, 300);
    p.openSolved();
    float right = 0, down = 0;
    const auto bar = [&] {
        drawViewportToolbar(*p.editor);
        const ImGuiWindow* window = ImGui::GetCurrentWindow();
        right = window->DC.CursorMaxPos.x - window->Pos.x, down = window->DC.CursorMaxPos.y - window->Pos.y;
    };
    const ImGuiID more = Panels::idOf("test", {"##more tools"});
    for (const float width : {1500.0f, 900.0f, 640.0f, 420.0f}) {
        p.windowSize(width, 100);
        p.frame(bar);
        p.frames(2);
        EXPECT_LE(right, width) << width;
        EXPECT_LE(down, 2 * ImGui::GetFrameHeight() + ImGui::GetStyle().WindowPadding.y) << "one row, at " << width;
    }
    const auto at = p.find(more);
    ASSERT_TRUE(at);
    p.click(*at);
    ASSERT_EQ(ImGui::GetCurrentContext()->OpenPopupStack.Size, 1);
    const ImGuiID menu = ImGui::GetCurrentContext()->OpenPopupStack[0].Window->ID;
    for (const char* row : {"False colour", "Overlays", "Local axes"})
        EXPECT_TRUE(p.find(ImHashStr("", 0, ImHashStr(row, 0, menu)))) << row;
    const auto overlays = p.find(ImHashStr("", 0, ImHashStr("Overlays", 0, menu)));
    ASSERT_TRUE(overlays);
    p.click(*overlays);
    EXPECT_FALSE(p.editor->state.viewport.overlays);
    p.frames(2);
    p.windowSize(1500, 100);
    p.frame(bar);
    p.frames(2);
    EXPECT_FALSE(p.find(more, 8)) << "there is room for everything";
}

}  // namespace
}  // namespace relamp::ui::test
