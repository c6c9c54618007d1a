// Groups of lights under the table of lights: a row each, whose switch, exposure and colour go to all members.
#include "edit/group_edits.h"
#include "item_map.h"
#include "panels/emitter_controls.h"
#include "panels/panels.h"
#include "panels/value_key_menu.h"
#include "widgets.h"

namespace relamp::ui {
namespace {

constexpr float darkestGroup = -20;  ///< stops; what a group that gives no light shows

float groupStops(const LightGroup& group) {
    const float level = luminance(group.powerScale);
    return level > 0 ? std::max(std::log2(level), darkestGroup) : darkestGroup;
}

/// A group that gives no light gets it back white.
void setGroupStops(LightGroup& group, float stops) {
    const float level = luminance(group.powerScale);
    group.powerScale = (level > 0 ? group.powerScale / level : Rgb(1)) * std::exp2(stops);
}

void nameOfGroup(Editor& editor, const LightGroup& group, float side) {
    const std::vector<std::string>& selected = editor.state.selection.emitters;
    ImGui::SetCursorPosX(ImGui::GetCursorPosX() + em(1.8f));  // under the lights' names
    ImGui::AlignTextToFramePadding();
    const std::string words = fmt::format("{} ({})", shown(group.name), group.members.size());
    if (ImGui::Selectable((elided(words, ImGui::GetContentRegionAvail().x) + "###group").c_str(),
                          selected == group.members, 0, {0, side}))
        editor.state.selection.emitters = group.members;
    noteItem("group " + group.name);
    tooltip(fmt::format("{}: {}\nClick selects its lights, right click for more.", shown(group.name),
                        shown(editor.namesOf(group.members))));
    if (!ImGui::BeginPopupContextItem("##menu")) return;
    static std::string name;
    if (ImGui::IsWindowAppearing()) name = group.name;
    ImGui::SetNextItemWidth(em(12));
    if (inputText("##name", name, "Name", ImGuiInputTextFlags_EnterReturnsTrue)) {
        editor.edit("Rename " + group.name, [&](Look& look) { renameGroup(look, group.name, name); });
        ImGui::CloseCurrentPopup();
    }
    noteItem("group name");
    tooltip("What the group is called; Enter takes it.");
    if (ImGui::MenuItem("Dissolve"))
        editor.edit("Dissolve " + group.name, [&](Look& look) { dissolveGroup(look, group.name); });
    tooltip("Its lights stay, and shine without what the group does to them");
    ImGui::EndPopup();
}

void groupSwitch(Editor& editor, const LightGroup& group, float side) {
    const bool on = group.enabled;
    if (iconButton("##mute", on ? Icon::eyeOpen : Icon::eyeShut,
                   on ? "Shines. Click to switch all its lights off." : "Is off. Click to switch it on.", !on, side))
        editor.edit((on ? "Switch off " : "Switch on ") + group.name,
                    [&](Look& look) { changeGroup(look, group.name, [&](LightGroup& g) { g.enabled = !on; }); });
    noteItem("mute group " + group.name);
    valueKeyMenu(editor, {{KeyedValue::groupEnabled, group.name}});
}

void groupSolo(Editor& editor, const LightGroup& group, float side) {
    auto& solo = editor.state.viewport.solo;
    const bool on = solo == group.members;
    if (iconButton("##solo", Icon::solo,
                   on ? "Shown alone. Click to show all lights again."
                      : "Shows its lights alone in the viewport. Files and exports are not touched.",
                   on, side))
        solo = on ? std::vector<std::string>{} : group.members;
    noteItem("solo group " + group.name);
}

void drawGroup(Editor& editor, const LightGroup& group, float side, const LightColumns& columns) {
    ImGui::TableNextColumn();
    nameOfGroup(editor, group, side);
    ImGui::TableNextColumn();
    groupSwitch(editor, group, side);
    ImGui::TableNextColumn();
    groupSolo(editor, group, side);
    if (!columns.exposure) return;
    ImGui::TableNextColumn();
    ImGui::SetNextItemWidth(-FLT_MIN);
    dragLook(editor, "##stops", "Exposure of " + group.name, groupStops(group), {0.02f, darkestGroup, 20, "%+.2f"},
             "Exposure of all its lights, in stops: +1 is twice as bright, -1 half.", [&](Look& look, float stops) {
                 changeGroup(look, group.name, [&](LightGroup& g) { setGroupStops(g, stops); });
             });
    valueKeyMenu(editor, {{KeyedValue::groupPower, group.name}});
    if (!columns.colour) return;
    ImGui::TableNextColumn();
    colourLook(editor, "##colour", "Colour of " + group.name, group.powerScale, side,
               "Multiplies the colour of all its lights; click to change. The exposure stays.",
               [&](Look& look, const Rgb& colour) {
                   changeGroup(look, group.name, [&](LightGroup& g) {
                       g.powerScale = colour / std::max(luminance(colour), 1e-12f) * luminance(g.powerScale);
                   });
               });
}

}  // namespace

void drawLightGroups(Editor& editor) {
    // A copy, because a click may change the look.
    const std::vector<LightGroup> groups = editor.look().groups;
    if (groups.empty()) return;
    const float side = ImGui::GetFrameHeight();
    const LightColumns columns(ImGui::GetContentRegionAvail().x);
    if (!ImGui::BeginTable("##groups", columns.count(),
                           ImGuiTableFlags_RowBg | ImGuiTableFlags_NoPadOuterX | ImGuiTableFlags_SizingFixedFit))
        return;
    columns.setUp("Group");
    for (const LightGroup& group : groups) {
        ImGui::PushID(group.name.c_str());
        ImGui::TableNextRow();
        drawGroup(editor, group, side, columns);
        ImGui::PopID();
    }
    ImGui::EndTable();
}

}  // namespace relamp::ui
