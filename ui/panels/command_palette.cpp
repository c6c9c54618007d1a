// Every command by a few of its letters.
#include <algorithm>

#include "actions.h"
#include "panels/dialogs.h"
#include "widgets.h"

namespace relamp::ui {

int fuzzyScore(const std::string& label, const std::string& words) {
    const auto low = [](char c) { return c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c; };
    int score = 0;
    size_t at = 0;
    bool run = false;
    for (const char wanted : words) {
        if (wanted == ' ') {
            run = false;
            continue;
        }
        // The start of a word is worth more than the next best place.
        size_t found = std::string::npos;
        for (size_t i = at; i < label.size(); ++i) {
            if (low(label[i]) != low(wanted)) continue;
            const bool start = i == 0 || label[i - 1] == ' ' || label[i - 1] == '.';
            if (run && i == at) {
                found = i;
                break;
            }
            if (found == std::string::npos) found = i;
            if (start) {
                found = i;
                break;
            }
        }
        if (found == std::string::npos) return -1;
        const bool start = found == 0 || label[found - 1] == ' ' || label[found - 1] == '.';
        score += 1 + (start ? 6 : 0) + (run && found == at ? 4 : 0);
        at = found + 1;
        run = true;
    }
    // Short labels first among equals.
    return score * 100 - int(std::min<size_t>(99, label.size()));
}

namespace {
bool mentions(const std::string& sentence, const std::string& words) {
    const auto low = [](char c) { return c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c; };
    return words.size() > 2 && std::search(sentence.begin(), sentence.end(), words.begin(), words.end(),
                                           [&](char a, char b) { return low(a) == low(b); }) != sentence.end();
}
}  // namespace

bool drawCommandPalette(Editor& editor) {
    static std::string words;
    static int selected = 0;
    const bool fresh = ImGui::IsWindowAppearing();
    if (fresh) words.clear(), selected = 0;
    ImGui::SetNextItemWidth(-FLT_MIN);
    if (fresh) ImGui::SetKeyboardFocusHere();
    if (inputText("##words", words, "Type what you want to do")) selected = 0;
    struct Row {
        const Action* action;
        int score;
        bool enabled;
    };
    std::vector<Row> rows;
    for (const Action& action : actions()) {
        // Labels by loose letters, explanations by whole words only: letters scattered over a sentence mean nothing.
        const int byLabel = fuzzyScore(action.label, words);
        const int score = byLabel >= 0 ? byLabel + 1000 : mentions(action.explanation, words) ? 1 : -1;
        if (words.empty() || score > 0) rows.push_back({&action, score, !action.enabled || action.enabled(editor)});
    }
    if (!words.empty())
        std::stable_sort(rows.begin(), rows.end(), [](const Row& a, const Row& b) {
            return a.enabled != b.enabled ? a.enabled : a.score > b.score;
        });
    bool moved = false;
    if (!rows.empty()) {
        const int last = int(rows.size()) - 1;
        if (keyPressed(ImGuiKey_DownArrow, true)) selected = selected >= last ? 0 : selected + 1, moved = true;
        if (keyPressed(ImGuiKey_UpArrow, true)) selected = selected <= 0 ? last : selected - 1, moved = true;
        selected = std::clamp(selected, 0, last);
    }
    const Action* wanted = nullptr;
    if (enterPressed() && !fresh && !rows.empty() && rows[size_t(selected)].enabled)
        wanted = rows[size_t(selected)].action;
    if (beginChild("##rows", {0, 0})) {
        if (rows.empty()) dimText("No command has these letters.");
        for (int i = 0; i < int(rows.size()); ++i) {
            const Action& action = *rows[size_t(i)].action;
            const std::string keys = action.keys.empty() ? "" : action.keys.front().text();
            const float room = ImGui::GetContentRegionAvail().x,
                        keyWidth = keys.empty() ? 0 : ImGui::CalcTextSize(keys.c_str()).x + em(0.8f),
                        left = ImGui::GetCursorPosX();
            ImGui::PushID(i);
            ImGui::BeginDisabled(!rows[size_t(i)].enabled);
            if (ImGui::Selectable("##row", i == selected, ImGuiSelectableFlags_DontClosePopups)) wanted = &action;
            tooltip(action.explanation);
            if (moved && i == selected) ImGui::SetScrollHereY();
            ImGui::SameLine(left);
            text(
                elided(action.menu.empty() ? action.label : action.menu + ": " + action.label, room - keyWidth, false));
            if (keyWidth > 0) {
                ImGui::SameLine(left + room - keyWidth + em(0.8f));
                dimText(keys);
            }
            ImGui::EndDisabled();
            ImGui::PopID();
        }
    }
    ImGui::EndChild();
    if (!wanted && !escapePressed()) return false;
    editor.state.panels.palette = false;
    if (wanted) wanted->run(editor);
    return true;
}

}  // namespace relamp::ui
