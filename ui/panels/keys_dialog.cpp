// The pages of the Help menu: every key, and what this program is.
#include "actions.h"
#include "keys.h"
#include "panels/dialogs.h"
#include "panels/panels.h"
#include "widgets.h"

namespace relamp::ui {

bool drawKeysDialog(Editor& editor) {
    static std::string filter;
    ImGui::SetNextItemWidth(-FLT_MIN);
    inputText("##filter", filter, "Filter");
    tooltip("Shows only commands and keys that contain this");
    const float below = ImGui::GetFrameHeightWithSpacing();
    if (beginChild("##keys", {0, -below})) {
        std::string menu;
        const auto matches = [&](const std::string& a, const std::string& b) {
            return filter.empty() || fuzzyScore(a, filter) > 0 || fuzzyScore(b, filter) > 0;
        };
        const auto keysOf = [](const Action& action) {
            std::string keys;
            for (const KeyChord& chord : action.keys) keys += (keys.empty() ? "" : ", ") + chord.text();
            return keys;
        };
        float column = em(10);
        for (const Action& action : actions())
            column = std::max(column, ImGui::CalcTextSize(keysOf(action).c_str()).x + em(1.5f));
        const auto row = [&](const std::string& keys, const std::string& label, const std::string& explanation) {
            const float left = ImGui::GetCursorPosX();
            text(keys);
            ImGui::SameLine(left + column);
            wrapped(label);
            tooltip(explanation);
        };
        for (const Action& action : actions()) {
            const std::string keys = keysOf(action);
            if (keys.empty() || !matches(action.label, keys)) continue;
            if (action.menu != menu) heading((menu = action.menu).empty() ? "Other" : menu);
            row(keys, action.label, action.explanation);
        }
        const struct {
            const char* keys;
            const char* label;
        } hands[] = {{"G, R, S", "Move, rotate or scale the selected lights with the hand"},
                     {"Alt+G, R, S", "Position, rotation or size back to how it was recovered"},
                     {"X, Y, Z", "while moving: along this axis only"},
                     {"0-9", "while moving: type the amount"},
                     {"Ctrl", "while moving: snap"},
                     {"Shift", "while moving: fine"},
                     {"Esc", "while dragging anything: take it back"},
                     {"Left drag", "over the image: selects the lights inside, with Ctrl besides those selected"},
                     {"Esc", "while a rectangle is drawn: give it up; nothing is selected anew"},
                     {"Middle drag", "Rotate the view (or Alt and left)"},
                     {"Shift+Middle", "Shift the view"},
                     {"Wheel", "Nearer or farther"}};
        heading("In the viewport");
        for (const auto& hand : hands)
            if (matches(hand.label, hand.keys)) row(hand.keys, hand.label, "");
    }
    ImGui::EndChild();
    const bool close = button("Close", "Closes this page (Esc)", em(7));
    if (!close && !escapePressed()) return false;
    editor.state.panels.keys = false;
    filter.clear();
    return true;
}

#ifndef RELAMP_VERSION
#define RELAMP_VERSION "0.1"
#endif

bool drawAboutDialog(Editor& editor) {
    text("relamp " RELAMP_VERSION);
    dimWrapped("To relamp is to change the lights of a fixture; here, of a captured scene.");
    ImGui::Spacing();
    wrapped(
        "It separates photographs of a scene into the light, near and far, and the reflectance of the surfaces, and "
        "lets you light the scene anew.");
    ImGui::Spacing();
    dimWrapped(
        "After J. Put, N. Michiels, P. Bekaert: Using near-field light sources to separate illumination from BRDF, "
        "BMVC 2015. The full bibliography is in core/README.md.");
    if (!editor.state.gpu.empty()) fact("Graphics", shown(editor.state.gpu));
    fact("Dear ImGui", ImGui::GetVersion());
    ImGui::Spacing();
    if (!button("Close", "Closes this page (Esc)", em(7)) && !escapePressed()) return false;
    editor.state.panels.about = false;
    return true;
}

}  // namespace relamp::ui
