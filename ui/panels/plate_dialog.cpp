// Import plate: which files, which camera, and how they are to be read.
#include "item_map.h"
#include "panels/dialogs.h"
#include "widgets.h"

namespace relamp::ui {
namespace {
namespace fs = std::filesystem;

void plateRow(const char* name) {
    ImGui::AlignTextToFramePadding();
    dimText(name);
    ImGui::SameLine(em(9));
}

/// A file to type or to choose. `take` makes of what was chosen what the field holds.
void fileField(const char* name, fs::path PlateLook::*member, PlateLook& plate, const char* hint,
               const char* explanation, const BrowserRequest& ask, fs::path (*take)(const fs::path&)) {
    plateRow(name);
    ImGui::PushID(name);
    std::string field = (plate.*member).string();
    const float browseWidth = buttonWidth("Browse...");
    ImGui::SetNextItemWidth(
        std::max(em(4), ImGui::GetContentRegionAvail().x - browseWidth - ImGui::GetStyle().ItemSpacing.x));
    if (inputText("##field", field, hint)) plate.*member = field;
    noteItem(std::string("plate ") + name);
    tooltip(explanation);
    ImGui::SameLine();
    if (button("Browse...", "Chooses a file")) {
        BrowserRequest request = ask;
        request.start = (plate.*member).empty() ? plate.files.parent_path() : (plate.*member).parent_path();
        browse(request, [member, take](Editor& e, const fs::path& chosen) {
            if (e.state.plateImport) (*e.state.plateImport).*member = take(chosen);
        });
    }
    ImGui::PopID();
}

fs::path itself(const fs::path& file) { return file; }

BrowserRequest imageRequest(const char* title, const char* note) {
    BrowserRequest request;
    request.title = title;
    request.confirm = "Use";
    request.extensions = {".exr", ".dpx", ".png", ".jpg", ".jpeg", ".tif", ".tiff", ".hdr"};
    request.note = note;
    return request;
}

struct Choice {
    const char* name;  ///< as the look holds it
    const char* label;
};

void choiceRow(const char* name, std::string& value, std::initializer_list<Choice> choices, const char* explanation) {
    plateRow(name);
    std::string label = value;
    for (const Choice& choice : choices)
        if (value == choice.name) label = choice.label;
    ImGui::PushID(name);
    ImGui::SetNextItemWidth(em(14));
    if (ImGui::BeginCombo("##choice", label.c_str())) {
        for (const Choice& choice : choices)
            if (ImGui::Selectable(choice.label, value == choice.name)) value = choice.name;
        ImGui::EndCombo();
    }
    tooltip(explanation);
    ImGui::PopID();
}

/// What is missing before it can be tried; empty: nothing.
std::string lacking(const PlateLook& plate) {
    if (plate.files.empty()) return "Choose one frame of the plate.";
    if (plate.cameras.empty())
        return "Choose its tracked camera: .chan (Nuke), .usda, transforms.json, or the folder of a COLMAP model.";
    return {};
}

}  // namespace

bool drawPlateDialog(Editor& editor) {
    if (!editor.state.plateImport) return true;
    PlateLook& plate = *editor.state.plateImport;
    fileField("Frames", &PlateLook::files, plate, "plate.####.exr",
              "#### stands for the number of the frame. Choosing one frame names all of them.",
              imageRequest("Choose a frame of the plate", "Any frame; the others are found by their numbers."),
              platePattern);
    BrowserRequest track;
    track.title = "Choose the tracked camera";
    track.confirm = "Use";
    track.extensions = {".chan", ".usda", ".usd", ".json"};
    track.note = "Nuke's .chan, USD text, or transforms.json. The folder of a COLMAP model can be typed.";
    fileField("Camera", &PlateLook::cameras, plate, "track.usda",
              "The camera of each frame. FILE#NAME is one of several cameras in a USD file.", track, itself);
    BrowserRequest lens;
    lens.title = "Choose the lens";
    lens.confirm = "Use";
    lens.extensions = {".json"};
    lens.note = "A file with the keys of transforms.json: w, h, fl_x, cx, k1 and so on.";
    fileField("Lens", &PlateLook::lens, plate, "as the camera says",
              "Focal length and distortion, where the camera's file has none", lens, itself);
    fileField("Matte", &PlateLook::matte, plate, "none",
              "White where the plate shows what the capture does not hold: actors, props. Those keep their light.",
              imageRequest("Choose a frame of the matte", "Any frame; the others are found by their numbers."),
              platePattern);
    if (!plate.matte.empty()) {
        plateRow("");
        checkbox("Relight what the matte holds out", plate.relightMatte,
                 "By the light at its place, as on an upright cylinder. Otherwise it stays as it is.");
    }
    plateRow("Camera offset");
    ImGui::SetNextItemWidth(em(6));
    ImGui::DragInt("##offset", &plate.offset, 0.2f, -1'000'000, 1'000'000, "%d frames", ImGuiSliderFlags_AlwaysClamp);
    tooltip("Frame 1 of the camera is the plate's frame 1 plus this");
    choiceRow("Values", plate.curve,
              {{"auto", "As the files say"},
               {"linear", "Linear"},
               {"srgb", "sRGB"},
               {"rec709", "Rec. 709"},
               {"gamma22", "Gamma 2.2"},
               {"gamma24", "Gamma 2.4"}},
              "Transfer curve. As the files say: linear for floating point, sRGB for integers.");
    choiceRow("Colours", plate.match,
              {{"auto", "Match as needed"},
               {"shot", "One match for the shot"},
               {"frames", "Match every frame"},
               {"off", "Leave as they are"}},
              "Gain and white balance of the plate against the photographs, from surfaces that both show");
    if (std::string(plate.cameras.extension()) == ".chan")
        choiceRow("Rotation", plate.rotation,
                  {{"XYZ", "XYZ"}, {"XZY", "XZY"}, {"YXZ", "YXZ"}, {"YZX", "YZX"}, {"ZXY", "ZXY"}, {"ZYX", "ZYX"}},
                  "Rotation order of the .chan file; the axis turned about first comes first");
    const std::string missing = lacking(plate);
    if (!missing.empty()) dimWrapped(missing);
    ImGui::Spacing();
    bool done = false;
    const bool ready = missing.empty() && !editor.job();
    ImGui::BeginDisabled(!ready);
    if (primaryButton("Import",
                      editor.job() ? "Wait until the running job is finished" : "Opens it in the background (Enter)",
                      em(8)) ||
        (ready && enterConfirms())) {
        const PlateLook wanted = plate;
        editor.state.plateImport.reset();
        editor.importPlate(wanted);
        done = true;
    }
    noteItem("import plate");
    ImGui::EndDisabled();
    ImGui::SameLine();
    if (!done && (button("Cancel", "Imports nothing (Esc)", em(7)) || (escapePressed() && !ImGui::IsAnyItemActive()))) {
        editor.state.plateImport.reset();
        done = true;
    }
    return done;
}

}  // namespace relamp::ui
