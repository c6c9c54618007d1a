// The menu Light: the estimate, the lights, what is added, and the environment.
#include "actions/menus.h"
#include "edit/group_edits.h"
#include "panels/emitter_controls.h"

namespace relamp::ui {
namespace {

using Adder = std::function<void(Action)>;

bool canSolve(const Editor& e) { return hasDocument(e) && !e.job(); }
bool hasSelection(const Editor& e) { return hasEstimate(e) && !e.state.selection.emitters.empty(); }

Action addAction(const EmitterShapeInfo& info) {
    Action a;
    a.id = std::string("light.add") + info.label;
    a.label = std::string("Add ") + info.name;
    a.explanation = "A new light in front of what you look at; move it with G, rotate it with R.";
    a.menu = "Light";
    a.enabled = hasEstimate;
    a.run = [shape = info.shape](Editor& e) { addNewEmitter(e, shape); };
    a.separatorBefore = &info == &emitterShapes().front();
    return a;
}

void addEstimate(const Adder& add) {
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
         "Find off-camera light",
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
}

void addSelected(const Adder& add) {
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
    add({"light.group",
         "Group",
         "The selected lights become a group with a switch, an exposure and a colour of its own.",
         "Light",
         {{'G', true}},
         [](Editor& e) {
             e.edit("Group " + e.namesOf(e.state.selection.emitters),
                    [&](Look& look) { groupLights(look, e.state.selection.emitters); });
         },
         hasSelection,
         {},
         false});
    add({"light.dissolve",
         "Dissolve group",
         "The groups of the selected lights end; their lights stay.",
         "Light",
         {{'G', true, true}},
         [](Editor& e) {
             e.edit("Dissolve group", [&](Look& look) {
                 for (const std::string& id : e.state.selection.emitters)
                     if (const LightGroup* group = groupOf(look.groups, id))
                         dissolveGroup(look, std::string(group->name));
             });
         },
         [](const Editor& e) {
             const auto grouped = [&](const std::string& id) { return groupOf(e.look().groups, id) != nullptr; };
             const auto& ids = e.state.selection.emitters;
             return hasSelection(e) && std::any_of(ids.begin(), ids.end(), grouped);
         },
         {},
         false});
    add({"light.reset",
         "Reset to recovered",
         "The selected lights back to what was found: position, colour and power.",
         "Light",
         {},
         [](Editor& e) { resetEmitters(e, e.state.selection.emitters, EmitterValue::all); },
         hasSelection,
         {},
         false});
    const auto clear = [&](const char* id, const char* label, const char* explanation, int key, TransformPart part) {
        add({id,
             label,
             explanation,
             "Light",
             {{key, false, false, true}},
             [part](Editor& e) { clearTransform(e, e.state.selection.emitters, part); },
             hasSelection,
             {},
             false});
    };
    clear("light.clearPosition", "Clear position", "The selected lights back to where they were recovered or added.",
          'G', TransformPart::position);
    clear("light.clearRotation", "Clear rotation", "The selected lights turned as they were recovered.", 'R',
          TransformPart::rotation);
    clear("light.clearScale", "Clear scale", "The selected lights as large as they were recovered.", 'S',
          TransformPart::scale);
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
         "Delete or switch off",
         "Removes added lights. Recovered ones are switched off, because their geometry is part of the scene.",
         "Light",
         {{keyDelete}, {'X', false, true}},
         [](Editor& e) { deleteEmitters(e, e.state.selection.emitters); },
         [](const Editor& e) { return hasSelection(e) && !e.state.time.takesDelete; },
         {},
         false});
}

void addNew(const Adder& add) {
    for (const EmitterShapeInfo& info : emitterShapes())
        if (info.own()) add(addAction(info));
    add({"light.addPart",
         "Add object light",
         "Click an object of the scene and it shines.",
         "Light",
         {},
         [](Editor& e) { e.state.viewport.clickTask = ClickTask::newPart; },
         hasEstimate,
         {},
         false});
    add({"light.paint",
         "Paint with light",
         "Stroke over the image what is to be brighter, darker or of another colour; the lights change to make it so.",
         "Light",
         {{'P'}},
         [](Editor& e) {
             Tool& tool = e.state.viewport.tool;
             tool = tool == Tool::paint ? Tool::select : Tool::paint;
         },
         hasEstimate,
         [](const Editor& e) { return e.state.viewport.tool == Tool::paint; },
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
         "Click where its reflection is to be seen; the light moves there.",
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
    add({"light.leaveOut",
         "Leave an object out",
         "Click an object that the selected lights do not fall on.",
         "Light",
         {},
         [](Editor& e) { e.state.viewport.clickTask = ClickTask::leaveOut; },
         hasSelection,
         {},
         false});
    add({"light.only",
         "Light one object alone",
         "Click an object that the selected lights fall on, and on nothing else.",
         "Light",
         {},
         [](Editor& e) { e.state.viewport.clickTask = ClickTask::lightOnly; },
         hasSelection,
         {},
         false});
    add({"light.attach",
         "Attach an object",
         "Click an object that follows the selected light from then on: its shade, its stand.",
         "Light",
         {},
         [](Editor& e) { e.state.viewport.clickTask = ClickTask::attach; },
         hasSelection,
         {},
         false});
}

void addEnvironment(const Adder& add) {
    add({"light.environmentBrowse",
         "Load HDRI...",
         "Replace the environment with a panorama (EXR or HDR).",
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
}

}  // namespace

void addLightActions(std::vector<Action>& table) {
    const Adder add = [&](Action a) { table.push_back(std::move(a)); };
    addEstimate(add);
    addSelected(add);
    addNew(add);
    addEnvironment(add);
}

}  // namespace relamp::ui
