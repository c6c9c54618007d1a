#include "panels/value_key_menu.h"

#include <imgui_internal.h>

#include "item_map.h"
#include "widgets.h"

namespace relamp::ui {
namespace {

void mark(bool here) {
    const ImVec2 high = ImGui::GetItemRectMax(), low = ImGui::GetItemRectMin();
    const float r = em(0.26f), x = high.x - r - em(0.1f), y = low.y + r + em(0.1f);
    ImDrawList* list = ImGui::GetWindowDrawList();
    const ImU32 colour = here ? IM_COL32(255, 170, 70, 255) : IM_COL32(110, 160, 230, 255);
    list->AddQuadFilled({x - r, y}, {x, y - r}, {x + r, y}, {x, y + r}, colour);
    list->AddRect(low, high, (colour & ~IM_COL32_A_MASK) | (IM_COL32_A_MASK / 255 * 110),
                  ImGui::GetStyle().FrameRounding);
}

void item(const char* label, bool enabled, const char* explanation, const std::function<void()>& act) {
    if (ImGui::MenuItem(label, nullptr, false, enabled)) act();
    noteItem(std::string("value ") + label);
    tooltip(explanation);
}

}  // namespace

std::vector<KeyedOf> valuesOf(KeyedValue value, const std::vector<std::string>& ids) {
    std::vector<KeyedOf> values;
    for (const std::string& id : ids) values.push_back({value, id});
    return values;
}

std::vector<KeyedOf> powersOf(const Editor& editor, const std::vector<std::string>& ids) {
    std::vector<KeyedOf> values;
    for (const std::string& id : ids) {
        const EmitterState* emitter = editor.emitter(id);
        values.push_back({emitter && !emitter->recovered ? KeyedValue::radiance : KeyedValue::powerScale, id});
    }
    return values;
}

std::string nameOfValues(const Editor& editor, const std::vector<KeyedOf>& values) {
    if (values.empty()) return {};
    const KeyedValueInfo& info = infoOf(values.front().value);
    if (values.front().value == KeyedValue::neutral) return info.label;
    if (!info.ofLight())
        return fmt::format("{} of {}", info.label,
                           info.owner == KeyedValueInfo::Owner::group ? values.front().of : "the environment");
    std::vector<std::string> ids;
    for (const KeyedOf& value : values) ids.push_back(value.of);
    return fmt::format("{} of {}", info.label, editor.namesOf(ids));
}

void valueKeyMenu(Editor& editor, const std::vector<KeyedOf>& values) {
    if (values.empty() || !editor.estimate()) return;
    const int frame = editor.state.time.frame;
    const ValueCurve* curve = curveOf(editor.look(), values.front());
    const bool here = curve && valueKeyAt(*curve, frame);
    if (curve) mark(here);
    ImGui::PushID(int(ImGui::GetItemID()));
    if (ImGui::IsItemHovered() && ImGui::IsMouseReleased(ImGuiMouseButton_Right)) ImGui::OpenPopup("##value keys");
    if (ImGui::BeginPopup("##value keys")) {
        dimText(nameOfValues(editor, values));
        item("Set key", true,
             "Keeps this value for the present frame. From then on a change of it sets a key, and the rest of the look "
             "stays without.",
             [&] { editor.setValueKeys(values); });
        item("Delete key", here, "Forgets the key of the present frame",
             [&] { editor.deleteValueKeys(values, frame); });
        item("Previous key", curve && curve->keys.front().frame < frame, "Goes to the key before the present frame",
             [&] { editor.goToValueKey(values.front(), -1); });
        item("Next key", curve && curve->keys.back().frame > frame, "Goes to the key after the present frame",
             [&] { editor.goToValueKey(values.front(), 1); });
        item("Delete all its keys", curve != nullptr, "The value stays as it is now, in every frame",
             [&] { editor.deleteValueKeys(values, -1); });
        ImGui::Separator();
        item("Show curves", true, "Value against frame, in the panel Frames", [&] {
            editor.state.time.curves = true;
            editor.state.panels.bottomTab = framesTab;
            editor.state.panels.bottomFolded = false;
        });
        ImGui::EndPopup();
    }
    ImGui::PopID();
}

}  // namespace relamp::ui
