// The gizmo's strokes.
#include "item_map.h"
#include "viewport/overlays.h"

namespace relamp::ui {
namespace {

constexpr int ringPieces = 72;
const ImVec4 axisColours[3] = {{0.88f, 0.30f, 0.32f, 1}, {0.46f, 0.74f, 0.26f, 1}, {0.30f, 0.52f, 0.92f, 1}};

ImU32 colourOf(int axis, bool bright, float alpha = 1) {
    ImVec4 c = bright ? ImVec4(1.0f, 0.85f, 0.30f, 1) : axis >= 0 ? axisColours[axis] : ImVec4(0.88f, 0.88f, 0.88f, 1);
    c.w = alpha;
    return ImGui::ColorConvertFloat4ToU32(c);
}

void line(const Canvas& canvas, const Vec3& a, const Vec3& b, ImU32 colour, float width) {
    Vec2 p, q;
    if (canvas.eye->segmentToScreen(a, b, p, q)) canvas.list->AddLine(toIm(p), toIm(q), colour, width);
}

/// A ring, or the half of it on the eye's side of the pivot.
void ring(const Canvas& canvas, const GizmoFrame& f, const Vec3& axis, float radius, bool half, ImU32 colour,
          float width) {
    const Mat3 frame = frameAround(axis);
    const Vec3 sight = canvas.eye->towardEye(f.origin);
    std::vector<ImVec2> points;
    const auto flush = [&] {
        if (points.size() > 1) canvas.list->AddPolyline(points.data(), int(points.size()), colour, 0, width);
        points.clear();
    };
    // Starts behind the pivot, so that the visible half is one stroke.
    const Vec3 local = glm::transpose(frame) * sight;
    const float start = std::atan2(local.y, local.x) + pi;
    for (int i = 0; i <= ringPieces; ++i) {
        const float angle = start + 2 * pi * float(i) / ringPieces;
        const Vec3 offset = frame[0] * std::cos(angle) + frame[1] * std::sin(angle);
        const auto at = canvas.eye->toScreen(f.origin + radius * f.size * offset);
        if (!at || (half && glm::dot(offset, sight) < -0.03f)) flush();
        else points.push_back(toIm(*at));
    }
    flush();
}

}  // namespace

void drawGizmo(const Canvas& canvas, GizmoKind kind, const GizmoFrame& f, GizmoHandle active) {
    const float width = 2.2f * canvas.scale;
    const auto shown = [&](GizmoHandle handle) { return handleVisible(kind, handle, f, *canvas.eye); };
    if (kind == GizmoKind::rotate) {
        ring(canvas, f, canvas.eye->towardEye(f.origin), screenRingRadius, false,
             colourOf(-1, active == GizmoHandle::screen, 0.75f), width * 0.75f);
        for (int axis = 0; axis < 3; ++axis) {
            const GizmoHandle handle = GizmoHandle(int(GizmoHandle::x) + axis);
            if (shown(handle)) ring(canvas, f, f.axes[axis], ringRadius, true, colourOf(axis, active == handle), width);
        }
        return;
    }
    for (int axis = 0; axis < 3; ++axis) {
        const GizmoHandle handle = GizmoHandle(int(GizmoHandle::yz) + axis);
        if (!shown(handle)) continue;
        const Vec3 a = f.axes[(axis + 1) % 3] * f.size, b = f.axes[(axis + 2) % 3] * f.size;
        ImVec2 corners[4];
        const Vec2 places[4] = {{planeFrom, planeFrom}, {planeTo, planeFrom}, {planeTo, planeTo}, {planeFrom, planeTo}};
        bool whole = true;
        for (int i = 0; i < 4; ++i) {
            const auto at = canvas.eye->toScreen(f.origin + a * places[i].x + b * places[i].y);
            whole = whole && at;
            if (at) corners[i] = toIm(*at);
        }
        if (!whole) continue;
        canvas.list->AddConvexPolyFilled(corners, 4, colourOf(axis, active == handle, 0.35f));
        canvas.list->AddPolyline(corners, 4, colourOf(axis, active == handle, 0.9f), ImDrawFlags_Closed,
                                 1.2f * canvas.scale);
    }
    for (int axis = 0; axis < 3; ++axis) {
        const GizmoHandle handle = GizmoHandle(int(GizmoHandle::x) + axis);
        if (!shown(handle)) continue;
        const ImU32 colour = colourOf(axis, active == handle);
        const Vec3 tip = f.origin + f.axes[axis] * f.size;
        line(canvas, f.origin + f.axes[axis] * (f.size * centreRadius), tip, colour, width);
        const auto end = canvas.eye->toScreen(tip),
                   before = canvas.eye->toScreen(f.origin + f.axes[axis] * (f.size * 0.82f));
        if (!end || !before) continue;
        notePoint(std::string("gizmo:") + "xyz"[axis], *end);
        const float half = 5.0f * canvas.scale;
        if (kind == GizmoKind::scale) {
            canvas.list->AddRectFilled({end->x - half, end->y - half}, {end->x + half, end->y + half}, colour);
        } else {
            const Vec2 along = *end - *before, side = glm::length(along) > 0.5f
                                                          ? Vec2(-along.y, along.x) / glm::length(along) * half
                                                          : Vec2(half, 0);
            canvas.list->AddTriangleFilled(toIm(*end + along * 0.25f), toIm(*before + side), toIm(*before - side),
                                           colour);
        }
    }
    if (const auto centre = canvas.eye->toScreen(f.origin)) {
        notePoint("gizmo:centre", *centre);
        const float radius = (kind == GizmoKind::scale ? 6.0f : 5.5f) * canvas.scale;
        const ImU32 colour = colourOf(-1, active == GizmoHandle::screen, 0.95f);
        canvas.list->AddCircle(toIm(*centre), radius + 2 * canvas.scale, IM_COL32(0, 0, 0, 90), 0, 2 * canvas.scale);
        canvas.list->AddCircle(toIm(*centre), radius + 1 * canvas.scale, colour, 0, 1.6f * canvas.scale);
    }
}

void drawConstraint(const Canvas& canvas, const GizmoDrag& drag) {
    const float reach = 200 * drag.frame.size;
    for (int axis = 0; axis < 3; ++axis) {
        const bool alone = drag.handle == GizmoHandle(int(GizmoHandle::x) + axis);
        const bool inPlane = int(drag.handle) >= int(GizmoHandle::yz) && int(drag.handle) <= int(GizmoHandle::xy) &&
                             drag.handle != GizmoHandle(int(GizmoHandle::yz) + axis);
        if (alone || inPlane)
            line(canvas, drag.frame.origin - reach * drag.frame.axes[axis],
                 drag.frame.origin + reach * drag.frame.axes[axis], colourOf(axis, false, 0.7f), 1.3f * canvas.scale);
    }
}

}  // namespace relamp::ui
