// The import doctor: what was noticed about cameras, exposure and mesh before anything is estimated, and what to do
// about it.
#include <cmath>
#include <optional>

#include "panels/dialogs.h"
#include "panels/images.h"
#include "panels/panels.h"
#include "widgets.h"

namespace relamp::ui {
namespace {

/// What to do about a warning, told from its words.
std::string adviceFor(const std::string& warning) {
    const auto has = [&](const char* part) { return warning.find(part) != std::string::npos; };
    if (has("much better. Try")) return "The button below reads the files so. They are not touched.";
    if (has("OpenCV axes")) return "Flip the cameras' axes below, or export with OpenGL axes.";
    if (has("set \"up\""))
        return "Turn the world below when it stands on its side; ignore this when the cameras were really tilted.";
    if (has("clipped"))
        return "Add darker exposures of the same view, or accept that what is clipped is known only as \"at least this "
               "bright\".";
    if (has("stops"))
        return "Develop all photographs with the same settings, or leave this one out. Where lights were switched "
               "between photographs, name their lighting states below.";
    if (has("covers"))
        return "Turn on the mesh overlay and look through this camera: mesh and photograph should lie on each other.";
    if (has("left out")) return "Look at its mask: black is ignored.";
    if (has("NaN")) return "These pixels are ignored. Write the file again if there are many.";
    if (has("black")) return "Leave this view out, or check its file.";
    if (has("only") && has("views")) return "Add photographs from other sides; five or more see most surfaces twice.";
    if (has("two views")) return "Add photographs, so that surfaces are seen from several sides.";
    if (has("holes")) return "Close large holes in the mesh where light could come through; small ones do no harm.";
    if (has("Is the scene really")) return "If so, the button below says so; nothing but lengths rests on it.";
    if (has("m across")) return "Scale mesh and cameras together, so that one unit is a metre.";
    if (has("faces") || has("vertices") || has("edges")) return "It was repaired; nothing has to be done.";
    return "";
}

/// Sets right what the files say about their axes; the capture is then read again.
void axes(Editor& editor, const CaptureCheck& check) {
    const CaptureFix now = editor.state.document.fix;
    std::optional<CaptureFix> wanted;
    const auto changeTo = [&](const CaptureFix& fix) {
        wanted = fix;
        // What was found along the old axes is found anew.
        wanted->registration = {};
        wanted->mend = {};
        std::erase_if(wanted->proxies, [](const ProxyLight& p) { return p.observed(); });
    };
    const auto change = [&](const std::string& up, bool flipped) {
        CaptureFix fix = now;
        fix.up = up;
        fix.flipCameras = flipped;
        changeTo(fix);
    };
    ImGui::BeginDisabled(editor.job().has_value());
    if (check.advice && button(check.advice->button.c_str(),
                               "Reads the capture again as the photographs speak for. The files are not touched."))
        changeTo(advised(now, *check.advice));
    if (check.unitQuestion && button(check.unitQuestion->button.c_str(),
                                     "Reads the capture again in this unit. The files are not touched.")) {
        CaptureFix fix = now;
        fix.scale = check.unitQuestion->scale;
        changeTo(fix);
    }
    if (!check.upGuess.empty() && check.upGuess != check.up) {
        warningText(fmt::format("The world may stand on its side. The cameras think that {} is up.", check.upGuess));
        if (button(fmt::format("Turn it: {} is up", check.upGuess).c_str(),
                   "Reads the capture again with this axis up. The files are not touched."))
            change(check.upGuess, now.flipCameras);
    }
    if (check.lookBackwards) {
        warningText("The cameras look away from the mesh.");
        if (button("Flip the cameras",
                   "Reads the matrices as OpenCV's (Y down, looking along +Z). The files are not touched."))
            change(now.up, !now.flipCameras);
    }
    ImGui::AlignTextToFramePadding();
    dimText("Up in the files");
    ImGui::SameLine();
    ImGui::SetNextItemWidth(em(8));
    if (ImGui::BeginCombo("##up", now.up.empty() ? "as they say" : now.up.c_str())) {
        for (const char* axis : {"", "z", "-z", "y", "-y", "x", "-x"})
            if (ImGui::Selectable(*axis ? axis : "as they say", now.up == axis) && now.up != axis)
                change(axis, now.flipCameras);
        ImGui::EndCombo();
    }
    tooltip(
        "The axis that points up in the capture's files. The scene is turned so that it stands upright; the files are "
        "not touched.");
    bool flip = now.flipCameras;
    sameLineIfFits(em(12));
    if (checkbox("Cameras flipped", flip,
                 "Reads the camera matrices as OpenCV's: Y down, looking along +Z. For cameras that look away from the "
                 "mesh."))
        change(now.up, flip);
    ImGui::EndDisabled();
    if (editor.estimate())
        dimWrapped(
            "A change here reads the capture again; the present estimate and its edits then go. Undo brings them "
            "back.");
    if (wanted) editor.fixCapture(*wanted);
}

void viewTable(Editor& editor, const CaptureCheck& check, float height) {
    const float room = ImGui::GetContentRegionAvail().x;
    const bool images = room > em(30), masked = room > em(36);
    if (!ImGui::BeginTable("##views", 4 + images + masked,
                           ImGuiTableFlags_RowBg | ImGuiTableFlags_ScrollY | ImGuiTableFlags_NoPadOuterX, {0, height}))
        return;
    ImGui::TableSetupScrollFreeze(0, 1);
    if (images) ImGui::TableSetupColumn("", ImGuiTableColumnFlags_WidthFixed, em(3.6f));
    ImGui::TableSetupColumn("View", ImGuiTableColumnFlags_WidthStretch);
    ImGui::TableSetupColumn("Mesh", ImGuiTableColumnFlags_WidthFixed, em(3.6f));
    ImGui::TableSetupColumn("Clipped", ImGuiTableColumnFlags_WidthFixed, em(4.2f));
    if (masked) ImGui::TableSetupColumn("Left out", ImGuiTableColumnFlags_WidthFixed, em(4.2f));
    ImGui::TableSetupColumn("Exposure", ImGuiTableColumnFlags_WidthFixed, em(5));
    ImGui::TableHeadersRow();
    ImGuiListClipper clipper;
    const float rowHeight = images ? em(2.6f) : ImGui::GetTextLineHeight();
    clipper.Begin(int(check.views.size()), rowHeight + 2 * ImGui::GetStyle().CellPadding.y);
    const auto cell = [](const std::string& words, bool odd, const std::string& explanation) {
        ImGui::TableNextColumn();
        if (odd) ImGui::PushStyleColor(ImGuiCol_Text, warningColour);
        text(words);
        if (odd) ImGui::PopStyleColor();
        tooltip(explanation);
    };
    while (clipper.Step())
        for (int i = clipper.DisplayStart; i < clipper.DisplayEnd; ++i) {
            const ViewCheck& v = check.views[size_t(i)];
            ImGui::PushID(i);
            ImGui::TableNextRow(0, rowHeight);
            if (images) {
                ImGui::TableNextColumn();
                image("##image", viewImage(editor.state.document, size_t(i)), em(3.4f), em(2.5f), "");
                tooltip(shown(v.name));
            }
            ImGui::TableNextColumn();
            if (ImGui::Selectable((elided(shown(v.name), ImGui::GetContentRegionAvail().x) + "##row").c_str(),
                                  editor.state.selection.view == i, ImGuiSelectableFlags_AllowDoubleClick)) {
                editor.state.selection.view = i;
                if (ImGui::IsMouseDoubleClicked(ImGuiMouseButton_Left)) editor.state.viewport.throughView = true;
            }
            tooltip(shown(v.name) + "\nDouble click looks through its camera");
            cell(percent(v.meshFraction), v.meshFraction < 0.02, "Fraction of the image that sees the mesh");
            cell(percent(v.clippedFraction), v.clippedFraction > 0.01, "Pixels too bright for the file");
            if (masked)
                cell(percent(v.maskedFraction), v.maskedFraction > 0.9, "Pixels that are masked, broken or negative");
            const bool odd =
                v.comparedVertices >= 100 && std::abs(v.exposureStops) > std::max(0.25, v.exposureScatterStops);
            cell(v.comparedVertices ? signedStops(float(v.exposureStops)) + " st." : "-", odd,
                 fmt::format("Stops brighter or darker than the other views of the same surfaces, from {} points",
                             count(v.comparedVertices)));
            ImGui::PopID();
        }
    ImGui::EndTable();
}

/// Smoothing of a noisy mesh's normals: the capture is read again when the slider is let go.
void normalsSetting(Editor& editor) {
    const CaptureFix& fix = editor.state.document.fix;
    static int wanted = 0;
    if (!ImGui::IsAnyItemActive()) wanted = std::max(0, fix.smoothNormals);
    ImGui::BeginDisabled(editor.job().has_value());
    ImGui::SetNextItemWidth(em(16));
    ImGui::SliderInt("##normals", &wanted, 0, 12,
                     wanted > 0 ? "normals smoothed %d times" : "normals as the mesh has them",
                     ImGuiSliderFlags_AlwaysClamp);
    if (ImGui::IsItemDeactivatedAfterEdit() && wanted != std::max(0, fix.smoothNormals)) {
        CaptureFix changed = fix;
        changed.smoothNormals = wanted;
        editor.fixCapture(changed);
    }
    tooltip(
        "Meshes made from photographs often have good places and bad directions: speckled shading, lights that are not "
        "there. Smoothing averages directions over neighbours; creases stay. Let go to read the capture again.");
    ImGui::EndDisabled();
}

}  // namespace

void drawImportDoctor(Editor& editor) {
    if (!editor.state.panels.doctor) return;
    const ImVec2 screen = ImGui::GetIO().DisplaySize;
    const ImVec2 size{std::min(em(46), screen.x * 0.94f), std::min(em(38), screen.y * 0.86f)};
    ImGui::SetNextWindowSize(size, ImGuiCond_Appearing);
    ImGui::SetNextWindowPos({(screen.x - size.x) / 2, (screen.y - size.y) / 2}, ImGuiCond_Appearing);
    bool open = true;
    if (ImGui::Begin("Check of the capture###doctor", &open,
                     ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoSavedSettings)) {
        const auto check = editor.state.document.check;
        const float below = 2 * ImGui::GetFrameHeightWithSpacing() + em(0.4f);
        if (!check) {
            dimWrapped(editor.state.document.capture ? "The capture has not been checked." : "Nothing is open.");
        } else if (beginChild("##content", {0, -below})) {
            if (check->warnings.empty()) {
                iconText(Icon::check, goodColour);
                ImGui::SameLine(0, em(0.4f));
                wrapped("Nothing to worry about: cameras, exposure and mesh agree.");
            }
            for (const std::string& warning : check->warnings) {
                warningText(shown(warning));
                if (const std::string advice = adviceFor(warning); !advice.empty()) {
                    ImGui::Indent(em(1.35f));
                    dimWrapped(advice);
                    ImGui::Unindent(em(1.35f));
                }
            }
            heading("Axes and units");
            wrapped(fmt::format("Up is {} by the file{}.", check->up.empty() ? "z" : check->up,
                                check->upGuess.empty() ? ""
                                : check->upGuess == check->up
                                    ? ", and the cameras agree"
                                    : ", but the cameras' own up is nearest to " + check->upGuess));
            axes(editor, *check);
            heading("Lights that no photograph shows");
            drawUnobservedLights(editor);
            heading("Lighting states");
            drawStatePatterns(editor);
            heading("Surface");
            fact("Seen",
                 fmt::format("{} of the surface, {} twice or more", percent(check->seenFraction),
                             percent(check->seenTwiceFraction)),
                 "Surfaces that no photograph shows are guessed from those around them");
            normalsSetting(editor);
            fact("Views a point", fmt::format("{:.1f}", check->meanViewsPerVertex),
                 "Photographs that show a point of the surface, on average");
            const Vec3 extent = check->meshMax - check->meshMin;
            fact("Size",
                 fmt::format("{} x {} x {}", lengthText(extent.x, editor.state.lengthUnit),
                             lengthText(extent.y, editor.state.lengthUnit),
                             lengthText(extent.z, editor.state.lengthUnit)),
                 "A table that is 75 m high means that the units are wrong");
            fact("Exposure", fmt::format("{:.2f} stops between the views", check->exposureSpreadStops),
                 "All views must share one exposure scale; below a quarter of a stop is fine");
            for (const std::string& note : check->notes) dimWrapped(shown(note));
            heading("Views");
            viewTable(editor, *check, std::max(em(11), std::min(ImGui::GetContentRegionAvail().y, em(24))));
        }
        if (check) ImGui::EndChild();
        checkbox("Cameras", editor.state.viewport.frusta, "Shows in the viewport where the photographs were taken");
        sameLineIfFits(em(12));
        checkbox("Mesh over the photograph", editor.state.viewport.meshOverlay,
                 "Draws the mesh's edges over the photograph: they should lie on what they belong to");
        if (button("Close", "Closes this page; File, Check the capture brings it back", em(6))) open = false;
        ImGui::SameLine();
        ImGui::BeginDisabled(!editor.state.document.capture || editor.job());
        if (primaryButton("Estimate", "Separates the photographs into light and surfaces", em(8))) {
            editor.solve(editor.state.solve);
            open = false;
        }
        ImGui::EndDisabled();
        if (ImGui::IsWindowFocused(ImGuiFocusedFlags_ChildWindows) && escapePressed()) open = false;
    }
    ImGui::End();
    editor.state.panels.doctor = open;
}

}  // namespace relamp::ui
