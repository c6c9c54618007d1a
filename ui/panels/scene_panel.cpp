// The left column: what the scene consists of, from the photographs to the button that separates it.
#include "panels/panels.h"
#include "widgets.h"

namespace relamp::ui {

void drawScenePanel(Editor& editor) {
    const Document& document = editor.state.document;
    const bool open = document.capture != nullptr;
    const std::string views =
        open ? fmt::format("Views ({})###views", document.capture->views.size()) : "Views###views";
    const size_t lights = editor.emitters().size();
    const std::string emitters = lights ? fmt::format("Lights ({})###emitters", lights) : "Lights###emitters";
    const bool estimated = editor.estimate() != nullptr;
    const bool solving = editor.job() && editor.job()->kind == JobStatus::Kind::solve;
    const float below = ImGui::GetFrameHeightWithSpacing() + em(0.9f) +
                        (solving ? ImGui::GetFrameHeightWithSpacing() + ImGui::GetTextLineHeightWithSpacing()
                         : interruptedOfferShown(editor) ? ImGui::GetFrameHeightWithSpacing()
                                                         : 0);
    if (beginChild("##sections", {0, -below})) {
        if (section(views.c_str(), "The photographs of this capture")) drawViewsPanel(editor);
        if (section(emitters.c_str(), "Lights that stand in the scene: what was recovered, and what you add")) {
            drawEmittersPanel(editor);
            drawUnobservedLights(editor);
        }
        if (section("Environment", "Light from far away: sky, windows, the room around", estimated))
            drawEnvironmentPanel(editor);
        if (section("Surfaces", "How the surfaces reflect light", estimated)) drawMaterialsPanel(editor);
        if (editor.state.panels.solveSettings) ImGui::SetNextItemOpen(true), editor.state.panels.solveSettings = false;
        if (section("Settings of the estimate",
                    "Quality, time limit, and how light and surface brightness are told apart", false))
            drawEstimateSettings(editor);
    }
    ImGui::EndChild();
    drawEstimateButton(editor);
}

}  // namespace relamp::ui
