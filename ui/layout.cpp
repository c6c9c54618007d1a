#include "layout.h"

#include <imgui.h>

#include "panels/panels.h"
#include "viewport/viewport.h"
#include "widgets.h"

namespace relamp::ui {
namespace {

/// A fixed pane of the window; its content scrolls, the frame does not move.
template <class Draw>
void pane(const char* name, const ImVec2& position, const ImVec2& size, ImGuiWindowFlags flags, Draw&& draw) {
    ImGui::SetNextWindowPos(position);
    ImGui::SetNextWindowSize(size);
    ImGui::PushStyleVar(ImGuiStyleVar_WindowRounding, 0);
    ImGui::PushStyleVar(ImGuiStyleVar_WindowBorderSize, 0);
    const bool open =
        ImGui::Begin(name, nullptr,
                     ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoResize |
                         ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoBringToFrontOnFocus | flags);
    ImGui::PopStyleVar(2);
    if (open) draw();
    ImGui::End();
}

}  // namespace

void drawLayout(Editor& editor, Viewport* viewport, const std::string& reason) {
    beginPanelFrame();
    PanelState& p = editor.state.panels;
    const float scale = editor.state.uiScale;
    if (ImGui::BeginMainMenuBar()) {
        drawMenuBar(editor);
        ImGui::EndMainMenuBar();
    }
    const ImVec2 screen = ImGui::GetIO().DisplaySize;
    const float top = ImGui::GetFrameHeight(), status = statusBarHeight(), gap = std::max(4.0f, std::floor(5 * scale));
    // Side columns leave the image at least 320 pixels (at scale 1); the bottom strip takes a third of the height at
    // most.
    const float spare = std::max(0.0f, screen.x - 320 * scale - 2 * gap);
    float left = std::min(p.leftWidth * scale, spare * 0.5f), right = std::min(p.rightWidth * scale, spare * 0.5f);
    left = std::floor(std::max(left, std::min(200 * scale, screen.x * 0.25f)));
    right = std::floor(std::max(right, std::min(200 * scale, screen.x * 0.25f)));
    const float bodyHeight = screen.y - top - status;
    const float bottom =
        std::floor(std::clamp(p.bottomHeight * scale, 60 * scale, std::max(60 * scale, 0.35f * bodyHeight)));
    const float columnsHeight = bodyHeight - bottom - gap;
    const float middleX = left + gap, middleWidth = screen.x - left - right - 2 * gap;

    pane("##left", {0, top}, {left, columnsHeight}, 0, [&] {
        if (beginChild("scene", ImVec2(0, 0))) drawScenePanel(editor);
        ImGui::EndChild();
    });
    float banner = 0;
    if (qualityBannerShown(editor)) {
        banner = std::min(std::floor(qualityBannerHeight(editor, middleWidth)), 0.5f * columnsHeight);
        pane("##banner", {middleX, top}, {middleWidth, banner}, ImGuiWindowFlags_NoScrollbar,
             [&] { drawQualityBanner(editor); });
    }
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(0, 0));
    pane("##viewport", {middleX, top + banner}, {middleWidth, columnsHeight - banner},
         ImGuiWindowFlags_NoScrollbar | ImGuiWindowFlags_NoScrollWithMouse, [&] {
             ImGui::PopStyleVar();
             if (viewport) {
                 viewport->draw(editor);
             } else {
                 ImGui::SetCursorPos({em(1), em(1)});
                 ImGui::PushTextWrapPos(ImGui::GetCursorPosX() + middleWidth - em(2));
                 wrapped("The 3D view cannot be shown: " + reason);
                 ImGui::PopTextWrapPos();
             }
             ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(0, 0));
         });
    ImGui::PopStyleVar();
    pane("##right", {screen.x - right, top}, {right, columnsHeight}, 0, [&] {
        if (beginChild("inspector", ImVec2(0, 0))) drawInspectorPanel(editor);
        ImGui::EndChild();
    });
    pane("##bottom", {0, top + columnsHeight + gap}, {screen.x, bottom}, ImGuiWindowFlags_NoScrollbar,
         [&] { drawBottomPanel(editor); });
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(em(0.5f), 0));
    pane("##status", {0, screen.y - status}, {screen.x, status},
         ImGuiWindowFlags_NoScrollbar | ImGuiWindowFlags_NoScrollWithMouse, [&] { drawStatusBar(editor); });
    ImGui::PopStyleVar();

    // Handles between the areas.
    const auto handle = [&](const char* name, const ImVec2& position, const ImVec2& size, bool vertical, float& value,
                            float least, float most, float direction) {
        ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(0, 0));
        ImGui::PushStyleVar(ImGuiStyleVar_WindowMinSize, ImVec2(1, 1));
        pane(name, position, size, ImGuiWindowFlags_NoScrollbar,
             [&] { splitter("handle", vertical, vertical ? size.y : size.x, value, least, most, direction, scale); });
        ImGui::PopStyleVar(2);
    };
    handle("##handleLeft", {left, top}, {gap, columnsHeight}, true, p.leftWidth, 200, 700, 1);
    handle("##handleRight", {screen.x - right - gap, top}, {gap, columnsHeight}, true, p.rightWidth, 200, 700, -1);
    handle("##handleBottom", {0, top + columnsHeight}, {screen.x, gap}, false, p.bottomHeight, 60, 600, -1);

    drawDialogs(editor);
}

}  // namespace relamp::ui
