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
    ImGui::PushStyleVar(ImGuiStyleVar_WindowMinSize, ImVec2(1, 1));  // strips are lower than the usual least
    const bool open =
        ImGui::Begin(name, nullptr,
                     ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoResize |
                         ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoBringToFrontOnFocus | flags);
    ImGui::PopStyleVar(3);
    if (open) draw();
    ImGui::End();
}

}  // namespace

namespace {

/// Where the areas are, pixels. A width of 0: not shown.
struct Areas {
    float top = 0, status = 0, gap = 0, left = 0, right = 0, bottom = 0;
    bool oneColumn = false;  ///< scene and inspector share the right one
};

Areas areasOf(const Editor& editor, const ImVec2& screen) {
    const PanelState& p = editor.state.panels;
    const float scale = editor.state.uiScale;
    Areas a;
    a.status = statusBarHeight();
    a.gap = std::max(4.0f, std::floor(5 * scale));
    if (p.hidden) return a;
    a.top = ImGui::GetFrameHeight();
    // The image keeps 640 pixels (at scale 1) where that is possible.
    const float least = 200 * scale, spare = screen.x - 640 * scale - 2 * a.gap;
    a.oneColumn = spare < 2.1f * least;
    if (a.oneColumn) {
        // Where the whole cannot be had, the image is 640 pixels wide all the same, as long as the column can be read.
        const float narrow = std::min(least, std::max(0.3f * screen.x, screen.x - 640 - a.gap));
        a.right = std::floor(std::max(std::min(p.rightWidth * scale, spare + a.gap), narrow));
    } else {
        a.left = p.leftWidth * scale, a.right = p.rightWidth * scale;
        if (const float sum = a.left + a.right; sum > spare) a.left *= spare / sum, a.right *= spare / sum;
        a.left = std::floor(std::max(a.left, least)), a.right = std::floor(std::max(a.right, least));
    }
    const float body = screen.y - a.top - a.status;
    // A view of curves needs height; the image keeps half of it.
    const bool curves = editor.state.time.curves && p.bottomTab == framesTab;
    // In a short window the tabs and two rows of buttons would be all that is seen of it.
    const float most = std::max((curves ? 0.5f : 0.35f) * body, std::min(0.5f * body, 125 * scale));
    const float wanted = curves ? std::max(p.bottomHeight, 330.0f) : p.bottomHeight;
    a.bottom = p.bottomFolded ? bottomPanelFoldedHeight()
                              : std::floor(std::clamp(wanted * scale, 60 * scale, std::max(60 * scale, most)));
    return a;
}

/// Scene or inspector, by two tabs; a new selection brings the inspector: once the menu that came with it has closed,
/// and not while several lights are being selected in the scene.
void drawOnlyColumn(Editor& editor) {
    PanelState& p = editor.state.panels;
    std::string selected = editor.state.selection.active();
    if (editor.state.selection.point) selected += "point";
    const ImGuiIO& io = ImGui::GetIO();
    const bool menu = ImGui::IsPopupOpen("", ImGuiPopupFlags_AnyPopupId | ImGuiPopupFlags_AnyPopupLevel);
    const bool several =
        (io.KeyCtrl || io.KeyShift) &&
        ImGui::IsWindowHovered(ImGuiHoveredFlags_RootAndChildWindows | ImGuiHoveredFlags_AllowWhenBlockedByActiveItem);
    const bool turn = selected != p.narrowSelection && !selected.empty() && !menu && !several;
    if (!menu) p.narrowSelection = selected;
    if (!ImGui::BeginTabBar("##column")) return;
    const bool asked = turn && !p.narrowInspector;
    if (asked) p.narrowInspector = true;
    const char* const names[] = {"Scene", "Inspector"};
    for (const bool inspector : {false, true}) {
        const bool set = asked && inspector;
        if (!ImGui::BeginTabItem(names[inspector], nullptr, set ? ImGuiTabItemFlags_SetSelected : 0)) continue;
        if (!asked || inspector) p.narrowInspector = inspector;
        if (beginChild(names[inspector], ImVec2(0, 0))) inspector ? drawInspectorPanel(editor) : drawScenePanel(editor);
        ImGui::EndChild();
        ImGui::EndTabItem();
    }
    ImGui::EndTabBar();
}

}  // namespace

