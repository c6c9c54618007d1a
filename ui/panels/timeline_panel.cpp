// Error against run time, live, and the stages with their times.
#include "base/atomic_file.h"
#include "panels/dialogs.h"
#include "panels/panels.h"
#include "plot.h"
#include "widgets.h"

namespace relamp::ui {
namespace {

struct StageTime {
    std::string stage;
    double begin = 0, end = 0, error = 0;
    int steps = 0;
};

std::vector<StageTime> stagesOf(const RunCurve& curve) {
    std::vector<StageTime> stages;
    double before = 0;
    for (const TimelineEntry& t : curve.entries) {
        if (stages.empty() || stages.back().stage != t.stage) stages.push_back({t.stage, before, t.seconds, t.rmse, 0});
        stages.back().end = t.seconds;
        stages.back().error = t.rmse;
        ++stages.back().steps;
        before = t.seconds;
    }
    return stages;
}

void saveAs(Editor& editor, const char* title, const char* extension, std::string bytes) {
    BrowserRequest request;
    request.mode = BrowserRequest::Mode::save;
    request.title = title;
    request.confirm = "Save";
    request.name = editor.state.document.name() + "-error-over-time" + extension;
    request.extensions = {extension};
    browse(request, [bytes = std::move(bytes)](Editor& e, const std::filesystem::path& file) {
        try {
            writeBytesAtomically(file, bytes);
            e.log(LogLevel::info, shown(file) + ": written");
        } catch (const std::exception& error) {
            e.fail("The plot could not be saved", error.what(),
                   "Choose another folder, or free some space, and save again.");
        }
    });
}

void stageTable(const EditorState& state) {
    if (!ImGui::BeginTable("##stages", 3,
                           ImGuiTableFlags_RowBg | ImGuiTableFlags_NoPadOuterX | ImGuiTableFlags_ScrollY))
        return;
    ImGui::TableSetupScrollFreeze(0, 1);
    ImGui::TableSetupColumn("Stage", ImGuiTableColumnFlags_WidthStretch);
    ImGui::TableSetupColumn("Took", ImGuiTableColumnFlags_WidthFixed, em(4.4f));
    ImGui::TableSetupColumn("Error", ImGuiTableColumnFlags_WidthFixed, em(4));
    ImGui::TableHeadersRow();
    constexpr const char* modes[] = {"lights in the scene", "distant light only"};
    for (size_t m = 0; m < 2; ++m) {
        const auto stages = stagesOf(state.curves[m]);
        if (stages.empty()) continue;
        ImGui::TableNextRow();
        ImGui::TableNextColumn();
        dimText(std::string(modes[m]) + (state.curves[m].running ? ", running" : ""));
        for (const StageTime& s : stages) {
            ImGui::TableNextRow();
            ImGui::TableNextColumn();
            text(elided(s.stage, ImGui::GetContentRegionAvail().x, false));
            tooltip(fmt::format("{}: {} step{}, from {} to {}", s.stage, s.steps, s.steps == 1 ? "" : "s",
                                duration(s.begin), duration(s.end)));
            ImGui::TableNextColumn();
            text(duration(s.end - s.begin));
            ImGui::TableNextColumn();
            text(s.error > 0 ? number(s.error) : "-");
        }
    }
    ImGui::EndTable();
}

}  // namespace

void drawTimelinePanel(Editor& editor) {
    const auto& curves = editor.state.curves;
    const bool any = !curves[0].entries.empty() || !curves[1].entries.empty();
    const ImVec2 room = ImGui::GetContentRegionAvail();
    const float side = room.x > em(40) ? std::min(em(20), room.x * 0.36f) : 0;
    if (beginChild("##plot", {side > 0 ? room.x - side - ImGui::GetStyle().ItemSpacing.x : 0, 0})) {
        const ImVec2 inner = ImGui::GetContentRegionAvail();
        drawLogPlot("##error", timelineCurves(curves), "seconds since the start",
                    "Difference of points with equal colour (relative)", inner,
                    "Error against run time appears here while an estimate runs.");
    }
    ImGui::EndChild();
    if (side <= 0) return;
    ImGui::SameLine();
    if (beginChild("##right", {0, 0})) {
        ImGui::BeginDisabled(!any);
        if (button("Save CSV...", "Writes all values as a table for a spreadsheet"))
            saveAs(editor, "Save the values", ".csv", timelineCsv(curves));
        ImGui::SameLine();
        if (button("Save SVG...", "Writes the plot as a drawing for a page"))
            saveAs(editor, "Save the plot", ".svg", timelineSvg(curves));
        ImGui::EndDisabled();
        if (any) stageTable(editor.state);
        else dimWrapped("The stages of an estimate and their times appear here.");
    }
    ImGui::EndChild();
}

}  // namespace relamp::ui
