#include "widgets.h"

#include <imgui_internal.h>
#include <imgui_stdlib.h>

#include <cmath>
#include <utility>

#include "base/significant.h"
#include "image/image_io.h"
#include "item_map.h"
#include "keys.h"
#include "note.h"

namespace relamp::ui {
namespace {

struct Hover {
    ImGuiID id = 0;
    double since = 0;
    bool seen = false;  ///< in this frame
};
Hover hover;
bool awake = false, awakeLast = false, escapeTaken = false, escapeOfMenu = false;

constexpr double tooltipDelay = 0.45;

ImU32 colourOf(ImGuiCol which) { return ImGui::GetColorU32(which); }

}  // namespace

void note(const char* label) {
    if (!itemMapOn()) return;
    const std::string name(label, ImGui::FindRenderedTextEnd(label));
    noteItem(name.empty() ? label : name);
}

// ---- versions

bool beginChild(const char* id, const ImVec2& size, bool border, ImGuiWindowFlags flags) {
#if IMGUI_VERSION_NUM >= 19000
    return ImGui::BeginChild(id, size, border ? ImGuiChildFlags(1) : ImGuiChildFlags(0), flags);
#else
    return ImGui::BeginChild(id, size, border, flags);
#endif
}

ImTextureID textureId(uint64_t texture) { return (ImTextureID)(uintptr_t)texture; }

bool keyPressed(ImGuiKey key, bool repeat) {
#if IMGUI_VERSION_NUM >= 18700
    return ImGui::IsKeyPressed(key, repeat);
#else
    const int index = ImGui::GetKeyIndex(key);
    return index >= 0 && ImGui::IsKeyPressed(index, repeat);
#endif
}

bool escapePressed() { return !escapeTaken && (input().pressed == keyEscape || keyPressed(ImGuiKey_Escape)); }
void takeEscape() { escapeTaken = true; }
void menuTookEscape() { escapeOfMenu = true; }
bool enterPressed() {
    return input().pressed == keyEnter || input().pressed == keyPadEnter || keyPressed(ImGuiKey_Enter);
}

bool inputText(const char* label, std::string& value, const char* hint, ImGuiInputTextFlags flags) {
    const bool changed = ImGui::InputTextWithHint(label, hint, &value, flags);
    note(label);
    return changed;
}

// ---- text

float em(float n) { return n * ImGui::GetFontSize(); }

std::string shown(const std::string& bytes) {
    std::string out;
    for (size_t i = 0; i < bytes.size();) {
        const unsigned char c = static_cast<unsigned char>(bytes[i]);
        const size_t length = c < 0x80                ? 1
                              : c >= 0xC2 && c < 0xE0 ? 2
                              : c >= 0xE0 && c < 0xF0 ? 3
                              : c >= 0xF0 && c < 0xF5 ? 4
                                                      : 0;
        bool good = length > 0 && i + length <= bytes.size() && c >= 0x20 && c != 0x7f;
        for (size_t k = 1; good && k < length; ++k) good = (static_cast<unsigned char>(bytes[i + k]) & 0xC0) == 0x80;
        if (good) out.append(bytes, i, length);
        else out += '?';
        i += good ? length : 1;
    }
    return out;
}

std::string shown(const std::filesystem::path& path) { return shown(path.string()); }

std::string elided(const std::string& full, float width, bool middle) {
    const auto widthOf = [](const std::string& s) { return ImGui::CalcTextSize(s.c_str(), s.c_str() + s.size()).x; };
    if (widthOf(full) <= width) return full;
    const auto isStart = [&](size_t i) {
        return i >= full.size() || (static_cast<unsigned char>(full[i]) & 0xC0) != 0x80;
    };
    const auto cut = [&](size_t keep) {
        size_t head = middle ? (keep + 1) / 2 : keep, tail = full.size() - (middle ? keep / 2 : 0);
        while (head > 0 && !isStart(head)) --head;
        while (tail < full.size() && !isStart(tail)) ++tail;
        return full.substr(0, head) + "..." + full.substr(tail);
    };
    size_t low = 0, high = full.size();
    while (low < high) {
        const size_t keep = (low + high + 1) / 2;
        if (widthOf(cut(keep)) <= width) low = keep;
        else high = keep - 1;
    }
    return cut(low);
}

void text(const std::string& value) { ImGui::TextUnformatted(value.c_str(), value.c_str() + value.size()); }

void dimText(const std::string& value) {
    ImGui::PushStyleColor(ImGuiCol_Text, dimColour);
    text(value);
    ImGui::PopStyleColor();
}

void wrapped(const std::string& value) {
    ImGui::PushTextWrapPos(0);
    text(value);
    ImGui::PopTextWrapPos();
}

void dimWrapped(const std::string& value) {
    ImGui::PushStyleColor(ImGuiCol_Text, dimColour);
    wrapped(value);
    ImGui::PopStyleColor();
}

void warningText(const std::string& value) {
    iconText(Icon::warning, warningColour);
    ImGui::SameLine(0, em(0.35f));
    ImGui::PushStyleColor(ImGuiCol_Text, warningColour);
    wrapped(value);
    ImGui::PopStyleColor();
}

void fact(const std::string& name, const std::string& value, const std::string& explanation) {
    ImGui::BeginGroup();
    const float left = ImGui::GetCursorPosX(), column = std::min(em(8), 0.44f * ImGui::GetContentRegionAvail().x);
    dimText(name);
    ImGui::SameLine(0, 0);
    ImGui::SetCursorPosX(std::max(left + column, ImGui::GetCursorPosX() + em(0.6f)));
    wrapped(value);
    ImGui::EndGroup();
    if (!explanation.empty()) tooltip(explanation);
}

namespace {
struct HintPlace {
    ImVec2 at;
    float wrap;  ///< width of its lines
};

/// Where nothing is covered that belongs to the same list of controls: beside a column, a menu or a dialog, in shorter
/// lines where there is less room, else above or below a row.
HintPlace hintPlace(const std::string& explanation) {
    const ImVec2 screen = ImGui::GetIO().DisplaySize, low = ImGui::GetItemRectMin(), high = ImGui::GetItemRectMax();
    const ImGuiWindow* around = ImGui::GetCurrentWindow()->RootWindow;
    const float gap = em(0.3f), left = around->Pos.x, right = around->Pos.x + around->Size.x, full = em(26);
    const auto sizeAt = [&](float wrap) {
        const ImVec2 words = ImGui::CalcTextSize(explanation.c_str(), nullptr, false, wrap);
        return ImVec2(words.x + em(1.2f), words.y + em(0.9f));
    };
    const auto inside = [](float at, float length, float all) { return std::max(0.0f, std::min(at, all - length)); };
    if (around->Size.x < 0.6f * screen.x && around->Size.y > 2 * (high.y - low.y)) {
        const float roomRight = screen.x - right - gap, roomLeft = left - gap;
        for (const float wrap : {full, std::max(roomRight, roomLeft) - em(1.3f)}) {
            if (wrap < em(10)) break;
            const ImVec2 size = sizeAt(std::min(wrap, full));
            const float y = inside(low.y, size.y, screen.y);
            if (size.x <= roomRight) return {{right + gap, y}, std::min(wrap, full)};
            if (size.x <= roomLeft) return {{left - gap - size.x, y}, std::min(wrap, full)};
        }
    }
    const ImVec2 size = sizeAt(full);
    const bool below = low.y < 0.5f * screen.y && high.y + gap + size.y <= screen.y;
    return {{inside(low.x, size.x, screen.x), below ? high.y + gap : std::max(0.0f, low.y - gap - size.y)}, full};
}
}  // namespace

void tooltip(const std::string& explanation) {
    // No hint while the item is dragged or typed into.
    if (explanation.empty() || ImGui::IsItemActive() ||
        !ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled | ImGuiHoveredFlags_AllowWhenOverlapped))
        return;
    const ImVec2 at = ImGui::GetItemRectMin();
    const float where[2] = {at.x, at.y};
    const ImGuiID id = ImHashData(where, sizeof where, ImGui::GetCurrentWindow()->ID);
    hover.seen = true;
    if (id != hover.id) hover = {id, ImGui::GetTime(), true};
    if (ImGui::GetTime() - hover.since < tooltipDelay) {
        stayAwake();
        return;
    }
    if (ImGui::IsMouseDown(ImGuiMouseButton_Left) || ImGui::IsMouseDown(ImGuiMouseButton_Right)) return;
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {em(0.6f), em(0.45f)});
    ImGui::PushStyleVar(ImGuiStyleVar_Alpha, 1.0f);
    const HintPlace place = hintPlace(explanation);
    ImGui::SetNextWindowPos(place.at);
    ImGui::BeginTooltip();
    ImGui::PushTextWrapPos(ImGui::GetCursorPosX() + place.wrap);
    text(explanation);
    ImGui::PopTextWrapPos();
    ImGui::EndTooltip();
    ImGui::PopStyleVar(2);
}

