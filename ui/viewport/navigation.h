// Moving about the scene, as functions on the editor: the actions table, keys and buttons all call these. Knows no GL.
#pragma once
#include "editor.h"
#include "viewport/scene_extent.h"

namespace relamp::ui {

/// Extent of the capture that is open; measured once.
const SceneExtent& sceneExtent(const Editor& editor);

/// The selected emitters, or the picked point, fill the viewport; without either, the whole scene does.
void frameSelected(Editor& editor);
void frameAll(Editor& editor);
/// Looks through a photograph. Out of range: nothing happens.
void lookThrough(Editor& editor, int view);
/// Back to the orbit camera, starting from where the photograph was taken.
void leaveView(Editor& editor);
void toggleLookThrough(Editor& editor);
/// The viewport takes the place of a photograph's camera, or of the plate's.
bool looksThrough(const Editor& editor);
/// Looks through the plate's camera of the present frame, or leaves it. Without a plate: nothing happens.
void toggleLookThroughPlate(Editor& editor);
/// The present view without a name; that of a photograph or a plate as the orbit camera shows it (roll is lost).
CameraBookmark presentView(const Editor& editor);
/// The free camera takes a view that was kept.
void goToBookmark(Editor& editor, const CameraBookmark& bookmark);
/// The present view joins the look's bookmarks: one edit. Nothing happens before an estimate.
void bookmarkView(Editor& editor);
/// The bookmark that the free camera stands at; null: none.
const CameraBookmark* presentBookmark(const Editor& editor);
/// To the bookmark after the present one, going round; to the first from elsewhere.
void nextBookmark(Editor& editor);
/// Next (+1) or previous (-1) photograph, going round; looks through it when a photograph is looked through.
void stepView(Editor& editor, int step);
/// Looks along an axis at the orbit's target: axis 0, 1, 2 for x, y, z; `sign` +1 looks from its positive end.
void lookAlongAxis(Editor& editor, int axis, int sign);
void toggleOrthographic(Editor& editor);

/// Hides the component of the mesh that holds the picked point, or the active emitter's.
void hidePicked(Editor& editor);
void showAll(Editor& editor);
/// The capture's vertex under the picked point; none on added shapes or without a point.
std::optional<uint32_t> pickedCaptureVertex(const Editor& editor);

void setMode(Editor& editor, ViewMode mode);
void changeExposure(Editor& editor, float stops);

/// The view transform in use: the chosen one, or, where the artist leaves it to the window, one that keeps the hue of
/// what is brighter than the screen where there is such a thing (lights, photographs without a clip level).
std::string displayViewOf(const Editor& editor);

}  // namespace relamp::ui
