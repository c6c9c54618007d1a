#include "viewport/toolbar.h"

#include <fmt/format.h>

#include "item_map.h"
#include "keys.h"
#include "viewport/display_transform.h"
#include "viewport/navigation.h"
#include "widgets.h"

namespace relamp::ui {
namespace {

/// Puts buttons side by side and goes to the next line when one does not fit.
class Flow {
public:
    Flow()
        : left_(ImGui::GetCursorScreenPos().x + em(0.35f)),
          right_(ImGui::GetCursorScreenPos().x + ImGui::GetContentRegionAvail().x - em(0.35f)) {
        ImGui::SetCursorScreenPos({left_, ImGui::GetCursorScreenPos().y + em(0.25f)});
    }
    void place(float width, float gap = -1) {
        if (gap < 0) gap = std::floor(em(0.15f));
        if (!first_) {
            const float next = end_ + gap;
            if (next + width <= right_) {
                ImGui::SetCursorScreenPos({next, line_});
            } else {
                line_ += ImGui::GetFrameHeight() + em(0.2f);
                ImGui::SetCursorScreenPos({left_, line_});
            }
        } else {
            line_ = ImGui::GetCursorScreenPos().y;
        }
        first_ = false;
        end_ = ImGui::GetCursorScreenPos().x + width;
    }
    void finish() const { ImGui::SetCursorScreenPos({left_ - em(0.35f), line_ + ImGui::GetFrameHeight() + em(0.25f)}); }

private:
    float left_, right_, end_ = 0, line_ = 0;
    bool first_ = true;
};

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
    } else {
        list->AddRect(p(0.18f, 0.48f), p(0.52f, 0.82f), colour, 0, 0, w);
        list->AddLine(p(0.5f, 0.5f), p(0.72f, 0.28f), colour, w);
        list->AddTriangleFilled(p(0.82f, 0.18f), p(0.62f, 0.24f), p(0.76f, 0.38f), colour);
    }
}

void modeButtons(Editor& editor, Flow& flow, float available) {
    float all = 0;
    const float pad = em(0.7f), gap = std::floor(em(0.15f));
    const auto keyOf = [](const ViewModeInfo& info) { return info.key ? keyName(info.key) : std::string(); };
    const auto full = [&](const ViewModeInfo& info) {
        return info.key ? fmt::format("{} {}", keyOf(info), info.name) : std::string(info.name);
    };
    for (const ViewModeInfo& info : viewModes()) all += ImGui::CalcTextSize(full(info).c_str()).x + pad + gap;
    // Names where they all fit; else keys, and the name of the present one.
    const bool named = all < available - em(0.7f);
    for (const ViewModeInfo& info : viewModes()) {
        const bool on = editor.state.viewport.mode == info.mode;
        const std::string label = named || on || !info.key ? full(info) : keyOf(info);
        const float width = ImGui::CalcTextSize(label.c_str()).x + pad;
        flow.place(width);
        const std::string title = info.key ? fmt::format("{} ({})", info.name, keyOf(info)) : std::string(info.name);
        if (textButton(fmt::format("##mode{}", int(info.mode)).c_str(), label, width, on,
                       fmt::format("{}\n{}", title, info.explanation)))
            setMode(editor, info.mode);
    }
}

}  // namespace

