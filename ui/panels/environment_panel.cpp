// Light from far away: as recovered, none, or an image; turned, brightened and tinted.
#include <cmath>

#include "item_map.h"
#include "panels/dialogs.h"
#include "panels/images.h"
#include "panels/panels.h"
#include "panels/value_key_menu.h"
#include "widgets.h"

namespace relamp::ui {
namespace {
using Source = EnvironmentLook::Source;

float wrapDegrees(float degrees) { return degrees - 360 * std::floor((degrees + 180) / 360); }

/// A panorama that is turned by dragging it sideways. `yaw` < 0: not turnable.
void panorama(Editor& editor, const char* id, const EnvironmentImage& image, const std::string& missing, float width,
              bool used, const std::string& explanation) {
    const float height = width / 2, yaw = used ? editor.look().environment.yawDegrees : 0;
    const ImVec2 at = ImGui::GetCursorScreenPos(), end{at.x + width, at.y + height};
    static float dragStart = 0;
    ImGui::InvisibleButton(id, {width, height});
    noteItem(std::string("panorama ") + (id + 2));
    if (ImGui::IsItemActivated()) dragStart = yaw;
    const float moved = ImGui::GetMouseDragDelta(ImGuiMouseButton_Left, 2).x;
    if (used) {
        const bool changed = ImGui::IsItemActive() && ImGui::GetIO().MouseDelta.x != 0 && moved != 0;
        // The image follows the hand: to the right is a negative yaw, because going right runs from +Y to -Y.
        const float turned = wrapDegrees(dragStart - 360 * moved / width);
        followGesture(editor, "Rotate the environment", changed,
                      [&](Look& look) { look.environment.yawDegrees = turned; });
        if (ImGui::IsItemHovered() || ImGui::IsItemActive()) ImGui::SetMouseCursor(ImGuiMouseCursor_ResizeEW);
    }
    ImDrawList* list = ImGui::GetWindowDrawList();
    if (image.texture) {
        const float shift = wrapDegrees(yaw) / 360;  // of the width, to the left
        const float split = shift > 0 ? 1 - shift : -shift;
        const ImU32 tone = ImGui::GetColorU32(ImVec4(1, 1, 1, used ? 1.0f : 0.4f));
        const float u = shift > 0 ? shift : 1 + shift;  // what stands at the left edge
        list->AddImage(textureId(image.texture), at, {at.x + width * split, end.y}, {shift == 0 ? 1 : u, 0}, {1, 1},
                       tone);
        list->AddImage(textureId(image.texture), {at.x + width * split, at.y}, end, {0, 0}, {shift == 0 ? 1 : u, 1},
                       tone);
    } else {
        list->AddRectFilled(at, end, ImGui::GetColorU32(ImVec4(0.22f, 0.22f, 0.22f, 1)));
        const std::string words = elided(image.loading ? "reading..." : missing, width - em(0.4f));
        const ImVec2 size = ImGui::CalcTextSize(words.c_str());
        list->AddText({at.x + (width - size.x) / 2, at.y + (height - size.y) / 2},
                      ImGui::GetColorU32(ImGuiCol_TextDisabled), words.c_str());
    }
    if (used) list->AddRect(at, end, ImGui::GetColorU32(accentColour), 0, 0, std::max(1.0f, em(0.1f)));
    tooltip(explanation);
}

/// A small arrow back, when there is something to take back.
void resetIcon(Editor& editor, const char* id, bool changed, const char* label,
               const std::function<void(Look&)>& change) {
    ImGui::SameLine();
    ImGui::BeginDisabled(!changed);
    if (iconButton(id, Icon::reset, changed ? "Back to how it was recovered" : "As recovered"))
        editor.edit(label, change);
    ImGui::EndDisabled();
}

}  // namespace

void drawEnvironmentPanel(Editor& editor) {
    const auto estimate = editor.estimate();
    ImGui::BeginDisabled(!estimate);
    const EnvironmentLook environment = editor.look().environment;
    if (radio("Recovered", environment.source == Source::recovered,
              "The light from far away that was found in the photographs"))
        editor.edit("Recovered environment", [](Look& look) { look.environment.source = Source::recovered; });
    sameLineIfFits(em(4));
    if (radio("None", environment.source == Source::none, "No light from far away: only the lights shine"))
        editor.edit("No environment", [](Look& look) { look.environment.source = Source::none; });
    sameLineIfFits(em(4));
    if (radio("File", environment.source == Source::file,
              "A panorama of your own: a latitude-longitude image, twice as wide as high")) {
        if (environment.file.empty()) editor.state.panels.environmentBrowser = true;
        else editor.openEnvironment(environment.file);
    }
    const float room = ImGui::GetContentRegionAvail().x, spacing = ImGui::GetStyle().ItemSpacing.x;
    const bool beside = room > em(13);
    const float width = std::floor(beside ? (room - spacing) / 2 : room);
    const std::string turn = "\nDrag it sideways to turn it.";
    ImGui::BeginGroup();
    panorama(editor, "##recovered", recoveredEnvironmentImage(estimate, environment),
             estimate ? "recovered" : "not estimated", width, environment.source == Source::recovered,
             "The recovered environment. The middle looks along +X, the top is up." +
                 (environment.source == Source::recovered ? turn : ""));
    dimText(environment.mixState.empty() && environment.state.empty() ? "Recovered"
            : environment.mixState.empty()                            ? elided(shown(environment.state), width)
                                                                      : "Recovered, mixed");
    ImGui::EndGroup();
    if (beside) ImGui::SameLine();
    ImGui::BeginGroup();
    const EnvironmentImage file = environmentImage(environment.file);
    panorama(editor, "##file", file, environment.file.empty() ? "no file" : "cannot be shown", width,
             environment.source == Source::file,
             environment.file.empty() ? "Your own environment appears here"
                                      : shown(environment.file) + (file.error.empty() ? "" : "\n" + file.error) +
                                            (environment.source == Source::file ? turn : ""));
    dimText(environment.file.empty() ? "Replacement" : elided(shown(environment.file.filename()), width));
    ImGui::EndGroup();
    if (!file.error.empty()) warningText(file.error);
    if (button("Load HDRI...", "Chooses a panorama (EXR or HDR). You can also drop one on the window.",
               beside ? 0 : -FLT_MIN))
        editor.state.panels.environmentBrowser = true;

    if (!editor.state.recentEnvironments.empty()) {
        const float small = em(4.2f);
        std::filesystem::path chosen;
        int index = 0;
        for (const std::filesystem::path& recent : editor.state.recentEnvironments) {
            ImGui::PushID(index);
            if (index > 0) sameLineIfFits(small);
            const EnvironmentImage tiny = environmentImage(recent);
            if (image("##recent", tiny.texture, small, small / 2, tiny.loading ? "..." : shown(recent.filename()),
                      recent == environment.file && environment.source == Source::file))
                chosen = recent;
            tooltip(shown(recent) + (tiny.error.empty() ? "" : "\n" + tiny.error));
            ImGui::PopID();
            if (++index == 8) break;
        }
        if (!chosen.empty()) editor.openEnvironment(chosen);
    }

    ImGui::BeginDisabled(environment.source == Source::none);
    const float label = em(6.2f), icon = ImGui::GetFrameHeight() + spacing;
    const auto row = [&](const char* name) {
        ImGui::AlignTextToFramePadding();
        dimText(name);
        ImGui::SameLine(label);
        ImGui::SetNextItemWidth(std::max(em(3), ImGui::GetContentRegionAvail().x - icon));
    };
    const std::string hint = keysHint;
    row("Rotate");
    dragLook(editor, "##yaw", "Rotate the environment", environment.yawDegrees, {0.5f, 0, 0, "%.1f\u00b0"},
             "Turns the environment about the vertical axis, counter-clockwise seen from above." + hint,
             [](Look& look, float value) { look.environment.yawDegrees = wrapDegrees(value); });
    valueKeyMenu(editor, {{KeyedValue::yaw, {}}});
    resetIcon(editor, "##reset yaw", environment.yawDegrees != 0, "Reset the environment's rotation",
              [](Look& look) { look.environment.yawDegrees = 0; });
    row("Exposure");
    dragLook(editor, "##stops", "Exposure of the environment", environment.exposureStops,
             {0.02f, -20, 20, "%+.2f stops"},
             "Exposure of the environment in stops: +1 is twice as bright, -1 half. The lights stay." + hint,
             [](Look& look, float value) { look.environment.exposureStops = value; });
    valueKeyMenu(editor, {{KeyedValue::exposure, {}}});
    resetIcon(editor, "##reset stops", environment.exposureStops != 0, "Reset the environment's exposure",
              [](Look& look) { look.environment.exposureStops = 0; });
    row("White");
    const float whiteRoom = ImGui::GetContentRegionAvail().x - icon - ImGui::GetFrameHeight() - spacing;
    ImGui::SetNextItemWidth(std::max(em(3), whiteRoom));
    const auto tinted = [](Look& look, const Rgb& colour) {
        look.environment.tint =
            colour / std::max(luminance(colour), 1e-12f) * std::max(luminance(look.environment.tint), 1e-12f);
    };
    kelvinLook(
        editor, "##kelvin", "White balance of the environment", environment.tint,
        "Tints the environment: 6504 K leaves it as it is, less is warmer, more is bluer. Its brightness stays." + hint,
        tinted);
    valueKeyMenu(editor, {{KeyedValue::tint, {}}});
    ImGui::SameLine();
    colourLook(editor, "##tint", "Tint of the environment", environment.tint, ImGui::GetFrameHeight(),
               "Any other tint of the environment. Its brightness stays.", tinted);
    resetIcon(editor, "##reset tint", environment.tint != Rgb(1), "Reset the environment's tint",
              [](Look& look) { look.environment.tint = Rgb(1); });
    ImGui::EndDisabled();
    ImGui::BeginDisabled(environment == EnvironmentLook{});
    if (button("Reset all", "The recovered environment, not turned, as bright and as coloured as it was found",
               -FLT_MIN))
        editor.edit("Reset the environment", [](Look& look) { look.environment = {}; });
    ImGui::EndDisabled();
    ImGui::EndDisabled();
}

}  // namespace relamp::ui
