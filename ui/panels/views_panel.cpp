// The photographs as thumbnails, with what the import doctor has to say about each.
#include <cmath>

#include "capture/capture_formats.h"
#include "item_map.h"
#include "panels/images.h"
#include "panels/panels.h"
#include "viewport/navigation.h"
#include "widgets.h"

namespace relamp::ui {
namespace {

/// As the import doctor warns: only where enough vertices were compared and they agree among themselves.
bool exposureIsOdd(const ViewCheck& v) {
    return v.comparedVertices >= 100 && std::abs(v.exposureStops) > std::max(0.25, v.exposureScatterStops);
}

/// How well the estimate explains one view, if that was measured.
const ViewReproduction* explained(const Estimate* estimate, const View& view) {
    if (!estimate) return nullptr;
    const auto& views = estimate->reproduction.views;
    const auto at =
        std::find_if(views.begin(), views.end(), [&](const ViewReproduction& v) { return v.name == view.name; });
    return at == views.end() ? nullptr : &*at;
}

std::string describe(const View& view, const ViewCheck* check, const ViewReproduction* found) {
    std::string words = fmt::format("{}\n{} x {} pixels", shown(view.name), view.camera.width, view.camera.height);
    if (found) words += fmt::format("\nThe estimate explains it at {:.1f} dB", found->psnr);
    if (found && found->heldOut > 0)
        words += fmt::format(", and predicts it at {:.1f} dB from the others", found->heldOut);
    if (check) {
        words += fmt::format("\nThe mesh covers {} of the image", percent(check->meshFraction));
        if (check->clippedFraction > 0)
            words += fmt::format("\n{} of the pixels are clipped (too bright for the file)",
                                 percent(check->clippedFraction));
        if (check->maskedFraction > 0)
            words += fmt::format("\n{} of the pixels are left out (masked or broken)", percent(check->maskedFraction));
        if (exposureIsOdd(*check))
            words += fmt::format("\n{:.2f} stops {} than the other views of the same surfaces",
                                 std::abs(check->exposureStops), check->exposureStops > 0 ? "brighter" : "darker");
    }
    return words + "\n\nClick selects it, double click looks through its camera.";
}

void badges(const ImVec2& corner, const ViewCheck* check, bool worst, bool poor) {
    struct Mark {
        const char* word;
        bool shown;
    };
    const Mark marks[] = {{"clipped", check && check->clippedFraction > 0.01},
                          {"exposure", check && exposureIsOdd(*check)},
                          {"masked", check && check->maskedFraction > 0.9},
                          {"off mesh", check && check->meshFraction < 0.02},
                          {"worst", worst},
                          {"poor", poor && !worst}};
    ImDrawList* list = ImGui::GetWindowDrawList();
    float y = corner.y + em(0.2f);
    for (const Mark& mark : marks) {
        if (!mark.shown) continue;
        const ImVec2 size = ImGui::CalcTextSize(mark.word);
        list->AddRectFilled({corner.x + em(0.2f), y}, {corner.x + em(0.7f) + size.x, y + size.y},
                            IM_COL32(20, 20, 20, 210), em(0.2f));
        list->AddText({corner.x + em(0.45f), y}, ImGui::GetColorU32(warningColour), mark.word);
        y += size.y + em(0.15f);
    }
}

/// The plate's camera beside those of the photographs.
void drawPlateEntry(Editor& editor) {
    const std::optional<PlateLook>& named = editor.look().plate;
    if (!named) return;
    const auto plate = editor.plate();
    const bool through = editor.plateCamera() != nullptr;
    const float icon = ImGui::GetFrameHeight() + ImGui::GetStyle().ItemSpacing.x;
    const std::string name = shown(named->files.filename());
    std::string words = shown(named->files);
    if (!plate) words += "\nIt is being opened.";
    else if (!plate->trouble.empty()) words += "\nIt cannot be shown: " + shown(plate->trouble);
    else {
        const auto& frames = plate->plate.frames;
        words += fmt::format("\n{} frames, {} to {}", frames.size(), frames.front().number, frames.back().number);
        for (const std::string& fault : plate->plate.faults) words += "\n" + shown(fault);
        for (const std::string& note : plate->plate.notes) words += "\n" + shown(note);
        words += "\n\nA click looks through its camera (Shift+C).";
    }
    const bool usable = plate && plate->trouble.empty();
    const bool lacking = plate && (!usable || !plate->plate.faults.empty());
    const float width = ImGui::GetContentRegionAvail().x - icon;
    ImGui::BeginDisabled(!usable);
    const ImVec2 at = ImGui::GetCursorScreenPos();
    if (ImGui::Selectable("###plate", through, 0, {width, 0})) toggleLookThroughPlate(editor);
    // The name has # in it, which a label ends at.
    ImGui::GetWindowDrawList()->AddText(
        at, ImGui::GetColorU32(lacking ? warningColour : ImGui::GetStyle().Colors[ImGuiCol_Text]),
        elided("Plate: " + name, width).c_str());
    ImGui::EndDisabled();
    noteItem("plate");
    if (ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled)) tooltip(words);
    ImGui::SameLine(ImGui::GetCursorPosX() + ImGui::GetContentRegionAvail().x - ImGui::GetFrameHeight());
    if (iconButton("##remove plate", Icon::trash, "The shot does without the plate; its files stay as they are"))
        editor.removePlate();
}

/// How the photographs are laid out. All cells have one size, so that thousands of views cost no more than those on
/// screen.
struct ViewGrid {
    int columns = 1, rows = 1;
    float width = 0, height = 0;  ///< of an image
    float cell = 0;               ///< height with the name below
    bool onward = false;          ///< the columns go on to the right, and are scrolled
    float high() const { return float(rows) * (cell + ImGui::GetStyle().ItemSpacing.y); }
};

ViewGrid gridOf(const std::vector<View>& views, float room) {
    const ImGuiStyle& style = ImGui::GetStyle();
    const float spacing = style.ItemSpacing.x;
    float aspect = 0.1f;
    for (const View& view : views)
        aspect = std::max(aspect, view.camera.width > 0 ? float(view.camera.height) / float(view.camera.width) : 0.75f);
    const auto ofWidth = [&](float width) {
        ViewGrid g;
        g.width = std::floor(width);
        g.height = std::floor(g.width * std::min(aspect, 1.2f));
        g.cell = g.height + ImGui::GetTextLineHeight() + em(0.5f);
        return g;
    };
    const auto gridFor = [&](float least) {
        const int columns = std::max(1, int((room + spacing) / (least + spacing)));
        ViewGrid g = ofWidth((room - spacing * float(columns - 1)) / float(columns));
        g.columns = columns;
        g.rows = (int(views.size()) + columns - 1) / columns;
        return g;
    };
    // A third of the column at least is left to what comes below.
    const float most = std::clamp(0.45f * ImGui::GetWindowHeight(), em(8), em(30));
    ViewGrid grid = gridFor(em(6.4f));
    for (float least = em(5.4f); grid.high() > most && least > em(2.6f); least -= em(0.5f)) grid = gridFor(least);
    if (grid.high() <= most) return grid;
    // Too many: they go on to the right, because a second scrollbar would stand beside the column's own. The last one
    // that is seen is cut, which says so.
    const float high = most - style.ScrollbarSize - em(0.2f);
    float width = std::clamp((room - 2 * spacing) / 2.5f, em(3), em(6.4f));
    while (width > em(3) && ofWidth(width).high() > high) width -= em(0.25f);
    grid = ofWidth(width);
    grid.rows = std::max(1, int(high / grid.high()));
    grid.columns = (int(views.size()) + grid.rows - 1) / grid.rows;
    grid.onward = true;
    return grid;
}

/// One photograph with its name, at the cursor.
void drawView(Editor& editor, size_t i, const ViewGrid& grid) {
    const Document& document = editor.state.document;
    const View& view = document.capture->views[i];
    const ViewCheck* check = document.check && i < document.check->views.size() ? &document.check->views[i] : nullptr;
    const auto estimate = editor.estimate();
    const ViewReproduction* worst = estimate && estimate->reproduction.measured()
                                        ? &estimate->reproduction.views[estimate->reproduction.worst()]
                                        : nullptr;
    ImGui::PushID(int(i));
    ImGui::BeginGroup();
    const bool selected = editor.state.selection.view == int(i);
    const float own =
        view.camera.width > 0 ? grid.width * float(view.camera.height) / float(view.camera.width) : grid.height;
    const float drawnWidth = own > grid.height ? grid.width * grid.height / own : grid.width,
                drawnHeight = std::min(own, grid.height);
    const ImVec2 corner = ImGui::GetCursorScreenPos();
    ImGui::Dummy({grid.width, grid.height});
    ImGui::SetCursorScreenPos(
        {corner.x + std::floor((grid.width - drawnWidth) / 2), corner.y + std::floor((grid.height - drawnHeight) / 2)});
    if (image("##image", viewImage(document, i), drawnWidth, drawnHeight, "no image", selected)) {
        editor.state.selection.view = int(i);
        editor.state.selection.emitters.clear();
        editor.pick(std::nullopt);
    }
    noteItem(fmt::format("view {}", i));
    const bool doubled = ImGui::IsItemHovered() && ImGui::IsMouseDoubleClicked(ImGuiMouseButton_Left);
    const ViewReproduction* found = explained(estimate.get(), view);
    tooltip(describe(view, check, found));
    if (doubled) editor.state.selection.view = int(i), editor.state.viewport.throughView = true;
    badges(corner, check, found && found == worst, found && found->psnr < Reproduction::gateDb);
    ImGui::SetCursorScreenPos({corner.x, corner.y + grid.height + em(0.1f)});
    const std::string name = captionOf(view.name, grid.width);
    if (selected) text(name);
    else dimText(name);
    ImGui::SetCursorScreenPos({corner.x, corner.y + grid.cell - 1});
    ImGui::Dummy({grid.width, 1});
    ImGui::EndGroup();
    ImGui::PopID();
}

/// Row after row.
void drawRows(Editor& editor, const ViewGrid& grid, int views) {
    ImGuiListClipper clipper;
    clipper.Begin(grid.rows, grid.cell + ImGui::GetStyle().ItemSpacing.y);
    while (clipper.Step())
        for (int row = clipper.DisplayStart; row < clipper.DisplayEnd; ++row)
            for (int column = 0; column < grid.columns && row * grid.columns + column < views; ++column) {
                if (column > 0) ImGui::SameLine();
                drawView(editor, size_t(row * grid.columns + column), grid);
            }
}

/// Column after column, those in sight alone.
void drawColumns(Editor& editor, const ViewGrid& grid, int views) {
    const ImVec2 start = ImGui::GetCursorPos();
    const float step = grid.width + ImGui::GetStyle().ItemSpacing.x, down = grid.cell + ImGui::GetStyle().ItemSpacing.y;
    const int first = std::max(0, int(ImGui::GetScrollX() / step)),
              last = std::min(grid.columns, int((ImGui::GetScrollX() + ImGui::GetWindowWidth()) / step) + 1);
    for (int column = first; column < last; ++column)
        for (int row = 0; row < grid.rows && column * grid.rows + row < views; ++row) {
            ImGui::SetCursorPos({start.x + float(column) * step, start.y + float(row) * down});
            drawView(editor, size_t(column * grid.rows + row), grid);
        }
    ImGui::SetCursorPos(start);
    ImGui::Dummy({float(grid.columns) * step - ImGui::GetStyle().ItemSpacing.x, grid.high() - 1});
}

}  // namespace