void drawViewportToolbar(Editor& editor) {
    ViewportState& viewport = editor.state.viewport;
    const float available = ImGui::GetContentRegionAvail().x, side = ImGui::GetFrameHeight(), group = em(0.5f);
    Flow flow;
    modeButtons(editor, flow, available);

    struct ToolRow {
        Tool tool;
        const char* id;
        const char* explanation;
    };
    static const ToolRow tools[] = {
        {Tool::select, "##select", "Select: click lights, surfaces and cameras."},
        {Tool::move, "##move",
         "Move handles on the selected light. The key G moves it at once; then X, Y, Z lock an axis."},
        {Tool::rotate, "##rotate", "Turn handles on the selected light. The key R turns it at once."},
        {Tool::scale, "##scale", "Size handles on the selected light. The key S resizes it at once."}};
    bool first = true;
    for (const ToolRow& row : tools) {
        flow.place(side, first ? group : -1);
        first = false;
        if (faceButton(row.id, side, viewport.tool == row.tool, row.explanation,
                       [&](ImDrawList* list, const ImVec2& at, float size, ImU32 colour) {
                           drawToolIcon(list, row.tool, at, size, colour);
                       }))
            viewport.tool = row.tool;
    }
    const std::string axes = viewport.localAxes ? "Local" : "World";
    const float axesWidth = std::max(ImGui::CalcTextSize("Local").x, ImGui::CalcTextSize("World").x) + em(0.8f);
    flow.place(axesWidth);
    if (textButton("##axes", axes, axesWidth, false,
                   "Axes of the handles and of the X, Y, Z locks: the world's, or the light's own."))
        viewport.localAxes = !viewport.localAxes;

    const bool roomy = available > em(52);
    const float exposureWidth = roomy ? em(5.6f) : em(3.4f);
    flow.place(exposureWidth, group);
    ImGui::SetNextItemWidth(exposureWidth);
    ImGui::DragFloat("##exposure", &viewport.exposureStops, 0.02f, -20, 20, roomy ? "%+.2f stops" : "%+.2f");
    tooltip(
        "Exposure of the image on screen, in stops. Files are not affected. Drag, or double click to type; E and "
        "Shift+E go by half a stop.");
    if (ImGui::IsItemClicked(ImGuiMouseButton_Right)) viewport.exposureStops = 0;

    const DisplayTransform& display = displayTransform();
    if (std::find(display.views().begin(), display.views().end(), viewport.displayView) == display.views().end())
        viewport.displayView = display.defaultView();
    float viewWidth = 0;
    for (const std::string& name : display.views())
        viewWidth = std::max(viewWidth, ImGui::CalcTextSize(name.c_str()).x);
    viewWidth = std::min(viewWidth + side + em(0.9f), roomy ? em(9) : em(5.6f));
    flow.place(viewWidth);
    ImGui::SetNextItemWidth(viewWidth);
    if (ImGui::BeginCombo("##display", viewport.displayView.c_str())) {
        for (const std::string& name : display.views())
            if (ImGui::Selectable(name.c_str(), name == viewport.displayView)) viewport.displayView = name;
        ImGui::EndCombo();
    }
    tooltip("How scene light becomes screen colour. Configuration: " + display.source() +
            (display.source() == "built in" ? " ($OCIO names another one)." : "."));
    flow.place(side);
    if (faceButton("##false", side, viewport.falseColour,
                   "False colour: brightness in bands of one stop about middle grey (0.18).",
                   [](ImDrawList* list, const ImVec2& at, float size, ImU32) {
                       for (int i = 0; i < 5; ++i) {
                           const Rgb c = falseColour(0.18f * std::exp2(float(2 * i - 4)));
                           list->AddRectFilled({at.x + size * (0.2f + 0.12f * float(i)), at.y + size * 0.24f},
                                               {at.x + size * (0.32f + 0.12f * float(i)), at.y + size * 0.76f},
                                               ImGui::ColorConvertFloat4ToU32({c.x, c.y, c.z, 1}));
                       }
                   }))
        viewport.falseColour = !viewport.falseColour;
    const std::string camera = viewport.throughView ? fmt::format("View {}", editor.state.selection.view + 1) : "Free";
    const float cameraWidth =
        std::max(ImGui::CalcTextSize(camera.c_str()).x, ImGui::CalcTextSize("View 8").x) + em(0.6f);
    flow.place(cameraWidth);
    ImGui::BeginDisabled(!editor.state.document.capture);
    if (textButton("##camera", camera, cameraWidth, viewport.throughView,
                   "Looks through the selected photograph's camera, or freely (C). Comma and period go through the "
                   "photographs."))
        toggleLookThrough(editor);
    ImGui::EndDisabled();
    flow.finish();
}

}  // namespace relamp::ui
