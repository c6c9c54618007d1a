#include "viewport/transform_gesture.h"

#include <cstdlib>
#include <utility>

#include "keys.h"
#include "viewport/navigation.h"

namespace relamp::ui {
namespace {

std::optional<GizmoKind> requested;

std::optional<float> numberIn(const std::string& text) {
    if (text.empty() || text == "-" || text == "." || text == "-.") return std::nullopt;
    return std::strtof(text.c_str(), nullptr);
}

const char* verbOf(GizmoKind kind) {
    return kind == GizmoKind::move ? "Move" : kind == GizmoKind::rotate ? "Rotate" : "Scale";
}

}  // namespace

void requestTransform(GizmoKind kind) { requested = kind; }
std::optional<GizmoKind> takeTransformRequest() { return std::exchange(requested, std::nullopt); }

std::optional<TransformPivot> transformPivot(const Editor& editor) {
    const EmitterState* active = editor.emitter(editor.state.selection.active());
    if (!active) return std::nullopt;
    return TransformPivot{active->pivot, active->axes};
}

void TransformGesture::begin(Editor& editor, GizmoKind kind, GizmoHandle handle, bool byKey, const EyeView& eye,
                             const Vec2& mouse, float points) {
    if (running_) abandon(editor);
    const auto pivot = transformPivot(editor);
    if (!pivot) return;
    pivot_ = *pivot;
    local_ = editor.state.viewport.localAxes;
    emitters_ = editor.state.selection.emitters;
    drag_ = {kind,
             handle,
             gizmoFrameAt(pivot_.origin, local_ ? pivot_.local : Mat3(1), eye, points),
             eye.rayAt(mouse),
             byKey,
             editor.state.lengthUnit};
    lastMouse_ = effective_ = mouse;
    number_.clear();
    readout_.clear();
    running_ = true;
    editor.beginGesture(std::string(verbOf(kind)) + " " + editor.namesOf(emitters_));
    apply(editor, eye);
}

void TransformGesture::lock(GizmoHandle handle, const Editor& editor) {
    // The same lock again means the other axes, a third time none.
    const bool preferred = editor.state.viewport.localAxes;
    if (drag_.handle != handle) local_ = preferred, drag_.handle = handle;
    else if (local_ == preferred) local_ = !preferred;
    else local_ = preferred, drag_.handle = GizmoHandle::screen;
    drag_.frame.axes = local_ ? pivot_.local : Mat3(1);
}

bool TransformGesture::keys(Editor& editor, int pressed, const std::string& typed, bool shift, const EyeView& eye) {
    if (!running_) return false;
    if (pressed == keyEscape) {
        abandon(editor);
        return false;
    }
    if (pressed == keyEnter || pressed == keyPadEnter || pressed == keySpace) {
        commit(editor);
        return false;
    }
    if (pressed >= 'X' && pressed <= 'Z') {
        const int axis = pressed - 'X';
        const bool plane = shift && drag_.kind != GizmoKind::rotate;
        lock(GizmoHandle(int(plane ? GizmoHandle::yz : GizmoHandle::x) + axis), editor);
    }
    if (pressed == 'G' || pressed == 'R' || pressed == 'S') {
        const GizmoKind kind = pressed == 'G' ? GizmoKind::move : pressed == 'R' ? GizmoKind::rotate : GizmoKind::scale;
        if (kind != drag_.kind && drag_.byKey) {
            const float points = drag_.frame.size / eye.metresPerPoint(drag_.frame.origin);
            abandon(editor);
            begin(editor, kind, GizmoHandle::screen, true, eye, lastMouse_, points);
            return running_;
        }
    }
    if (pressed == keyBackspace && !number_.empty()) number_.pop_back();
    for (const char c : typed) {
        if (c == '-')  // turns the sign, wherever it is typed
            number_ = number_.starts_with('-') ? number_.substr(1) : "-" + number_;
        else if ((c >= '0' && c <= '9') || (c == '.' && number_.find('.') == std::string::npos)) number_ += c;
        else if (c == ',' && number_.find('.') == std::string::npos) number_ += '.';
    }
    apply(editor, eye);
    return true;
}

void TransformGesture::follow(Editor& editor, const EyeView& eye, const Vec2& mouse, bool control, bool shift) {
    if (!running_) return;
    const Vec2 step = mouse - lastMouse_;
    if (step == Vec2(0) && control == control_) return;
    effective_ += step * (shift ? 0.1f : 1.0f);
    lastMouse_ = mouse;
    control_ = control;
    apply(editor, eye);
}

void TransformGesture::apply(Editor& editor, const EyeView& eye) {
    GizmoSnap snap;
    snap.on = control_;
    const float radius = sceneExtent(editor).radius;
    // A decimetre in a room; a step that makes sense in smaller and larger scenes.
    const LengthUnitInfo& unit = infoOf(drag_.unit);
    const auto inMetres = float(unit.inMetres);
    snap.metres =
        radius > 0.5f && radius < 20 ? float(unit.snap) * inMetres : roundStep(radius / 20 / inMetres) * inMetres;
    auto typed = numberIn(number_);
    if (typed && drag_.kind == GizmoKind::move) *typed *= inMetres;
    const GizmoMotion motion = drag(drag_, eye.rayAt(effective_), eye, snap, typed);
    readout_ = motion.readout;
    if (local_ && drag_.handle != GizmoHandle::screen) readout_ += " local";
    if (!number_.empty()) readout_ += "  [" + number_ + "_]";
    const bool still = motion.change == Mat4(1);
    editor.preview([&](Look& look) {
        if (still) return;
        for (const std::string& id : emitters_) moveEmitter(look, id, motion.change);
    });
}

void TransformGesture::commit(Editor& editor) {
    if (!std::exchange(running_, false)) return;
    editor.commitGesture();
}

void TransformGesture::abandon(Editor& editor) {
    if (!std::exchange(running_, false)) return;
    editor.abandonGesture();
}

}  // namespace relamp::ui
