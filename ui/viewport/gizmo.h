// The transform gizmo as pure functions: what a ray hits, and what a drag along a ray means. No state of its own, no
// drawing. The same functions serve the handles and the keys G, R, S with their locks and typed numbers.
#pragma once
#include <array>
#include <optional>
#include <string>

#include "length_unit.h"
#include "scene/ray_tracer.h"
#include "viewport/eye_view.h"

namespace relamp::ui {

enum class GizmoKind { move, rotate, scale };
/// x, y, z: along or about one axis; yz, zx, xy: in the plane of two; screen: in the plane of the screen, about the
/// line of sight, or evenly in all directions.
enum class GizmoHandle { none, x, y, z, yz, zx, xy, screen };

/// Where the gizmo stands: axes are unit columns, `size` is the length of its arrows in metres.
struct GizmoFrame {
    Vec3 origin{0};
    Mat3 axes{1};
    float size = 1;
};

inline constexpr float gizmoPoints = 80;        ///< length of an arrow on screen at interface scale 1
inline constexpr float hideWithinDegrees = 10;  ///< of the line of sight

/// As large on screen at every distance: `points` long.
GizmoFrame gizmoFrameAt(const Vec3& origin, const Mat3& axes, const EyeView& eye, float points);

/// Whether a handle can be used from here: an arrow that points at the eye, or a plane or ring seen edge on, cannot.
bool handleVisible(GizmoKind kind, GizmoHandle handle, const GizmoFrame& frame, const EyeView& eye);

/// The handle that a ray meets, none further than about 7 percent of the gizmo's size from it.
GizmoHandle hitTest(const Ray& ray, const GizmoFrame& frame, const EyeView& eye, GizmoKind kind);

/// Places of the parts in units of the gizmo's size, shared with the drawing.
inline constexpr float planeFrom = 0.30f, planeTo = 0.48f, centreRadius = 0.11f, ringRadius = 0.92f,
                       screenRingRadius = 1.12f;

/// A drag: how it started.
struct GizmoDrag {
    GizmoKind kind = GizmoKind::move;
    GizmoHandle handle = GizmoHandle::screen;
    GizmoFrame frame;  ///< where the pivot was when it began
    Ray start;         ///< the mouse then
    bool byKey =
        false;  ///< G, R or S: the mouse is far from the handle, so turns follow its angle about the pivot on screen
    LengthUnit unit = LengthUnit::metres;  ///< of the readout
};

/// Steps of Ctrl: lengths fall on multiples counted from the world's origin, turns and factors on multiples counted
/// from the start.
struct GizmoSnap {
    bool on = false;
    float metres = 0.1f, degrees = 15, factor = 0.1f;
};

/// What a drag has come to.
struct GizmoMotion {
    Mat4 change{1};       ///< world to world
    Vec3 offset{0};       ///< metres along the frame's axes (move)
    float degrees = 0;    ///< rotate
    Vec3 factor{1};       ///< scale
    std::string readout;  ///< "Move X 0.250 m", in the drag's unit
};

/// `typed`: a number in place of the mouse (metres, degrees or a factor).
GizmoMotion drag(const GizmoDrag& drag, const Ray& now, const EyeView& eye, const GizmoSnap& snap,
                 std::optional<float> typed = {});

}  // namespace relamp::ui
