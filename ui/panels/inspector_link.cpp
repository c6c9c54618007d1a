// Which objects a light falls on.
#include "edit/link_edits.h"
#include "panels/emitter_controls.h"
#include "panels/inspector.h"
#include "viewport/overlays.h"
#include "widgets.h"

namespace relamp::ui {

void inspectLink(Editor& editor, const EmitterState& emitter, const std::vector<std::string>& targets) {
    const Scene* scene = editor.state.document.scene.get();
    if (!scene ||
        !section("Falls on", "The objects that it lights. Real light falls on everything.", !emitter.link.everything()))
        return;
    if (emitter.link.everything()) dimWrapped("It falls on every object.");
    uint32_t forget = ~0u;
    for (const uint32_t seed : emitter.link.parts) {
        if (seed >= scene->component.size()) continue;
        ImGui::PushID(int(seed));
        ImGui::AlignTextToFramePadding();
        text(fmt::format(
            "{} an object of {} points", emitter.link.only ? "Only on" : "Not on",
            count(size_t(std::count(scene->component.begin(), scene->component.end(), scene->component[seed])))));
        if (ImGui::IsItemHovered()) pointOut(seed);
        tooltip("The image frames it while the pointer is here");
        sameLineIfFits(buttonWidth("Forget"));
        if (button("Forget", "Takes this object off the list")) forget = seed;
        if (ImGui::IsItemHovered()) pointOut(seed);
        ImGui::PopID();
    }
    const auto change = [&](const std::string& label, const std::function<LightLink(const LightLink&)>& made) {
        editor.edit(label + editor.namesOf(targets), [&](Look& look) {
            for (const std::string& id : targets)
                if (const EmitterState* light = editor.emitter(id)) setLink(look, id, made(light->link));
        });
    };
    if (forget != ~0u) change("Objects of ", [&](const LightLink& link) { return forgetPart(link, *scene, forget); });
    const ClickTask armed = editor.state.viewport.clickTask;
    if (iconTextButton("Not on...", Icon::link,
                       "Then click an object that this light does not fall on. It keeps its shadow. No real light does "
                       "that.",
                       armed == ClickTask::leaveOut))
        armClick(editor, ClickTask::leaveOut);
    sameLineIfFits(buttonWidth("Only on...") + em(2));
    if (iconTextButton(
            "Only on...", Icon::link,
            "Then click an object that this light falls on alone. More than one may be chosen, one after the "
            "other.",
            armed == ClickTask::lightOnly))
        armClick(editor, ClickTask::lightOnly);
    if (emitter.link.everything()) return;
    sameLineIfFits(buttonWidth("On everything"));
    if (button("On everything", "It falls on every object again"))
        change("Everything lit by ", [](const LightLink&) { return LightLink{}; });
}

}  // namespace relamp::ui
