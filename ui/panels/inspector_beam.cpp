// How an added light is shaped: cone, barn doors, photometric file, images.
#include "item_map.h"
#include "panels/dialogs.h"
#include "panels/emitter_controls.h"
#include "panels/inspector.h"
#include "panels/value_key_menu.h"
#include "relight/shaping_files.h"
#include "widgets.h"

namespace relamp::ui {
namespace {

using File = std::filesystem::path LightShaping::*;

/// One file that shapes light, as a row of the section.
struct ShapingRow {
    File file;
    const char* label;
    const char* title;        ///< of the browser
    const char* explanation;  ///< tooltip of the row
    std::vector<std::string> extensions;
    bool flatOnly = false;
};

const std::vector<ShapingRow>& shapingRows() {
    static const std::vector<std::string> images{".exr", ".hdr", ".png", ".jpg", ".jpeg", ".tif", ".tiff"};
    static const std::vector<ShapingRow> rows{
        {&LightShaping::iesFile,
         "IES profile",
         "Choose an IES profile",
         "How bright a real luminaire is in every direction, from its maker's photometric file (.ies). -Z of the light "
         "is straight down in it.",
         {".ies"}},
        {&LightShaping::goboFile, "Gobo", "Choose a gobo image",
         "A pattern thrown into the cone: leaves, blinds, a window. White lets all light through, black none. Sharpest "
         "from a small light.",
         images},
        {&LightShaping::surfaceFile, "Surface image", "Choose an image for the surface",
         "A photograph of a real softbox or a screen: how bright each part of the light's face is.", images, true}};
    return rows;
}

void setShaping(Editor& editor, const std::string& id, const std::string& label,
                const std::function<void(LightShaping&)>& change) {
    editor.edit(label, [&](Look& look) { shapeEmitter(look, id, change); });
}

void shapingNumber(Editor& editor, const EmitterState& emitter, const char* id, const std::string& what, float value,
                   const DragRange& range, const std::string& explanation, float LightShaping::*number,
                   KeyedValue keyed) {
    dragLook(editor, id, what + " of " + emitter.name, value, range, explanation + keysHint,
             [&](Look& look, float typed) {
                 shapeEmitter(look, emitter.id,
                              [&](LightShaping& s) { s.*number = std::clamp(typed, range.least, range.most); });
             });
    valueKeyMenu(editor, {{keyed, emitter.id}});
}

void fileRow(Editor& editor, const EmitterState& emitter, const LightShaping& shaping, const ShapingRow& row) {
    const std::filesystem::path& file = shaping.*row.file;
    ImGui::PushID(row.label);
    ImGui::AlignTextToFramePadding();
    dimText(row.label);
    tooltip(row.explanation);
    ImGui::SameLine(em(6.2f));
    const float side = ImGui::GetFrameHeight();
    const float width = ImGui::GetContentRegionAvail().x - (file.empty() ? 0 : side + ImGui::GetStyle().ItemSpacing.x);
    const std::string label = file.empty() ? "Choose..." : elided(shown(file.filename()), width - em(1));
    if (button((label + "##file").c_str(), file.empty() ? row.explanation : shown(file), width)) {
        BrowserRequest request;
        request.title = row.title;
        request.confirm = "Use";
        request.extensions = row.extensions;
        request.note = row.explanation;
        if (!file.empty()) request.start = file.parent_path();
        browse(request, [id = emitter.id, member = row.file, name = std::string(row.label)](
                            Editor& e, const std::filesystem::path& chosen) {
            e.readInBackground(
                chosen,
                [chosen, member] {
                    if (member == &LightShaping::iesFile) iesOf(chosen);
                    else shapingImageOf(chosen);
                },
                [id, member, name, chosen](Editor& then) {
                    setShaping(then, id, name + " " + chosen.filename().string(),
                               [&](LightShaping& s) { s.*member = chosen; });
                });
        });
    }
    noteItem(std::string("shaping ") + row.label);
    if (!file.empty()) {
        ImGui::SameLine();
        if (iconButton("##none", Icon::reset, "Takes it away", false, side))
            setShaping(editor, emitter.id, std::string("No ") + row.label,
                       [&](LightShaping& s) { (s.*row.file).clear(); });
    }
    ImGui::PopID();
}

}  // namespace

void inspectBeam(Editor& editor, const EmitterState& emitter) {
    if (emitter.recovered || size_t(emitter.index) >= editor.look().added.size()) return;
    const AddedEmitter& added = editor.look().added[size_t(emitter.index)];
    const EmitterShapeInfo& info = infoOf(added.shape);
    if (!info.shapeable()) return;
    if (!section("Beam", "Where its light goes: a cone, barn doors, a real luminaire's profile, patterns",
                 !added.shaping.plain()))
        return;
    const LightShaping shaping = added.shaping;
    const auto row = [&](const char* name) {
        ImGui::AlignTextToFramePadding();
        dimText(name);
        ImGui::SameLine(em(6.2f));
        ImGui::SetNextItemWidth(-FLT_MIN);
    };
    row("Cone");
    shapingNumber(
        editor, emitter, "##cone", "Cone", shaping.coneDegrees, {0.3f, 0.1f, 180, "%.1f\u00b0"},
        "Angle from the middle of the beam to its edge, in degrees; 180 is no cone. Inside the light stays as "
        "bright, so a narrow beam sends less of it.",
        &LightShaping::coneDegrees, KeyedValue::coneDegrees);
    row("Softness");
    shapingNumber(editor, emitter, "##softness", "Softness", shaping.coneSoftness, {0.004f, 0, 1, "%.2f"},
                  "How much of the cone is its soft edge: 0 is sharp, 1 fades from the middle on.",
                  &LightShaping::coneSoftness, KeyedValue::coneSoftness);
    row("Focus");
    shapingNumber(editor, emitter, "##focus", "Focus", shaping.focus, {0.05f, 0, 1000, "%.1f"},
                  "Draws the light to the middle of the beam: 0 is even.", &LightShaping::focus, KeyedValue::focus);
    const std::string doors =
        "Barn doors are flaps on the sides of a light. Degrees that this one stands open: 90 is wide open and leaves "
        "the "
        "light alone, 0 is straight ahead, less closes it over the light. Sides are as the light sees them.";
    const auto doorRow = [&](const char* name, float LightShaping::*degrees, KeyedValue keyed) {
        row(name);
        shapingNumber(editor, emitter, (std::string("##") + name).c_str(), name, shaping.*degrees,
                      {0.3f, mostShutDoor, 90, "%.1f\u00b0"}, doors, degrees, keyed);
    };
    if (info.flat) {
        doorRow("Left door", &LightShaping::leftDoor, KeyedValue::leftDoor);
        doorRow("Right door", &LightShaping::rightDoor, KeyedValue::rightDoor);
        doorRow("Top door", &LightShaping::topDoor, KeyedValue::topDoor);
        doorRow("Bottom door", &LightShaping::bottomDoor, KeyedValue::bottomDoor);
    }
    for (const ShapingRow& file : shapingRows())
        if (info.flat || !file.flatOnly) fileRow(editor, emitter, shaping, file);
}

}  // namespace relamp::ui
