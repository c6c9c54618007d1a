#include "actions.h"

#include <algorithm>

#include "panels/emitter_controls.h"
#include "viewport/navigation.h"

namespace relamp::ui {
namespace {

bool hasDocument(const Editor& e) { return e.state.document.capture != nullptr; }
bool hasEstimate(const Editor& e) { return e.estimate() != nullptr; }
bool idle(const Editor& e) { return !e.job(); }
bool canSolve(const Editor& e) { return hasDocument(e) && idle(e); }
bool hasSelection(const Editor& e) { return hasEstimate(e) && !e.state.selection.emitters.empty(); }

void scaleUi(Editor& e, float factor) { e.state.uiScale = std::clamp(e.state.uiScale * factor, 0.75f, 3.0f); }

Action modeAction(const ViewModeInfo& info) {
    Action a;
    a.id = info.id;
    a.label = info.name;
    a.explanation = info.explanation;
    a.menu = "View";
    if (info.key) a.keys = {{info.key}};
    a.run = [mode = info.mode](Editor& e) { setMode(e, mode); };
    a.checked = [mode = info.mode](const Editor& e) { return e.state.viewport.mode == mode; };
    return a;
}

Action addAction(const EmitterShapeInfo& info) {
    Action a;
    a.id = std::string("light.add") + info.label;
    a.label = std::string("Add ") + info.name;
    a.explanation = "A new light in front of what you look at; move it with G, turn it with R.";
    a.menu = "Light";
    a.enabled = hasEstimate;
    a.run = [shape = info.shape](Editor& e) { addNewEmitter(e, shape); };
    a.separatorBefore = &info == &emitterShapes().front();
    return a;
}

std::vector<Action> makeActions() {
    std::vector<Action> t;
    const auto add = [&](Action a) { t.push_back(std::move(a)); };
    // ---- file
    add({"file.open",
         "Open...",
         "Open a capture folder or a saved shot.",
         "File",
         {{'O', true}},
         [](Editor& e) { e.state.panels.openBrowser = true; },
         {},
         {},
         false});
    add({"file.save",
         "Save",
         "Save the shot: what was found about the light, and your edits.",
         "File",
         {{'S', true}},
         [](Editor& e) { e.save(); },
         hasEstimate,
         {},
         true});
    add({"file.saveAs",
         "Save as...",
         "Save the shot to another place.",
         "File",
         {{'S', true, true}},
         [](Editor& e) { e.state.panels.saveBrowser = true; },
         hasEstimate,
         {},
         false});
    add({"file.export",
         "Export frames...",
         "Render the present look to files for compositing.",
         "File",
         {{keyF12}},
         [](Editor& e) { e.state.panels.exportFrames = true; },
         hasEstimate,
         {},
         true});
    add({"file.doctor",
         "Check the capture...",
         "Cameras against mesh, exposure, clipped pixels: what to look at before estimating.",
         "File",
         {},
         [](Editor& e) { e.state.panels.doctor = true; },
         hasDocument,
         {},
         true});
    add({"file.quit",
         "Quit",
         "Close the window. Asks first when something is not saved.",
         "File",
         {{'Q', true}},
         [](Editor& e) { e.requestQuit(); },
         {},
         {},
         true});
    // ---- edit
    add({"edit.undo",
         "Undo",
         "Take the last edit back.",
         "Edit",
         {{'Z', true}},
         [](Editor& e) { e.undo(); },
         [](const Editor& e) { return e.history().canUndo(); },
         {},
         false});
    add({"edit.redo",
         "Redo",
         "Bring back what was undone.",
         "Edit",
         {{'Z', true, true}, {'Y', true}},
         [](Editor& e) { e.redo(); },
         [](const Editor& e) { return e.history().canRedo(); },
         {},
         false});
    add({"edit.resetAll",
         "Reset the look",
         "Every light back to what was recovered, the environment as photographed, added lights gone.",
         "Edit",
         {},
         [](Editor& e) { e.edit("Reset the look", resetLook); },
         hasEstimate,
         {},
         true});
    add({"edit.selectNone",
         "Deselect",
         "Select nothing; also disarms a click that waits.",
         "Edit",
         {{keyEscape}},
         [](Editor& e) {
             if (e.state.viewport.clickTask != ClickTask::none) {
                 e.state.viewport.clickTask = ClickTask::none;
                 return;
             }
             e.state.selection.emitters.clear();
             e.pick(std::nullopt);
         },
         [](const Editor& e) {
             return e.state.viewport.clickTask != ClickTask::none || !e.state.selection.emitters.empty() ||
                    e.state.selection.point;
         },
         {},
         true});
    add({"edit.selectAll",
         "Select all lights",
         "Select every emitter, to edit them together.",
         "Edit",
         {{'A', true}},
         [](Editor& e) {
             e.state.selection.emitters.clear();
             for (const EmitterState& s : e.emitters()) e.state.selection.emitters.push_back(s.id);
         },
         hasEstimate,
         {},
         false});
    // ---- light
    add({"light.solve",
         "Estimate",
         "Separate the light from the surfaces. Runs in the background; you can keep working.",
         "Light",
         {{keyEnter, true}, {keyPadEnter, true}},
         [](Editor& e) { e.solve(e.state.solve); },
         canSolve,
         {},
         false});
    add({"light.unseen",
         "Look for an unobserved light",
         "A light outside all photographs leaves shading and shadows: finds its place. Runs in the background.",
         "Light",
         {},
         [](Editor& e) { e.findUnobservedLight(); },
         canSolve,
         {},
         false});
    add({"light.solveDistant",
         "Estimate with distant light only",
         "The older way, without lights in the scene, to compare with.",
         "Light",
         {},
         [](Editor& e) {
             SolveRequest r = e.state.solve;
             r.nearField = false;
             e.solve(r);
         },
         canSolve,
         {},
         false});
    add({"light.cancel",
         "Stop what is running",
         "Stops the job in the background and keeps the best answer so far.",
         "Light",
         {{keyPeriod, true}},
         [](Editor& e) { e.cancelJob(); },
         [](const Editor& e) { return e.job().has_value(); },
         {},
         false});
    add({"light.mute",
         "Switch on or off",
         "The selected lights, on or off.",
         "Light",
         {{'M'}},
         [](Editor& e) {
             const EmitterState* active = e.emitter(e.state.selection.active());
             if (!active) return;
             const bool on = !active->enabled;
             e.edit((on ? "Switch on " : "Switch off ") + e.namesOf(e.state.selection.emitters), [&](Look& look) {
                 for (const std::string& id : e.state.selection.emitters) setEnabled(look, id, on);
             });
         },
         hasSelection,
         {},
         true});
    add({"light.solo",
         "Solo",
         "Show only the selected lights; press again to see all. Files are not affected.",
         "Light",
         {{'M', false, true}},
         [](Editor& e) {
             e.state.viewport.solo = e.state.viewport.solo == e.state.selection.emitters ? std::vector<std::string>{}
                                                                                         : e.state.selection.emitters;
         },
         [](const Editor& e) { return hasSelection(e) || !e.state.viewport.solo.empty(); },
         [](const Editor& e) { return !e.state.viewport.solo.empty(); },
         false});
    add({"light.rename",
         "Rename",
         "What the selected light is called: in the lists, as a light group of exported frames and in exported scenes.",
         "Light",
         {{keyF2}},
         [](Editor& e) { e.state.panels.renameLight = true; },
         hasSelection,
         {},
         false});
    add({"light.reset",
         "Reset to recovered",
         "The selected lights back to what was found: place, colour and power.",
         "Light",
         {},
         [](Editor& e) { resetEmitters(e, e.state.selection.emitters, EmitterValue::all); },
         hasSelection,
         {},
         false});
    add({"light.duplicate",
         "Duplicate",
         "A second light like this one, a little aside.",
         "Light",
         {{'D', false, true}},
         [](Editor& e) { duplicateEmitters(e, e.state.selection.emitters); },
         hasSelection,
         {},
         false});
    add({"light.delete",
         "Delete",
         "Removes added lights; recovered ones are switched off, because their geometry is part of the scene.",
         "Light",
         {{keyDelete}, {'X', false, true}},
         [](Editor& e) { deleteEmitters(e, e.state.selection.emitters); },
         hasSelection,
         {},
         false});
    for (const EmitterShapeInfo& info : emitterShapes())
        if (info.own()) add(addAction(info));
    add({"light.addPart",
         "Add a part of the scene",
         "Click a thing in the scene and it shines.",
         "Light",
         {},
         [](Editor& e) { e.state.viewport.clickTask = ClickTask::newPart; },
         hasEstimate,
         {},
         false});
    add({"light.aim",
         "Aim at a point",
         "Click a point and the selected light turns towards it.",
         "Light",
         {},
         [](Editor& e) { e.state.viewport.clickTask = ClickTask::aim; },
         hasSelection,
         {},
         true});
    add({"light.reflect",
         "Place by its reflection",
         "Click where the light should be mirrored; it moves there.",
         "Light",
         {},
         [](Editor& e) { e.state.viewport.clickTask = ClickTask::reflect; },
         hasSelection,
         {},
         false});
    add({"light.illuminate",
         "Place by its light",
         "Click what it should light; it moves straight above that spot.",
         "Light",
         {},
         [](Editor& e) { e.state.viewport.clickTask = ClickTask::illuminate; },
         hasSelection,
         {},
         false});
    add({"light.attach",
         "Attach a part",
         "Click a thing that should follow the selected light: its shade, its stand.",
         "Light",
         {},
         [](Editor& e) { e.state.viewport.clickTask = ClickTask::attach; },
         hasSelection,
         {},
         false});
    add({"light.environmentBrowse",
         "Environment image...",
         "Replace the distant environment with a panorama (EXR or HDR).",
         "Light",
         {},
         [](Editor& e) { e.state.panels.environmentBrowser = true; },
         hasEstimate,
         {},
         true});
    add({"light.environmentRecovered",
         "Environment as photographed",
         "Back to the environment that was recovered.",
         "Light",
         {},
         [](Editor& e) { e.edit("Environment as photographed", [](Look& look) { look.environment = {}; }); },
         hasEstimate,
         {},
         false});
    add({"light.environmentNone",
         "No environment",
         "Only the lights in the scene.",
         "Light",
         {},
         [](Editor& e) {
             e.edit("No environment", [](Look& look) { look.environment.source = EnvironmentLook::Source::none; });
         },
         hasEstimate,
         {},
         false});
    add({"light.neutral",
         "Neutral surfaces",
         "Every surface at its own brightness without colour: shows the light alone.",
         "Light",
         {},
         [](Editor& e) {
             e.edit(e.look().neutralMaterials ? "Coloured surfaces" : "Neutral surfaces",
                    [](Look& look) { look.neutralMaterials = !look.neutralMaterials; });
         },
         hasEstimate,
         [](const Editor& e) { return e.look().neutralMaterials; },
         false});
    // ---- view
    for (const ViewModeInfo& info : viewModes()) add(modeAction(info));
    add({"view.frame",
         "Frame what is selected",
         "Moves the camera so that the selection fills the image.",
         "View",
         {{'F'}},
         [](Editor& e) { frameSelected(e); },
         hasDocument,
         {},
         true});
    add({"view.frameAll",
         "Frame everything",
         "Moves the camera so that the whole scene fills the image.",
         "View",
         {{keyHome}},
         [](Editor& e) { frameAll(e); },
         hasDocument,
         {},
         false});
    add({"view.lookThrough",
         "Look through the photograph",
         "The viewport takes the place of the camera that took the selected photograph.",
         "View",
         {{'C'}, {keyPad0}},
         [](Editor& e) { toggleLookThrough(e); },
         hasDocument,
         [](const Editor& e) { return e.state.viewport.throughView; },
         false});
    add({"view.next",
         "Next photograph",
         "Selects the next photograph.",
         "View",
         {{keyPeriod}},
         [](Editor& e) { stepView(e, 1); },
         hasDocument,
         {},
         false});
    add({"view.previous",
         "Previous photograph",
         "Selects the photograph before.",
         "View",
         {{keyComma}},
         [](Editor& e) { stepView(e, -1); },
         hasDocument,
         {},
         false});
    add({"view.orthographic",
         "Without perspective",
         "Parallel lines stay parallel.",
         "View",
         {},
         [](Editor& e) { toggleOrthographic(e); },
         hasDocument,
         [](const Editor& e) { return e.state.viewport.camera.orthographic; },
         false});
    add({"view.brighter",
         "Brighter",
         "The image on screen, half a stop brighter. Files are not affected.",
         "View",
         {{'E'}},
         [](Editor& e) { changeExposure(e, 0.5f); },
         {},
         {},
         true});
    add({"view.darker",
         "Darker",
         "The image on screen, half a stop darker. Files are not affected.",
         "View",
         {{'E', false, true}},
         [](Editor& e) { changeExposure(e, -0.5f); },
         {},
         {},
         false});
    add({"view.falseColour",
         "False colour",
         "Brightness in bands of a stop about middle grey.",
         "View",
         {},
         [](Editor& e) { e.state.viewport.falseColour = !e.state.viewport.falseColour; },
         {},
         [](const Editor& e) { return e.state.viewport.falseColour; },
         false});
    add({"view.hide",
         "Hide",
         "Hides the picked thing, so that you can reach behind it. Its light stays.",
         "View",
         {{'H'}},
         [](Editor& e) { hidePicked(e); },
         hasDocument,
         {},
         true});
    add({"view.showAll",
         "Show everything",
         "Brings hidden things back.",
         "View",
         {{'H', false, false, true}},
         [](Editor& e) { showAll(e); },
         hasDocument,
         {},
         false});
    add({"view.photograph",
         "Photograph behind",
         "Shows the photograph behind the scene when you look through it.",
         "View",
         {},
         [](Editor& e) { e.state.viewport.photographBehind = !e.state.viewport.photographBehind; },
         {},
         [](const Editor& e) { return e.state.viewport.photographBehind; },
         false});
    add({"view.overlay",
         "Mesh over the photograph",
         "Draws the mesh's edges over the photograph: how well cameras and mesh agree.",
         "View",
         {},
         [](Editor& e) { e.state.viewport.meshOverlay = !e.state.viewport.meshOverlay; },
         {},
         [](const Editor& e) { return e.state.viewport.meshOverlay; },
         false});
    add({"view.frusta",
         "Cameras",
         "Shows where the photographs were taken.",
         "View",
         {},
         [](Editor& e) { e.state.viewport.frusta = !e.state.viewport.frusta; },
         {},
         [](const Editor& e) { return e.state.viewport.frusta; },
         false});
    add({"view.grid",
         "Ground grid",
         "Shows a grid on the ground, a line a metre or as it fits.",
         "View",
         {},
         [](Editor& e) { e.state.viewport.grid = !e.state.viewport.grid; },
         {},
         [](const Editor& e) { return e.state.viewport.grid; },
         false});
    add({"view.dome",
         "Environment behind",
         "Shows the environment around the scene.",
         "View",
         {},
         [](Editor& e) { e.state.viewport.directionDome = !e.state.viewport.directionDome; },
         {},
         [](const Editor& e) { return e.state.viewport.directionDome; },
         false});
    add({"view.larger",
         "Larger text",
         "Makes everything in the window larger.",
         "View",
         {{keyEqual, true}},
         [](Editor& e) { scaleUi(e, 1.125f); },
         {},
         {},
         true});
    add({"view.smaller",
         "Smaller text",
         "Makes everything in the window smaller.",
         "View",
         {{keyMinus, true}},
         [](Editor& e) { scaleUi(e, 1 / 1.125f); },
         {},
         {},
         false});
    // ---- help
    add({"help.palette",
         "Find a command...",
         "Type what you want to do.",
         "Help",
         {{'P', true, true}},
         [](Editor& e) { e.state.panels.palette = true; },
         {},
         {},
         false});
    add({"help.keys",
         "Keys",
         "Every key there is.",
         "Help",
         {{keyF1}},
         [](Editor& e) { e.state.panels.keys = true; },
         {},
         {},
         false});
    add({"help.about",
         "About relamp",
         "What this is, its version and where its method comes from.",
         "Help",
         {},
         [](Editor& e) { e.state.panels.about = true; },
         {},
         {},
         false});
    return t;
}

}  // namespace

std::string KeyChord::text() const {
    std::string t;
    if (control) t += "Ctrl+";
    if (shift) t += "Shift+";
    if (alt) t += "Alt+";
    return t + keyName(key);
}

const std::vector<Action>& actions() {
    static const std::vector<Action> table = makeActions();
    return table;
}

const Action* findAction(const std::string& id) {
    for (const Action& a : actions())
        if (a.id == id) return &a;
    return nullptr;
}

bool runAction(Editor& editor, const std::string& id) {
    const Action* a = findAction(id);
    if (!a || (a->enabled && !a->enabled(editor))) return false;
    a->run(editor);
    return true;
}

bool runKey(Editor& editor, const KeyChord& chord) {
    for (const Action& a : actions())
        if (std::find(a.keys.begin(), a.keys.end(), chord) != a.keys.end() && (!a.enabled || a.enabled(editor))) {
            a.run(editor);
            return true;
        }
    return false;
}

}  // namespace relamp::ui
