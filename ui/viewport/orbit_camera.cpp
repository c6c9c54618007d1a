#include "viewport/orbit_camera.h"

#include <glm/gtc/matrix_transform.hpp>

namespace relamp::ui {
namespace {
constexpr float radiansPerPixel = 0.006f;
constexpr float steepest = pi / 2 - 0.002f;  // straight down would leave "up" undefined

/// Unit direction from the target to the eye.
Vec3 towardEye(float azimuth, float elevation) {
    return {std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth), std::sin(elevation)};
}
Vec3 rightOf(float azimuth) { return {-std::sin(azimuth), std::cos(azimuth), 0}; }
}  // namespace

OrbitCamera OrbitCamera::at(const CameraBookmark& bookmark) {
    return {bookmark.target,    bookmark.distance,    bookmark.azimuth,
            bookmark.elevation, bookmark.verticalFov, bookmark.orthographic};
}

CameraBookmark OrbitCamera::bookmark() const {
    return {{}, target, distance, azimuth, elevation, verticalFov, orthographic};
}

Vec3 OrbitCamera::position() const { return target + distance * towardEye(azimuth, elevation); }

void OrbitCamera::orbit(const Vec2& pixels) {
    azimuth = std::remainder(azimuth - pixels.x * radiansPerPixel, 2 * pi);
    elevation = std::clamp(elevation + pixels.y * radiansPerPixel, -steepest, steepest);
}

void OrbitCamera::pan(const Vec2& pixels, float viewportHeight) {
    const float metresPerPixel = 2 * distance * std::tan(verticalFov / 2) / std::max(viewportHeight, 1.0f);
    const Vec3 right = rightOf(azimuth), up = glm::cross(towardEye(azimuth, elevation), right);
    target += metresPerPixel * (up * pixels.y - right * pixels.x);
}

void OrbitCamera::zoom(float notches) { distance = std::clamp(distance * std::pow(0.88f, notches), 1e-4f, 1e6f); }

void OrbitCamera::frame(const Vec3& centre, float radius) {
    target = centre;
    distance = std::max(radius, 1e-4f) / std::sin(std::min(verticalFov, pi - 0.1f) / 2) * 1.05f;
}

void OrbitCamera::frameBox(const Vec3& low, const Vec3& high, float aspect) {
    target = 0.5f * (low + high);
    const Vec3 back = towardEye(azimuth, elevation), right = rightOf(azimuth), up = glm::cross(back, right);
    const float tall = std::tan(verticalFov / 2) * 0.92f, wide = tall * std::max(aspect, 0.05f);
    float wanted = 1e-4f;
    for (int corner = 0; corner < 8; ++corner) {
        const Vec3 p =
            Vec3(corner & 1 ? high.x : low.x, corner & 2 ? high.y : low.y, corner & 4 ? high.z : low.z) - target;
        const float toward = orthographic ? 0.0f : glm::dot(p, back);
        wanted =
            std::max(wanted, toward + std::max(std::abs(glm::dot(p, right)) / wide, std::abs(glm::dot(p, up)) / tall));
    }
    distance = wanted;
}

void OrbitCamera::matchCamera(const Camera& camera, float distanceToTarget) {
    const Vec3 forward(camera.forward());
    distance = std::max(distanceToTarget, 1e-4f);
    elevation = std::clamp(std::asin(std::clamp(-forward.z, -1.0f, 1.0f)), -steepest, steepest);
    // Looking straight down, the image's own up says where north is.
    const Vec3 level = std::hypot(forward.x, forward.y) > 1e-3f
                           ? forward
                           : Vec3(DVec3(camera.worldFromCamera[1])) * (forward.z < 0 ? 1.0f : -1.0f);
    azimuth = std::atan2(-level.y, -level.x);
    target = Vec3(camera.position()) - distance * towardEye(azimuth, elevation);
    verticalFov = float(std::clamp(2 * std::atan(camera.height / (2 * std::max(camera.focalY, 1e-6))), 0.02, 2.6));
    orthographic = false;
}

Camera OrbitCamera::asCamera(int width, int height) const {
    Camera camera;
    camera.width = width, camera.height = height;
    camera.focalX = camera.focalY = height / (2 * std::tan(double(verticalFov) / 2));
    camera.centreX = width / 2.0, camera.centreY = height / 2.0;
    camera.worldFromCamera = glm::inverse(DMat4(viewFromWorld()));
    return camera;
}

Mat4 OrbitCamera::viewFromWorld() const { return glm::lookAt(position(), target, Vec3(0, 0, 1)); }

Mat4 OrbitCamera::clipFromView(float aspect, const Vec3& sceneCentre, float sceneRadius) const {
    const float depth = -(viewFromWorld() * Vec4(sceneCentre, 1)).z;
    const float far = std::max(depth + sceneRadius, sceneRadius * 0.01f + distance);
    if (orthographic) {
        const float half = distance * std::tan(verticalFov / 2);
        return glm::ortho(-half * aspect, half * aspect, -half, half, std::min(depth - sceneRadius, 0.0f), far);
    }
    const float near = std::max(depth - sceneRadius, far * 1e-4f);
    return glm::perspective(verticalFov, aspect, std::min(near, far * 0.5f), far);
}

}  // namespace relamp::ui
