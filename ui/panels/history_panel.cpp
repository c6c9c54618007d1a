// Every edit by name; a click goes there.
#include <ctime>

#include "panels/panels.h"
#include "widgets.h"

namespace relamp::ui {
namespace {

std::string clockTime(const std::chrono::system_clock::time_point& time) {
    const std::time_t t = std::chrono::system_clock::to_time_t(time);
    std::tm local{};
    char words[16] = "";
    if (localtime_r(&t, &local)) std::strftime(words, sizeof words, "%H:%M:%S", &local);
    return words;
}

}  // namespace

void drawHistoryPanel(Editor& editor) {
    const History& history = editor.history();
    ImGui::BeginDisabled(!history.canUndo());
    if (button("Undo", "Takes the last edit back (Ctrl+Z)")) editor.undo();
    ImGui::EndDisabled();
    ImGui::SameLine();
    ImGui::BeginDisabled(!history.canRedo());
    if (button("Redo", "Brings back what was undone (Ctrl+Shift+Z)")) editor.redo();
    ImGui::EndDisabled();
    static size_t lastIndex = 0, lastCount = 0;
    std::optional<size_t> wanted;
    if (beginChild("##entries", {0, 0}, true)) {
        const auto& entries = history.entries();
        ImGuiListClipper clipper;
        clipper.Begin(int(entries.size()), ImGui::GetTextLineHeightWithSpacing());
        while (clipper.Step())
            for (int i = clipper.DisplayStart; i < clipper.DisplayEnd; ++i) {
                const HistoryEntry& entry = entries[size_t(i)];
                const bool undone = size_t(i) > history.index();
                ImGui::PushID(i);
                if (undone) ImGui::PushStyleColor(ImGuiCol_Text, ImGui::GetStyleColorVec4(ImGuiCol_TextDisabled));
                const float room = ImGui::GetContentRegionAvail().x;
                const std::string time = clockTime(entry.time);
                const float timeWidth = room > em(14) ? ImGui::CalcTextSize(time.c_str()).x + em(0.8f) : 0;
                const float left = ImGui::GetCursorPosX();
                if (ImGui::Selectable(("##" + std::to_string(i)).c_str(), size_t(i) == history.index()))
                    wanted = size_t(i);
                tooltip(undone                         ? "Click to bring this back, and everything before it"
                        : size_t(i) == history.index() ? "This is how it is now"
                                                       : "Click to go back to here");
                ImGui::SameLine(left);
                if (timeWidth > 0) {
                    dimText(time);
                    ImGui::SameLine(left + timeWidth);
                }
                text(elided(shown(entry.label), room - timeWidth, false));
                if (undone) ImGui::PopStyleColor();
                ImGui::PopID();
            }
        if (lastIndex != history.index() || lastCount != entries.size()) {
            const float y = float(history.index()) * ImGui::GetTextLineHeightWithSpacing();
            if (y < ImGui::GetScrollY() ||
                y > ImGui::GetScrollY() + ImGui::GetWindowHeight() - 2 * ImGui::GetTextLineHeightWithSpacing())
                ImGui::SetScrollY(std::max(0.0f, y - ImGui::GetWindowHeight() / 2));
            lastIndex = history.index();
            lastCount = entries.size();
        }
    }
    ImGui::EndChild();
    if (wanted) editor.goTo(*wanted);
}

}  // namespace relamp::ui