std::string duration(double seconds) {
    if (!std::isfinite(seconds) || seconds < 0) return "-";
    if (seconds < 10 && seconds != std::floor(seconds)) return fmt::format("{:.1f} s", seconds);
    const long s = std::lround(std::min(seconds, 1e9));
    if (s < 60) return fmt::format("{} s", s);
    if (s < 3600) return s % 60 ? fmt::format("{} min {} s", s / 60, s % 60) : fmt::format("{} min", s / 60);
    return fmt::format("{} h {} min", s / 3600, s % 3600 / 60);
}

std::string timeLeftWords(const JobStatus& job) {
    if (job.stopping) return "stopping...";
    if (job.paused) return "paused";
    if (!job.secondsLeft) return duration(job.seconds);
    // Whole seconds; in steps of five once it is long.
    const double left = *job.secondsLeft;
    return left < 1 ? "finishing"
                    : "about " + duration(left < 20 ? std::ceil(left) : 5 * std::ceil(left / 5)) + " left";
}

FineDrag::FineDrag(float& speed) : shift_(ImGui::GetIO().KeyShift), alt_(ImGui::GetIO().KeyAlt) {
    if (shift_) speed *= 0.1f;
    ImGui::GetIO().KeyShift = ImGui::GetIO().KeyAlt = false;
}
FineDrag::~FineDrag() {
    ImGui::GetIO().KeyShift = shift_;
    ImGui::GetIO().KeyAlt = alt_;
}

