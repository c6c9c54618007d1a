// Which photographs belong to which lighting state: patterns of their names, against what the capture's files say.
#include <algorithm>
#include <map>

#include "item_map.h"
#include "panels/dialogs.h"
#include "widgets.h"

namespace relamp::ui {
namespace {

/// What is typed, until the capture is read with it.
struct StateFields {
    std::filesystem::path capture;
    std::vector<StatePattern> asRead, typed;
};

std::string nameOf(const Capture& capture, size_t view) { return capture.views[view].name; }

/// Photographs that each folder holds; fewer than two folders: none.
std::map<std::string, size_t> foldersOf(const Capture& capture) {
    std::map<std::string, size_t> folders;
    for (size_t v = 0; v < capture.views.size(); ++v)
        ++folders[std::filesystem::path(nameOf(capture, v)).parent_path().string()];
    if (folders.size() < 2 || folders.contains("") || folders.size() > mostStates) folders.clear();
    return folders;
}

/// Photographs of each pattern: where several match, the last counts. The rest of them is at the end.
std::vector<size_t> photographsOf(const std::vector<StatePattern>& patterns, const Capture& capture) {
    std::vector<size_t> photographs(patterns.size() + 1, 0);
    for (size_t v = 0; v < capture.views.size(); ++v) {
        size_t of = patterns.size();
        for (size_t k = 0; k < patterns.size(); ++k)
            if (matchesPattern(nameOf(capture, v), patterns[k].pattern)) of = k;
        ++photographs[of];
    }
    return photographs;
}

bool finished(const std::vector<StatePattern>& patterns) {
    return std::all_of(patterns.begin(), patterns.end(),
                       [](const StatePattern& p) { return !p.name.empty() && !p.pattern.empty(); });
}

/// What keeps finished patterns from being used; empty: nothing. `others`: photographs that no pattern matches have a
/// state of their files.
std::string faultOf(const std::vector<StatePattern>& patterns, const Capture& capture,
                    const std::vector<size_t>& photographs, bool others) {
    for (size_t k = 0; k < patterns.size(); ++k) {
        if (const std::string fault = faultOfStateName(patterns[k].name); !fault.empty())
            return "A name " + fault + ".";
        if (photographs[k] == 0)
            return fmt::format("No photograph is left for {}; the first is called {}.", shown(patterns[k].pattern),
                               shown(nameOf(capture, 0)));
    }
    if (const size_t without = photographs.back(); !others && !patterns.empty() && without > 0)
        return fmt::format("{} photograph{} no state; each needs one.", without,
                           without == 1 ? " belongs to" : "s belong to");
    return "";
}

void statesAsRead(const Capture& capture) {
    if (capture.states.empty()) return dimWrapped("All photographs are of one lighting state.");
    std::string words;
    for (size_t s = 0; s < capture.states.size(); ++s) {
        const auto views = std::count_if(capture.views.begin(), capture.views.end(),
                                         [&](const View& view) { return view.state == s; });
        words += fmt::format("{}{} ({})", s ? ", " : "", shown(capture.states[s]), views);
    }
    wrapped("Photographs of each state: " + words);
}

/// Name, pattern and bin of each.
void patternRows(std::vector<StatePattern>& patterns, const std::vector<size_t>& photographs) {
    const ImGuiStyle& style = ImGui::GetStyle();
    size_t gone = patterns.size();
    for (size_t k = 0; k < patterns.size(); ++k) {
        ImGui::PushID(int(k));
        const float count = em(8),
                    room = ImGui::GetContentRegionAvail().x - count - ImGui::GetFrameHeight() - 3 * style.ItemSpacing.x;
        ImGui::SetNextItemWidth(std::max(em(4), 0.4f * room));
        inputText("##name", patterns[k].name, "light off");
        noteItem(fmt::format("state name {}", k));
        tooltip("Name of the lighting state");
        ImGui::SameLine();
        ImGui::SetNextItemWidth(std::max(em(4), 0.6f * room));
        inputText("##pattern", patterns[k].pattern, "images/off/*");
        noteItem(fmt::format("state pattern {}", k));
        tooltip("The photographs whose names match: * stands for any letters, ? for one. A folder is all within it.");
        ImGui::SameLine();
        if (iconButton("##gone", Icon::trash, "Takes this line away")) gone = k;
        ImGui::SameLine();
        dimText(fmt::format("{} photograph{}", photographs[k], photographs[k] == 1 ? "" : "s"));
        ImGui::PopID();
    }
    if (gone < patterns.size()) patterns.erase(patterns.begin() + std::ptrdiff_t(gone));
}

}  // namespace

void drawStatePatterns(Editor& editor) {
    static StateFields fields;
    const auto capture = editor.state.document.capture;
    if (!capture || capture->views.empty()) return;
    const CaptureFix& now = editor.state.document.fix;
    if (fields.capture != editor.state.document.captureFolder || fields.asRead != now.states)
        fields = {editor.state.document.captureFolder, now.states, now.states};
    std::vector<StatePattern>& typed = fields.typed;
    statesAsRead(*capture);
    ImGui::BeginDisabled(editor.job().has_value());
    const std::vector<size_t> photographs = photographsOf(typed, *capture);
    const bool ofFiles = !capture->states.empty() && now.states.empty();
    const std::string fault = finished(typed) ? faultOf(typed, *capture, photographs, ofFiles) : "";
    patternRows(typed, photographs);
    if (button("Add state", "Names photographs that were taken with the lights switched or dimmed otherwise"))
        typed.push_back({});
    const auto folders = foldersOf(*capture);
    if (!folders.empty() && capture->states.empty() && typed.empty()) {
        sameLineIfFits(buttonWidth("One state per folder"));
        if (button("One state per folder", "The photographs of each folder are one lighting state, called like it"))
            for (const auto& [folder, views] : folders)
                typed.push_back({std::filesystem::path(folder).filename().string(), folder});
    }
    if (typed != now.states) {
        sameLineIfFits(buttonWidth("Use these states"));
        ImGui::BeginDisabled(!fault.empty() || !finished(typed));
        if (button("Use these states", "Reads the capture again. The files are not touched.")) {
            CaptureFix wanted = now;
            wanted.states = typed;
            // What was found with the old states is found anew.
            wanted.registration = {};
            wanted.mend = {};
            wanted.photometric = {};
            editor.fixCapture(wanted, "Lighting states");
        }
        ImGui::EndDisabled();
        if (!fault.empty()) warningText(fault);
        else if (editor.estimate()) dimWrapped("The present estimate and its edits then go; undo brings them back.");
    }
    ImGui::EndDisabled();
}

}  // namespace relamp::ui
