// Controls that edit the look: what is dragged is one gesture, and one entry of the history.
#include <imgui_internal.h>

#include <cmath>

#include "image/colour_temperature.h"
#include "image/image_io.h"
#include "note.h"
#include "temperature_tint.h"
#include "widgets.h"

namespace relamp::ui {
namespace {

/// The gesture that a control of a panel holds open.
struct Following {
    Editor* editor = nullptr;
    ImGuiID id = 0;
};
Following following;

/// What a number shows while it is dragged: the value under the hand, not what the look makes of it.
struct Held {
    ImGuiID id = 0;
    float value = 0;
};
Held held;

void drop() { following = {}; }

}  // namespace

bool chromaticityDisc(const char* id, Rgb& light, float diameter) {
    const ImVec2 at = ImGui::GetCursorScreenPos(), centre{at.x + diameter / 2, at.y + diameter / 2};
    const float radius = diameter / 2 - em(0.2f);
    ImGui::InvisibleButton(id, {diameter, diameter});
    bool changed = false;
    if (ImGui::IsItemActive() &&
        (ImGui::IsItemActivated() || ImGui::GetIO().MouseDelta.x != 0 || ImGui::GetIO().MouseDelta.y != 0)) {
        const ImVec2 mouse = ImGui::GetIO().MousePos;
        const float x = (mouse.x - centre.x) / radius, y = (mouse.y - centre.y) / radius;
        const float hue = std::atan2(y, x) / (2 * pi);
        Rgb display;
        ImGui::ColorConvertHSVtoRGB(hue < 0 ? hue + 1 : hue, std::min(1.0f, std::hypot(x, y)), 1, display.x, display.y,
                                    display.z);
        const Rgb linear(srgbDecode(display.x), srgbDecode(display.y), srgbDecode(display.z));
        const float brightness = luminance(light);
        light = linear * ((brightness > 0 ? brightness : 1) / luminance(linear));
        changed = true;
    }
    ImDrawList* list = ImGui::GetWindowDrawList();
    constexpr int sectors = 48, rings = 6;
    const ImVec2 white = ImGui::GetFontTexUvWhitePixel();
    for (int r = 0; r < rings; ++r)
        for (int s = 0; s < sectors; ++s) {
            list->PrimReserve(6, 4);
            const ImDrawIdx first = ImDrawIdx(list->_VtxCurrentIdx);
            for (const auto& [dr, ds] : {std::pair{0, 0}, {0, 1}, {1, 1}, {1, 0}}) {
                const float saturation = float(r + dr) / rings, hue = float(s + ds) / sectors, angle = 2 * pi * hue;
                ImVec4 c(0, 0, 0, ImGui::GetStyle().Alpha);
                ImGui::ColorConvertHSVtoRGB(hue, saturation, 1, c.x, c.y, c.z);
                list->PrimWriteVtx({centre.x + radius * saturation * std::cos(angle),
                                    centre.y + radius * saturation * std::sin(angle)},
                                   white, ImGui::ColorConvertFloat4ToU32(c));
            }
            for (const int k : {0, 1, 2, 0, 2, 3}) list->PrimWriteIdx(ImDrawIdx(first + k));
        }
    const ImVec4 now = lightColour(light);
    float hue = 0, saturation = 0, value = 0;
    ImGui::ColorConvertRGBtoHSV(now.x, now.y, now.z, hue, saturation, value);
    const ImVec2 mark{centre.x + radius * saturation * std::cos(2 * pi * hue),
                      centre.y + radius * saturation * std::sin(2 * pi * hue)};
    list->AddCircleFilled(mark, em(0.4f), ImGui::GetColorU32(now));
    list->AddCircle(mark, em(0.4f), IM_COL32(0, 0, 0, 255), 0, std::max(1.5f, em(0.1f)));
    list->AddCircle(mark, em(0.48f), IM_COL32(255, 255, 255, 255), 0, std::max(1.0f, em(0.06f)));
    return changed;
}

bool followGesture(Editor& editor, const std::string& label, bool changed, const std::function<void(Look&)>& change) {
    const ImGuiID id = ImGui::GetItemID();
    const bool active = ImGui::IsItemActive();
    const bool mine = following.editor == &editor && (following.id == id || id == 0);
    if (mine && !editor.inGesture()) {
        // Taken back from outside (Esc, undo): the control must not start again under the same press.
        drop();
        if (active) ImGui::ClearActiveID();
        return false;
    }
    if (mine && active && escapePressed()) {
        takeEscape();
        editor.abandonGesture();
        drop();
        held = {};
        ImGui::ClearActiveID();
        return false;
    }
    if (changed) {
        if (!mine) {
            if (editor.inGesture()) editor.commitGesture();
            editor.beginGesture(label);
            following = {&editor, id};
        }
        editor.preview(change);
    }
    if (following.editor == &editor && following.id == id && !ImGui::IsItemActive() &&
        (changed || ImGui::IsItemDeactivated())) {
        editor.commitGesture();
        drop();
    }
    return changed;
}

void settleGestures(Editor& editor) {
    if (following.editor != &editor) return;
    if (!editor.inGesture()) drop();
    else if (!ImGui::IsAnyItemActive()) {
        editor.commitGesture();
        drop();
    }
}

bool dragLook(Editor& editor, const char* id, const std::string& label, float value, const DragRange& range,
              const std::string& explanation, const std::function<void(Look&, float)>& apply) {
    const ImGuiID key = ImGui::GetID(id);
    float now = held.id == key && ImGui::GetActiveID() == key ? held.value : value;
    ImGuiSliderFlags flags = range.logarithmic ? ImGuiSliderFlags_Logarithmic : 0;
    if (range.least != range.most) flags |= ImGuiSliderFlags_AlwaysClamp;
    bool changed = false;
    float speed = range.speed;
    if (const FineDrag fine(speed); range.offset == 0 && range.unit == 1) {
        changed = ImGui::DragFloat(id, &now, speed, range.least, range.most, range.format, flags);
    } else {
        const auto toShown = [&](double v) { return (v + range.offset) / range.unit; };
        double wide = toShown(now);
        const double least = toShown(range.least), most = toShown(range.most);
        const bool bounded = range.least != range.most;
        changed = ImGui::DragScalar(id, ImGuiDataType_Double, &wide, float(speed / range.unit),
                                    bounded ? &least : nullptr, bounded ? &most : nullptr, range.format, flags);
        if (changed) now = float(wide * range.unit - range.offset);
    }
    changed = changed && std::isfinite(now);
    if (ImGui::IsItemActive()) held = {key, now};
    note(label.c_str());
    const bool edited = followGesture(editor, label, changed, [&](Look& look) { apply(look, now); });
    if (!explanation.empty())
        tooltip(explanation + "\nDrag sideways, or double click to type. Shift is finer, Esc takes it back.");
    return edited;
}

bool kelvinLook(Editor& editor, const char* id, const std::string& label, const Rgb& colour,
                const std::string& explanation, const std::function<void(Look&, const Rgb&)>& apply) {
    const TemperatureTint now = splitColour(colour);
    return dragLook(editor, id, label, now.kelvin,
                    {std::max(2.0f, now.kelvin / 250), lowestKelvin, highestKelvin, "%.0f K"}, explanation,
                    [&, tint = now.tint](Look& look, float kelvin) {
                        apply(look, joinColour({kelvin, tint}));
                    });
}

bool tintLook(Editor& editor, const char* id, const std::string& label, const Rgb& colour,
              const std::string& explanation, const std::function<void(Look&, const Rgb&)>& apply) {
    const TemperatureTint now = splitColour(colour);
    return dragLook(editor, id, label, now.tint, {0.005f, -3, 3, "%+.2f"}, explanation,
                    [&, kelvin = now.kelvin](Look& look, float tint) {
                        apply(look, joinColour({kelvin, tint}));
                    });
}

namespace {

/// Red, green and blue, hue and saturation, and hexadecimal, of the colour at its brightest. True while it changes.
bool colourNumbers(Editor& editor, const std::string& label, const Rgb& light,
                   const std::function<void(Look&, const Rgb&)>& apply) {
    bool edited = false;
    constexpr ImGuiColorEditFlags plain = ImGuiColorEditFlags_NoSmallPreview | ImGuiColorEditFlags_NoPicker |
                                          ImGuiColorEditFlags_NoOptions | ImGuiColorEditFlags_NoLabel |
                                          ImGuiColorEditFlags_NoDragDrop;
    const struct {
        const char* id;
        ImGuiColorEditFlags flags;
        const char* explanation;
    } rows[] = {{"##rgb", ImGuiColorEditFlags_DisplayRGB, "Red, green, blue as on screen, at full brightness"},
                {"##hsv", ImGuiColorEditFlags_DisplayHSV, "Hue, saturation, and the value that is always full"},
                {"##hex", ImGuiColorEditFlags_DisplayHex, "Hexadecimal, as in other programs: #FFC58F"}};
    for (const auto& row : rows) {
        const ImVec4 shown = lightColour(light);
        float values[3] = {shown.x, shown.y, shown.z};
        ImGui::SetNextItemWidth(em(11));
        const bool changed = ImGui::ColorEdit3(row.id, values, plain | row.flags | ImGuiColorEditFlags_Uint8);
        const Rgb linear(srgbDecode(values[0]), srgbDecode(values[1]), srgbDecode(values[2]));
        const bool usable = changed && luminance(linear) > 1e-6f;
        edited |= followGesture(editor, label, usable, [&](Look& look) {
            apply(look, linear * (std::max(luminance(light), 1e-12f) / luminance(linear)));
        });
        tooltip(row.explanation);
    }
    return edited;
}

}  // namespace

bool colourLook(Editor& editor, const char* id, const std::string& label, const Rgb& light, float size,
                const std::string& explanation, const std::function<void(Look&, const Rgb&)>& apply,
                const std::function<void()>& fromImage) {
    ImGui::PushID(id);
    if (swatch("##swatch", lightColour(light), size, explanation)) ImGui::OpenPopup("##colour");
    bool changed = false;
    if (ImGui::BeginPopup("##colour")) {
        dimText(label);
        Rgb now = light;
        const bool dragged = chromaticityDisc("##disc", now, em(11));
        changed |= followGesture(editor, label, dragged, [&](Look& look) { apply(look, now); });
        tooltip("Colour of the light: hue around, stronger outwards, white in the middle. Its brightness stays.");
        const auto keeping = [&](Look& look, const Rgb& tint) {
            apply(look, tint * std::max(luminance(light), 1e-12f));
        };
        ImGui::SetNextItemWidth(em(7));
        changed |=
            kelvinLook(editor, "##kelvin", label, light,
                       "Temperature: 2700 K is a warm bulb, 6504 K is white, more is bluish. The tint stays.", keeping);
        ImGui::SameLine();
        ImGui::SetNextItemWidth(em(4) - ImGui::GetStyle().ItemSpacing.x);
        changed |= tintLook(editor, "##tint", label, light,
                            "Tint: above 0 greener, below 0 more magenta. The temperature stays.", keeping);
        changed |= colourNumbers(editor, label, light, apply);
        if (button("White", "Makes the light white, as bright as it is"))
            editor.edit(label, [&](Look& look) { apply(look, Rgb(luminance(light))); });
        if (fromImage) {
            ImGui::SameLine();
            if (button("From the image", "Then click where the colour is seen. The brightness stays.")) {
                fromImage();
                ImGui::CloseCurrentPopup();
            }
        }
        ImGui::EndPopup();
    }
    ImGui::PopID();
    return changed;
}

}  // namespace relamp::ui
