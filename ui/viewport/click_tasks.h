// What a click in the viewport does: selecting, picking a point, and the tasks that the inspector arms. Knows no GL and
// no ImGui.
#pragma once
#include "editor.h"
#include "viewport/eye_view.h"

namespace relamp::ui {

/// The emitter a triangle of the shown mesh belongs to; empty: none.
std::string emitterOfTriangle(const Editor& editor, uint32_t triangle);
/// Selects alone, or with `toggle` adds or removes.
void selectInViewport(Editor& editor, const std::string& id, bool toggle);
/// A click on a surface point, or on nothing: selects the emitter there, else picks the point; on nothing clears both.
void clickSurface(Editor& editor, const std::optional<PickedPoint>& point, bool toggle);
/// Tasks that place the selected lights by a surface point: a drag is followed as well as a click.
bool placesLights(ClickTask task);
/// What the history calls it: "Aim".
std::string editLabelOf(ClickTask task);
/// The selected lights as such a task wants them for a point: aimed at it, mirrored in it, or above it.
void placeLights(Look& look, const Editor& editor, ClickTask task, const PickedPoint& point, const EyeView& eye);
/// Does the armed task at the point as one edit and disarms it. False when no task is armed.
bool runClickTask(Editor& editor, const std::optional<PickedPoint>& point, const EyeView& eye);

}  // namespace relamp::ui
