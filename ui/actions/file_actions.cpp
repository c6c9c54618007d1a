// The menus File, Edit and Help.
#include "actions/menus.h"
#include "panels/light_clipboard.h"

namespace relamp::ui {

void addFileActions(std::vector<Action>& table) {
    const auto add = [&](Action a) { table.push_back(std::move(a)); };
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
    add({"file.saveVersion",
         "Save new version",
         "Saves beside the shot under the next number: NAME-002.relamp. The shot stays as it was.",
         "File",
         {{'S', true, false, true}},
         [](Editor& e) { e.saveVersion(); },
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
    add({"file.saveLook",
         "Save look...",
         "The look as a file of its own, for other shots and for relamp render --edits.",
         "File",
         {},
         [](Editor& e) { e.state.panels.saveLookBrowser = true; },
         hasEstimate,
         {},
         true});
    add({"file.loadLook",
         "Load look...",
         "A look from a file takes the place of the present one. One edit, which can be undone.",
         "File",
         {},
         [](Editor& e) { e.state.panels.loadLookBrowser = true; },
         hasEstimate,
         {},
         false});
    add({"file.importPlate",
         "Import plate...",
         "A shot that was filmed in the captured set with a tracked camera: its frames are shown and relit.",
         "File",
         {},
         [](Editor& e) {
             const std::optional<PlateLook>& plate = e.look().plate;
             e.state.plateImport = plate ? *plate : PlateLook{};
         },
         hasEstimate,
         {},
         true});
    add({"file.removePlate",
         "Remove the plate",
         "The shot does without it; its files stay as they are. One edit, which can be undone.",
         "File",
         {},
         [](Editor& e) { e.removePlate(); },
         [](const Editor& e) { return hasEstimate(e) && e.look().plate.has_value(); },
         {},
         false});
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
}

void addSnapshotActions(std::vector<Action>& table) {
    static constexpr const char* stores[] = {"Store as snapshot A", "Store as snapshot B", "Store as snapshot C"};
    static constexpr const char* recalls[] = {"Go to snapshot A", "Go to snapshot B", "Go to snapshot C"};
    for (int i = 0; i < 3; ++i) {
        Action store;
        store.id = std::string("edit.store") + char('A' + i);
        store.label = stores[i];
        store.explanation = "Keeps the present look, to compare with and to go back to. Saved with the shot.";
        store.menu = "Edit";
        store.keys = {{keyF1 + 4 + i, true}};
        store.run = [i](Editor& e) { e.storeSnapshot(size_t(i)); };
        store.enabled = hasEstimate;
        store.separatorBefore = i == 0;
        table.push_back(std::move(store));
    }
    for (int i = 0; i < 3; ++i) {
        Action recall;
        recall.id = std::string("edit.recall") + char('A' + i);
        recall.label = recalls[i];
        recall.explanation = "Makes the kept look the present one. One edit, which can be undone.";
        recall.menu = "Edit";
        recall.keys = {{keyF1 + 4 + i}};
        recall.run = [i](Editor& e) { e.recallSnapshot(size_t(i)); };
        recall.enabled = [i](const Editor& e) { return hasEstimate(e) && e.state.snapshots[size_t(i)].has_value(); };
        table.push_back(std::move(recall));
    }
}

void addEditActions(std::vector<Action>& table) {
    const auto add = [&](Action a) { table.push_back(std::move(a)); };
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
    add({"edit.copy",
         "Copy lights",
         "The selected lights, to be pasted here or in another shot.",
         "Edit",
         {{'C', true}},
         copyLights,
         [](const Editor& e) { return hasEstimate(e) && !e.state.selection.emitters.empty(); },
         {},
         true});
    add({"edit.paste",
         "Paste lights",
         "The copied lights as new lights, where they were.",
         "Edit",
         {{'V', true}},
         pasteLights,
         [](const Editor& e) { return hasEstimate(e) && !e.state.copied.lights.empty(); },
         {},
         false});
    add({"edit.pasteValues",
         "Paste exposure and colour",
         "Gives the selected lights the exposure and colour of the copied one.",
         "Edit",
         {{'V', true, true}},
         pasteLightValues,
         [](const Editor& e) {
             return hasEstimate(e) && !e.state.copied.lights.empty() && !e.state.selection.emitters.empty();
         },
         {},
         false});
    addSnapshotActions(table);
    add({"edit.selectNone",
         "Deselect",
         "Select nothing; first disarms a click that waits, or the brush of light.",
         "Edit",
         {{keyEscape}},
         [](Editor& e) {
             if (e.state.viewport.clickTask != ClickTask::none) {
                 e.state.viewport.clickTask = ClickTask::none;
                 return;
             }
             if (e.state.viewport.tool == Tool::paint) {
                 e.state.viewport.tool = Tool::select;  // what is selected stays
                 return;
             }
             e.state.selection.emitters.clear();
             e.pick(std::nullopt);
         },
         [](const Editor& e) {
             return e.state.viewport.clickTask != ClickTask::none || e.state.viewport.tool == Tool::paint ||
                    !e.state.selection.emitters.empty() || e.state.selection.point;
         },
         {},
         true});
    add({"edit.selectAll",
         "Select all lights",
         "Select every light, to edit them together.",
         "Edit",
         {{'A', true}},
         [](Editor& e) {
             e.state.selection.emitters.clear();
             for (const EmitterState& s : e.emitters()) e.state.selection.emitters.push_back(s.id);
         },
         hasEstimate,
         {},
         false});
}

void addHelpActions(std::vector<Action>& table) {
    const auto add = [&](Action a) { table.push_back(std::move(a)); };
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
}

}  // namespace relamp::ui
