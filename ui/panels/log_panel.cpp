#include "panels/panels.h"
#include "widgets.h"

namespace relamp::ui {

void drawLogPanel(Editor& editor) {
    static std::string filter;
    static bool warningsOnly = false;
    ImGui::SetNextItemWidth(std::min(em(14), ImGui::GetContentRegionAvail().x * 0.4f));
    inputText("##filter", filter, "Filter");
    tooltip("Shows only lines that contain this");
    ImGui::SameLine();
    checkbox("Warnings only", warningsOnly, "Hides ordinary messages");
    const auto& log = editor.state.log;
    const auto visible = [&](const LogEntry& entry) {
        return (!warningsOnly || entry.level == LogLevel::warning) &&
               (filter.empty() || entry.text.find(filter) != std::string::npos);
    };
    sameLineIfFits(buttonWidth("Copy"));
    if (button("Copy", "Copies the lines shown to the clipboard")) {
        std::string all;
        for (const LogEntry& entry : log)
            if (visible(entry)) all += entry.time + "  " + entry.text + "\n";
        ImGui::SetClipboardText(all.c_str());
    }
    sameLineIfFits(buttonWidth("Clear"));
    if (button("Clear", "Empties this list")) editor.state.log.clear();
    if (beginChild("##lines", {0, 0}, true)) {
        if (log.empty()) dimText("Nothing has happened yet.");
        for (const LogEntry& entry : log) {
            if (!visible(entry)) continue;
            dimText(entry.time);
            ImGui::SameLine(0, em(0.8f));
            if (entry.level == LogLevel::warning) warningText(shown(entry.text));
            else wrapped(shown(entry.text));
        }
        // Follows the newest line unless the user has scrolled up.
        if (ImGui::GetScrollY() >= ImGui::GetScrollMaxY() - em(1)) ImGui::SetScrollHereY(1);
    }
    ImGui::EndChild();
}

}  // namespace relamp::ui
