// The lights as a table, with as many columns as there is room for. Edits go to every selected row at once.
#include "display/vertex_images.h"
#include "item_map.h"
#include "panels/emitter_controls.h"
#include "panels/panels.h"
#include "viewport/overlays.h"
#include "widgets.h"

namespace relamp::ui {
namespace {

void evidenceCell(Editor& editor, const EmitterState& emitter) {
    if (!emitter.recovered) {
        dimText("added by you");
        tooltip("This light was not in the scene when the photographs were taken");
        return;
    }
    const float identifiability = identifiabilityOf(editor, emitter), sigma = uncertaintyOf(editor, emitter);
    const std::string spread = sigma < 0 ? "" : fmt::format("\u00b1{} ", percent(double(sigma)));
    const bool weak = identifiability >= 0 && identifiability < weakIdentifiability;
    if (weak) iconText(Icon::warning, warningColour), ImGui::SameLine(0, em(0.3f));
    text(spread + evidenceInShort(editor, emitter));
    std::string words = "Evidence for its brightness: " + evidenceInShort(editor, emitter) + ".";
    if (sigma >= 0) words += fmt::format("\nIts brightness is known to about {}.", percent(double(sigma)));
    if (identifiability >= 0)
        words += fmt::format("\n{} of its effect on the photographs could not come from far away.",
                             percent(double(identifiability)));
    if (weak)
        words +=
            "\nHard to tell from distant light: its fraction and the environment's may have been mixed up. Photographs "
            "with its shadows in them would help.";
    tooltip(words);
}

/// `menuOf`: set to its id by a right click.
void nameCell(Editor& editor, const EmitterState& emitter, float side, std::string& menuOf) {
    const bool selected = editor.state.selection.has(emitter.id);
    const ImVec2 start = ImGui::GetCursorPos();
    const float nameEnds = ImGui::GetCursorScreenPos().x + ImGui::GetContentRegionAvail().x;
    ImGui::AlignTextToFramePadding();
    if (ImGui::Selectable("##row", selected,
                          ImGuiSelectableFlags_SpanAllColumns | ImGuiSelectableFlags_AllowItemOverlap, {0, side}))
        selectEmitter(editor, emitter.id, ImGui::GetIO().KeyCtrl, ImGui::GetIO().KeyShift);
    noteItem("row " + emitter.id);
    if (ImGui::IsItemHovered() && ImGui::GetMousePos().x < nameEnds &&
        ImGui::IsMouseDoubleClicked(ImGuiMouseButton_Left))
        selectEmitter(editor, emitter.id, false, false), editor.state.panels.renameLight = true;
    const bool weak = emitter.recovered && identifiabilityOf(editor, emitter) >= 0 &&
                      identifiabilityOf(editor, emitter) < weakIdentifiability;
    tooltip(
        fmt::format("{}{}\nClick selects it; Ctrl and Shift select several, and an edit then goes to all of "
                    "them. Double click renames it, right click for more.",
                    shown(emitter.name), weak ? "\nHard to tell from distant light" : ""));
    if (ImGui::IsItemClicked(ImGuiMouseButton_Right)) menuOf = emitter.id;
    ImGui::SetCursorPos(start);
    const float dot = em(0.85f);
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const ImVec4 mark =
        emitter.recovered ? toScreen(clusterColour(size_t(emitter.index))) : ImVec4(0.5f, 0.5f, 0.5f, 1);
    ImGui::GetWindowDrawList()->AddRectFilled({at.x, at.y + (side - dot) / 2},
                                              {at.x + dot * 0.45f, at.y + (side + dot) / 2}, ImGui::GetColorU32(mark),
                                              em(0.15f));
    drawIcon(ImGui::GetWindowDrawList(), weak ? Icon::warning : iconOf(editor, emitter),
             {at.x + em(0.6f), at.y + (side - em(0.95f)) / 2}, em(0.95f),
             ImGui::GetColorU32(weak               ? warningColour
                                : emitter.shines() ? ImGui::GetStyleColorVec4(ImGuiCol_Text)
                                                   : dimColour));
    ImGui::SetCursorPosX(start.x + em(1.8f));
    ImGui::AlignTextToFramePadding();
    const std::string name = elided(shown(emitter.name) + (emitter.recovered && emitter.changed ? " *" : ""),
                                    ImGui::GetContentRegionAvail().x);
    if (emitter.shines()) text(name);
    else dimText(name);
}

void valueCells(Editor& editor, const EmitterState& emitter, float side, const LightColumns& columns) {
    ImGui::TableNextColumn();
    muteButton(editor, emitter, side);
    ImGui::TableNextColumn();
    soloButton(editor, emitter, side);
    if (columns.exposure) {
        ImGui::TableNextColumn();
        ImGui::SetNextItemWidth(-FLT_MIN);
        stopsControl(editor, emitter, "##stops");
    }
    if (columns.colour) {
        ImGui::TableNextColumn();
        colourControl(editor, emitter, "##colour", side);
    }
    if (columns.kelvin) {
        ImGui::TableNextColumn();
        ImGui::SetNextItemWidth(-FLT_MIN);
        kelvinControl(editor, emitter, "##kelvin");
    }
    if (columns.power) {
        ImGui::TableNextColumn();
        ImGui::AlignTextToFramePadding();
        text(number(double(powerOf(editor, emitter))));
        tooltip(
            "All light it sends out: its radiance times its area, in image units times square metres. A larger "
            "light of the same brightness sends more.");
    }
    if (columns.evidence) {
        ImGui::TableNextColumn();
        ImGui::AlignTextToFramePadding();
        evidenceCell(editor, emitter);
    }
}

}  // namespace

LightColumns::LightColumns(float room)
    : titles(room > em(19)),
      exposure(room > widthForExposures()),
      colour(room > em(16)),
      kelvin(room > em(26)),
      power(room > em(31)),
      evidence(room > em(38)) {}

void LightColumns::setUp(const char* first) const {
    const float side = ImGui::GetFrameHeight();
    ImGui::TableSetupColumn(first, ImGuiTableColumnFlags_WidthStretch, 1);
    ImGui::TableSetupColumn("On", ImGuiTableColumnFlags_WidthFixed, side);
    ImGui::TableSetupColumn("Solo", ImGuiTableColumnFlags_WidthFixed, titles ? em(2) : side);
    if (exposure) ImGui::TableSetupColumn("Exposure", ImGuiTableColumnFlags_WidthFixed, em(4.2f));
    if (colour) ImGui::TableSetupColumn("Colour", ImGuiTableColumnFlags_WidthFixed, titles ? em(2.9f) : side);
    if (kelvin) ImGui::TableSetupColumn("Kelvin", ImGuiTableColumnFlags_WidthFixed, em(5.2f));
    if (power) ImGui::TableSetupColumn("Power", ImGuiTableColumnFlags_WidthFixed, em(4));
    if (evidence) ImGui::TableSetupColumn("Evidence", ImGuiTableColumnFlags_WidthStretch, 1.6f);
}

float widthForExposures() { return em(13.5f); }

void drawEmittersPanel(Editor& editor) {
    // A copy, because a click may change the look, and with it the list.
    const std::vector<EmitterState> emitters = editor.emitters();
    if (emitters.empty()) {
        dimWrapped(
            !editor.state.document.capture ? (editor.job() ? "" : "Nothing is open.")
            : !editor.estimate()
                ? "Lights in the scene appear here after the estimate."
                : "No surface of this scene shines on its own; all light comes from far away. You can add lights.");
        addEmitterButton(editor, ImGui::GetContentRegionAvail().x);
        return;
    }
    drawLightingStates(editor);
    const float room = ImGui::GetContentRegionAvail().x;
    const LightColumns columns(room);
    const float side = ImGui::GetFrameHeight();
    if (ImGui::BeginTable("##emitters", columns.count(),
                          ImGuiTableFlags_RowBg | ImGuiTableFlags_NoPadOuterX | ImGuiTableFlags_SizingFixedFit)) {
        columns.setUp("Light");
        // Without room for their titles the columns are explained by their hints, and the names stay readable.
        if (columns.titles) ImGui::TableHeadersRow();
        std::string menuOf;
        for (const EmitterState& emitter : emitters) {
            ImGui::PushID(emitter.id.c_str());
            ImGui::TableNextRow();
            ImGui::TableNextColumn();
            nameCell(editor, emitter, side, menuOf);
            valueCells(editor, emitter, side, columns);
            if (menuOf == emitter.id) {
                if (!editor.state.selection.has(emitter.id)) selectEmitter(editor, emitter.id, false, false);
                ImGui::OpenPopup("##menu");
            }
            if (ImGui::BeginPopup("##menu")) {
                emitterMenu(editor, emitter.id);
                ImGui::EndPopup();
            }
            ImGui::PopID();
        }
        ImGui::EndTable();
    }
    drawLightGroups(editor);
    addEmitterButton(editor);
    if (!editor.state.viewport.solo.empty()) {
        sameLineIfFits(buttonWidth("Show all"));
        if (button("Show all", "Ends solo: all lights are shown again")) editor.state.viewport.solo.clear();
    }
    if (editor.state.selection.emitters.size() > 1)
        dimWrapped(fmt::format("{} selected: an edit goes to all of them.", editor.state.selection.emitters.size()));
    if (editor.state.viewport.clickTask == ClickTask::newPart) dimWrapped(hintOf(ClickTask::newPart));
}

}  // namespace relamp::ui
