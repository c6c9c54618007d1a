#include "viewport/gizmo.h"

#include <fmt/format.h>

#include <glm/gtc/matrix_transform.hpp>

namespace relamp::ui {
namespace {

int axisOf(GizmoHandle h) { return h == GizmoHandle::x ? 0 : h == GizmoHandle::y ? 1 : h == GizmoHandle::z ? 2 : -1; }
/// The axis that stands on a plane handle.
int planeNormalOf(GizmoHandle h) {
    return h == GizmoHandle::yz ? 0 : h == GizmoHandle::zx ? 1 : h == GizmoHandle::xy ? 2 : -1;
}
GizmoHandle axisHandle(int axis) { return GizmoHandle(int(GizmoHandle::x) + axis); }
GizmoHandle planeHandle(int axis) { return GizmoHandle(int(GizmoHandle::yz) + axis); }

/// Parameter along the line origin + t axis of the point nearest to the ray; none when they run side by side.
std::optional<float> alongAxis(const Ray& ray, const Vec3& origin, const Vec3& axis) {
    const float b = glm::dot(ray.direction, axis), denominator = 1 - b * b;
    if (denominator < 1e-5f) return std::nullopt;
    const Vec3 offset = ray.origin - origin;
    const float t = (glm::dot(offset, axis) - b * glm::dot(offset, ray.direction)) / denominator;
    return std::isfinite(t) ? std::optional<float>(t) : std::nullopt;
}

std::optional<Vec3> onPlane(const Ray& ray, const Vec3& origin, const Vec3& normal) {
    const float along = glm::dot(ray.direction, normal);
    if (std::abs(along) < 1e-5f) return std::nullopt;
    const float distance = glm::dot(origin - ray.origin, normal) / along;
    if (!(distance > 0) && glm::dot(ray.origin - origin, ray.origin - origin) > 0) return std::nullopt;
    return ray.origin + distance * ray.direction;
}

float distanceToRay(const Ray& ray, const Vec3& point) {
    const Vec3 offset = point - ray.origin;
    return glm::length(offset - ray.direction * std::max(glm::dot(offset, ray.direction), 0.0f));
}

float snapped(float value, float step) { return step > 0 ? std::round(value / step) * step : value; }

/// Angle about `axis` from one point to another, radians in (-pi, pi].
float angleAbout(const Vec3& origin, const Vec3& axis, const Vec3& from, const Vec3& to) {
    const Vec3 a = from - origin, b = to - origin;
    return std::atan2(glm::dot(axis, glm::cross(a, b)), glm::dot(a, b) - glm::dot(a, axis) * glm::dot(b, axis));
}

Mat4 about(const Vec3& pivot, const Mat4& change) {
    return glm::translate(Mat4(1), pivot) * change * glm::translate(Mat4(1), -pivot);
}

const char* axisNames(GizmoHandle h) {
    static const char* const names[] = {"", "X", "Y", "Z", "YZ", "ZX", "XY", ""};
    return names[int(h)];
}

float cleared(float value) { return std::abs(value) < 5e-7f ? 0.0f : value; }

GizmoMotion moved(const GizmoDrag& d, const Ray& now, const EyeView& eye, const GizmoSnap& snap,
                  std::optional<float> typed) {
    const GizmoFrame& f = d.frame;
    const int axis = axisOf(d.handle), normal = planeNormalOf(d.handle);
    GizmoMotion motion;
    Vec3 world(0);
    if (typed) {
        motion.offset[axis >= 0 ? axis : normal == 0 ? 1 : 0] = *typed;
        world = f.axes * motion.offset;
    } else if (axis >= 0) {
        const auto from = alongAxis(d.start, f.origin, f.axes[axis]), to = alongAxis(now, f.origin, f.axes[axis]);
        if (from && to) world = f.axes[axis] * (*to - *from);
    } else {
        const Vec3 plane = normal >= 0 ? f.axes[normal] : eye.forward;
        const auto from = onPlane(d.start, f.origin, plane), to = onPlane(now, f.origin, plane);
        if (from && to) world = *to - *from;
    }
    if (!typed) {
        motion.offset = glm::transpose(f.axes) * world;
        if (snap.on) {
            // To the grid of absolute coordinates along the frame's axes, from where the pivot started.
            const Vec3 at = glm::transpose(f.axes) * f.origin;
            for (int k = 0; k < 3; ++k)
                if (d.handle == GizmoHandle::screen || k == axis || (normal >= 0 && k != normal))
                    motion.offset[k] = snapped(at[k] + motion.offset[k], snap.metres) - at[k];
            world = f.axes * motion.offset;
        }
    }
    motion.change = glm::translate(Mat4(1), world);
    const Vec3 o(cleared(motion.offset.x), cleared(motion.offset.y), cleared(motion.offset.z));
    motion.readout = axis >= 0 ? fmt::format("Move {} {}", axisNames(d.handle), lengthText(o[axis], d.unit))
                               : fmt::format("Move {}{}{} ({})", axisNames(d.handle), normal >= 0 ? " " : "",
                                             placeText(DVec3(o), d.unit), lengthText(glm::length(o), d.unit));
    return motion;
}

GizmoMotion turned(const GizmoDrag& d, const Ray& now, const EyeView& eye, const GizmoSnap& snap,
                   std::optional<float> typed) {
    const GizmoFrame& f = d.frame;
    const int own = axisOf(d.handle);
    // About the line of sight: a turn to the left on screen counts as positive, as about an axis that points at the
    // eye.
    const Vec3 sight = eye.towardEye(f.origin);
    const Vec3 axis = own >= 0 ? f.axes[own] : sight;
    float radians = 0;
    if (typed) {
        radians = glm::radians(*typed);
    } else {
        const bool onScreen = own < 0 || d.byKey;
        const Vec3 plane = onScreen ? sight : axis;
        const auto from = onPlane(d.start, f.origin, plane), to = onPlane(now, f.origin, plane);
        if (from && to) radians = angleAbout(f.origin, plane, *from, *to);
        if (onScreen && own >= 0 && glm::dot(axis, sight) < 0) radians = -radians;
        if (snap.on) radians = glm::radians(snapped(glm::degrees(radians), snap.degrees));
    }
    GizmoMotion motion;
    motion.degrees = glm::degrees(radians);
    motion.change = about(f.origin, glm::rotate(Mat4(1), radians, axis));
    motion.readout =
        fmt::format("Rotate {}{}{:.1f} degrees", axisNames(d.handle), own >= 0 ? " " : "", cleared(motion.degrees));
    return motion;
}

GizmoMotion scaled(const GizmoDrag& d, const Ray& now, const EyeView& eye, const GizmoSnap& snap,
                   std::optional<float> typed) {
    const GizmoFrame& f = d.frame;
    const int axis = axisOf(d.handle), normal = planeNormalOf(d.handle);
    float factor = 1;
    if (typed) {
        factor = *typed;
    } else if (axis >= 0 && !d.byKey) {
        const auto from = alongAxis(d.start, f.origin, f.axes[axis]), to = alongAxis(now, f.origin, f.axes[axis]);
        if (from && to && std::abs(*from) > 1e-3f * f.size) factor = *to / *from;
    } else {
        const Vec3 sight = eye.towardEye(f.origin);
        const auto from = onPlane(d.start, f.origin, sight), to = onPlane(now, f.origin, sight);
        if (from && to) {
            const Vec3 a = *from - f.origin, b = *to - f.origin;
            // From the very centre a handle's drag counts as if it had begun at the gizmo's length: to the right is
            // larger.
            const float reach = glm::length(a);
            factor = reach > 0.25f * f.size ? glm::length(b) / reach : 1 + glm::dot(b - a, eye.right) / f.size;
        }
    }
    if (!typed && snap.on) factor = snapped(factor, snap.factor);
    // A part of no size cannot come back.
    if (std::abs(factor) < 1e-3f) factor = factor < 0 ? -1e-3f : 1e-3f;
    GizmoMotion motion;
    for (int k = 0; k < 3; ++k)
        if (d.handle == GizmoHandle::screen || k == axis || (normal >= 0 && k != normal)) motion.factor[k] = factor;
    const Mat4 axes(f.axes);
    motion.change = about(f.origin, axes * glm::scale(Mat4(1), motion.factor) * glm::transpose(axes));
    motion.readout =
        fmt::format("Scale {}{}{:.3f}", axisNames(d.handle), d.handle == GizmoHandle::screen ? "" : " ", factor);
    return motion;
}

}  // namespace

GizmoFrame gizmoFrameAt(const Vec3& origin, const Mat3& axes, const EyeView& eye, float points) {
    return {origin, axes, eye.metresPerPoint(origin) * points};
}

bool handleVisible(GizmoKind kind, GizmoHandle handle, const GizmoFrame& frame, const EyeView& eye) {
    const Vec3 sight = eye.towardEye(frame.origin);
    const float limit = glm::radians(hideWithinDegrees);
    if (const int axis = axisOf(handle); axis >= 0) {
        const float along = std::abs(glm::dot(frame.axes[axis], sight));
        return kind == GizmoKind::rotate ? along > std::sin(limit) : along < std::cos(limit);
    }
    if (const int normal = planeNormalOf(handle); normal >= 0)
        return kind != GizmoKind::rotate && std::abs(glm::dot(frame.axes[normal], sight)) > std::sin(limit);
    return handle != GizmoHandle::none;
}

GizmoHandle hitTest(const Ray& ray, const GizmoFrame& f, const EyeView& eye, GizmoKind kind) {
    const float reach = 0.075f * f.size;
    GizmoHandle best = GizmoHandle::none;
    float nearest = reach;
    const auto offer = [&](GizmoHandle handle, float distance) {
        if (distance < nearest && handleVisible(kind, handle, f, eye)) nearest = distance, best = handle;
    };
    if (kind == GizmoKind::rotate) {
        const Vec3 sight = eye.towardEye(f.origin);
        for (int axis = 0; axis < 3; ++axis) {
            const auto point = onPlane(ray, f.origin, f.axes[axis]);
            // The half of a ring behind the pivot is not drawn.
            if (point && glm::dot(*point - f.origin, sight) > -0.05f * f.size)
                offer(axisHandle(axis), std::abs(glm::length(*point - f.origin) - ringRadius * f.size));
        }
        if (const auto point = onPlane(ray, f.origin, sight))
            offer(GizmoHandle::screen, std::abs(glm::length(*point - f.origin) - screenRingRadius * f.size));
        return best;
    }
    if (distanceToRay(ray, f.origin) < centreRadius * f.size) return GizmoHandle::screen;
    for (int axis = 0; axis < 3; ++axis) {
        const Vec3 a = f.axes[(axis + 1) % 3], b = f.axes[(axis + 2) % 3];
        if (!handleVisible(kind, planeHandle(axis), f, eye)) continue;
        if (const auto point = onPlane(ray, f.origin, f.axes[axis])) {
            const float u = glm::dot(*point - f.origin, a) / f.size, v = glm::dot(*point - f.origin, b) / f.size;
            if (u > planeFrom && u < planeTo && v > planeFrom && v < planeTo) return planeHandle(axis);
        }
    }
    for (int axis = 0; axis < 3; ++axis) {
        const auto t = alongAxis(ray, f.origin, f.axes[axis]);
        if (!t) continue;
        const float along = std::clamp(*t, 0.0f, 1.05f * f.size);
        if (along > centreRadius * f.size) offer(axisHandle(axis), distanceToRay(ray, f.origin + along * f.axes[axis]));
    }
    return best;
}

GizmoMotion drag(const GizmoDrag& d, const Ray& now, const EyeView& eye, const GizmoSnap& snap,
                 std::optional<float> typed) {
    switch (d.kind) {
        case GizmoKind::move: return moved(d, now, eye, snap, typed);
        case GizmoKind::rotate: return turned(d, now, eye, snap, typed);
        default: return scaled(d, now, eye, snap, typed);
    }
}

}  // namespace relamp::ui
