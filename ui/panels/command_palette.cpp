// Every command by a few of its letters.
#include <algorithm>

#include "actions.h"
#include "panels/dialogs.h"
#include "widgets.h"

namespace relamp::ui {

int fuzzyScore(const std::string& label, const std::string& words) {
    const auto low = [](std::string text) {
        for (char& c : text)
            if (c >= 'A' && c <= 'Z') c = char(c - 'A' + 'a');
        return text;
    };
    const std::string in = low(label), wanted = low(words);
    // Short labels first among equals.
    const int shorter = -int(std::min<size_t>(99, in.size()));
    const auto startsWord = [&](size_t i) { return i == 0 || in[i - 1] == ' ' || in[i - 1] == '.'; };
    if (const size_t whole = in.find(wanted); whole != std::string::npos) {
        if (whole == 0) return 4000 + shorter;
        for (size_t at = whole; at != std::string::npos; at = in.find(wanted, at + 1))
            if (startsWord(at)) return 3000 + shorter;
        return wanted.size() > 1 ? 1000 + shorter : -1;
    }
    // Runs that each start a word: "exp fr", "sa" for "Save as".
    size_t word = 0;
    for (size_t i = 0; i < wanted.size();) {
        if (wanted[i] == ' ') {
            ++i;
            continue;
        }
        size_t best = 0, after = 0;
        for (size_t at = word; at < in.size(); ++at) {
            if (!startsWord(at)) continue;
            size_t run = 0;
            while (i + run < wanted.size() && at + run < in.size() && wanted[i + run] == in[at + run] &&
                   wanted[i + run] != ' ')
                ++run;
            if (run > best) best = run, after = at + run;
        }
        if (best == 0) return -1;
        i += best;
        word = after;
    }
    return 2000 + shorter;
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
        // Labels by starts of words, explanations by whole words only: letters scattered over a sentence mean nothing.
        const int byLabel = fuzzyScore(action.label, words);
        const int score = byLabel >= 0 ? byLabel + 1000 : mentions(action.explanation, words) ? 1 : -1;
        if (words.empty() || score > 0) rows.push_back({&action, score, !action.enabled || action.enabled(editor)});
    }
    if (!words.empty())
        // One that cannot be run now stays in its place: what comes up first never depends on the selection.
        std::stable_sort(rows.begin(), rows.end(), [](const Row& a, const Row& b) { return a.score > b.score; });
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