std::string mebibytes(double mib) {
    return mib < 1024 ? fmt::format("{:.0f} MiB", mib) : fmt::format("{:.1f} GiB", mib / 1024);
}

std::string count(size_t n) {
    std::string digits = std::to_string(n), out;
    for (size_t i = 0; i < digits.size(); ++i) {
        if (i && (digits.size() - i) % 3 == 0) out += ' ';
        out += digits[i];
    }
    return out;
}

std::string percent(double fraction) {
    const double p = 100 * fraction;
    return p > 0 && p < 0.95 ? fmt::format("{:.1f} %", p) : fmt::format("{:.0f} %", p);
}

std::string signedStops(float stops) { return std::abs(stops) < 0.05f ? "0.0" : fmt::format("{:+.1f}", stops); }

std::string number(double value) { return std::abs(value) < 1e-12 ? "0" : significant(value, 3); }

// ---- layout

bool section(const char* title, const std::string& explanation, bool open) {
    // Grey: the accent is kept for what is selected.
    ImGui::PushStyleColor(ImGuiCol_Header, {0.225f, 0.225f, 0.225f, 1});
    ImGui::PushStyleColor(ImGuiCol_HeaderHovered, {0.275f, 0.275f, 0.275f, 1});
    ImGui::PushStyleColor(ImGuiCol_HeaderActive, {0.31f, 0.31f, 0.31f, 1});
    const bool result = ImGui::CollapsingHeader(title, open ? ImGuiTreeNodeFlags_DefaultOpen : 0);
    ImGui::PopStyleColor(3);
    note(title);
    tooltip(explanation);
    return result;
}

