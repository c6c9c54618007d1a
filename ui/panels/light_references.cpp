// Light references of a capture: panoramas of the set that estimates take part of the light from, and how well each
// agreed with the photographs.
#include <algorithm>
#include <cmath>

#include "panels/dialogs.h"
#include "panels/inspector.h"
#include "panels/panels.h"
#include "widgets.h"

namespace relamp::ui {
namespace {
namespace fs = std::filesystem;

constexpr const char* referenceWords =
    "A panorama of the set as it was when the photographs were taken (EXR or HDR). It measures the environment "
    "where no photograph shows it. How it is turned and exposed is found.";

/// What the last estimate found of this file; null: it did not have it.
const ProbeFit* fitOf(const Editor& editor, const fs::path& file) {
    const auto estimate = editor.estimate();
    if (!estimate) return nullptr;
    for (const ProbeFit& fit : estimate->probes)
        if (fit.name == file.filename().string()) return &fit;
    return nullptr;
}

void saidOf(const ProbeFit& fit) {
    if (fit.doubtful()) warningText(shown(fit.words));
    else dimWrapped(shown(fit.words));
}

}  // namespace

bool drawPanoramaQuestion(Editor& editor) {
    if (!editor.state.panorama) return true;
    const fs::path file = editor.state.panorama->file;
    wrapped(shown(file.filename()) + " can be used in two ways.");
    ImGui::Spacing();
    const bool busy = editor.job().has_value();
    const float width = em(17);
    const auto answer = [&](PanoramaUse use) {
        editor.answerPanorama(use);
        return true;
    };
    ImGui::BeginDisabled(busy);
    if (primaryButton("Use as light reference of this capture", referenceWords, width) ||
        (!busy && enterPressed() && !ImGui::IsWindowAppearing())) {
        ImGui::EndDisabled();
        return answer(PanoramaUse::lightReference);
    }
    dimWrapped("It was taken on the set, in the light of the photographs: the estimate measures with it.");
    ImGui::Spacing();
    if (button("Use as environment",
               "Replaces the recovered environment, once there is one; the estimate does not see it", width)) {
        ImGui::EndDisabled();
        return answer(PanoramaUse::environment);
    }
    ImGui::EndDisabled();
    dimWrapped("It is other light: the scene is relit with it after the estimate.");
    ImGui::Spacing();
    if (busy) dimWrapped(editor.job()->title + " has to end first.");
    if (button("Cancel", "Does nothing (Esc)", em(7)) || escapePressed()) return answer(PanoramaUse::none);
    return false;
}

void drawLightReferences(Editor& editor) {
    std::vector<fs::path>& probes = editor.state.solve.lightProbes;
    dimText("Light references");
    tooltip(referenceWords);
    size_t gone = probes.size();
    for (size_t i = 0; i < probes.size(); ++i) {
        ImGui::PushID(int(i));
        const float icon = ImGui::GetFrameHeight() + ImGui::GetStyle().ItemSpacing.x;
        text(elided(shown(probes[i].filename()), ImGui::GetContentRegionAvail().x - icon));
        tooltip(shown(probes[i]));
        ImGui::SameLine(ImGui::GetCursorPosX() + ImGui::GetContentRegionAvail().x - ImGui::GetFrameHeight());
        if (iconButton("##remove reference", Icon::trash, "The next estimate does without it")) gone = i;
        if (const ProbeFit* fit = fitOf(editor, probes[i])) saidOf(*fit);
        ImGui::PopID();
    }
    if (gone < probes.size()) probes.erase(probes.begin() + std::ptrdiff_t(gone));
    ImGui::BeginDisabled(!editor.state.document.capture || editor.job());
    if (button("Add light probe...", referenceWords, -FLT_MIN)) {
        BrowserRequest request;
        request.title = "Choose a light reference";
        request.confirm = "Use";
        request.extensions = {".exr", ".hdr"};
        request.note = "A latitude-longitude panorama of the set, twice as wide as high (EXR or HDR).";
        request.start = editor.state.document.captureFolder;
        browse(request, [](Editor& e, const fs::path& file) { e.addLightProbe(file); });
    }
    ImGui::EndDisabled();
}

void inspectLightReferences(const Estimate& estimate) {
    if (estimate.probes.empty()) return;
    if (!section("Evidence", "What was measured on the set, and how well it agrees with the photographs")) return;
    for (const ProbeFit& fit : estimate.probes) {
        text(shown(fit.name));
        fact("Part in the light", fit.used ? "yes" : "none", "Whether the estimate took it as a measurement");
        if (!fit.by.empty()) {
            if (fit.by == "background")
                fact("Turned by", fmt::format("{:.1f}\u00b0 +- {:.1f}\u00b0", fit.yawDegrees, fit.yawSigma),
                     "About the vertical, counter-clockwise from above, to lie as the capture does");
            fact("Exposed by", signedStops(std::log2(std::max(1e-6f, luminance(fit.gain)))) + " stops",
                 "Radiance of the light found over the panorama's");
            fact("Agrees within", percent(double(fit.measuredNoise > 0 ? fit.measuredNoise : fit.noise)),
                 "Deviation of a patch of 7 degrees from the background that the photographs show");
            if (fit.residual > 0)
                fact("Light found differs", percent(double(fit.residual)),
                     "From the panorama, weighted by what the surfaces receive");
        }
        if (fit.doubtful() || fit.by.empty()) saidOf(fit);
    }
}

}  // namespace relamp::ui
