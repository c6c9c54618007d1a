#include "viewport/space_lines.h"

namespace relamp::ui {

void addGrid(std::vector<LineVertex>& lines, const SceneExtent& extent) {
    const float step = roundStep(extent.radius / 8), reach = 2.6f * extent.radius;
    const Vec2 middle = glm::round(Vec2(extent.centre) / step) * step;
    const int count = int(reach / step);
    constexpr int components = 24;  // a line fades with the distance from the middle, component by component
    for (int axis = 0; axis < 2; ++axis)
        for (int i = -count; i <= count; ++i) {
            const float across = (axis == 0 ? middle.y : middle.x) + float(i) * step;
            const int multiple = int(std::lround(across / step));
            // The lines through the world's origin carry the colours of the axes.
            Vec3 colour(multiple % 10 == 0 ? 0.52f : 0.42f);
            float strength = multiple % 10 == 0 ? 0.55f : 0.34f;
            if (multiple == 0)
                colour = axis == 0 ? Vec3(0.72f, 0.30f, 0.32f) : Vec3(0.42f, 0.62f, 0.30f), strength = 0.8f;
            for (int k = 0; k < components; ++k)
                for (int end = 0; end < 2; ++end) {
                    const float along =
                        (axis == 0 ? middle.x : middle.y) + reach * (2 * float(k + end) / components - 1);
                    const Vec3 p = axis == 0 ? Vec3(along, across, extent.ground) : Vec3(across, along, extent.ground);
                    const float fade = std::clamp(1 - glm::length(Vec2(p) - Vec2(extent.centre)) / reach, 0.0f, 1.0f);
                    lines.push_back({p, Vec4(colour, strength * std::sqrt(fade))});
                }
        }
}

std::array<Vec3, 4> frustumCorners(const Camera& camera, float depth) {
    std::array<Vec3, 4> corners;
    const DVec3 x(camera.worldFromCamera[0]), y(camera.worldFromCamera[1]), z(camera.worldFromCamera[2]);
    const double left = -camera.centreX / camera.focalX, right = (camera.width - camera.centreX) / camera.focalX;
    const double top = camera.centreY / camera.focalY, bottom = (camera.centreY - camera.height) / camera.focalY;
    const double place[4][2] = {{left, top}, {right, top}, {right, bottom}, {left, bottom}};
    // A very wide lens would spread its corners over the whole scene.
    for (size_t i = 0; i < 4; ++i)
        corners[i] = Vec3(camera.position() + double(depth) * (x * std::clamp(place[i][0], -1.5, 1.5) +
                                                               y * std::clamp(place[i][1], -1.5, 1.5) - z));
    return corners;
}

bool frustumShown(const Camera& camera, const Vec3& eye, float depth) {
    return glm::distance(Vec3(camera.position()), eye) > 1.5f * depth;
}

void addFrustum(std::vector<LineVertex>& lines, const Camera& camera, float depth, bool selected) {
    const Vec4 colour = selected ? Vec4(1.0f, 0.72f, 0.30f, 1.0f) : Vec4(0.66f, 0.70f, 0.76f, 0.75f);
    const auto corners = frustumCorners(camera, depth);
    const Vec3 eye(camera.position());
    const auto line = [&](const Vec3& a, const Vec3& b) { lines.push_back({a, colour}), lines.push_back({b, colour}); };
    for (size_t i = 0; i < 4; ++i) {
        line(eye, corners[i]);
        line(corners[i], corners[(i + 1) % 4]);
    }
    // A small roof shows which side is up.
    const Vec3 up = 0.25f * (corners[0] - corners[3]), middle = 0.5f * (corners[0] + corners[1]);
    const Vec3 a = glm::mix(corners[0], corners[1], 0.35f), b = glm::mix(corners[0], corners[1], 0.65f);
    line(a, middle + 0.6f * up), line(b, middle + 0.6f * up);
}

}  // namespace relamp::ui
