#include "theme.h"

namespace relamp::ui {
namespace {
ImVec4 grey(float value, float alpha = 1) { return {value, value, value, alpha}; }
ImVec4 accent(float alpha) { return {accentColour.x, accentColour.y, accentColour.z, alpha}; }
}  // namespace

void applyTheme(float scale) {
    ImGuiStyle style;
    style.WindowPadding = {8, 8};
    style.FramePadding = {6, 3};
    style.ItemSpacing = {6, 5};
    style.ItemInnerSpacing = {5, 4};
    style.CellPadding = {4, 2};
    style.IndentSpacing = 14;
    style.ScrollbarSize = 12;
    style.GrabMinSize = 10;
    style.WindowRounding = 3;
    style.ChildRounding = 3;
    style.FrameRounding = 3;
    style.PopupRounding = 4;
    style.ScrollbarRounding = 6;
    style.GrabRounding = 3;
    style.TabRounding = 3;
    style.WindowBorderSize = 1;
    style.PopupBorderSize = 1;
    style.FrameBorderSize = 1;
    style.WindowTitleAlign = {0.02f, 0.5f};
    style.WindowMenuButtonPosition = ImGuiDir_None;
    style.DisabledAlpha = 0.5f;
    style.ScaleAllSizes(scale);

    ImVec4* c = style.Colors;
    c[ImGuiCol_Text] = grey(0.88f);
    c[ImGuiCol_TextDisabled] = grey(0.60f);
    c[ImGuiCol_WindowBg] = grey(0.165f);
    c[ImGuiCol_ChildBg] = grey(0, 0);
    c[ImGuiCol_PopupBg] = grey(0.145f, 0.99f);
    c[ImGuiCol_Border] = grey(0.33f, 0.75f);
    c[ImGuiCol_BorderShadow] = grey(0, 0);
    c[ImGuiCol_FrameBg] = grey(0.115f);
    c[ImGuiCol_FrameBgHovered] = grey(0.21f);
    c[ImGuiCol_FrameBgActive] = grey(0.25f);
    c[ImGuiCol_TitleBg] = grey(0.125f);
    c[ImGuiCol_TitleBgActive] = grey(0.20f);
    c[ImGuiCol_TitleBgCollapsed] = grey(0.125f);
    c[ImGuiCol_MenuBarBg] = grey(0.135f);
    c[ImGuiCol_ScrollbarBg] = grey(0.12f, 0.5f);
    c[ImGuiCol_ScrollbarGrab] = grey(0.33f);
    c[ImGuiCol_ScrollbarGrabHovered] = grey(0.42f);
    c[ImGuiCol_ScrollbarGrabActive] = grey(0.52f);
    c[ImGuiCol_CheckMark] = accent(1);
    c[ImGuiCol_SliderGrab] = grey(0.48f);
    c[ImGuiCol_SliderGrabActive] = accent(1);
    c[ImGuiCol_Button] = grey(0.255f);
    c[ImGuiCol_ButtonHovered] = grey(0.33f);
    c[ImGuiCol_ButtonActive] = grey(0.40f);
    c[ImGuiCol_Header] = accent(0.34f);
    c[ImGuiCol_HeaderHovered] = grey(0.30f);
    c[ImGuiCol_HeaderActive] = accent(0.50f);
    c[ImGuiCol_Separator] = grey(0.27f);
    c[ImGuiCol_SeparatorHovered] = accent(0.7f);
    c[ImGuiCol_SeparatorActive] = accent(1);
    c[ImGuiCol_ResizeGrip] = grey(0.33f, 0.5f);
    c[ImGuiCol_ResizeGripHovered] = accent(0.7f);
    c[ImGuiCol_ResizeGripActive] = accent(1);
    c[ImGuiCol_Tab] = grey(0.165f);
    c[ImGuiCol_TabHovered] = grey(0.31f);
    c[ImGuiCol_TabActive] = grey(0.26f);
    c[ImGuiCol_TabUnfocused] = grey(0.165f);
    c[ImGuiCol_TabUnfocusedActive] = grey(0.24f);
    c[ImGuiCol_PlotLines] = grey(0.7f);
    c[ImGuiCol_PlotLinesHovered] = accent(1);
    c[ImGuiCol_PlotHistogram] = accent(1);
    c[ImGuiCol_PlotHistogramHovered] = accent(1);
    c[ImGuiCol_TableHeaderBg] = grey(0.195f);
    c[ImGuiCol_TableBorderStrong] = grey(0.26f);
    c[ImGuiCol_TableBorderLight] = grey(0.22f);
    c[ImGuiCol_TableRowBg] = grey(0, 0);
    c[ImGuiCol_TableRowBgAlt] = grey(1, 0.02f);
    c[ImGuiCol_TextSelectedBg] = accent(0.4f);
    c[ImGuiCol_DragDropTarget] = accent(1);
    c[ImGuiCol_NavHighlight] = accent(0.9f);
    c[ImGuiCol_NavWindowingHighlight] = grey(1, 0.6f);
    c[ImGuiCol_NavWindowingDimBg] = grey(0, 0.4f);
    c[ImGuiCol_ModalWindowDimBg] = grey(0, 0.5f);
    ImGui::GetStyle() = style;
}

}  // namespace relamp::ui
