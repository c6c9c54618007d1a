// The strip at the bottom: timeline, all lights in a wide table, log, history, the plan of the estimate.
#include "item_map.h"
#include "panels/panels.h"
#include "widgets.h"

namespace relamp::ui {

void drawBottomPanel(Editor& editor) {
    static int shownTab = -1;
    int& wanted = editor.state.panels.bottomTab;
    if (!ImGui::BeginTabBar("##bottom", ImGuiTabBarFlags_FittingPolicyScroll | ImGuiTabBarFlags_NoTooltip)) return;
    struct Tab {
        const char* label;
        const char* explanation;
        void (*draw)(Editor&);
    };
    const Tab tabs[] = {{"Timeline", "Error against run time of the estimate", drawTimelinePanel},
                        {"Lights", "All lights with colour, power and evidence", drawEmittersPanel},
                        {"Log", "What has happened so far", drawLogPanel},
                        {"History", "Every edit by name; a click goes there", drawHistoryPanel},
                        {"Plan", "What the estimate does, what it leaves out and why, with times", drawPlanPanel}};
    const int asked = wanted;
    const bool fromOutside = asked != shownTab;
    for (int i = 0; i < 5; ++i) {
        const bool open =
            ImGui::BeginTabItem(tabs[i].label, nullptr, fromOutside && asked == i ? ImGuiTabItemFlags_SetSelected : 0);
        noteItem(std::string("tab ") + tabs[i].label);
        tooltip(tabs[i].explanation);
        if (!open) continue;
        if (!fromOutside || asked == i) wanted = shownTab = i;
        if (beginChild("##content", {0, 0})) tabs[i].draw(editor);
        ImGui::EndChild();
        ImGui::EndTabItem();
    }
    ImGui::EndTabBar();
}

}  // namespace relamp::ui
