#include "relight/emitter_shape.h"

namespace relamp {
namespace {

Mesh rectangleMesh(const Vec2& size) {
    Mesh m;
    for (const Vec2& c : {Vec2(-1, -1), Vec2(-1, 1), Vec2(1, 1), Vec2(1, -1)}) {
        m.positions.emplace_back(c.x * (size.x / 2), c.y * (size.y / 2), 0);
        m.normals.emplace_back(0, 0, -1);
    }
    m.triangles = {{0, 1, 2}, {0, 2, 3}};
    return m;
}

Mesh diskMesh(const Vec2& size) {
    Mesh m;
    constexpr uint32_t around = 32;
    const float w = size.x / 2, h = size.y / 2;
    // Corners a little outside the circle, so that the polygon has the disc's area.
    const float grow = std::sqrt((2 * pi / around) / std::sin(2 * pi / around));
    m.positions.emplace_back(0);
    for (uint32_t i = 0; i < around; ++i)
        m.positions.push_back(
            grow * Vec3(w * std::cos(2 * pi * float(i) / around), h * std::sin(2 * pi * float(i) / around), 0));
    m.normals.assign(m.positions.size(), Vec3(0, 0, -1));
    for (uint32_t i = 0; i < around; ++i) m.triangles.push_back({0, 1 + (i + 1) % around, 1 + i});
    return m;
}

Mesh sphereMesh(const Vec2& size) {
    Mesh m;
    constexpr uint32_t rings = 12, around = 24;
    constexpr float grow = 1.00718f;  // so that the polyhedron has the sphere's area
    const float w = size.x / 2, h = size.y / 2;
    for (uint32_t r = 0; r <= rings; ++r)
        for (uint32_t i = 0; i < around; ++i) {
            const float t = pi * float(r) / rings, p = 2 * pi * float(i) / around;
            const Vec3 n(std::sin(t) * std::cos(p), std::sin(t) * std::sin(p), std::cos(t));
            m.positions.push_back(grow * Vec3(n.x * w, n.y * h, n.z * w));
            m.normals.push_back(n);
        }
    for (uint32_t r = 0; r < rings; ++r)
        for (uint32_t i = 0; i < around; ++i) {
            const uint32_t a = r * around + i, b = r * around + (i + 1) % around;
            if (r > 0) m.triangles.push_back({a, a + around, b});
            if (r + 1 < rings) m.triangles.push_back({b, a + around, b + around});
        }
    return m;
}

float rectangleArea(const Vec2& size) { return size.x * size.y; }
float diskArea(const Vec2& size) { return pi * size.x * size.y / 4; }
float sphereArea(const Vec2& size) { return pi * size.x * size.y; }

using Shape = EmitterShape;
using Geometry = EmitterShapeInfo::Geometry;

const EmitterShapeInfo shapes[] = {
    {Shape::rectangle, "rectangle", "Rectangle", "A flat light like a softbox, shining to one side",
     "Add rectangle light", "rectangle", Geometry::own, 2, true, Vec2(1), 180, rectangleMesh, rectangleArea},
    {Shape::disk, "disk", "Disk", "A flat round light, shining to one side", "Add disk light", "disk", Geometry::own, 1,
     true, Vec2(1), 180, diskMesh, diskArea},
    {Shape::sphere, "sphere", "Sphere", "A ball that shines to all sides, like a bulb", "Add sphere light", "sphere",
     Geometry::own, 1, false, Vec2(1), 180, sphereMesh, sphereArea},
    {Shape::spot, "spot", "Spot", "A small round light whose beam is a cone", "Add spot light", "spot", Geometry::own,
     1, true, Vec2(0.3f), 30, diskMesh, diskArea},
    {Shape::sun, "sun", "Sun", "Parallel light from far away, with sharp shadows", "Add sun", "sun", Geometry::own, 1,
     true, Vec2(0.53f), 180, diskMesh, diskArea, true},
    {Shape::part, "part", "Object of the scene...", "Then click the object that is to shine",
     "Add light from an object", "mesh", Geometry::component},
    {Shape::copy, "copy", "", "", "Add copy", "copy", Geometry::emitter},
};

}  // namespace

std::span<const EmitterShapeInfo> emitterShapes() { return shapes; }

const EmitterShapeInfo& infoOf(EmitterShape shape) { return shapes[size_t(shape)]; }

float sunRadiance(float degrees) {
    const float sine = std::sin(degrees * (pi / 360));
    return 1 / std::max(sine * sine, 1e-12f);
}

const EmitterShapeInfo* emitterShapeNamed(const std::string& name) {
    for (const EmitterShapeInfo& info : shapes)
        if (name == info.name) return &info;
    return nullptr;
}

}  // namespace relamp
