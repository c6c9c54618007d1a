// One line that says how things stand: the job at the left, figures and marks at the right; the less important ones go
// first when there is no room.
#include <unistd.h>

#include <fstream>

#include "panels/panels.h"
#include "viewport/navigation.h"
#include "widgets.h"

namespace relamp::ui {
namespace {

/// Resident memory of this process now, MiB; read once a second.
double residentMib() {
    static double value = 0, read = -10;
    if (const double now = ImGui::GetTime(); now - read > 1) {
        read = now;
        long pages = 0, resident = 0;
        if (std::ifstream in("/proc/self/statm"); in >> pages >> resident)
            value = double(resident) * double(sysconf(_SC_PAGESIZE)) / 1048576;
    }
    return value;
}

struct Piece {
    std::string words, explanation;
    int rank = 0;  ///< lower goes first
    bool badge = false;
    ImVec4 colour = dimColour;
};

float widthOf(const Piece& component) {
    return ImGui::CalcTextSize(component.words.c_str()).x + (component.badge ? em(0.7f) : 0);
}

std::string gaugeExplanation(const GaugeReport& gauge) {
    std::string words = "Brightness scale: how light and surface brightness were told apart.\n";
    words += gauge.kind == "assumed" ? "It was assumed, so all lights may be off by one factor" : "It was measured";
    return words + (gauge.evidence.empty() ? "." : ": " + gauge.evidence + ".");
}

/// Who does a step and how long each took when it was measured.
std::string placeOf(const char* step, bool onCard, double processorMs, double cardMs) {
    if (onCard)
        return fmt::format("\n{}: on the graphics card ({:.1f} ms, the processor would take {:.1f} ms)", step, cardMs,
                           processorMs);
    if (cardMs > 0)
        return fmt::format("\n{}: on the processor ({:.1f} ms, the graphics card would take {:.1f} ms)", step,
                           processorMs, cardMs);
    if (processorMs > 0) return fmt::format("\n{}: on the processor ({:.1f} ms)", step, processorMs);
    return fmt::format("\n{}: on the processor", step);
}

/// Where light is summed and dragged lights are computed; empty before the first image.
std::string lightSums(const Editor& editor) {
    const auto frame = editor.liveFrame();
    if (!frame) return {};
    const LiveReport& report = frame->report;
    return placeOf("Light sums", !report.device.empty(), report.cpuApplyMs, report.deviceApplyMs) +
           placeOf("Dragged lights", !report.nearDevice.empty(), report.cpuNearMs, report.deviceNearMs) +
           placeOf("Their shadows", !report.shadowDevice.empty(), report.cpuShadowMs, report.deviceShadowMs);
}

std::vector<Piece> piecesOf(const Editor& editor) {
    const EditorState& state = editor.state;
    std::vector<Piece> components;
    const auto estimate = editor.estimate();
    if (state.document.readOnly)
        components.push_back({"read-only", "Another process has this shot open: saving asks for another place.", 99,
                              true, warningColour});
    if (!state.viewport.solo.empty())
        components.push_back(
            {"solo", "Only some lights are shown in the viewport; files and exports are not touched. Shift+M ends it.",
             95, true, warningColour});
    if (editor.stale())
        components.push_back({"settings changed",
                              "The settings have changed since the last estimate: estimate again to use them.", 90,
                              true, warningColour});
    if (estimate && estimate->cancelled && !editor.job())
        components.push_back({"stopped early",
                              "The estimate was stopped before its end: this is the best answer so far.", 70, true,
                              warningColour});
    if (editor.relightingPlate())
        components.push_back({"relighting plate", "The plate is relit under the present look", 30, false, dimColour});
    else if (editor.refining())
        components.push_back({"refining", "The image gets better while you wait", 30, false, dimColour});
    if (estimate && estimate->reproduction.measured()) {
        const Reproduction& r = estimate->reproduction;
        const ViewReproduction& worst = r.views[r.worst()];
        std::string words = fmt::format(
            "How well frames through the photographs' cameras match the photographs, on the surfaces: median of {} "
            "views, in decibels. "
            "35 is very good, below {:.0f} is not to be trusted.\nWorst: {}, {:.1f} dB.",
            r.views.size(), Reproduction::gateDb, shown(worst.name), worst.psnr);
        if (r.heldOut > 0)
            words += fmt::format(
                "\nViews left out of the estimate are predicted at {:.1f} dB: so good will new views be.", r.heldOut);
        if (!r.advice.empty()) words += "\n" + r.advice;
        components.push_back({fmt::format("photographs {:.1f} dB", r.median), words, 80, r.poor(),
                              r.poor() ? warningColour : dimColour});
    }
    if (estimate && !estimate->gauge.kind.empty()) {
        const bool assumed = estimate->gauge.kind == "assumed";
        components.push_back({assumed ? "scale: assumed" : "scale: measured", gaugeExplanation(estimate->gauge), 60,
                              false, assumed ? warningColour : dimColour});
    }
    components.push_back(
        {displayViewOf(editor) +
             (state.viewport.exposureStops != 0 ? " " + signedStops(state.viewport.exposureStops) : ""),
         "How linear light becomes screen colours, and the exposure of the screen in stops. EXR "
         "files are not touched.",
         50, false, dimColour});
    if (state.probe) {
        const float stops = std::log2(std::max(luminance(*state.probe), 1e-9f) / 0.18f) + state.viewport.exposureStops;
        components.push_back({fmt::format("{} {} {}  {:+.1f} stops", number(state.probe->x), number(state.probe->y),
                                          number(state.probe->z), stops),
                              "Under the pointer: radiance, red green blue, without fine texture, and stops above "
                              "middle grey at the exposure of the screen",
                              55, false, dimColour});
    }
    if (state.framesPerSecond > 0)
        components.push_back({fmt::format("{:.0f} fps {:.1f} ms", state.framesPerSecond, state.frameCpuMs),
                              "Frames a second while something moves, and relamp's own work for each frame", 40, false,
                              dimColour});
    const double resident = residentMib();
    const double peak = std::max(peakMib(), state.document.resources.peakMib);
    components.push_back({mebibytes(resident),
                          fmt::format("Memory in use now. The most so far was {}.", mebibytes(peak)), 45, false,
                          dimColour});
    if (!state.gpu.empty())
        components.push_back(
            {elided(state.gpu, em(12)), "Graphics: " + state.gpu + lightSums(editor), 10, false, dimColour});
    if (state.document.capture)
        components.push_back(
            editor.unsavedChanges()
                ? Piece{"unsaved",
                        "There are edits that are not in the shot's folder yet (Ctrl+S). They are saved "
                        "by themselves every few seconds, for the case of a crash.",
                        85, false, warningColour}
                : Piece{state.document.shotFolder.empty() ? "no edits" : "saved",
                        state.document.shotFolder.empty() ? "Nothing to save yet"
                                                          : "Everything is in " + shown(state.document.shotFolder),
                        20, false, dimColour});
    return components;
}

}  // namespace

namespace {
/// What to do, what was just done, else what is open and selected.
std::string nowWords(const Editor& editor) {
    static uint64_t told = 0;
    static double since = -1e9;
    const EditorState& state = editor.state;
    if (state.messages != told) told = state.messages, since = ImGui::GetTime();
    if (!state.keyHints.empty()) return state.keyHints;
    // At rest nothing is drawn, so the message then stays until something else happens.
    if (ImGui::GetTime() - since < 6 && !state.message.empty()) return shown(state.message);
    if (state.panels.hidden) return "Tab brings the panels back";
    if (state.selection.emitters.size() == 1) return shown(editor.namesOf(state.selection.emitters));
    if (!state.selection.emitters.empty()) return fmt::format("{} lights selected", state.selection.emitters.size());
    return !state.document.capture ? "Drop a capture here, or press Ctrl+O"
           : !editor.estimate()    ? "Ready to estimate (Ctrl+Enter)"
                                   : shown(state.document.name());
}
}  // namespace

float statusBarHeight() { return ImGui::GetFrameHeight() + ImGui::GetStyle().ItemSpacing.y; }

void drawStatusBar(Editor& editor) {
    const float start = ImGui::GetCursorPosX(), room = ImGui::GetContentRegionAvail().x, gap = em(1.1f);
    std::vector<Piece> components = piecesOf(editor);
    const auto& job = editor.job();
    const std::string now = nowWords(editor);
    const bool hint = !editor.state.keyHints.empty();

    // The job keeps at least this much; marks on the right are dropped by rank until they fit.
    const float wanted = ImGui::CalcTextSize(now.c_str()).x + em(1);
    const float reserved = hint  ? std::min(room, wanted)
                           : job ? std::min(room * 0.55f, em(30))
                                 : std::clamp(wanted, em(9), room * 0.7f);
    const auto total = [&] {
        float sum = 0;
        for (const Piece& component : components) sum += widthOf(component) + gap;
        return sum;
    };
    while (!components.empty() && total() > room - reserved)
        components.erase(std::min_element(components.begin(), components.end(),
                                          [](const Piece& a, const Piece& b) { return a.rank < b.rank; }));
    const float own = room - total();

    ImGui::AlignTextToFramePadding();
    if (hint) {
        text(elided(now, own - em(0.5f), false));
    } else if (job) {
        const float buttons = 2 * (ImGui::GetFrameHeight() + ImGui::GetStyle().ItemSpacing.x);
        const std::string left = timeLeftWords(*job);
        const std::string stage = job->stage.empty() ? left : left + " (" + job->stage + ")";
        const float barWidth = std::min(em(7), own * 0.25f);
        ImGui::BeginDisabled(job->stopping);
        if (iconButton("##stop", Icon::stop, "Stops this job (Ctrl+.). An estimate keeps its best answer so far."))
            editor.cancelJob();
        ImGui::SameLine();
        if (iconButton("##pause", job->paused ? Icon::play : Icon::pause,
                       job->paused ? "Goes on" : "Pauses, to give the processor to something else"))
            editor.pauseJob(!job->paused);
        ImGui::EndDisabled();
        ImGui::SameLine();
        // The buttons may have ended the job.
        if (editor.job()) {
            bar(job->whole.value_or(-1), progressColour, job->whole ? percent(*job->whole) : "", barWidth);
            tooltip(fmt::format("{}: {} of the whole.\nNow: {}, {} of this step. {} so far.", job->title,
                                job->whole ? percent(*job->whole) : "some", job->stage, percent(job->fraction),
                                duration(job->seconds)));
            ImGui::SameLine();
            const float rest =
                std::max(em(2), own - buttons - barWidth - 2 * ImGui::GetStyle().ItemSpacing.x - em(0.5f));
            const std::string whole = job->title + ": " + stage;
            const auto fits = [&](const std::string& words) { return ImGui::CalcTextSize(words.c_str()).x <= rest; };
            text(fits(whole) ? whole : fits(stage) ? stage : elided(left, rest, false));
            tooltip(whole);
        }
    } else {
        dimText(elided(now, own - em(0.5f), false));
        tooltip("What is open and selected");
    }
    float x = start + room - total() + gap;
    for (const Piece& component : components) {
        ImGui::SameLine(x);
        if (component.badge) {
            badge(component.words, component.colour, component.explanation);
        } else {
            ImGui::PushStyleColor(ImGuiCol_Text, component.colour);
            text(component.words);
            ImGui::PopStyleColor();
            tooltip(component.explanation);
        }
        x += widthOf(component) + gap;
    }
    if (components.empty()) ImGui::NewLine();
}

}  // namespace relamp::ui
