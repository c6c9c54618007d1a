// Light references of a capture: panoramas of the set that estimates take part of the light from, and how well each
// agreed with the photographs.
#include <algorithm>
#include <cmath>

#include "base/statistics.h"
#include "panels/dialogs.h"
#include "panels/inspector.h"
#include "panels/panels.h"
#include "panels/reference_marks.h"
#include "widgets.h"

namespace relamp::ui {
namespace {
namespace fs = std::filesystem;

constexpr const char* referenceWords =
    "A panorama of the set as it was when the photographs were taken (EXR or HDR). It measures the environment "
    "where no photograph shows it. How it is turned and exposed is found.";

/// What the estimate found of the probe of this name; null: it did not have it.
const ProbeFit* fitOf(const Estimate& estimate, const std::string& name) {
    for (const ProbeFit& fit : estimate.probes)
        if (fit.name == name) return &fit;
    return nullptr;
}

void saidOf(const ProbeFit& fit) {
    if (fit.doubtful()) warningText(shown(fit.words));
    else dimWrapped(shown(fit.words));
}

/// What is found over what was told, and how many patches do not agree.
struct PatchSummary {
    size_t patches = 0, doubtful = 0, leftOut = 0;
    std::vector<float> ratios;
};
PatchSummary summaryOf(const Estimate& estimate, const std::string& begin) {
    PatchSummary all;
    for (const PatchFit& fit : estimate.patches) {
        if (!fit.name.starts_with(begin)) continue;
        ++all.patches;
        all.doubtful += fit.doubtful;
        all.leftOut += !fit.used;
        all.ratios.push_back(luminance(fit.found) / std::max(1e-6f, luminance(fit.told)));
    }
    return all;
}

/// How the last estimate agrees with what is marked; nothing where it did not have it.
void saidOf(const Estimate& estimate, const MarkedReference& mark) {
    if (const ProbeFit* fit = fitOf(estimate, nameOf(mark))) return saidOf(*fit);
    const PatchSummary all = summaryOf(estimate, nameOf(mark));
    if (all.patches == 0) return;
    const std::string words = fmt::format("Found {} of what is told.", percent(double(medianOf(all.ratios))));
    if (all.doubtful == 0) return dimWrapped(words);
    const std::string left = all.leftOut == 0   ? ""
                             : all.patches == 1 ? " It was left out; tell a white patch to insist."
                                                : fmt::format(" {} were left out.", all.leftOut);
    warningText(words +
                (all.patches == 1 ? " Other measurements contradict it."
                                  : fmt::format(" {} of {} patches do not agree.", all.doubtful, all.patches)) +
                left);
}

/// A name with a bin behind it. True when the bin was pressed.
bool referenceRow(const std::string& name, const std::string& explanation, const std::function<void()>& clicked) {
    const float icon = ImGui::GetFrameHeight() + ImGui::GetStyle().ItemSpacing.x,
                width = ImGui::GetContentRegionAvail().x - icon;
    if (clicked) {
        if (ImGui::Selectable(elided(name, width).c_str(), false, 0, {width, 0})) clicked();
    } else {
        text(elided(name, width));
    }
    tooltip(explanation);
    ImGui::SameLine(ImGui::GetCursorPosX() + ImGui::GetContentRegionAvail().x - ImGui::GetFrameHeight());
    return iconButton("##remove reference", Icon::trash, "The next estimate does without it");
}

void drawMarks(Editor& editor) {
    std::vector<MarkedReference>& marks = editor.state.solve.marks;
    const Document& document = editor.state.document;
    const auto estimate = editor.estimate();
    size_t gone = marks.size();
    for (size_t i = 0; i < marks.size(); ++i) {
        const MarkedReference& mark = marks[i];
        const bool there = document.capture && mark.view < document.capture->views.size();
        const fs::path where = !mark.photograph.empty() ? mark.photograph.filename()
                               : there                  ? fs::path(document.capture->views[mark.view].name)
                                                        : fs::path();
        ImGui::PushID(int(i));
        if (referenceRow(fmt::format("{}, {}", wordOf(mark.kind), shown(where)), "A click shows it and changes it",
                         [&] {
                             editor.state.marking = ReferenceMarking{mark, i};
                         }))
            gone = i;
        if (estimate) saidOf(*estimate, mark);
        ImGui::PopID();
    }
    if (gone < marks.size()) marks.erase(marks.begin() + std::ptrdiff_t(gone));
}

/// Begins to mark one in the selected view's photograph.
void markButton(Editor& editor, MarkedReference::Kind kind, const char* explanation, float width) {
    if (!button(fmt::format("{}...", wordOf(kind)).c_str(), explanation, width)) return;
    ReferenceMarking marking;
    marking.mark.kind = kind;
    marking.mark.view = size_t(std::max(0, editor.state.selection.view));
    editor.state.marking = marking;
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
    tooltip(
        "What was measured on the set: panoramas, mirror balls, grey cards, charts. An estimate takes them as "
        "measurements.");
    size_t gone = probes.size();
    for (size_t i = 0; i < probes.size(); ++i) {
        ImGui::PushID(int(i));
        if (referenceRow(shown(probes[i].filename()), shown(probes[i]), {})) gone = i;
        const auto estimate = editor.estimate();
        const ProbeFit* fit = estimate ? fitOf(*estimate, probes[i].filename().string()) : nullptr;
        if (fit) saidOf(*fit);
        ImGui::PopID();
    }
    if (gone < probes.size()) probes.erase(probes.begin() + std::ptrdiff_t(gone));
    drawMarks(editor);
    ImGui::BeginDisabled(!editor.state.document.capture || editor.job());
    const float half = (ImGui::GetContentRegionAvail().x - ImGui::GetStyle().ItemSpacing.x) / 2;
    if (button("Light probe...", referenceWords, half)) {
        BrowserRequest request;
        request.title = "Choose a light reference";
        request.confirm = "Use";
        request.extensions = {".exr", ".hdr"};
        request.note = "A latitude-longitude panorama of the set, twice as wide as high (EXR or HDR).";
        request.start = editor.state.document.captureFolder;
        browse(request, [](Editor& e, const fs::path& file) { e.addLightProbe(file); });
    }
    ImGui::SameLine();
    markButton(editor, MarkedReference::Kind::mirrorBall,
               "A mirror ball in a photograph: what it mirrors measures the environment", half);
    markButton(editor, MarkedReference::Kind::grey,
               "A grey card or ball in a photograph: its albedo is known, so the scale of all light is", half);
    ImGui::SameLine();
    markButton(editor, MarkedReference::Kind::chart,
               "A chart of 24 patches in a photograph: it fixes scale and white balance", half);
    ImGui::EndDisabled();
}

void inspectLightReferences(const Estimate& estimate) {
    if (estimate.probes.empty() && estimate.patches.empty()) return;
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
    if (estimate.patches.empty()) return;
    const PatchSummary all = summaryOf(estimate, "");
    text(all.patches == 1 ? "Known patch" : fmt::format("{} known patches", all.patches));
    fact("Found over told", percent(double(medianOf(all.ratios))), "Albedo of the patches, median");
    fact("Contradicted", all.doubtful == 0 ? "none" : count(all.doubtful),
         "Patches that differ from what was told by more than three deviations and 5 %");
    if (all.leftOut > 0)
        fact("Left out", count(all.leftOut), "Patches that took no part, because what else is known contradicts them");
    for (const PatchFit& fit : estimate.patches)
        if (fit.doubtful) warningText(shown(fit.words));
}

}  // namespace relamp::ui
