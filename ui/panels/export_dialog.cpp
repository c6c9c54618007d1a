#include "panels/export_dialog.h"

#include <algorithm>

#include "item_map.h"
#include "panels/dialogs.h"
#include "shot/export_frame.h"
#include "viewport/navigation.h"
#include "widgets.h"

namespace relamp::ui {
namespace {
namespace fs = std::filesystem;

void row(const char* name) {
    ImGui::AlignTextToFramePadding();
    dimText(name);
    ImGui::SameLine(em(9));
}

/// A turntable, and a way through views or bookmarks.
void movingCameras(ExportRequest& request, size_t views, size_t bookmarks) {
    using Views = ExportRequest::Views;
    const auto count = [&] {
        ImGui::SameLine();
        ImGui::SetNextItemWidth(em(6));
        ImGui::DragInt("##count", &request.moveFrames, 0.3f, 1, 100'000, "%d frames", ImGuiSliderFlags_AlwaysClamp);
        tooltip("How many frames the camera takes for it");
    };
    if (radio("A turntable", request.views == Views::turntable,
              "The first photograph's camera goes once round what the photographs look at"))
        request.views = Views::turntable;
    if (request.views == Views::turntable) count();
    const auto way = [&](Views which, size_t places, const char* label, const char* what, const char* numbers) {
        if (places < 2) {
            if (request.views == which) request.views = Views::present;
            return;
        }
        if (radio(label, request.views == which, what) && request.views != which) {
            request.views = which;
            request.range = fmt::format("1-{}", places);
        }
        if (request.views != which) return;
        count();
        ImGui::SameLine();
        ImGui::SetNextItemWidth(-FLT_MIN);
        inputText("##way", request.range, "1,4,6");
        tooltip(numbers);
    };
    way(Views::path, views, "A way through views:", "The camera moves smoothly from view to view, in this order",
        "Numbers of the photographs, in the order of the way: 1,4,6 or 1-8");
    way(Views::bookmarks, bookmarks, "A way through bookmarks:",
        "The camera moves smoothly from bookmark to bookmark, in this order, in perspective",
        "Places of the bookmarks in their list, in the order of the way: 1,3,2 or 1-4");
}

void viewsRow(Editor& editor, size_t views) {
    using Views = ExportRequest::Views;
    ExportRequest& request = editor.state.exportFrames;
    row("What");
    ImGui::BeginGroup();
    if (radio("What the viewport shows", request.views == Views::present, "One frame from where you look now"))
        request.views = Views::present;
    if (radio(fmt::format("The selected view ({})###view", editor.state.selection.view + 1).c_str(),
              request.views == Views::capture, "One frame from the camera of the selected photograph"))
        request.views = Views::capture;
    if (radio(fmt::format("All {} views###all", views).c_str(), request.views == Views::all,
              "A frame from the camera of every photograph"))
        request.views = Views::all;
    const bool some = request.views == Views::range;
    std::string range = some ? request.range : "";
    bool chosen = radio("Some views:", some, "Frames from the cameras of these photographs, counted from 1");
    if (chosen && !some) range = fmt::format("1-{}", views);
    ImGui::SameLine();
    ImGui::SetNextItemWidth(-FLT_MIN);
    chosen = inputText("##range", range, "1-3,5,7-20:2") || chosen;
    if (chosen) request.views = Views::range, request.range = range;
    tooltip("Numbers of the photographs: 1-3,5 are four views; 1-20:2 is every second one");
    if (!editor.look().keys.empty() || !editor.look().curves.empty()) {
        const TimeState& time = editor.state.time;
        if (radio("Frames of the time line:", request.views == Views::timeline,
                  "What the viewport shows, in each of these frames")) {
            request.views = Views::timeline;
            request.range = fmt::format("{}-{}", time.first, time.last);
        }
        if (request.views == Views::timeline) {
            ImGui::SameLine();
            ImGui::SetNextItemWidth(-FLT_MIN);
            inputText("##frames", request.range, "1-48");
        }
    } else if (request.views == Views::timeline) {
        request.views = Views::present;
    }
    movingCameras(request, views, editor.look().bookmarks.size());
    if (const auto plate = editor.plate(); plate && !plate->plate.frames.empty()) {
        if (radio("Frames of the plate:", request.views == Views::plate,
                  "The plate relit, at its own size, through its own camera")) {
            request.views = Views::plate;
            request.range = fmt::format("{}-{}", plate->plate.frames.front().number, plate->plate.frames.back().number);
        }
        noteItem("export plate");
        if (request.views == Views::plate) {
            ImGui::SameLine();
            ImGui::SetNextItemWidth(-FLT_MIN);
            inputText("##plate frames", request.range, "all of them");
        }
    } else if (request.views == Views::plate && !editor.look().plate) {
        request.views = Views::present;
    }
    ImGui::EndGroup();
}

/// Whether the model is written, or what a camera took is relit.
void ratioRow(ExportRequest& request) {
    using Views = ExportRequest::Views;
    const bool plate = request.views == Views::plate;
    row("Relit");
    constexpr const char* names[] = {"The model", "Photograph x new / old", "Photograph + new - old"};
    constexpr const char* ofPlate[] = {"Plate x new / old", "Plate x new / old", "Plate + new - old"};
    constexpr const char* explanations[] = {
        "The scene as the model has it",
        "Keeps the detail and grain of the photograph, or of the plate. Another camera's frames take it from the "
        "photographs that see the surface best",
        "The same, with the model's errors where they were: where the light gets much brighter"};
    const auto label = [&](int i) { return plate ? ofPlate[i] : names[i]; };
    ImGui::SetNextItemWidth(em(14));
    if (ImGui::BeginCombo("##ratio", label(int(request.ratio)))) {
        for (int i = plate ? 1 : 0; i < 3; ++i) {
            if (ImGui::Selectable(label(i), int(request.ratio) == i)) request.ratio = Ratio(i);
            tooltip(explanations[i]);
        }
        ImGui::EndCombo();
    }
    tooltip(explanations[plate && request.ratio == Ratio::none ? 1 : int(request.ratio)]);
}

/// What the model decides where it rests on little.
void unsureRow(ExportRequest& request) {
    if (request.views != ExportRequest::Views::plate) return;
    row("");
    bool smooth = request.unsure == PlateUnsure::smooth;
    if (checkbox("Smooth where unsure", smooth,
                 "Where hardly a photograph shows the surface, the light changes as on the surfaces around"))
        request.unsure = smooth ? PlateUnsure::smooth : PlateUnsure::model;
    noteItem("plate unsure");
}

/// What the plate shows and the capture does not hold. It belongs to the plate: one edit.
void matteRow(Editor& editor) {
    const auto plate = editor.plate();
    if (editor.state.exportFrames.views != ExportRequest::Views::plate || !plate) return;
    row("Matte");
    const std::string name = plate->look.matte.empty() ? "none" : shown(plate->look.matte.filename());
    text(elided(name, em(12)));
    tooltip(plate->look.matte.empty() ? "Everything in the plate is relit" : shown(plate->look.matte));
    ImGui::SameLine();
    if (ImGui::SmallButton("Change...")) editor.state.plateImport = plate->look;
    tooltip("Files and settings of the plate");
    for (const std::string& fault : plate->plate.faults) warningText(shown(fault) + ".");
}

void sizeRow(Editor& editor) {
    ExportRequest& request = editor.state.exportFrames;
    if (request.views == ExportRequest::Views::plate) return;  // it keeps its own
    row("Size");
    int size[2] = {request.width, request.height};
    ImGui::SetNextItemWidth(em(8));
    if (ImGui::DragInt2("##size", size, 4, 0, 16384, size[0] > 0 ? "%d" : "auto", ImGuiSliderFlags_AlwaysClamp))
        request.width = std::max(0, size[0]), request.height = std::max(0, size[1]);
    tooltip("Width and height in pixels. 0: the size of the photograph, or of the viewport.");
    for (const auto& [name, w, h] : {std::tuple{"Source size", 0, 0}, {"1080p", 1920, 1080}, {"4K", 3840, 2160}}) {
        sameLineIfFits(buttonWidth(name));
        if (ImGui::SmallButton(name)) request.width = w, request.height = h;
        tooltip(w ? fmt::format("{} x {} pixels", w, h) : "As large as the photograph, or the viewport");
    }
    if ((request.width > 0) != (request.height > 0)) warningText("Give both numbers, or neither.");
    using Views = ExportRequest::Views;
    if (editor.state.viewport.region && (request.views == Views::present || request.views == Views::timeline)) {
        row("");
        checkbox("Region only", request.regionOnly,
                 "Renders the viewport's region alone. EXR keeps it in its place in the whole frame (data window); PNG "
                 "and JPEG hold nothing else.");
    }
}

void samplesRow(ExportRequest& request) {
    row("Samples per pixel");
    ImGui::SetNextItemWidth(em(8));
    const bool ofPlate = request.views == ExportRequest::Views::plate;
    ImGui::DragInt("##samples", ofPlate ? &request.plateSamples : &request.samples, 0.2f, 1, 1024, "%d",
                   ImGuiSliderFlags_AlwaysClamp);
    tooltip(ofPlate
                ? "More samples give less noise and take longer in proportion. Of a plate 4 are enough: neighbouring "
                  "frames steady the light."
                : "More samples give less noise and take longer in proportion. 8 is clean on matte surfaces when "
                  "denoised.");
    sameLineIfFits(em(8));
    ImGui::Checkbox("Denoise", &request.denoise);
    tooltip("Filters the light on matte surfaces. Prints and reflections stay as they are.");
}

void layersRow(ExportRequest& request) {
    row("Layers");
    ImGui::BeginGroup();
    std::string layers = request.layers == "all"
                             ? "groups,albedo,normal,position,depth,correction,cryptomatte,confidence"
                             : request.layers;
    const auto has = [&](const std::string& name) {
        return ("," + layers + ",").find("," + name + ",") != std::string::npos;
    };
    const struct {
        const char* name;
        const char* label;
        const char* explanation;
    } known[] = {
        {"groups", "Light groups",
         "The part of each light by itself: their sum is the image, so that lights can be graded in compositing"},
        {"albedo", "Surface colour", "Colour of the surfaces in white light"},
        {"normal", "Normals", "Direction of the surface, for relighting tricks in compositing"},
        {"position", "Positions", "Position of the surface in the world, metres"},
        {"depth", "Depth", "Distance along the camera's axis, metres"},
        {"correction", "Baked light",
         "The light that a reading without lights in the scene would bake into the surface (layer correction)"},
        {"residual", "Residual", "Photograph minus model, of views at their own size"},
        {"cryptomatte", "Cryptomatte", "Mattes of the lights"},
        {"confidence", "Confidence", "How much of a surface's colour rests on photographs of it: a mask, 0 to 1"}};
    std::string chosen;
    int index = 0;
    for (const auto& layer : known) {
        bool on = has(layer.name);
        if (index++) sameLineIfFits(ImGui::CalcTextSize(layer.label).x + ImGui::GetFrameHeight() + em(0.6f));
        checkbox(layer.label, on, layer.explanation);
        if (on) chosen += (chosen.empty() ? "" : ",") + std::string(layer.name);
    }
    request.layers = chosen;
    ImGui::EndGroup();
}

/// How layers are called and stored in EXR; what PNG and JPEG show.
void formatRow(Editor& editor) {
    ExportRequest& request = editor.state.exportFrames;
    if (writesExr(request.file) || request.file.empty()) {
        row("Packed");
        ImGui::SetNextItemWidth(em(8));
        if (ImGui::BeginCombo("##compression", request.exr.compression.c_str())) {
            for (const char* name : exrCompressions)
                if (ImGui::Selectable(name, request.exr.compression == name)) request.exr.compression = name;
            ImGui::EndCombo();
        }
        noteItem("compression");
        tooltip(
            "How EXR is compressed. zip and piz keep every bit; pxr24, dwaa and dwab are smaller and lose a little.");
        sameLineIfFits(em(8));
        checkbox("Float", request.exr.floats, "Colours as 32 bit float, not as 16 bit half; data are always float");
        if (request.layers.empty()) return;
        row("");
        bool arnold = request.naming == LayerNaming::arnold;
        if (checkbox("Arnold's names", arnold, "Light groups are called RGBA_GROUP instead of Combined_GROUP"))
            request.naming = arnold ? LayerNaming::arnold : LayerNaming::blender;
        sameLineIfFits(em(12));
        checkbox("A part for each layer", request.multipart, "Multi-part EXR: programs read single layers faster");
        return;
    }
    row("Shown");
    const float stops = editor.state.viewport.exposureStops;
    const std::string asShown =
        "As in the window: " + displayViewOf(editor) + (stops != 0 ? ", " + signedStops(stops) + " stops" : "");
    const std::string names[] = {asShown, "sRGB", "sRGB, exposed by itself", "Without a curve"};
    const int present = request.view ? 1 + int(*request.view) : 0;
    ImGui::SetNextItemWidth(std::min(em(20), ImGui::GetContentRegionAvail().x));
    if (ImGui::BeginCombo("##view", names[present].c_str())) {
        for (int i = 0; i < 4; ++i) {
            if (ImGui::Selectable(names[i].c_str(), present == i))
                request.view = i ? std::optional(DisplayView(i - 1)) : std::nullopt;
            noteItem(fmt::format("export view {}", i));
        }
        ImGui::EndCombo();
    }
    noteItem("export view");
    tooltip("What PNG and JPEG show of the scene's light. As in the window: with its view transform and exposure.");
}

void fileRow(Editor& editor) {
    ExportRequest& request = editor.state.exportFrames;
    row("File");
    static fs::path fieldOf;
    static std::string field;
    if (fieldOf != request.file) fieldOf = request.file, field = request.file.string();
    const float browseWidth = buttonWidth("Browse...");
    ImGui::SetNextItemWidth(
        std::max(em(4), ImGui::GetContentRegionAvail().x - browseWidth - ImGui::GetStyle().ItemSpacing.x));
    if (inputText("##file", field, "name.####.exr")) fieldOf = request.file = field;
    tooltip(
        "#### stands for the number of the frame with that many digits: name.####.exr becomes name.0001.exr. Ends in "
        ".exr, .png or .jpg.");
    ImGui::SameLine();
    if (button("Browse...", "Chooses the folder and the name")) {
        BrowserRequest ask;
        ask.mode = BrowserRequest::Mode::save;
        ask.title = "Export frames";
        ask.confirm = "Use this name";
        ask.start = request.file.parent_path();
        ask.name = request.file.filename().string().empty()
                       ? fs::path(nameToSave(editor.state.document)).stem().string() + ".####.exr"
                       : request.file.filename().string();
        ask.extensions = {".exr", ".png", ".jpg", ".jpeg"};
        ask.note = "#### in the name becomes the number of the frame.";
        browse(ask, [](Editor& e, const fs::path& file) {
            e.state.exportFrames.file = file;
            e.state.panels.exportFrames = true;
        });
    }
}

void summaryOf(const ExportProblems& problems) {
    if (!problems.file.empty()) warningText(problems.file);
    else if (!problems.firstFile.empty())
        dimWrapped(fmt::format("{} frame{}, {}{}", problems.frames, problems.frames == 1 ? "" : "s",
                               shown(problems.firstFile), problems.frames > 1 ? " and so on" : ""));
}

/// The buttons, or how far the export is. True: the page is to be closed.
bool footer(Editor& editor, const ExportProblems& problems, bool exporting) {
    const ExportRequest& request = editor.state.exportFrames;
    const auto& job = editor.job();
    bool done = false;
    if (exporting) {
        bar(job->whole.value_or(-1), progressColour,
            (job->whole && !job->stopping ? percent(*job->whole) + ", " : "") + timeLeftWords(*job));
        dimText(job->title + (job->stage.empty() ? "" : ": " + job->stage));
        ImGui::BeginDisabled(job->stopping);
        if (button("Stop", "Frames that are finished stay", em(7))) editor.cancelJob();
        ImGui::EndDisabled();
        ImGui::SameLine();
        if (button("Run in background", "Closes this page; the status bar shows how far it is")) done = true;
    } else {
        const bool sizes = (request.width > 0) == (request.height > 0);
        std::string problem;  // what asks for it may be scrolled out of sight
        for (const std::string* one : {&problems.range, &problems.file, &problems.layers})
            if (problem.empty()) problem = *one;
        const bool ready = problems.ok() && sizes && editor.estimate() && !job;
        ImGui::BeginDisabled(!ready);
        if (primaryButton("Export",
                          !editor.estimate() ? "Estimate first"
                          : job              ? "Wait until the running job is finished"
                          : !problem.empty() ? problem.c_str()
                                             : "Renders the frames in the background (Enter)",
                          em(8)) ||
            (ready && enterConfirms()))
            editor.exportFrames(request);
        ImGui::EndDisabled();
        ImGui::SameLine();
        if (button("Close", "Closes this page (Esc)", em(7))) done = true;
    }
    return done;
}

}  // namespace

bool drawExportDialog(Editor& editor) {
    ExportRequest& request = editor.state.exportFrames;
    const auto& capture = editor.state.document.capture;
    const size_t views = capture ? capture->views.size() : 0;
    const auto& job = editor.job();
    const bool exporting = job && job->kind == JobStatus::Kind::exportFrames;
    // In a short window what is asked scrolls, and the buttons stay in sight.
    static float asked = 0;  // its height
    const ImGuiStyle& style = ImGui::GetStyle();
    const float buttons =
        ImGui::GetFrameHeight() + 2 * style.ItemSpacing.y +
        (exporting ? ImGui::GetFrameHeight() + ImGui::GetTextLineHeight() + 2 * style.ItemSpacing.y : 0);
    const float room = ImGui::GetIO().DisplaySize.y - em(1) - ImGui::GetCursorPosY() - style.WindowPadding.y - buttons;
    const bool scrolls = asked > room;
    if (scrolls) beginChild("##asked", {0, std::max(room, em(4))});
    const float top = ImGui::GetCursorPosY();
    ImGui::BeginDisabled(exporting);
    viewsRow(editor, views);
    const auto plate = editor.plate();
    const ExportProblems problems =
        checkExport(request, views, editor.state.selection.view, plate.get(), editor.look().bookmarks.size());
    if (!problems.range.empty()) warningText(problems.range);
    ratioRow(request);
    unsureRow(request);
    matteRow(editor);
    sizeRow(editor);
    samplesRow(request);
    layersRow(request);
    if (!problems.layers.empty()) warningText(problems.layers);
    formatRow(editor);
    fileRow(editor);
    summaryOf(problems);
    ImGui::EndDisabled();
    asked = ImGui::GetCursorPosY() - top;
    if (scrolls) ImGui::EndChild();

    ImGui::Spacing();
    bool done = footer(editor, problems, exporting);
    if (escapePressed() && !ImGui::IsAnyItemActive()) done = true;
    if (done) editor.state.panels.exportFrames = false;
    return done;
}

}  // namespace relamp::ui
