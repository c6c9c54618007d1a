// The menu Time: keys of the look, playing, the frame that is shown.
#include "actions/menus.h"
#include "edit/look_keys.h"

namespace relamp::ui {
namespace {

bool hasKeys(const Editor& e) { return hasEstimate(e) && !keyFrames(e.look()).empty(); }
bool onKey(const Editor& e) { return hasEstimate(e) && keyAt(e.look(), e.state.time.frame) >= 0; }

}  // namespace

void addTimeActions(std::vector<Action>& table) {
    const auto add = [&](Action a) {
        a.menu = "Time";
        table.push_back(std::move(a));
    };
    add({"time.play",
         "Play",
         "Shows one frame after the other; the first pass as fast as frames are made, then at their own speed.",
         "",
         {{keySpace}},
         [](Editor& e) { e.play(!e.state.time.playing); },
         hasEstimate,
         [](const Editor& e) { return e.state.time.playing; },
         false});
    add({"time.setKey",
         "Set key",
         "Keeps the look as it is for the present frame. With keys, every edit sets the key of its frame.",
         "",
         {{'K'}},
         [](Editor& e) {
             e.setKey();
             e.state.panels.bottomTab = framesTab;
             e.state.panels.bottomFolded = false;
         },
         hasEstimate,
         {},
         true});
    add({"time.deleteKey",
         "Delete key",
         "Forgets the key of the present frame.",
         "",
         {{'K', false, true}},
         [](Editor& e) { e.deleteKey(e.state.time.frame); },
         onKey,
         {},
         false});
    add({"time.previousKey",
         "Previous key",
         "Goes to the key before the present frame.",
         "",
         {{'J'}},
         [](Editor& e) { e.goToKey(-1); },
         hasKeys,
         {},
         true});
    add({"time.nextKey",
         "Next key",
         "Goes to the key after the present frame.",
         "",
         {{'L'}},
         [](Editor& e) { e.goToKey(1); },
         hasKeys,
         {},
         false});
    add({"time.curves",
         "Curves of values",
         "Values with keys of their own against frames, in the panel Frames.",
         "",
         {},
         [](Editor& e) {
             e.state.time.curves = !e.state.time.curves || e.state.panels.bottomTab != framesTab;
             e.state.panels.bottomTab = framesTab;
             e.state.panels.bottomFolded = false;
         },
         hasDocument,
         [](const Editor& e) { return e.state.time.curves; },
         false});
    add({"time.plateRelit",
         "Plate relit",
         "Shows the plate as the export relights it, once nothing moves; key 1 shows it alone.",
         "",
         {},
         [](Editor& e) {
             e.state.viewport.plateRelit = !e.state.viewport.plateRelit;
             if (e.state.viewport.plateRelit) e.state.viewport.mode = ViewMode::photograph;
         },
         [](const Editor& e) { return hasEstimate(e) && e.plate(); },
         [](const Editor& e) { return e.state.viewport.plateRelit; },
         false});
    add({"time.frames",
         "Show frames",
         "The strip of frames with the keys, in the bottom panel.",
         "",
         {},
         [](Editor& e) {
             e.state.panels.bottomTab = framesTab;
             e.state.panels.bottomFolded = false;
         },
         hasDocument,
         {},
         true});
}

}  // namespace relamp::ui
