// Mouse and keys over the image: camera, picking, dividers, gizmo and gestures. Reads Dear ImGui's mouse and keys.h;
// changes the editor.
#pragma once
#include "viewport/light_stroke.h"
#include "viewport/overlays.h"
#include "viewport/placement_drag.h"
#include "viewport/transform_gesture.h"

namespace relamp::ui {

/// What the image shows: its strips, the mesh that can be picked (null: none), and which triangles of it are visible.
struct ShownImage {
    const std::vector<Strip>& strips;
    const std::shared_ptr<const Mesh>& mesh;
    const std::vector<uint8_t>& visible;
};

class Interaction {
public:
    /// Moves the orbit camera before the image is drawn. `hovered`, `active`: the viewport's own item under the
    /// mouse, or held.
    void moveCamera(Editor& editor, const Canvas& canvas, bool hovered, bool active);
    /// Everything else, after it: `image` says what can be picked.
    void act(Editor& editor, const Canvas& canvas, const ShownImage& image, bool hovered, bool active);
    void draw(const Canvas& canvas, const ShownImage& image);
    /// The pointer draws a box, a stroke or a light's place: Esc gives that up, and does nothing else.
    bool takesEscape() const {
        return drag_ == Drag::box || drag_ == Drag::region || drag_ == Drag::stroke || drag_ == Drag::placement;
    }
    bool gestureRunning() const { return gesture_.running(); }
    void abandon(Editor& editor) { gesture_.abandon(editor); }

private:
    enum class Drag { none, orbit, pan, handle, divider, click, box, region, stroke, placement };
    Drag drag_ = Drag::none;
    int divider_ = -1;
    Vec2 pressedAt_{0};
    TransformGesture gesture_;
    LightStroke stroke_;
    PlacementDrag placement_;
    GizmoHandle hoveredHandle_ = GizmoHandle::none;
    std::string hoveredEmitter_;
    int hoveredDivider_ = -1, hoveredView_ = -1;
    bool hovered_ = false;
    Vec2 probedAt_{0};
    std::weak_ptr<const LiveFrame> probed_;

    /// A press begins a stroke of light.
    static bool painting(const Editor& editor);
    std::optional<std::pair<GizmoKind, GizmoFrame>> gizmo(const Editor& editor, const Canvas& canvas) const;
    void keys(Editor& editor, const Canvas& canvas, const Vec2& mouse);
    void findHovered(Editor& editor, const Canvas& canvas, const ShownImage& image, const Vec2& mouse);
    /// Radiance of the model under the pointer, per vertex; looked up again when either changes.
    void probe(Editor& editor, const Canvas& canvas, const ShownImage& image, const Vec2& mouse);
    void press(Editor& editor, const Canvas& canvas, const ShownImage& image, const Vec2& mouse);
    /// Selects the lights between where the drag began and `mouse`.
    void selectBox(Editor& editor, const Canvas& canvas, const Vec2& mouse) const;
    /// What lies between where the drag began and `mouse` becomes the region that is rendered.
    void setRegion(Editor& editor, const Canvas& canvas, const Vec2& mouse) const;
    void click(Editor& editor, const Canvas& canvas, const ShownImage& image, const Vec2& mouse);
};

}  // namespace relamp::ui
