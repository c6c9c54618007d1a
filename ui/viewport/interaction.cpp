#include "viewport/interaction.h"

#include "keys.h"
#include "viewport/click_tasks.h"
#include "viewport/navigation.h"
#include "viewport/picking.h"

namespace relamp::ui {
namespace {

Vec2 mousePosition() { return {ImGui::GetIO().MousePos.x, ImGui::GetIO().MousePos.y}; }

bool popupOpen() { return ImGui::IsPopupOpen("", ImGuiPopupFlags_AnyPopupId | ImGuiPopupFlags_AnyPopupLevel); }

GizmoKind kindOf(Tool tool) {
    return tool == Tool::rotate ? GizmoKind::rotate : tool == Tool::scale ? GizmoKind::scale : GizmoKind::move;
}

}  // namespace

bool Interaction::painting(const Editor& editor) {
    return editor.state.viewport.tool == Tool::paint && editor.state.viewport.clickTask == ClickTask::none &&
           editor.estimate() && editor.liveFrame();
}

std::optional<std::pair<GizmoKind, GizmoFrame>> Interaction::gizmo(const Editor& editor, const Canvas& canvas) const {
    const ViewportState& viewport = editor.state.viewport;
    if (viewport.tool == Tool::select || viewport.tool == Tool::paint || viewport.clickTask != ClickTask::none)
        return std::nullopt;
    const auto pivot = transformPivot(editor);
    if (!pivot || !canvas.eye->toScreen(pivot->origin)) return std::nullopt;
    return std::pair(kindOf(viewport.tool), gizmoFrameAt(pivot->origin, viewport.localAxes ? pivot->local : Mat3(1),
                                                         *canvas.eye, gizmoPoints * canvas.scale));
}

void Interaction::moveCamera(Editor& editor, const Canvas& canvas, bool hovered, bool active) {
    const ImGuiIO& io = ImGui::GetIO();
    if (!editor.state.document.scene) return;
    OrbitCamera& camera = editor.state.viewport.camera;
    const auto leave = [&] {
        if (looksThrough(editor)) leaveView(editor);
    };
    if (drag_ == Drag::none && active && !gesture_.running()) {
        const bool alt = input().alt || io.KeyAlt, shift = input().shift || io.KeyShift;
        if (ImGui::IsMouseClicked(ImGuiMouseButton_Middle)) drag_ = shift ? Drag::pan : Drag::orbit;
        if (ImGui::IsMouseClicked(ImGuiMouseButton_Left) && alt) drag_ = shift ? Drag::pan : Drag::orbit;
        if (ImGui::IsMouseClicked(ImGuiMouseButton_Right)) drag_ = Drag::pan;
    }
    if (drag_ == Drag::orbit || drag_ == Drag::pan) {
        const Vec2 step(io.MouseDelta.x, io.MouseDelta.y);
        if (step != Vec2(0)) {
            leave();
            drag_ == Drag::orbit ? camera.orbit(step / canvas.scale) : camera.pan(step, canvas.size.y);
        }
        if (!active) drag_ = Drag::none;
    }
    if (hovered && io.MouseWheel != 0 && !popupOpen()) {
        leave();
        camera.zoom(io.MouseWheel);
    }
}

void Interaction::findHovered(Editor& editor, const Canvas& canvas, const ShownImage& image, const Vec2& mouse) {
    hoveredHandle_ = GizmoHandle::none;
    hoveredEmitter_.clear();
    hoveredDivider_ = hoveredView_ = -1;
    const bool overlays = editor.state.viewport.overlays;
    if (!hovered_ || drag_ != Drag::none || gesture_.running() || (overlays && axisAt(canvas, mouse))) return;
    if (const auto g = gizmo(editor, canvas))
        hoveredHandle_ = hitTest(canvas.eye->rayAt(mouse), g->second, *canvas.eye, g->first);
    if (hoveredHandle_ != GizmoHandle::none) return;
    hoveredDivider_ = dividerAt(canvas, image.strips, mouse);
    if (hoveredDivider_ >= 0) return;
    if (!overlays) return;
    hoveredEmitter_ = emitterMarkAt(canvas, mouse);
    if (hoveredEmitter_.empty()) hoveredView_ = frustumAt(canvas, mouse);
}

void Interaction::keys(Editor& editor, const Canvas& canvas, const Vec2& mouse) {
    const Input& in = input();
    const float points = gizmoPoints * canvas.scale;
    if (gesture_.running()) {
        // Something else ended the gesture: an undo from a menu, another document.
        if (!editor.inGesture()) {
            gesture_.abandon(editor);
            return;
        }
        if (in.pressed || !in.typed.empty()) gesture_.keys(editor, in.pressed, in.typed, in.shift, *canvas.eye);
        return;
    }
    if (const auto wanted = takeTransformRequest())
        gesture_.begin(editor, *wanted, GizmoHandle::screen, true, *canvas.eye, mouse, points);
    if (popupOpen() || ImGui::GetIO().WantTextInput || editor.inGesture() || in.control || in.alt || in.shift) return;
    if (in.pressed == 'G' || in.pressed == 'R' || in.pressed == 'S')
        gesture_.begin(editor,
                       in.pressed == 'G'   ? GizmoKind::move
                       : in.pressed == 'R' ? GizmoKind::rotate
                                           : GizmoKind::scale,
                       GizmoHandle::screen, true, *canvas.eye, mouse, points);
}

void Interaction::probe(Editor& editor, const Canvas& canvas, const ShownImage& image, const Vec2& mouse) {
    std::optional<Rgb>& value = editor.state.probe;
    const auto live = editor.liveFrame();
    if (!hovered_ || drag_ != Drag::none || gesture_.running() || !live || live->mesh != image.mesh ||
        !canvas.eye->contains(mouse) || image.strips.size() != 1 ||
        !infoOf(editor.state.viewport.mode).shows(Paint::model)) {
        value.reset();
        probed_.reset();
        return;
    }
    if (mouse == probedAt_ && probed_.lock() == live) return;
    probedAt_ = mouse;
    probed_ = live;
    value = radianceAlong(*live, canvas.eye->rayAt(mouse), image.visible);
}

void Interaction::press(Editor& editor, const Canvas& canvas, const ShownImage& image, const Vec2& mouse) {
    pressedAt_ = mouse;
    if (editor.state.viewport.clickTask == ClickTask::region) {
        drag_ = Drag::region;
        return;
    }
    drag_ = Drag::click;
    if (const auto axis = editor.state.viewport.overlays ? axisAt(canvas, mouse) : std::nullopt) {
        lookAlongAxis(editor, axis->first, axis->second);
        drag_ = Drag::none;
        return;
    }
    if (const auto g = gizmo(editor, canvas)) {
        const GizmoHandle handle = hitTest(canvas.eye->rayAt(mouse), g->second, *canvas.eye, g->first);
        if (handle != GizmoHandle::none) {
            gesture_.begin(editor, g->first, handle, false, *canvas.eye, mouse, gizmoPoints * canvas.scale);
            if (gesture_.running()) drag_ = Drag::handle;
            return;
        }
    }
    if (const int divider = dividerAt(canvas, image.strips, mouse); divider >= 0) {
        drag_ = Drag::divider, divider_ = divider;
    } else if (PlacementDrag::fits(editor) && image.mesh && canvas.eye->contains(mouse)) {
        drag_ = Drag::placement;
        placement_.begin(editor, image.mesh, image.visible);
    } else if (painting(editor)) {
        drag_ = Drag::stroke;
        stroke_.begin(mouse);
    }
}

void Interaction::selectBox(Editor& editor, const Canvas& canvas, const Vec2& mouse) const {
    std::vector<std::string>& selected = editor.state.selection.emitters;
    const bool adds = input().control || input().shift || ImGui::GetIO().KeyCtrl || ImGui::GetIO().KeyShift;
    if (!adds) selected.clear();
    for (const std::string& id : emitterMarksIn(canvas, pressedAt_, mouse))
        if (!editor.state.selection.has(id)) selected.push_back(id);
    editor.pick(std::nullopt);
}

void Interaction::setRegion(Editor& editor, const Canvas& canvas, const Vec2& mouse) const {
    editor.state.viewport.clickTask = ClickTask::none;
    const auto fraction = [&](const Vec2& at) {
        return glm::clamp((at - canvas.eye->corner) / canvas.eye->size, Vec2(0), Vec2(1));
    };
    const Vec2 a = fraction(pressedAt_), b = fraction(mouse), low = glm::min(a, b), high = glm::max(a, b);
    const Vec2 size = (high - low) * canvas.eye->size;
    if (std::min(size.x, size.y) < 5 * canvas.scale) return;  // a click: none
    editor.state.viewport.region = ImageRegion{low, high};
}

void Interaction::click(Editor& editor, const Canvas& canvas, const ShownImage& image, const Vec2& mouse) {
    const bool toggle = input().control || ImGui::GetIO().KeyCtrl;
    const bool inside = canvas.eye->contains(mouse);
    const auto surface = [&]() -> std::optional<PickedPoint> {
        return inside && image.mesh ? pickSurface(*image.mesh, canvas.eye->rayAt(mouse), image.visible) : std::nullopt;
    };
    if (editor.state.viewport.clickTask != ClickTask::none) {
        if (runClickTask(editor, surface(), *canvas.eye)) return;
    }
    if (const std::string id = editor.state.viewport.overlays ? emitterMarkAt(canvas, mouse) : ""; !id.empty()) {
        selectInViewport(editor, id, toggle);
        editor.pick(std::nullopt);
        return;
    }
    if (const int view = editor.state.viewport.overlays ? frustumAt(canvas, mouse) : -1; view >= 0) {
        editor.state.selection.view = view;
        return;
    }
    clickSurface(editor, surface(), toggle);
}

void Interaction::act(Editor& editor, const Canvas& canvas, const ShownImage& image, bool hovered, bool active) {
    const Vec2 mouse = mousePosition();
    hovered_ = hovered;
    if (!editor.state.document.scene) {
        if (gesture_.running()) gesture_.abandon(editor);
        return;
    }
    keys(editor, canvas, mouse);
    findHovered(editor, canvas, image, mouse);
    probe(editor, canvas, image, mouse);
    const bool control = input().control || ImGui::GetIO().KeyCtrl, shift = input().shift || ImGui::GetIO().KeyShift;

    if (gesture_.running() && gesture_.byKey()) {
        gesture_.follow(editor, *canvas.eye, mouse, control, shift);
        if (ImGui::IsMouseClicked(ImGuiMouseButton_Left)) gesture_.commit(editor), drag_ = Drag::none;
        if (ImGui::IsMouseClicked(ImGuiMouseButton_Right)) gesture_.abandon(editor), drag_ = Drag::none;
        return;
    }
    if (active && drag_ == Drag::none && ImGui::IsMouseClicked(ImGuiMouseButton_Left))
        press(editor, canvas, image, mouse);
    if (hovered && ImGui::IsMouseDoubleClicked(ImGuiMouseButton_Left) &&
        editor.state.viewport.clickTask == ClickTask::none)
        if (const int view = frustumAt(canvas, mouse); view >= 0) {
            lookThrough(editor, view);
            drag_ = Drag::none;
            return;
        }

    const bool held = ImGui::IsMouseDown(ImGuiMouseButton_Left);
    switch (drag_) {
        case Drag::handle:
            if (!gesture_.running()) {
                drag_ = Drag::none;
            } else if (ImGui::IsMouseClicked(ImGuiMouseButton_Right)) {
                gesture_.abandon(editor), drag_ = Drag::none;
            } else {
                gesture_.follow(editor, *canvas.eye, mouse, control, shift);
                if (!held) gesture_.commit(editor), drag_ = Drag::none;
            }
            break;
        case Drag::divider:
            moveDivider(canvas, divider_, mouse.x);
            if (!held) drag_ = Drag::none;
            break;
        case Drag::stroke:
            // Escape, or a right click, gives the stroke up.
            if (!painting(editor) || ImGui::IsMouseClicked(ImGuiMouseButton_Right) || input().pressed == keyEscape) {
                stroke_.abandon(), drag_ = Drag::none;
            } else if (held) {
                stroke_.follow(canvas, mouse);
            } else {
                stroke_.end(canvas, shift), drag_ = Drag::none;
            }
            break;
        case Drag::placement:
            if (!editor.inGesture()) {
                // An undo from a menu, another document.
                placement_.abandon(editor), drag_ = Drag::none;
            } else if (ImGui::IsMouseClicked(ImGuiMouseButton_Right) || input().pressed == keyEscape) {
                placement_.abandon(editor), drag_ = Drag::none;
            } else {
                placement_.follow(editor, canvas.eye->rayAt(mouse), *canvas.eye);
                if (!held) placement_.commit(editor), drag_ = Drag::none;
            }
            break;
        case Drag::box:
            if (ImGui::IsMouseClicked(ImGuiMouseButton_Right) || input().pressed == keyEscape) drag_ = Drag::none;
            else if (!held) selectBox(editor, canvas, mouse), drag_ = Drag::none;
            break;
        case Drag::region:
            if (editor.state.viewport.clickTask != ClickTask::region || input().pressed == keyEscape ||
                ImGui::IsMouseClicked(ImGuiMouseButton_Right)) {
                editor.state.viewport.clickTask = ClickTask::none;
                drag_ = Drag::none;
            } else if (!held) {
                setRegion(editor, canvas, mouse);
                drag_ = Drag::none;
            }
            break;
        case Drag::click:
            if (!held) {
                click(editor, canvas, image, mouse);
                drag_ = Drag::none;
            } else if (glm::length(mouse - pressedAt_) >= 5 * canvas.scale) {
                const bool selects = editor.state.viewport.overlays &&
                                     editor.state.viewport.clickTask == ClickTask::none && editor.estimate();
                drag_ = selects ? Drag::box : Drag::none;
            }
            break;
        default: break;
    }
}

namespace {
/// The keys that mean something while a light is transformed.
std::string hintsFor(const TransformGesture& gesture, LengthUnit unit) {
    const bool turns = gesture.state().kind == GizmoKind::rotate;
    const char* const amount = turns                                     ? "degrees"
                               : gesture.state().kind == GizmoKind::move ? infoOf(unit).name
                                                                         : "a factor";
    return fmt::format("X Y Z: axis{}   0-9: {}   Ctrl: snap   Shift: fine   {}   Esc: back",
                       turns ? "" : ", Shift: plane", amount,
                       gesture.byKey() ? "Click or Enter: done" : "Release: done");
}
}  // namespace

void Interaction::draw(const Canvas& canvas, const ShownImage& image) {
    Editor& editor = *canvas.editor;
    editor.state.keyHints = gesture_.running() ? hintsFor(gesture_, editor.state.lengthUnit)
                            : editor.state.viewport.clickTask != ClickTask::none
                                ? hintOf(editor.state.viewport.clickTask)
                                : "";
    const Vec2 mouse = mousePosition();
    if (!editor.state.document.scene) {
        drawEmpty(canvas);
        return;
    }
    drawStrips(canvas, image.strips, drag_ == Drag::divider ? divider_ : hoveredDivider_);
    if (gesture_.running()) drawConstraint(canvas, gesture_.state());
    const bool overlays = editor.state.viewport.overlays;
    if (overlays) drawPickedPoint(canvas);
    if (overlays) drawEmitterMarks(canvas, hoveredEmitter_);
    if (gesture_.running() && !gesture_.byKey()) {
        if (const auto g = gizmo(editor, canvas)) drawGizmo(canvas, g->first, g->second, gesture_.state().handle);
    } else if (!gesture_.running()) {
        if (const auto g = gizmo(editor, canvas)) drawGizmo(canvas, g->first, g->second, hoveredHandle_);
    }
    if (overlays) drawLegend(canvas);
    if (overlays) drawAxes(canvas, hovered_ ? mouse : Vec2(-1e6f));
    drawFrustumName(canvas, hoveredView_);
    if ((hovered_ || stroke_.running()) && painting(editor)) stroke_.draw(canvas, mouse);
    if (const auto& region = editor.state.viewport.region) {
        const Vec2 a = canvas.eye->corner + region->low * canvas.eye->size,
                   b = canvas.eye->corner + region->high * canvas.eye->size;
        canvas.list->AddRect(toIm(a), toIm(b), IM_COL32(0, 0, 0, 150), 0, 0, 3 * canvas.scale);
        canvas.list->AddRect(toIm(a), toIm(b), IM_COL32(255, 170, 70, 230), 0, 0, canvas.scale);
    }
    if (drag_ == Drag::box || drag_ == Drag::region) {
        canvas.list->AddRectFilled(toIm(pressedAt_), toIm(mouse), IM_COL32(120, 170, 255, 30));
        canvas.list->AddRect(toIm(pressedAt_), toIm(mouse), IM_COL32(150, 190, 255, 200), 0, 0, canvas.scale);
    }
    if (gesture_.running()) {
        labelAt(canvas, mouse + Vec2(18, 18) * canvas.scale, gesture_.readout());
        if (const auto pivot = canvas.eye->toScreen(gesture_.state().frame.origin);
            pivot && gesture_.byKey() && gesture_.state().kind != GizmoKind::move)
            canvas.list->AddLine(toIm(*pivot), toIm(mouse), IM_COL32(230, 230, 230, 110), canvas.scale);
    } else if (hovered_ && editor.state.viewport.clickTask != ClickTask::none) {
        labelAt(canvas, mouse + Vec2(18, 18) * canvas.scale, hintOf(editor.state.viewport.clickTask));
    }
    if (hovered_ || drag_ == Drag::divider) {
        if (drag_ == Drag::divider || hoveredDivider_ >= 0) ImGui::SetMouseCursor(ImGuiMouseCursor_ResizeEW);
        if (editor.state.viewport.clickTask != ClickTask::none || hoveredHandle_ != GizmoHandle::none)
            ImGui::SetMouseCursor(ImGuiMouseCursor_Hand);
    }
}

}  // namespace relamp::ui
