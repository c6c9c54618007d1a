// From where the image is seen and where it lies on screen: the orbit camera, or a photograph's camera letterboxed
// into the viewport. Pure geometry; everything that draws, picks or drags asks this.
#pragma once
#include <optional>

#include "base/math.h"
#include "capture/camera.h"
#include "scene/ray_tracer.h"
#include "viewport/orbit_camera.h"

namespace relamp::ui {

struct EyeView {
    Vec2 corner{0}, size{1};    ///< of the image on screen: top left and extent, in the window system's points
    int width = 1, height = 1;  ///< framebuffer pixels
    Camera camera;              ///< the same view as a pinhole camera of these pixels
    Mat4 viewFromWorld{1}, clipFromView{1}, clipFromWorld{1};
    Vec3 position{0}, forward{0, 1, 0}, right{1, 0, 0}, up{0, 0, 1};
    bool orthographic = false;

    /// Screen position of a world point; none behind the eye.
    std::optional<Vec2> toScreen(const Vec3& world) const;
    /// The two ends of a segment on screen, cut at the near plane; false when all of it lies behind.
    bool segmentToScreen(const Vec3& a, const Vec3& b, Vec2& screenA, Vec2& screenB) const;
    /// The ray through a screen position.
    Ray rayAt(const Vec2& screen) const;
    /// Unit direction from a point towards the eye.
    Vec3 towardEye(const Vec3& world) const { return orthographic ? -forward : glm::normalize(position - world); }
    /// World length that one point of screen covers at a place.
    float metresPerPoint(const Vec3& world) const;
    bool contains(const Vec2& screen) const {
        return screen.x >= corner.x && screen.y >= corner.y && screen.x < corner.x + size.x &&
               screen.y < corner.y + size.y;
    }
};

/// The whole rectangle seen by the orbit camera.
EyeView eyeOf(const OrbitCamera& orbit, const Vec2& corner, const Vec2& size, const Vec2& pixelsPerPoint,
              const Vec3& sceneCentre, float sceneRadius);
/// A photograph's camera: the largest rectangle of its aspect in the middle of the given one. Lens distortion is left
/// out.
EyeView eyeOf(const Camera& camera, const Vec2& corner, const Vec2& size, const Vec2& pixelsPerPoint,
              const Vec3& sceneCentre, float sceneRadius);

}  // namespace relamp::ui