void heading(const std::string& title) {
    ImGui::Spacing();
    dimText(title);
    const ImVec2 from = ImGui::GetItemRectMin(), to = ImGui::GetItemRectMax();
    const float right = ImGui::GetCursorScreenPos().x + ImGui::GetContentRegionAvail().x,
                y = std::round((from.y + to.y) / 2);
    if (to.x + em(0.5f) < right)
        ImGui::GetWindowDrawList()->AddLine({to.x + em(0.5f), y}, {right, y}, colourOf(ImGuiCol_Separator));
}

void sameLineIfFits(float width) {
    const float right = ImGui::GetWindowPos().x + ImGui::GetWindowContentRegionMax().x;
    if (ImGui::GetItemRectMax().x + ImGui::GetStyle().ItemSpacing.x + width <= right) ImGui::SameLine();
}

float buttonWidth(const std::string& label) {
    return ImGui::CalcTextSize(label.c_str(), nullptr, true).x + 2 * ImGui::GetStyle().FramePadding.x;
}

bool splitter(const char* id, bool vertical, float length, float& value, float least, float most, float direction,
              float scale) {
    const float thickness = std::max(4.0f, 5 * scale);
    ImGui::InvisibleButton(id, vertical ? ImVec2(thickness, length) : ImVec2(length, thickness));
    const bool active = ImGui::IsItemActive(), hovered = ImGui::IsItemHovered();
    if (active || hovered) ImGui::SetMouseCursor(vertical ? ImGuiMouseCursor_ResizeEW : ImGuiMouseCursor_ResizeNS);
    if (active || hovered)
        ImGui::GetWindowDrawList()->AddRectFilled(
            ImGui::GetItemRectMin(), ImGui::GetItemRectMax(),
            colourOf(active ? ImGuiCol_SeparatorActive : ImGuiCol_SeparatorHovered));
    if (active) {
        const float moved = vertical ? ImGui::GetIO().MouseDelta.x : ImGui::GetIO().MouseDelta.y;
        value = std::clamp(value + direction * moved / scale, least, std::max(least, most));
    }
    tooltip("Drag to resize");
    return active;
}

// ---- controls

bool button(const char* label, const std::string& explanation, float width) {
    const bool pressed = ImGui::Button(label, {width, 0});
    note(label);
    tooltip(explanation);
    return pressed;
}

bool primaryButton(const char* label, const std::string& explanation, float width) {
    ImGui::PushStyleColor(ImGuiCol_Button, {0.26f, 0.41f, 0.58f, 1});
    ImGui::PushStyleColor(ImGuiCol_ButtonHovered, {0.31f, 0.48f, 0.67f, 1});
    ImGui::PushStyleColor(ImGuiCol_ButtonActive, {0.36f, 0.54f, 0.74f, 1});
    ImGui::PushStyleColor(ImGuiCol_Text, {1, 1, 1, 1});
    const bool pressed = ImGui::Button(label, {width, 0});
    ImGui::PopStyleColor(4);
    note(label);
    tooltip(explanation);
    return pressed;
}

bool iconButton(const char* id, Icon icon, const std::string& explanation, bool on, float size) {
    if (size <= 0) size = ImGui::GetFrameHeight();
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const bool pressed = ImGui::InvisibleButton(id, {size, size});
    ImDrawList* list = ImGui::GetWindowDrawList();
    const bool hovered = ImGui::IsItemHovered(), active = ImGui::IsItemActive();
    if (on || hovered || active) {
        const ImU32 ground = on ? ImGui::GetColorU32({accentColour.x, accentColour.y, accentColour.z, 0.42f})
                                : colourOf(active ? ImGuiCol_ButtonActive : ImGuiCol_ButtonHovered);
        list->AddRectFilled(at, {at.x + size, at.y + size}, ground, ImGui::GetStyle().FrameRounding);
    }
    const float inner = std::round(size * 0.72f), inset = std::round((size - inner) / 2);
    drawIcon(list, icon, {at.x + inset, at.y + inset}, inner, colourOf(ImGuiCol_Text));
    tooltip(explanation);
    return pressed;
}

