// What the estimate does and what it leaves out because the scene does not need it, with times.
#include "panels/panels.h"
#include "widgets.h"

namespace relamp::ui {
namespace {

std::string secondsOf(double value) { return value < 0 ? "-" : value < 0.05 ? "0 s" : duration(value); }

void stagesKept(const SolvePlan& plan) {
    if (!ImGui::BeginTable("##kept", 4, ImGuiTableFlags_RowBg | ImGuiTableFlags_NoPadOuterX | ImGuiTableFlags_ScrollY))
        return;
    ImGui::TableSetupScrollFreeze(0, 1);
    ImGui::TableSetupColumn("What is done", ImGuiTableColumnFlags_WidthStretch);
    ImGui::TableSetupColumn("Expected", ImGuiTableColumnFlags_WidthFixed, em(5));
    ImGui::TableSetupColumn("Took", ImGuiTableColumnFlags_WidthFixed, em(4.4f));
    ImGui::TableSetupColumn("Memory", ImGuiTableColumnFlags_WidthFixed, em(5));
    ImGui::TableHeadersRow();
    for (const PlannedStage& s : plan.stages) {
        ImGui::TableNextRow();
        ImGui::TableNextColumn();
        text(elided(nameOf(s.stage), ImGui::GetContentRegionAvail().x, false));
        tooltip(s.predictedMib >= 0 ? fmt::format("{}: {:.0f} MiB expected", nameOf(s.stage), s.predictedMib)
                                    : std::string(nameOf(s.stage)));
        ImGui::TableNextColumn();
        text(secondsOf(s.predictedSeconds));
        ImGui::TableNextColumn();
        text(secondsOf(s.measuredSeconds));
        ImGui::TableNextColumn();
        text(s.measuredMib >= 0 ? fmt::format("{:.0f} MiB", s.measuredMib) : "-");
    }
    ImGui::EndTable();
}

void partsLeftOut(const SolvePlan& plan) {
    if (plan.leftOut.empty()) return dimWrapped("Nothing is left out.");
    text(fmt::format("Left out, because this scene does not need it: saves about {}", secondsOf(plan.savedSeconds())));
    for (const PlannedOmission& o : plan.leftOut) {
        ImGui::Bullet();
        ImGui::SameLine();
        dimWrapped(o.savedSeconds >= 0.05
                       ? fmt::format("{} ({}): {}", nameOf(o.what), secondsOf(o.savedSeconds), o.reason)
                       : fmt::format("{}: {}", nameOf(o.what), o.reason));
    }
}

}  // namespace

void drawPlanPanel(Editor& editor) {
    const SolvePlan& plan = editor.state.plan;
    if (plan.stages.empty() && plan.leftOut.empty())
        return dimWrapped(
            "What an estimate does, what it leaves out and what each part takes appears here when one starts.");
    const ImVec2 room = ImGui::GetContentRegionAvail();
    const float side = room.x > em(44) ? room.x * 0.5f : 0;
    if (beginChild("##stages",
                   {side > 0 ? room.x - side - ImGui::GetStyle().ItemSpacing.x : 0, side > 0 ? 0 : room.y * 0.5f}))
        stagesKept(plan);
    ImGui::EndChild();
    if (side > 0) ImGui::SameLine();
    if (beginChild("##omissions", {0, 0})) partsLeftOut(plan);
    ImGui::EndChild();
}

}  // namespace relamp::ui
