#include "viewport/toolbar.h"

#include <fmt/format.h>

#include <functional>

#include "item_map.h"
#include "keys.h"
#include "viewport/display_transform.h"
#include "viewport/navigation.h"
#include "widgets.h"

namespace relamp::ui {
namespace {

/// A flat button whose face is drawn by `face`; lit while `on`.
template <class Face>
bool faceButton(const char* id, float width, bool on, const std::string& explanation, Face&& face) {
    const float height = ImGui::GetFrameHeight();
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const bool pressed = ImGui::InvisibleButton(id, {width, height});
    const ImVec4 accent = accentColour;
    const ImU32 ground = on ? ImGui::GetColorU32({accent.x * 0.62f, accent.y * 0.62f, accent.z * 0.62f, 1})
                            : ImGui::GetColorU32(ImGui::IsItemActive()    ? ImGuiCol_ButtonActive
                                                 : ImGui::IsItemHovered() ? ImGuiCol_ButtonHovered
                                                                          : ImGuiCol_Button);
    ImDrawList* list = ImGui::GetWindowDrawList();
    list->AddRectFilled(at, {at.x + width, at.y + height}, ground, ImGui::GetStyle().FrameRounding);
    noteItem(id);
    face(list, at, height, ImGui::GetColorU32(on ? ImVec4(1, 1, 1, 1) : ImGui::GetStyle().Colors[ImGuiCol_Text]));
    tooltip(explanation);
    return pressed;
}

bool textButton(const char* id, const std::string& label, float width, bool on, const std::string& explanation) {
    return faceButton(id, width, on, explanation, [&](ImDrawList* list, const ImVec2& at, float height, ImU32 colour) {
        const ImVec2 size = ImGui::CalcTextSize(label.c_str());
        list->AddText({std::floor(at.x + (width - size.x) / 2), std::floor(at.y + (height - size.y) / 2)}, colour,
                      label.c_str());
    });
}

void drawToolIcon(ImDrawList* list, Tool tool, const ImVec2& at, float size, ImU32 colour) {
    const float w = std::max(1.0f, size * 0.07f);
    const auto p = [&](float x, float y) { return ImVec2(at.x + x * size, at.y + y * size); };
    if (tool == Tool::select) {
        const ImVec2 arrow[] = {p(0.34f, 0.20f), p(0.34f, 0.76f), p(0.47f, 0.63f), p(0.57f, 0.83f),
                                p(0.66f, 0.78f), p(0.56f, 0.59f), p(0.73f, 0.57f)};
        list->AddPolyline(arrow, 7, colour, ImDrawFlags_Closed, w);
    } else if (tool == Tool::move) {
        list->AddLine(p(0.5f, 0.2f), p(0.5f, 0.8f), colour, w), list->AddLine(p(0.2f, 0.5f), p(0.8f, 0.5f), colour, w);
        list->AddTriangleFilled(p(0.5f, 0.12f), p(0.4f, 0.27f), p(0.6f, 0.27f), colour),
            list->AddTriangleFilled(p(0.5f, 0.88f), p(0.6f, 0.73f), p(0.4f, 0.73f), colour);
        list->AddTriangleFilled(p(0.12f, 0.5f), p(0.27f, 0.6f), p(0.27f, 0.4f), colour),
            list->AddTriangleFilled(p(0.88f, 0.5f), p(0.73f, 0.4f), p(0.73f, 0.6f), colour);
    } else if (tool == Tool::rotate) {
        list->PathArcTo(p(0.5f, 0.5f), 0.3f * size, -0.3f, 4.6f, 24), list->PathStroke(colour, 0, w);
        list->AddTriangleFilled(p(0.46f, 0.08f), p(0.46f, 0.34f), p(0.66f, 0.2f), colour);
    } else if (tool == Tool::paint) {
        list->AddLine(p(0.82f, 0.18f), p(0.46f, 0.54f), colour, 1.6f * w);
        const ImVec2 tip[] = {p(0.5f, 0.62f), p(0.38f, 0.5f), p(0.24f, 0.62f), p(0.18f, 0.82f), p(0.38f, 0.78f)};
        list->AddConvexPolyFilled(tip, 5, colour);
    } else {
        list->AddRect(p(0.18f, 0.48f), p(0.52f, 0.82f), colour, 0, 0, w);
        list->AddLine(p(0.5f, 0.5f), p(0.72f, 0.28f), colour, w);
        list->AddTriangleFilled(p(0.82f, 0.18f), p(0.62f, 0.24f), p(0.76f, 0.38f), colour);
    }
}

/// One thing of the toolbar. What there is no room for goes into the menu at its end, the lowest rank first.
struct Item {
    int rank;
    float width;
    bool newGroup;               ///< a little space before it
    std::function<void()> draw;  ///< at the cursor
    std::function<void()> menu;  ///< as a row of the menu
};

float pad() { return em(0.7f); }
float gapWidth() { return std::floor(em(0.15f)); }
float groupWidth() { return em(0.5f); }

std::string keyOf(const ViewModeInfo& info) { return info.key ? keyName(info.key) : std::string(); }
std::string fullName(const ViewModeInfo& info) {
    return info.key ? fmt::format("{} {}", keyOf(info), info.name) : std::string(info.name);
}
std::string modeTooltip(const ViewModeInfo& info) {
    return fmt::format("{}\n{}", info.key ? fmt::format("{} ({})", info.name, keyOf(info)) : info.name,
                       info.explanation);
}

enum class Modes { named, keys, menu };

float modesWidth(const Editor& editor, Modes how) {
    float sum = 0;
    const ViewMode now = editor.state.viewport.mode;
    if (how == Modes::menu) {
        for (const ViewModeInfo& info : viewModes()) sum = std::max(sum, ImGui::CalcTextSize(fullName(info).c_str()).x);
        return sum + pad() + ImGui::GetFrameHeight();
    }
    for (const ViewModeInfo& info : viewModes()) {
        const bool named = how == Modes::named || info.mode == now || !info.key;
        sum += ImGui::CalcTextSize((named ? fullName(info) : keyOf(info)).c_str()).x + pad() + gapWidth();
    }
    return sum - gapWidth();
}

void drawModes(Editor& editor, Modes how) {
    const ViewMode now = editor.state.viewport.mode;
    if (how == Modes::menu) {
        ImGui::SetNextItemWidth(modesWidth(editor, how));
        if (ImGui::BeginCombo("##modes", fullName(infoOf(now)).c_str(), ImGuiComboFlags_HeightLarge)) {
            for (const ViewModeInfo& info : viewModes()) {
                if (ImGui::Selectable(fullName(info).c_str(), info.mode == now)) setMode(editor, info.mode);
                tooltip(modeTooltip(info));
            }
            ImGui::EndCombo();
        }
        noteItem("##modes");
        return;
    }
    bool first = true;
    for (const ViewModeInfo& info : viewModes()) {
        if (!first) ImGui::SameLine(0, gapWidth());
        first = false;
        const bool on = info.mode == now;
        const std::string label = how == Modes::named || on || !info.key ? fullName(info) : keyOf(info);
        if (textButton(fmt::format("##mode{}", int(info.mode)).c_str(), label,
                       ImGui::CalcTextSize(label.c_str()).x + pad(), on, modeTooltip(info)))
            setMode(editor, info.mode);
    }
}

void addTools(Editor& editor, std::vector<Item>& items) {
    struct ToolRow {
        Tool tool;
        const char* id;
        const char* name;
        const char* explanation;
    };
    static const ToolRow tools[] = {
        {Tool::select, "##select", "Select", "Select: click lights, surfaces and cameras."},
        {Tool::move, "##move", "Move",
         "Move: handles on the selected light. The key G moves it at once; then X, Y, Z lock an axis."},
        {Tool::rotate, "##rotate", "Rotate", "Rotate: handles on the selected light. The key R rotates it at once."},
        {Tool::scale, "##scale", "Scale", "Scale: handles on the selected light. The key S scales it at once."},
        {Tool::paint, "##paint", "Paint with light",
         "Paint with light (P): stroke over the image what is to be brighter, darker or of another colour. The lights "
         "change to make it so. Settings are in the inspector."}};
    const float side = ImGui::GetFrameHeight();
    for (const ToolRow& row : tools)
        items.push_back({90, side, &row == tools,
                         [&editor, &row, side] {
                             if (faceButton(row.id, side, editor.state.viewport.tool == row.tool, row.explanation,
                                            [&](ImDrawList* list, const ImVec2& at, float size, ImU32 colour) {
                                                drawToolIcon(list, row.tool, at, size, colour);
                                            }))
                                 editor.state.viewport.tool = row.tool;
                         },
                         [&editor, &row] {
                             if (ImGui::MenuItem(row.name, nullptr, editor.state.viewport.tool == row.tool))
                                 editor.state.viewport.tool = row.tool;
                         }});
    const float axesWidth = std::max(ImGui::CalcTextSize("Local").x, ImGui::CalcTextSize("World").x) + em(0.8f);
    bool& local = editor.state.viewport.localAxes;
    items.push_back({40, axesWidth, false,
                     [&local, axesWidth] {
                         if (textButton("##axes", local ? "Local" : "World", axesWidth, false,
                                        "Axes of the handles and of the X, Y, Z locks: the world's, or the light's "
                                        "own."))
                             local = !local;
                     },
                     [&local] { ImGui::MenuItem("Local axes", nullptr, &local); }});
}

void exposureField(Editor& editor, float width, bool words) {
    ViewportState& viewport = editor.state.viewport;
    ImGui::SetNextItemWidth(width);
    float speed = 0.02f;
    {
        const FineDrag fine(speed);
        ImGui::DragFloat("##exposure", &viewport.exposureStops, speed, -20, 20, words ? "%+.2f stops" : "%+.2f");
    }
    noteItem("##exposure");
    if (ImGui::IsItemClicked(ImGuiMouseButton_Right)) viewport.exposureStops = 0;
    tooltip(
        "Exposure of the image on screen, in stops. EXR files are not affected. Drag, or double click to type; Shift "
        "is "
        "finer, a right click resets. E and Shift+E go by half a stop.");
}

void displayCombo(Editor& editor, float width) {
    const DisplayTransform& display = displayTransform();
    std::string& view = editor.state.viewport.displayView;
    ImGui::SetNextItemWidth(width);
    const std::string present = displayViewOf(editor);
    if (ImGui::BeginCombo("##display", present.c_str())) {
        if (ImGui::Selectable("Automatic", view.empty())) view.clear();
        tooltip(
            "Soft highlights where lights are brighter than the screen, so that they keep their colour; else "
            "Standard.");
        for (const std::string& name : display.views())
            if (ImGui::Selectable(name.c_str(), name == view)) view = name;
        ImGui::EndCombo();
    }
    tooltip("How scene light becomes screen colour; EXR files are not affected. " +
            (view.empty() ? "Now by itself: " + present + ". " : std::string()) + "Configuration: " + display.source() +
            (display.source() == "built in" ? " ($OCIO names another one)." : "."));
}

/// What the before side of mode "before and after" shows.
void compareCombo(Editor& editor, float width) {
    int& with = editor.state.viewport.compareWith;
    const auto nameOf = [](int which) {
        return which < 0 ? std::string("As recovered") : fmt::format("Snapshot {}", char('A' + which));
    };
    ImGui::SetNextItemWidth(width);
    if (ImGui::BeginCombo("##compare", ("Before: " + nameOf(with)).c_str())) {
        for (int which = -1; which < int(editor.state.snapshots.size()); ++which) {
            const bool there = which < 0 || editor.state.snapshots[size_t(which)];
            ImGui::BeginDisabled(!there);
            if (ImGui::Selectable(nameOf(which).c_str(), which == with)) with = which;
            ImGui::EndDisabled();
            if (!there) tooltip("Nothing is stored there: Edit, Store as snapshot");
        }
        ImGui::EndCombo();
    }
    noteItem("##compare");
    tooltip("What the present look is compared with");
}

void addImageItems(Editor& editor, std::vector<Item>& items, bool roomy) {
    ViewportState& viewport = editor.state.viewport;
    const float side = ImGui::GetFrameHeight();
    if (viewport.mode == ViewMode::compare) {
        const float width = ImGui::CalcTextSize("Before: As recovered").x + pad() + side;
        items.push_back({95, width, true, [&editor, width] { compareCombo(editor, width); },
                         [&editor, width] { compareCombo(editor, width); }});
    }
    const float exposureWidth = roomy ? em(5.6f) : em(3.4f);
    items.push_back({70, exposureWidth, true,
                     [&editor, exposureWidth, roomy] { exposureField(editor, exposureWidth, roomy); },
                     [&editor] { exposureField(editor, em(8), true); }});
    const DisplayTransform& display = displayTransform();
    if (std::find(display.views().begin(), display.views().end(), viewport.displayView) == display.views().end())
        viewport.displayView.clear();
    float viewWidth = 0;
    for (const std::string& name : display.views())
        viewWidth = std::max(viewWidth, ImGui::CalcTextSize(name.c_str()).x);
    viewWidth = std::min(viewWidth + side + em(0.9f), em(roomy ? 9 : 7.6f));
    items.push_back({60, viewWidth, false, [&editor, viewWidth] { displayCombo(editor, viewWidth); },
                     [&editor] { displayCombo(editor, em(10)); }});
    bool& falseOn = viewport.falseColour;
    items.push_back({30, side, false,
                     [&falseOn, side] {
                         if (faceButton("##false", side, falseOn,
                                        "False colour: exposure in bands of one stop about middle grey (0.18).",
                                        [](ImDrawList* list, const ImVec2& at, float size, ImU32) {
                                            for (int i = 0; i < 5; ++i) {
                                                const Rgb c = falseColour(0.18f * std::exp2(float(2 * i - 4)));
                                                list->AddRectFilled(
                                                    {at.x + size * (0.2f + 0.12f * float(i)), at.y + size * 0.24f},
                                                    {at.x + size * (0.32f + 0.12f * float(i)), at.y + size * 0.76f},
                                                    ImGui::ColorConvertFloat4ToU32({c.x, c.y, c.z, 1}));
                                            }
                                        }))
                             falseOn = !falseOn;
                     },
                     [&falseOn] { ImGui::MenuItem("False colour", nullptr, &falseOn); }});
    bool& overlays = viewport.overlays;
    items.push_back(
        {35, side, false,
         [&overlays, side] {
             if (faceButton("##overlays", side, overlays,
                            "Overlays: marks, grid, cameras, legend and axes over the image (O).",
                            [](ImDrawList* list, const ImVec2& at, float size, ImU32 colour) {
                                const float w = std::max(1.0f, size * 0.07f);
                                list->AddCircle({at.x + 0.42f * size, at.y + 0.5f * size}, 0.2f * size, colour, 0, w);
                                list->AddCircle({at.x + 0.6f * size, at.y + 0.5f * size}, 0.2f * size, colour, 0, w);
                            }))
                 overlays = !overlays;
         },
         [&overlays] { ImGui::MenuItem("Overlays", "O", &overlays); }});
    const std::string camera = editor.plateCamera()   ? "Plate"
                               : viewport.throughView ? fmt::format("View {}", editor.state.selection.view + 1)
                                                      : "Free";
    const float cameraWidth =
        std::max(ImGui::CalcTextSize(camera.c_str()).x, ImGui::CalcTextSize("View 8").x) + em(0.6f);
    const auto enabled = [&editor] { return editor.state.document.capture != nullptr; };
    items.push_back(
        {80, cameraWidth, true,
         [&editor, camera, cameraWidth, enabled] {
             ImGui::BeginDisabled(!enabled());
             if (textButton("##camera", camera, cameraWidth, looksThrough(editor),
                            "Looks through the selected photograph's camera, or freely (C). Comma and "
                            "period go through the photographs."))
                 toggleLookThrough(editor);
             ImGui::EndDisabled();
         },
         [&editor, enabled] {
             if (ImGui::MenuItem("Look through the photograph", "C", editor.state.viewport.throughView, enabled()))
                 toggleLookThrough(editor);
         }});
}

}  // namespace

void drawViewportToolbar(Editor& editor) {
    const float room = ImGui::GetContentRegionAvail().x - em(0.7f), side = ImGui::GetFrameHeight();
    std::vector<Item> items;
    addTools(editor, items);
    addImageItems(editor, items, room > em(52));
    const auto widthOf = [](const std::vector<Item>& some) {
        float sum = 0;
        for (const Item& item : some) sum += item.width + (item.newGroup ? groupWidth() : gapWidth());
        return sum;
    };
    // Names of the modes where everything fits, else their keys, else one list of them.
    Modes how = Modes::named;
    if (modesWidth(editor, how) + widthOf(items) > room) how = Modes::keys;
    if (how == Modes::keys && modesWidth(editor, how) + widthOf(items) > room) how = Modes::menu;
    std::vector<bool> folded(items.size(), false);
    float left = room - modesWidth(editor, how) - widthOf(items);
    if (left < 0) left -= side + gapWidth();  // the button of the menu
    while (left < 0) {
        size_t lowest = items.size();
        for (size_t i = 0; i < items.size(); ++i)
            if (!folded[i] && (lowest == items.size() || items[i].rank < items[lowest].rank)) lowest = i;
        if (lowest == items.size()) break;
        // Those of one rank go together.
        for (size_t i = 0; i < items.size(); ++i)
            if (!folded[i] && items[i].rank == items[lowest].rank && i != lowest)
                folded[i] = true, left += items[i].width + gapWidth();
        folded[lowest] = true;
        left += items[lowest].width + gapWidth();
    }
    const ImVec2 start = ImGui::GetCursorScreenPos();
    ImGui::SetCursorScreenPos({start.x + em(0.35f), start.y + em(0.25f)});
    ImGui::BeginGroup();
    drawModes(editor, how);
    bool any = false;
    for (size_t i = 0; i < items.size(); ++i) {
        any = any || folded[i];
        if (folded[i]) continue;
        ImGui::SameLine(0, items[i].newGroup ? groupWidth() : gapWidth());
        items[i].draw();
    }
    if (any) {
        ImGui::SameLine(0, gapWidth());
        if (iconButton("##more tools", Icon::dots, "The rest of the toolbar", false, side))
            ImGui::OpenPopup("##toolbar menu");
        noteItem("##more tools");
    }
    ImGui::EndGroup();
    if (ImGui::BeginPopup("##toolbar menu")) {
        for (size_t i = 0; i < items.size(); ++i)
            if (folded[i]) items[i].menu();
        ImGui::EndPopup();
    }
    ImGui::SetCursorScreenPos({start.x, start.y + ImGui::GetFrameHeight() + em(0.5f)});
}

}  // namespace relamp::ui
