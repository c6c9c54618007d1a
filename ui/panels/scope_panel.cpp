// Waveform and histogram of the image in the viewport.
#include "display/scope.h"
#include "panels/panels.h"
#include "widgets.h"

namespace relamp::ui {
namespace {

/// Brightness of a count on the graticule: faint traces stay visible beside large areas.
int glow(uint32_t count, uint32_t most) {
    return count == 0 ? 0 : int(40 + 215 * std::sqrt(std::min(1.0, double(count) / double(std::max(1u, most)))));
}

/// Lines at 0, 25, 50, 75 and 100 % of the display's range, with their names.
void graticule(const ImVec2& low, const ImVec2& high) {
    ImDrawList* list = ImGui::GetWindowDrawList();
    for (int quarter = 0; quarter <= 4; ++quarter) {
        const float y = std::floor(high.y - (high.y - low.y - 1) * float(quarter) / 4) - 0.5f;
        list->AddLine({low.x, y}, {high.x, y}, IM_COL32(255, 255, 255, quarter % 4 ? 22 : 60));
        if (quarter > 0 && quarter < 4)
            list->AddText({low.x + 3, y - ImGui::GetTextLineHeight()}, IM_COL32(255, 255, 255, 90),
                          fmt::format("{} %", 25 * quarter).c_str());
    }
}

void waveform(const Scope& scope, const ImVec2& low, const ImVec2& high) {
    graticule(low, high);
    ImDrawList* list = ImGui::GetWindowDrawList();
    const float wide = (high.x - low.x) / Scope::columns, tall = (high.y - low.y) / Scope::levels;
    const uint32_t most = scope.pixels / Scope::columns / 12;
    for (size_t column = 0; column < Scope::columns; ++column)
        for (size_t level = 0; level < Scope::levels; ++level) {
            const auto of = [&](size_t channel) { return glow(scope.waveform[channel][column][level], most); };
            const int red = of(0), green = of(1), blue = of(2);
            if (red + green + blue == 0) continue;
            const ImVec2 at(low.x + wide * float(column), high.y - tall * float(level + 1));
            list->AddRectFilled(at, {at.x + wide, at.y + tall}, IM_COL32(red, green, blue, 255));
        }
}

void histogram(const Scope& scope, const ImVec2& low, const ImVec2& high) {
    ImDrawList* list = ImGui::GetWindowDrawList();
    uint32_t most = 1;
    for (const Scope::Levels& channel : scope.histogram)
        for (size_t level = 1; level + 1 < Scope::levels; ++level) most = std::max(most, channel[level]);
    const float wide = (high.x - low.x) / Scope::levels;
    for (size_t level = 0; level < Scope::levels; ++level)
        for (size_t channel = 0; channel < 3; ++channel) {
            const float part = std::min(1.0f, float(scope.histogram[channel][level]) / float(most));
            const float y = high.y - std::sqrt(part) * (high.y - low.y);
            list->AddRectFilled({low.x + wide * float(level), y}, {low.x + wide * float(level + 1), high.y},
                                IM_COL32(channel == 0 ? 220 : 0, channel == 1 ? 200 : 0, channel == 2 ? 255 : 0, 110));
        }
}

}  // namespace

void drawScopePanel(Editor& editor) {
    const std::shared_ptr<const Scope> scope = editor.state.scope;
    if (!scope || scope->pixels == 0) return dimWrapped("Open a capture: the image's brightness is shown here.");
    dimText(
        fmt::format("Clipped: {:.1f} % bright, {:.1f} % dark", 100 * scope->clippedBright, 100 * scope->clippedDark));
    tooltip("Pixels with a channel at its upper or lower end. The empty background does not count.");
    const ImVec2 room = ImGui::GetContentRegionAvail();
    if (room.x < em(8) || room.y < em(3)) return;
    const float gap = ImGui::GetStyle().ItemSpacing.x, left = std::floor(0.66f * (room.x - gap));
    const struct {
        const char* id;
        float width;
        void (*draw)(const Scope&, const ImVec2&, const ImVec2&);
        const char* explanation;
    } parts[] = {{"##waveform", left, waveform,
                  "Waveform: from left to right as the image, upwards from black to the brightest the screen can show"},
                 {"##histogram", room.x - gap - left, histogram,
                  "Histogram: how much of the image has each brightness, red, green and blue, dark at the left"}};
    for (const auto& part : parts) {
        if (&part != parts) ImGui::SameLine();
        const ImVec2 low = ImGui::GetCursorScreenPos(), high(low.x + part.width, low.y + room.y);
        ImGui::InvisibleButton(part.id, {part.width, room.y});
        tooltip(part.explanation);
        ImGui::GetWindowDrawList()->AddRectFilled(low, high, IM_COL32(14, 14, 14, 255));
        part.draw(*scope, low, high);
    }
}

}  // namespace relamp::ui