bool iconTextButton(const char* label, Icon icon, const std::string& explanation, bool on, float width) {
    const float side = ImGui::GetFontSize(), gap = em(0.4f);
    const ImVec2 padding = ImGui::GetStyle().FramePadding, extent = ImGui::CalcTextSize(label, nullptr, true);
    if (width <= 0) width = extent.x + side + gap + 2 * padding.x;
    const ImVec2 at = ImGui::GetCursorScreenPos();
    ImGui::PushID(label);
    const bool pressed = ImGui::InvisibleButton("##button", {width, ImGui::GetFrameHeight()});
    ImGui::PopID();
    ImDrawList* list = ImGui::GetWindowDrawList();
    const ImU32 ground = on ? ImGui::GetColorU32({accentColour.x, accentColour.y, accentColour.z, 0.42f})
                            : colourOf(ImGui::IsItemActive()    ? ImGuiCol_ButtonActive
                                       : ImGui::IsItemHovered() ? ImGuiCol_ButtonHovered
                                                                : ImGuiCol_Button);
    list->AddRectFilled(ImGui::GetItemRectMin(), ImGui::GetItemRectMax(), ground, ImGui::GetStyle().FrameRounding);
    const std::string word(label, ImGui::FindRenderedTextEnd(label));
    const std::string fits = elided(word, width - side - gap - 2 * padding.x, false);
    // One or two letters and dots say less than the icon alone.
    const bool words = fits == word || fits.size() > 6;
    const float left = words ? padding.x : std::max(0.0f, (width - side) / 2);
    drawIcon(list, icon, {at.x + left, at.y + padding.y}, side, colourOf(ImGuiCol_Text));
    if (words) list->AddText({at.x + left + side + gap, at.y + padding.y}, colourOf(ImGuiCol_Text), fits.c_str());
    note(label);
    tooltip(explanation);
    return pressed;
}

bool checkbox(const char* label, bool& value, const std::string& explanation) {
    const bool changed = ImGui::Checkbox(label, &value);
    note(label);
    tooltip(explanation);
    return changed;
}

bool radio(const char* label, bool on, const std::string& explanation) {
    const bool pressed = ImGui::RadioButton(label, on);
    note(label);
    tooltip(explanation);
    return pressed;
}

void iconText(Icon icon, const ImVec4& colour) {
    const float side = ImGui::GetTextLineHeight();
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const float down = ImGui::GetCurrentWindow()->DC.CurrLineTextBaseOffset;
    ImGui::Dummy({side, side});
    drawIcon(ImGui::GetWindowDrawList(), icon, {at.x, at.y + down}, side, ImGui::GetColorU32(colour));
}

void badge(const std::string& label, const ImVec4& colour, const std::string& explanation) {
    const ImVec2 padding{em(0.35f), em(0.06f)}, size = ImGui::CalcTextSize(label.c_str()),
                                                at = ImGui::GetCursorScreenPos();
    const float down = ImGui::GetCurrentWindow()->DC.CurrLineTextBaseOffset;
    ImGui::Dummy({size.x + 2 * padding.x, size.y});
    ImDrawList* list = ImGui::GetWindowDrawList();
    list->AddRectFilled({at.x, at.y + down - padding.y},
                        {at.x + size.x + 2 * padding.x, at.y + down + size.y + padding.y},
                        ImGui::GetColorU32({colour.x, colour.y, colour.z, 0.2f}), em(0.25f));
    ImGui::PushStyleColor(ImGuiCol_Text, colour);
    ImGui::RenderText({at.x + padding.x, at.y + down}, label.c_str(), label.c_str() + label.size(), false);
    ImGui::PopStyleColor();
    tooltip(explanation);
}

