// The menu View: modes, the camera, the image on screen, and what is drawn over it.
#include <algorithm>
#include <cctype>

#include "actions/menus.h"
#include "viewport/navigation.h"

namespace relamp::ui {
namespace {

using Adder = std::function<void(Action)>;

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

void addCamera(const Adder& add) {
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
    add({"view.lookThroughPlate",
         "Look through the plate",
         "The viewport takes the place of the plate's tracked camera and follows it from frame to frame.",
         "View",
         {{'C', false, true}},
         [](Editor& e) { toggleLookThroughPlate(e); },
         [](const Editor& e) { return e.plate() != nullptr; },
         [](const Editor& e) { return e.plateCamera() != nullptr; },
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
    add({"view.bookmark",
         "Bookmark this view",
         "Keeps what the viewport shows in the list below the photographs.",
         "View",
         {{'V', false, true}},
         [](Editor& e) { bookmarkView(e); },
         hasEstimate,
         {},
         true});
    add({"view.nextBookmark",
         "Next bookmark",
         "Goes to the next view that was kept.",
         "View",
         {{'V'}},
         [](Editor& e) { nextBookmark(e); },
         [](const Editor& e) { return hasEstimate(e) && !e.look().bookmarks.empty(); },
         {},
         false});
    add({"view.orthographic",
         "Orthographic",
         "Parallel lines stay parallel.",
         "View",
         {},
         [](Editor& e) { toggleOrthographic(e); },
         hasDocument,
         [](const Editor& e) { return e.state.viewport.camera.orthographic; },
         false});
}

void addImage(const Adder& add) {
    add({"view.brighter",
         "Brighter",
         "The image on screen, half a stop brighter. EXR files are not affected.",
         "View",
         {{'E'}},
         [](Editor& e) { changeExposure(e, 0.5f); },
         {},
         {},
         true});
    add({"view.darker",
         "Darker",
         "The image on screen, half a stop darker. EXR files are not affected.",
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
         "Hides the picked object, so that you can reach behind it. Its light stays.",
         "View",
         {{'H'}},
         [](Editor& e) { hidePicked(e); },
         hasDocument,
         {},
         true});
    add({"view.showAll",
         "Show everything",
         "Brings hidden objects back.",
         "View",
         {{'H', false, false, true}},
         [](Editor& e) { showAll(e); },
         hasDocument,
         {},
         false});
}

void toggleRegion(Editor& e) {
    ViewportState& viewport = e.state.viewport;
    if (viewport.clickTask == ClickTask::region) viewport.clickTask = ClickTask::none;
    else if (viewport.region) viewport.region.reset();
    else viewport.clickTask = ClickTask::region;
}

void addRegion(const Adder& add) {
    add({"view.region",
         "Render region",
         "Drag a rectangle: only what lies in it is rendered at rest, and exported. Again removes it.",
         "View",
         {{'B', false, true}},
         toggleRegion,
         hasEstimate,
         [](const Editor& e) {
             return e.state.viewport.region.has_value() || e.state.viewport.clickTask == ClickTask::region;
         },
         false});
}

void addOverlays(const Adder& add) {
    add({"view.overlays",
         "Overlays",
         "Marks, grid, cameras, legend and axes over the image, all at once.",
         "View",
         {{'O'}},
         [](Editor& e) { e.state.viewport.overlays = !e.state.viewport.overlays; },
         {},
         [](const Editor& e) { return e.state.viewport.overlays; },
         true});
    add({"view.photograph",
         "Background photo",
         "Shows the photograph, or the plate, behind the scene when you look through it.",
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
}

void addWindow(const Adder& add) {
    add({"view.panels",
         "Hide the panels",
         "Shows the viewport alone; again brings the panels back.",
         "View",
         {{keyTab}},
         [](Editor& e) { e.state.panels.hidden = !e.state.panels.hidden; },
         {},
         [](const Editor& e) { return e.state.panels.hidden; },
         true});
    add({"view.fullScreen",
         "Full screen",
         "The window over the whole screen.",
         "View",
         {{keyF11}},
         [](Editor& e) { e.state.fullScreen = !e.state.fullScreen; },
         {},
         [](const Editor& e) { return e.state.fullScreen; },
         false});
    add({"view.bottom",
         "Fold the bottom panel",
         "Leaves its tabs alone; a click on a tab unfolds it.",
         "View",
         {{'B', true}},
         [](Editor& e) { e.state.panels.bottomFolded = !e.state.panels.bottomFolded; },
         {},
         [](const Editor& e) { return e.state.panels.bottomFolded; },
         false});
}

void addTextSize(const Adder& add) {
    add({"view.larger",
         "Larger text",
         "Makes everything in the window larger.",
         "View",
         {{keyEqual, true}},
         [](Editor& e) { scaleUi(e, 1.125f); },
         {},
         {},
         false});
    add({"view.smaller",
         "Smaller text",
         "Makes everything in the window smaller.",
         "View",
         {{keyMinus, true}},
         [](Editor& e) { scaleUi(e, 1 / 1.125f); },
         {},
         {},
         false});
}

void addUnits(const Adder& add) {
    for (size_t i = 0; i < lengthUnitCount; ++i) {
        const LengthUnit unit{int(i)};
        const std::string name = infoOf(unit).name;
        Action a;
        a.id = "view.unit." + name;
        a.label = char(std::toupper(name[0])) + name.substr(1);
        a.explanation = fmt::format("Lengths are shown and typed in {}. Files stay in metres.", name);
        a.menu = "View";
        a.run = [unit](Editor& e) { e.state.lengthUnit = unit; };
        a.checked = [unit](const Editor& e) { return e.state.lengthUnit == unit; };
        a.separatorBefore = i == 0;
        a.submenu = "Unit of length";
        add(std::move(a));
    }
}

}  // namespace

void addViewActions(std::vector<Action>& table) {
    const Adder add = [&](Action a) { table.push_back(std::move(a)); };
    for (const ViewModeInfo& info : viewModes()) add(modeAction(info));
    addCamera(add);
    addImage(add);
    addRegion(add);
    addOverlays(add);
    addWindow(add);
    addUnits(add);
    addTextSize(add);
}

}  // namespace relamp::ui
