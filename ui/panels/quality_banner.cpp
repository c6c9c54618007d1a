// A calm strip above the viewport when an estimate does not explain its photographs: why, most likely, and what to do.
#include "panels/panels.h"
#include "widgets.h"

namespace relamp::ui {
namespace {

std::string wordsOf(const Reproduction& r) {
    return fmt::format(
        "This estimate explains its photographs badly ({:.1f} dB; {:.0f} dB and more can be trusted). {}", r.median,
        Reproduction::gateDb, r.advice);
}

float buttonWidth() { return em(5); }

}  // namespace

bool qualityBannerShown(const Editor& editor) {
    const auto estimate = editor.estimate();
    return estimate && !editor.job() && estimate->reproduction.poor() &&
           editor.state.bannerClosedFor.lock() != estimate;
}

float qualityBannerHeight(const Editor& editor, float width) {
    const float room = std::max(em(8), width - buttonWidth() - 4 * ImGui::GetStyle().ItemSpacing.x);
    return ImGui::CalcTextSize(wordsOf(editor.estimate()->reproduction).c_str(), nullptr, false, room).y + em(1);
}

void drawQualityBanner(Editor& editor) {
    const auto estimate = editor.estimate();
    const float width = ImGui::GetContentRegionAvail().x,
                room = std::max(em(8), width - buttonWidth() - 2 * ImGui::GetStyle().ItemSpacing.x);
    ImGui::PushTextWrapPos(ImGui::GetCursorPosX() + room);
    ImGui::PushStyleColor(ImGuiCol_Text, warningColour);
    text(wordsOf(estimate->reproduction));
    ImGui::PopStyleColor();
    ImGui::PopTextWrapPos();
    tooltip("The views list shows how well each photograph is explained; mode 3 shows where they differ.");
    ImGui::SameLine(ImGui::GetCursorPosX() + width - buttonWidth());
    if (button("Close", "Hides this until the next estimate; the figure stays in the status bar", buttonWidth()))
        editor.state.bannerClosedFor = estimate;
}

}  // namespace relamp::ui