void bar(double fraction, const ImVec4& colour, const std::string& label, float width) {
    if (width <= 0) width = std::max(1.0f, ImGui::GetContentRegionAvail().x);
    const float height = ImGui::GetTextLineHeight() + em(0.25f);
    const ImVec2 at = ImGui::GetCursorScreenPos();
    ImGui::Dummy({width, height});
    ImDrawList* list = ImGui::GetWindowDrawList();
    const float filled = width * float(std::clamp(std::isfinite(fraction) ? fraction : 0.0, 0.0, 1.0)),
                rounding = ImGui::GetStyle().FrameRounding;
    list->AddRectFilled(at, {at.x + width, at.y + height}, colourOf(ImGuiCol_FrameBg), rounding);
    if (fraction < 0) {
        const float phase = float(std::fmod(ImGui::GetTime() * 0.4, 1.0)), piece = 0.3f * width;
        const float from = at.x - piece + phase * (width + piece);
        list->AddRectFilled({std::max(at.x, from), at.y}, {std::min(at.x + width, from + piece), at.y + height},
                            ImGui::GetColorU32(colour), rounding);
    }
    if (filled >= 1) list->AddRectFilled(at, {at.x + filled, at.y + height}, ImGui::GetColorU32(colour), rounding);
    const std::string fits = elided(label, width - em(0.8f), false);
    const ImVec2 place{at.x + em(0.4f), at.y + em(0.125f)};
    list->AddText({place.x + 1, place.y + 1}, IM_COL32(0, 0, 0, 170), fits.c_str());
    list->AddText(place, colourOf(ImGuiCol_Text), fits.c_str());
}

bool swatch(const char* id, const ImVec4& colour, float size, const std::string& explanation) {
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const bool pressed = ImGui::InvisibleButton(id, {size, size});
    ImDrawList* list = ImGui::GetWindowDrawList();
    const ImVec2 end{at.x + size, at.y + size};
    list->AddRectFilled(at, end, ImGui::GetColorU32(colour), ImGui::GetStyle().FrameRounding);
    list->AddRect(at, end, colourOf(ImGui::IsItemHovered() ? ImGuiCol_Text : ImGuiCol_Border),
                  ImGui::GetStyle().FrameRounding);
    tooltip(explanation);
    return pressed;
}

bool image(const char* id, uint64_t texture, float width, float height, const std::string& missing, bool selected) {
    const ImVec2 at = ImGui::GetCursorScreenPos(), end{at.x + width, at.y + height};
    const bool pressed = ImGui::InvisibleButton(id, {std::max(1.0f, width), std::max(1.0f, height)});
    ImDrawList* list = ImGui::GetWindowDrawList();
    if (texture) {
        list->AddImage(textureId(texture), at, end, {0, 0}, {1, 1}, ImGui::GetColorU32(ImVec4(1, 1, 1, 1)));
    } else {
        list->AddRectFilled(at, end, ImGui::GetColorU32(ImVec4(0.22f, 0.22f, 0.22f, 1)));
        const std::string fits = elided(missing, width - em(0.4f));
        const ImVec2 size = ImGui::CalcTextSize(fits.c_str());
        list->AddText({at.x + (width - size.x) / 2, at.y + (height - size.y) / 2}, colourOf(ImGuiCol_TextDisabled),
                      fits.c_str());
    }
    if (selected) list->AddRect(at, end, ImGui::GetColorU32(accentColour), 0, 0, std::max(2.0f, em(0.14f)));
    else if (ImGui::IsItemHovered()) list->AddRect(at, end, colourOf(ImGuiCol_TextDisabled));
    return pressed;
}

// ---- colours

ImVec4 toScreen(const Rgb& display, float alpha) { return {display.x, display.y, display.z, alpha}; }

ImVec4 lightColour(const Rgb& radiance) {
    const float most = maxChannel(radiance);
    if (!(most > 0) || !std::isfinite(most)) return {0, 0, 0, 1};
    return {srgbEncode(std::max(0.0f, radiance.x / most)), srgbEncode(std::max(0.0f, radiance.y / most)),
            srgbEncode(std::max(0.0f, radiance.z / most)), 1};
}

bool panelsBusy() { return awake || awakeLast; }
void stayAwake() { awake = true; }
void beginPanelFrame() {
    awakeLast = awake;
    awake = false;
    escapeTaken = std::exchange(escapeOfMenu, false);
    if (!hover.seen) hover = {};
    hover.seen = false;
}

}  // namespace relamp::ui
