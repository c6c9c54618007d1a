// Mouse and keys over the image: camera, picking, dividers, gizmo and gestures. Reads Dear ImGui's mouse and keys.h;
// changes the editor.
#pragma once
#include "viewport/light_stroke.h"
#include "viewport/overlays.h"
#include "viewport/transform_gesture.h"
#include "viewport/viewport_image.h"

namespace relamp::ui {

class Interaction {
public:
    /// Moves the orbit camera before the image is drawn. `hovered`, `active`: the viewport's own item under the
    /// mouse, or held.
    void moveCamera(Editor& editor, const Canvas& canvas, bool hovered, bool active);
    /// Everything else, after it: `image` says what can be picked.
    void act(Editor& editor, const Canvas& canvas, const ViewportImage& image, bool hovered, bool active);
    void draw(const Canvas& canvas, const ViewportImage& image);
    bool gestureRunning() const { return gesture_.running(); }
    void abandon(Editor& editor) { gesture_.abandon(editor); }

private:
    enum class Drag { none, orbit, pan, handle, divider, click, stroke };
    Drag drag_ = Drag::none;
    int divider_ = -1;
    Vec2 pressedAt_{0};
    TransformGesture gesture_;
    LightStroke stroke_;
    GizmoHandle hoveredHandle_ = GizmoHandle::none;
    std::string hoveredEmitter_;
    int hoveredDivider_ = -1, hoveredView_ = -1;
    bool hovered_ = false;

    /// A press begins a stroke of light.
    static bool painting(const Editor& editor);
    std::optional<std::pair<GizmoKind, GizmoFrame>> gizmo(const Editor& editor, const Canvas& canvas) const;
    void keys(Editor& editor, const Canvas& canvas, const Vec2& mouse);
    void findHovered(Editor& editor, const Canvas& canvas, const ViewportImage& image, const Vec2& mouse);
    void press(Editor& editor, const Canvas& canvas, const ViewportImage& image, const Vec2& mouse);
    void click(Editor& editor, const Canvas& canvas, const ViewportImage& image, const Vec2& mouse);
};

}  // namespace relamp::ui
