// The areas of the window in little room.
#include "layout.h"

#include "actions.h"
#include "theme.h"
#include "ui/panels/panel_harness.h"

namespace relamp::ui::test {
namespace {

void drawWindow(Panels& p, int frames) {
    for (int i = 0; i < frames; ++i) {
        ImGui::NewFrame();
        drawLayout(*p.editor, nullptr, "tests have no window");
        ImGui::Render();
        input().pressed = 0;
    }
}

void scaleBy(Panels& p, float scale) {
    p.editor->state.uiScale = scale;
    ImGui::GetIO().FontGlobalScale = scale;
    applyTheme(scale);
}

ImVec2 sizeOf(const char* window) {
    const ImGuiWindow* found = ImGui::FindWindowByName(window);
    return found ? found->Size : ImVec2(0, 0);
}

/// Windows with a vertical scrollbar inside another one that has one.
std::string doubleScrollbars() {
    std::string names;
    for (const ImGuiWindow* window : ImGui::GetCurrentContext()->Windows) {
        if (!window->Active || !window->ScrollbarY) continue;
        for (const ImGuiWindow* outer = window->ParentWindow; outer; outer = outer->ParentWindow)
            if (outer->ScrollbarY) names += std::string(window->Name) + "\n";
    }
    return names;
}

/// Windows whose contents are wider than they are, and cannot be scrolled.
std::string cutOff() {
    std::string names;
    for (const ImGuiWindow* window : ImGui::GetCurrentContext()->Windows)
        if (window->Active && !window->Hidden && !window->ScrollbarX &&
            window->ContentSize.x > window->WorkRect.GetWidth() + 1)
            names += fmt::format("{}: {} in {}\n", window->Name, window->ContentSize.x, window->WorkRect.GetWidth());
    return names;
}

TEST(Layout, theImageKeepsItsWidthAndMostOfTheHeightInASmallWindow) {
    Panels p(1024, 640);
    p.openSolved();
    for (const float scale : {1.0f, 2.0f})
        for (const char* selected : {"", "light"}) {
            scaleBy(p, scale);
            p.editor->state.selection.emitters.clear();
            if (*selected) p.editor->state.selection.emitters = {p.editor->emitters()[0].id};
            drawWindow(p, 4);
            EXPECT_GE(sizeOf("##viewport").x, 640) << scale << selected;
            EXPECT_LE(sizeOf("##bottom").y + sizeOf("##status").y, 52 * scale) << scale << selected;
            EXPECT_GE(sizeOf("##viewport").y, scale > 1 ? 480 : 560) << scale << selected;
            EXPECT_EQ(doubleScrollbars(), "") << scale << selected;
            EXPECT_EQ(cutOff(), "") << scale << selected;
        }
    // Unfolded, the panel shows more than its tabs and buttons.
    p.editor->state.panels.bottomFolded = false;
    drawWindow(p, 4);
    EXPECT_GE(sizeOf("##bottom").y, 240);
    EXPECT_GE(sizeOf("##viewport").y, 270);
}

TEST(Layout, tabShowsTheImageAloneAndAgainThePanels) {
    Panels p(1280, 800);
    p.openSolved();
    drawWindow(p, 3);
    const auto shows = [](const char* name) {
        const ImGuiWindow* window = ImGui::FindWindowByName(name);
        return window && window->Active;
    };
    const Action* hide = findAction("view.panels");
    ASSERT_TRUE(hide);
    EXPECT_EQ(hide->keys.at(0).key, int(keyTab));
    const float before = sizeOf("##viewport").x;
    for (const bool alone : {true, false}) {
        hide->run(*p.editor);
        drawWindow(p, 3);
        for (const char* panel : {"##left", "##right", "##bottom", "##MainMenuBar"})
            EXPECT_EQ(shows(panel), !alone) << panel;
        EXPECT_TRUE(shows("##status"));
        EXPECT_EQ(sizeOf("##viewport").x, alone ? 1280 : before);
        if (alone) { EXPECT_EQ(sizeOf("##viewport").y, 800 - statusBarHeight()); }
    }
}

TEST(Layout, manyPhotographsGoOnToTheRightAndAllAreReached) {
    Panels p(1024, 640);
    p.openCapture();
    auto many = std::make_shared<Capture>(*p.editor->state.document.capture);
    const View one = many->views[0];
    many->views.assign(300, one);
    for (size_t i = 0; i < many->views.size(); ++i) many->views[i].name = fmt::format("{:03}.exr", i);
    p.editor->state.document.capture = many;
    scaleBy(p, 1);
    drawWindow(p, 4);
    EXPECT_EQ(doubleScrollbars(), "");
    ImGuiWindow* views = nullptr;
    for (ImGuiWindow* window : ImGui::GetCurrentContext()->Windows)
        if (window->Active && std::string(window->Name).find("##views") != std::string::npos) views = window;
    ASSERT_TRUE(views);
    EXPECT_TRUE(views->ScrollbarX);
    EXPECT_FALSE(views->ScrollbarY);
    // The last column holds the last photograph.
    ImGui::SetScrollX(views, views->ScrollMax.x);
    drawWindow(p, 3);
    const float right = views->Pos.x + views->Size.x;
    for (float y = views->Pos.y + 10; y < views->Pos.y + views->Size.y && p.editor->state.selection.view < 299; y += 12)
        for (float x = right - 20; x > right - 40 && p.editor->state.selection.view < 299; x -= 10) {
            p.mouse({x, y});
            drawWindow(p, 2);
            ImGui::GetIO().MouseDown[0] = true;
            drawWindow(p, 1);
            ImGui::GetIO().MouseDown[0] = false;
            drawWindow(p, 1);
        }
    EXPECT_EQ(p.editor->state.selection.view, 299);
}

}  // namespace
}  // namespace relamp::ui::test
