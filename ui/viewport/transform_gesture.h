// One transform of the selected emitters, from the first movement to one undo entry: by a handle of the gizmo or by the
// keys G, R, S with X, Y, Z locks and typed numbers. Knows no GL and no ImGui.
#pragma once
#include <string>

#include "editor.h"
#include "viewport/gizmo.h"

namespace relamp::ui {

/// Where the gizmo stands for the present selection; none when no emitter is selected. The active emitter gives pivot
/// and local axes.
struct TransformPivot {
    Vec3 origin{0};
    Mat3 local{1};
};
std::optional<TransformPivot> transformPivot(const Editor& editor);

class TransformGesture {
public:
    bool running() const { return running_; }
    bool byKey() const { return drag_.byKey; }
    const GizmoDrag& state() const { return drag_; }
    const std::string& readout() const { return readout_; }

    /// Does nothing without a selected emitter. `mouse` is a screen position, `points` the gizmo's size on screen.
    void begin(Editor& editor, GizmoKind kind, GizmoHandle handle, bool byKey, const EyeView& eye, const Vec2& mouse,
               float points);
    /// Takes what was typed since the last frame: X, Y, Z (again: the other axes; with Shift: the plane), digits,
    /// point, minus, Backspace, G, R, S (another kind), Enter, Esc. `pressed` and `typed` as in keys.h. False when the
    /// gesture ended.
    bool keys(Editor& editor, int pressed, const std::string& typed, bool shift, const EyeView& eye);
    /// Follows the mouse: with Shift a tenth of the way, with Ctrl in steps.
    void follow(Editor& editor, const EyeView& eye, const Vec2& mouse, bool control, bool shift);
    void commit(Editor& editor);
    void abandon(Editor& editor);

private:
    bool running_ = false;
    GizmoDrag drag_;
    TransformPivot pivot_;
    bool local_ = false;
    std::vector<std::string> emitters_;
    Vec2 lastMouse_{0}, effective_{0};  ///< the mouse, and where it would be without Shift's slow motion
    bool control_ = false;
    std::string number_, readout_;
    void apply(Editor& editor, const EyeView& eye);
    void lock(GizmoHandle handle, const Editor& editor);
};

/// A button or the palette asks the viewport to begin a transform as the key would; the viewport takes it in its next
/// draw.
void requestTransform(GizmoKind kind);
std::optional<GizmoKind> takeTransformRequest();

}  // namespace relamp::ui
