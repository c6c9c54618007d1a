// The viewport's camera: turns about a point, Z up.
#pragma once
#include "base/math.h"
#include "capture/camera.h"
#include "relight/camera_bookmark.h"

namespace relamp::ui {

struct OrbitCamera {
    Vec3 target{0};            ///< metres
    float distance = 3;        ///< metres from the target
    float azimuth = 0.6f;      ///< radians about +Z, 0 looks along -X
    float elevation = 0.4f;    ///< radians above the horizon
    float verticalFov = 0.7f;  ///< radians
    bool orthographic = false;

    static OrbitCamera at(const CameraBookmark& bookmark);
    /// Without a name.
    CameraBookmark bookmark() const;
    Vec3 position() const;
    void orbit(const Vec2& pixels);                      ///< a drag
    void pan(const Vec2& pixels, float viewportHeight);  ///< the target follows the hand
    void zoom(float notches);                            ///< towards the target, positive is closer
    /// Looks at a sphere so that it fills the viewport.
    void frame(const Vec3& centre, float radius);
    /// Looks at a box so that its corners fill the viewport from the present direction.
    void frameBox(const Vec3& low, const Vec3& high, float aspect);
    /// Takes over a photograph's camera as well as an orbit can (roll is lost).
    void matchCamera(const Camera& camera, float distanceToTarget);
    /// The same view as a pinhole camera of this many pixels.
    Camera asCamera(int width, int height) const;
    Mat4 viewFromWorld() const;
    /// `near` and `far` enclose a sphere about the scene.
    Mat4 clipFromView(float aspect, const Vec3& sceneCentre, float sceneRadius) const;
};

}  // namespace relamp::ui