void drawViewsPanel(Editor& editor) {
    const Document& document = editor.state.document;
    if (!document.capture) {
        if (editor.job()) return dimWrapped(shown(editor.job()->title) + "...");
        dimWrapped(
            fmt::format("Drop a capture here: a folder with {}, photographs and a mesh. Or open one:", captureMarks()));
        if (primaryButton("Open...", "Chooses a capture folder or a saved shot", -FLT_MIN))
            editor.state.panels.openBrowser = true;
        return;
    }
    const auto& views = document.capture->views;
    if (views.empty()) return dimText("There are no views.");
    const auto estimate = editor.estimate();
    const ViewGrid grid = gridOf(views, ImGui::GetContentRegionAvail().x);
    const float scrollbar = grid.onward ? ImGui::GetStyle().ScrollbarSize : 0;
    if (beginChild("##views", {0, grid.high() + scrollbar + em(0.2f)}, false,
                   grid.onward ? ImGuiWindowFlags_HorizontalScrollbar : 0))
        grid.onward ? drawColumns(editor, grid, int(views.size())) : drawRows(editor, grid, int(views.size()));
    ImGui::EndChild();
    drawPlateEntry(editor);
    drawBookmarks(editor);
    const float side = ImGui::GetFrameHeight(),
                rest = ImGui::GetContentRegionAvail().x - side - ImGui::GetStyle().ItemSpacing.x;
    if (looksThrough(editor)) {
        if (button("Leave the camera", "The free camera goes on from here (C)", rest)) leaveView(editor);
    } else if (button(buttonWidth("Look through this camera") <= rest ? "Look through this camera###through"
                                                                      : "Look through###through",
                      "The viewport takes the place of the camera that took the selected photograph (C)", rest)) {
        lookThrough(editor, editor.state.selection.view);
    }
    ImGui::SameLine();
    ImGui::BeginDisabled(!estimate);
    if (iconButton("##bookmark", Icon::plus,
                   "Bookmark this view: keeps what the viewport shows in this list (Shift+V). Needs an estimate.",
                   false, side))
        bookmarkView(editor);
    ImGui::EndDisabled();
    noteItem("bookmark this view");
}

}  // namespace relamp::ui
