// The legends of the view modes: what the colours mean.
#include "display/vertex_images.h"
#include "viewport/display_transform.h"
#include "viewport/overlays.h"
#include "widgets.h"

namespace relamp::ui {
namespace {

struct ColourKey {
    std::string title;
    std::vector<std::pair<Rgb, std::string>> entries;
};

ImU32 colourOf(const Rgb& c) {
    const Rgb s = glm::clamp(c, Rgb(0), Rgb(1));
    return ImGui::ColorConvertFloat4ToU32({s.x, s.y, s.z, 1});
}

ColourKey falseColourKey() {
    ColourKey key{"Stops from grey", {}};
    for (int stop = falseColourHigh; stop >= falseColourLow; stop -= 2)
        key.entries.push_back({falseColour(0.18f * std::exp2(float(stop))), (stop > 0 ? "+" : "") +
                                                                                std::to_string(stop) +
                                                                                (stop == falseColourHigh  ? " and more"
                                                                                 : stop == falseColourLow ? " and less"
                                                                                                          : "")});
    return key;
}

ColourKey confidenceKey() {
    ColourKey key{"Surface colour", {}};
    static const char* const words[] = {"own photographs", "mostly seen", "half and half", "mostly filled in",
                                        "filled in"};
    for (int i = 0; i < 5; ++i) key.entries.push_back({confidenceColour(1 - float(i) / 4), words[i]});
    key.entries.push_back({Rgb(0.18f, 0.19f, 0.22f), "never seen"});
    return key;
}

ColourKey differenceKey() {
    const Rgb equal(0.5f), tooBright(0.95f, 0.52f, 0.15f), tooDark(0.20f, 0.50f, 0.95f);  // as differenceColours
    return {"Model, photographs",
            {{tooBright, "2 x too bright"},
             {glm::mix(equal, tooBright, 0.5f), "1.4 x too bright"},
             {equal, "equal"},
             {glm::mix(equal, tooDark, 0.5f), "1.4 x too dark"},
             {tooDark, "2 x too dark"},
             {Rgb(0.18f, 0.19f, 0.22f), "not seen"}}};
}

ColourKey emittersKey(const Editor& editor) {
    ColourKey key{"Emitters", {}};
    const auto estimate = editor.estimate();
    const auto& found = estimate->emitters.emitters;
    for (size_t i = 0; i < found.size() && i < 10; ++i)
        key.entries.push_back({clusterColour(i), shown(editor.namesOf({found[i].id}))});
    if (found.size() > 10) key.entries.push_back({Rgb(0.35f), "and " + std::to_string(found.size() - 10) + " more"});
    if (found.empty()) key.entries.push_back({Rgb(0.35f), "none found"});
    return key;
}

void labelOneLight(const Canvas& canvas) {
    const auto live = canvas.editor->liveFrame();
    const int i = live ? irradianceEmitter(*canvas.editor, *live) : -1;
    if (i < 0) return;
    labelAt(canvas, canvas.corner + Vec2(10, canvas.size.y - 10 * canvas.scale),
            "Light of " + shown(canvas.editor->namesOf({live->emitterIds[size_t(i)]})) + " alone", {0, 1});
}

void drawKey(const Canvas& canvas, const ColourKey& key) {
    if (key.entries.empty()) return;
    const float s = canvas.scale, row = ImGui::GetTextLineHeight() + 3 * s;
    float width = ImGui::CalcTextSize(key.title.c_str()).x;
    for (const auto& [colour, text] : key.entries)
        width = std::max(width, ImGui::CalcTextSize(text.c_str()).x + 20 * s);
    const Vec2 size(width + 16 * s, row * float(key.entries.size() + 1) + 12 * s);
    if (size.x > canvas.size.x * 0.6f || size.y > canvas.size.y * 0.8f) return;
    const Vec2 at = glm::floor(Vec2(canvas.corner.x + 10 * s, canvas.corner.y + canvas.size.y - size.y - 10 * s));
    canvas.list->AddRectFilled(toIm(at), toIm(at + size), IM_COL32(18, 18, 18, 185), 4 * s);
    canvas.list->AddText(toIm(at + Vec2(8, 5) * s), IM_COL32(190, 190, 190, 255), key.title.c_str());
    for (size_t i = 0; i < key.entries.size(); ++i) {
        const Vec2 p = at + Vec2(8 * s, 6 * s + row * float(i + 1));
        canvas.list->AddRectFilled(toIm(p + Vec2(0, 2 * s)), toIm(p + Vec2(12 * s, row - 4 * s)),
                                   colourOf(key.entries[i].first), 2 * s);
        canvas.list->AddText(toIm(p + Vec2(20 * s, 0)), IM_COL32(225, 225, 225, 255), key.entries[i].second.c_str());
    }
}

}  // namespace

void drawLegend(const Canvas& canvas) {
    const Editor& editor = *canvas.editor;
    const ViewModeInfo& mode = infoOf(editor.state.viewport.mode);
    if (editor.state.viewport.falseColour && !mode.display) return drawKey(canvas, falseColourKey());
    if (!editor.estimate()) return;
    switch (mode.legend) {
        case Legend::none: break;
        case Legend::confidence: return drawKey(canvas, confidenceKey());
        case Legend::difference: return drawKey(canvas, differenceKey());
        case Legend::emitters: return drawKey(canvas, emittersKey(editor));
        case Legend::oneLight: return labelOneLight(canvas);
    }
}

}  // namespace relamp::ui
