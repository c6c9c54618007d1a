// The strip at the bottom: progress, all lights in a wide table, log, history, details of the solve.
#include "item_map.h"
#include "panels/panels.h"
#include "widgets.h"

namespace relamp::ui {

float bottomPanelFoldedPadding() { return std::floor(ImGui::GetStyle().FramePadding.y / 2); }
float bottomPanelFoldedHeight() { return ImGui::GetFrameHeight() + 2 * bottomPanelFoldedPadding(); }

void drawBottomPanel(Editor& editor) {
    bool& folded = editor.state.panels.bottomFolded;
    static int shownTab = -1;
    int& wanted = editor.state.panels.bottomTab;
    if (!ImGui::BeginTabBar("##bottom", ImGuiTabBarFlags_FittingPolicyScroll | ImGuiTabBarFlags_NoTooltip)) return;
    struct Tab {
        const char* label;
        const char* explanation;
        void (*draw)(Editor&);
    };
    constexpr Tab tabs[] = {
        {"Progress", "Error against run time of the estimate", drawTimelinePanel},
        {"Lights", "All lights with colour, power and evidence", drawEmittersPanel},
        {"Log", "What has happened so far", drawLogPanel},
        {"History", "Every edit by name; a click goes there", drawHistoryPanel},
        {"Solve details", "What the estimate does, what it leaves out and why, with times", drawPlanPanel},
        {"Scope", "Waveform and histogram of the image", drawScopePanel},
        {"Frames", "Keys: what lights and environment do over time; play", drawFramesPanel}};
    static_assert(std::size(tabs) == framesTab + 1);
    const int asked = wanted;
    const bool fromOutside = asked != shownTab;
    int chosen = -1;
    for (int i = 0; i < int(std::size(tabs)); ++i) {
        const bool open =
            ImGui::BeginTabItem(tabs[i].label, nullptr, fromOutside && asked == i ? ImGuiTabItemFlags_SetSelected : 0);
        noteItem(std::string("tab ") + tabs[i].label);
        tooltip(tabs[i].explanation);
        // By hand as well: a tab that was not under the pointer in the frame before does not take the click.
        if (ImGui::IsItemClicked()) folded = false, chosen = i;
        if (!open) continue;
        if (!fromOutside || asked == i) wanted = shownTab = i;
        if (!folded) {
            if (beginChild("##content", {0, 0})) tabs[i].draw(editor);
            ImGui::EndChild();
        }
        ImGui::EndTabItem();
    }
    if (chosen >= 0) wanted = chosen;
    if (ImGui::TabItemButton(folded ? "Unfold###fold" : "Fold###fold", ImGuiTabItemFlags_Trailing)) folded = !folded;
    noteItem("fold the bottom panel");
    tooltip(folded ? "Shows the panel (Ctrl+B)" : "Leaves the tabs alone, for a larger image (Ctrl+B)");
    ImGui::EndTabBar();
}

}  // namespace relamp::ui
