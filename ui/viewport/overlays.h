// What lies over the image: emitter icons, dividers with captions, legends, the axes in the corner, hints. Drawn as
// strokes with ImDrawList, sharp at every scale. Each thing that can be clicked has its hit test beside its drawing.
#pragma once
#include <imgui.h>

#include "editor.h"
#include "viewport/eye_view.h"
#include "viewport/gizmo.h"
#include "viewport/paint.h"

namespace relamp::ui {

/// Where overlays are drawn.
struct Canvas {
    ImDrawList* list = nullptr;
    Editor* editor = nullptr;
    const EyeView* eye = nullptr;
    Vec2 corner{0}, size{0};  ///< of the whole viewport; the image may be smaller
    float scale = 1;          ///< of the interface
};

inline ImVec2 toIm(const Vec2& p) { return {p.x, p.y}; }
/// Text on a soft dark ground, so that it can be read over any image. `anchor`: which part of it lies at `at`, (0, 0)
/// its top left.
void labelAt(const Canvas& canvas, const Vec2& at, const std::string& text, const Vec2& anchor = Vec2(0),
             float widest = 1e9f);

void drawEmitterMarks(const Canvas& canvas, const std::string& hovered);
/// Id of the emitter whose icon is under the mouse; empty: none.
std::string emitterMarkAt(const Canvas& canvas, const Vec2& mouse);

/// Ids of the emitters whose icons lie inside the rectangle.
std::vector<std::string> emitterMarksIn(const Canvas& canvas, const Vec2& a, const Vec2& b);

/// Photograph whose camera is under the mouse; -1: none.
int frustumAt(const Canvas& canvas, const Vec2& mouse);
void drawFrustumName(const Canvas& canvas, int view);

/// Axes in the corner. The hit test gives axis (0 to 2) and sign.
void drawAxes(const Canvas& canvas, const Vec2& mouse);
std::optional<std::pair<int, int>> axisAt(const Canvas& canvas, const Vec2& mouse);

/// Lines between strips, captions and what is missing. `active`: number of the divider under the mouse or held, -1:
/// none.
void drawStrips(const Canvas& canvas, const std::vector<Strip>& strips, int active);
int dividerAt(const Canvas& canvas, const std::vector<Strip>& strips, const Vec2& mouse);
/// Moves divider `index` of the present mode to a screen position.
void moveDivider(const Canvas& canvas, int index, float screenX);

/// Explains the colours of the present mode.
void drawLegend(const Canvas& canvas);
/// A calm sentence in the middle: nothing is open.
void drawEmpty(const Canvas& canvas);
/// And the object that a panel points out.
void drawPickedPoint(const Canvas& canvas);
/// Frames the object of this vertex of the capture's mesh in the next image: which one a line of a panel means.
void pointOut(uint32_t vertex);
/// What the armed click will do, in words: beside the mouse, in the inspector and in the status bar.
const char* hintOf(ClickTask task);

void drawGizmo(const Canvas& canvas, GizmoKind kind, const GizmoFrame& frame, GizmoHandle active);
/// The locked axis through the scene while keys drive the gesture.
void drawConstraint(const Canvas& canvas, const GizmoDrag& drag);

}  // namespace relamp::ui
