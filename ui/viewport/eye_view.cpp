#include "viewport/eye_view.h"

#include <glm/gtc/matrix_transform.hpp>

namespace relamp::ui {
namespace {

void finish(EyeView& eye) {
    eye.clipFromWorld = eye.clipFromView * eye.viewFromWorld;
    const Mat4 worldFromView = glm::inverse(eye.viewFromWorld);
    eye.right = Vec3(worldFromView[0]), eye.up = Vec3(worldFromView[1]), eye.forward = -Vec3(worldFromView[2]);
    eye.position = Vec3(worldFromView[3]);
}

}  // namespace

std::optional<Vec2> EyeView::toScreen(const Vec3& world) const {
    const Vec4 clip = clipFromWorld * Vec4(world, 1);
    if (!(clip.w > 1e-7f)) return std::nullopt;
    const Vec2 ndc = Vec2(clip) / clip.w;
    if (!std::isfinite(ndc.x) || !std::isfinite(ndc.y)) return std::nullopt;
    return corner + size * Vec2(0.5f + 0.5f * ndc.x, 0.5f - 0.5f * ndc.y);
}

bool EyeView::segmentToScreen(const Vec3& a, const Vec3& b, Vec2& screenA, Vec2& screenB) const {
    Vec4 p = clipFromWorld * Vec4(a, 1), q = clipFromWorld * Vec4(b, 1);
    // Points in front of the near plane have z + w > 0.
    const float dp = p.z + p.w, dq = q.z + q.w;
    if (dp <= 0 && dq <= 0) return false;
    if (dp <= 0) p += (q - p) * (dp / (dp - dq) + 1e-4f);
    if (dq <= 0) q += (p - q) * (dq / (dq - dp) + 1e-4f);
    if (!(p.w > 1e-7f) || !(q.w > 1e-7f)) return false;
    screenA = corner + size * Vec2(0.5f + 0.5f * p.x / p.w, 0.5f - 0.5f * p.y / p.w);
    screenB = corner + size * Vec2(0.5f + 0.5f * q.x / q.w, 0.5f - 0.5f * q.y / q.w);
    return true;
}

Ray EyeView::rayAt(const Vec2& screen) const {
    const Vec2 fraction = (screen - corner) / size;
    if (orthographic) {
        const Vec2 half(1 / clipFromView[0][0], 1 / clipFromView[1][1]);
        // From the near plane, which may lie behind the eye.
        const float near = (1 + clipFromView[3][2]) / clipFromView[2][2];
        return {
            position + forward * near + right * ((2 * fraction.x - 1) * half.x) + up * ((1 - 2 * fraction.y) * half.y),
            forward};
    }
    const Vec2 pixel(fraction.x * float(camera.width), fraction.y * float(camera.height));
    return {position, camera.rayDirection(pixel)};
}

float EyeView::metresPerPoint(const Vec3& world) const {
    const float tall = 2 / (clipFromView[1][1] * size.y);
    return orthographic ? tall : tall * std::max(glm::dot(world - position, forward), 1e-5f);
}

EyeView eyeOf(const OrbitCamera& orbit, const Vec2& corner, const Vec2& size, const Vec2& pixelsPerPoint,
              const Vec3& sceneCentre, float sceneRadius) {
    EyeView eye;
    eye.corner = corner, eye.size = glm::max(size, Vec2(1));
    eye.width = std::max(1, int(std::lround(size.x * pixelsPerPoint.x)));
    eye.height = std::max(1, int(std::lround(size.y * pixelsPerPoint.y)));
    eye.camera = orbit.asCamera(eye.width, eye.height);
    eye.viewFromWorld = orbit.viewFromWorld();
    eye.clipFromView = orbit.clipFromView(float(eye.width) / float(eye.height), sceneCentre, sceneRadius);
    eye.orthographic = orbit.orthographic;
    finish(eye);
    return eye;
}

EyeView eyeOf(const Camera& camera, const Vec2& corner, const Vec2& size, const Vec2& pixelsPerPoint,
              const Vec3& sceneCentre, float sceneRadius) {
    EyeView eye;
    const Vec2 area = glm::max(size, Vec2(1)) * pixelsPerPoint;
    const float scale = std::min(area.x / float(camera.width), area.y / float(camera.height));
    eye.width = std::max(1, int(std::lround(float(camera.width) * scale)));
    eye.height = std::max(1, int(std::lround(float(camera.height) * scale)));
    eye.size = Vec2(eye.width, eye.height) / pixelsPerPoint;
    // Whole pixels, so that the image is not resampled on its way to the screen.
    eye.corner = corner + glm::floor(0.5f * (area - Vec2(eye.width, eye.height))) / pixelsPerPoint;
    eye.camera = camera;
    eye.camera.model = LensModel::pinhole;
    eye.camera.distortion = {};
    eye.camera.width = eye.width, eye.camera.height = eye.height;
    const double sx = double(eye.width) / camera.width, sy = double(eye.height) / camera.height;
    eye.camera.focalX *= sx, eye.camera.centreX *= sx, eye.camera.focalY *= sy, eye.camera.centreY *= sy;
    const Camera& c = eye.camera;
    eye.viewFromWorld = Mat4(glm::inverse(c.worldFromCamera));
    const float depth = -(eye.viewFromWorld * Vec4(sceneCentre, 1)).z;
    const float far = std::max(depth + sceneRadius, sceneRadius * 0.1f),
                near = std::clamp(depth - sceneRadius, far * 1e-4f, far * 0.5f);
    eye.clipFromView =
        glm::frustum(float(-c.centreX / c.focalX) * near, float((c.width - c.centreX) / c.focalX) * near,
                     float((c.centreY - c.height) / c.focalY) * near, float(c.centreY / c.focalY) * near, near, far);
    finish(eye);
    return eye;
}

}  // namespace relamp::ui