void drawLayout(Editor& editor, Viewport* viewport, const std::string& reason) {
    beginPanelFrame();
    editor.state.time.takesDelete = false;
    PanelState& p = editor.state.panels;
    const float scale = editor.state.uiScale;
    if (!p.hidden && ImGui::BeginMainMenuBar()) {
        drawMenuBar(editor);
        ImGui::EndMainMenuBar();
    }
    const ImVec2 screen = ImGui::GetIO().DisplaySize;
    const Areas a = areasOf(editor, screen);
    const float between = p.bottomFolded ? 0 : a.gap;  // there is nothing to drag where only the tabs are shown
    const float columnsHeight = screen.y - a.top - a.status - (a.bottom > 0 ? a.bottom + between : 0);
    const float middleX = a.left > 0 ? a.left + a.gap : 0,
                middleWidth = screen.x - middleX - (a.right > 0 ? a.right + a.gap : 0);

    if (a.left > 0)
        pane("##left", {0, a.top}, {a.left, columnsHeight}, 0, [&] {
            if (beginChild("scene", ImVec2(0, 0))) drawScenePanel(editor);
            ImGui::EndChild();
        });
    float banner = 0;
    if (qualityBannerShown(editor) && !p.hidden) {
        banner = std::min(std::floor(qualityBannerHeight(editor, middleWidth)), 0.5f * columnsHeight);
        pane("##banner", {middleX, a.top}, {middleWidth, banner}, ImGuiWindowFlags_NoScrollbar,
             [&] { drawQualityBanner(editor); });
    }
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(0, 0));
    pane("##viewport", {middleX, a.top + banner}, {middleWidth, columnsHeight - banner},
         ImGuiWindowFlags_NoScrollbar | ImGuiWindowFlags_NoScrollWithMouse, [&] {
             ImGui::PopStyleVar();
             if (!editor.state.document.capture && !editor.job()) {
                 drawStartPage(editor);
             } else if (viewport) {
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
    if (a.right > 0)
        pane("##right", {screen.x - a.right, a.top}, {a.right, columnsHeight}, 0, [&] {
            if (a.oneColumn) return drawOnlyColumn(editor);
            if (beginChild("inspector", ImVec2(0, 0))) drawInspectorPanel(editor);
            ImGui::EndChild();
        });
    if (a.bottom > 0) {
        const bool folded = p.bottomFolded;
        if (folded)
            ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding,
                                ImVec2(ImGui::GetStyle().WindowPadding.x, bottomPanelFoldedPadding()));
        pane("##bottom", {0, a.top + columnsHeight + between}, {screen.x, a.bottom}, ImGuiWindowFlags_NoScrollbar,
             [&] { drawBottomPanel(editor); });
        if (folded) ImGui::PopStyleVar();
    }
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(em(0.5f), 0));
    pane("##status", {0, screen.y - a.status}, {screen.x, a.status},
         ImGuiWindowFlags_NoScrollbar | ImGuiWindowFlags_NoScrollWithMouse, [&] { drawStatusBar(editor); });
    ImGui::PopStyleVar();

    // Handles between the areas.
    const auto handle = [&](const char* name, const ImVec2& position, const ImVec2& size, bool vertical, float& value,
                            float least, float most, float direction) {
        ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(0, 0));
        pane(name, position, size, ImGuiWindowFlags_NoScrollbar,
             [&] { splitter("handle", vertical, vertical ? size.y : size.x, value, least, most, direction, scale); });
        ImGui::PopStyleVar();
    };
    if (a.left > 0) handle("##handleLeft", {a.left, a.top}, {a.gap, columnsHeight}, true, p.leftWidth, 200, 700, 1);
    if (a.right > 0)
        handle("##handleRight", {screen.x - a.right - a.gap, a.top}, {a.gap, columnsHeight}, true, p.rightWidth, 200,
               700, -1);
    if (a.bottom > 0 && !p.bottomFolded)
        handle("##handleBottom", {0, a.top + columnsHeight}, {screen.x, a.gap}, false, p.bottomHeight, 60, 600, -1);

    drawDialogs(editor);
}

}  // namespace relamp::ui
