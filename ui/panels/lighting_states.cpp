// The lighting states of the photographs: one of them shown as a look, or a mix of two.
#include "edit/state_edits.h"
#include "item_map.h"
#include "panels/panels.h"
#include "relight/state_look.h"
#include "widgets.h"

namespace relamp::ui {
namespace {

/// A state chosen from a list; none: nothing was.
std::optional<size_t> stateCombo(const char* id, const Estimate& estimate, const std::string& preview,
                                 std::optional<size_t> chosen, std::optional<size_t> without,
                                 const std::string& explanation) {
    std::optional<size_t> picked;
    if (ImGui::BeginCombo(id, shown(preview).c_str())) {
        for (size_t s = 0; s < estimate.states.size(); ++s) {
            if (without == s) continue;
            ImGui::PushID(int(s));
            if (ImGui::Selectable(shown(estimate.states[s].name).c_str(), chosen == s)) picked = s;
            noteItem(std::string("choice ") + (id + 2) + " " + estimate.states[s].name);
            tooltip(fmt::format("{} photographs", estimate.states[s].views.size()));
            ImGui::PopID();
        }
        ImGui::EndCombo();
    }
    noteItem(std::string("list ") + (id + 2));
    tooltip(explanation);
    return picked;
}

void stateRow(const char* name) {
    ImGui::AlignTextToFramePadding();
    dimText(name);
    ImGui::SameLine(em(5));
    ImGui::SetNextItemWidth(std::max(em(3), ImGui::GetContentRegionAvail().x));
}

}  // namespace

void drawLightingStates(Editor& editor) {
    const auto estimate = editor.estimate();
    if (!estimate || estimate->states.size() < 2) return;
    if (estimate->emitters.emitters.empty() && !environmentsDiffer(*estimate)) return;
    const std::vector<LightingState>& states = estimate->states;
    const std::optional<size_t> now = shownState(editor.look(), *estimate);
    // The ends of the mix are what was chosen last; they are no part of the look.
    ImGuiStorage& kept = *ImGui::GetStateStorage();
    int& from = *kept.GetIntRef(ImGui::GetID("from"), 0);
    int& to = *kept.GetIntRef(ImGui::GetID("to"), 1);
    if (from >= int(states.size())) from = 0;
    if (to >= int(states.size()) || to == from) to = from == 0 ? 1 : 0;
    stateRow("State");
    if (const auto picked = stateCombo("##state", *estimate, now ? states[*now].name : "edited", now, {},
                                       environmentsDiffer(*estimate)
                                           ? "Lights and environment as in the photographs of one lighting state. "
                                             "Where lights stand, and those you added, stay."
                                           : "Lights on and off as in the photographs of one lighting state. Where "
                                             "they stand, lights you added and the environment stay.")) {
        from = int(*picked);
        editor.edit("State " + states[*picked].name, [&](Look& look) { showState(look, *estimate, *picked); });
        return;
    }
    stateRow("Mix with");
    if (const auto picked =
            stateCombo("##mixed", *estimate, states[size_t(to)].name, size_t(to), size_t(from),
                       fmt::format("The state that {} is mixed with", shown(states[size_t(from)].name))))
        to = int(*picked);
    stateRow("");
    const float mix = shownMix(editor.look(), *estimate, size_t(from), size_t(to));
    const size_t first = size_t(from), second = size_t(to);
    dragLook(editor, "##mix", "Mix lighting states", 100 * mix, {0.5f, 0, 100, "%.0f %%"},
             fmt::format("From {} (0 %) to {} (100 %): {} evenly from one to the other.", shown(states[first].name),
                         shown(states[second].name),
                         environmentsDiffer(*estimate) ? "lights and environment go" : "every light goes"),
             [estimate, first, second](Look& look, float percent) {
                 showMix(look, *estimate, first, second, std::clamp(percent / 100, 0.0f, 1.0f));
             });
    noteItem("mix of states");
}

}  // namespace relamp::ui
