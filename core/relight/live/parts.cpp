#include "relight/live/parts.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "base/box.h"
#include "base/json_fields.h"

namespace relamp {
namespace {

/// What a part's geometry and light depend on, its matrix and radiance aside.
std::string keyOf(const EditedGeometry& geometry, const EditedPart& part, const Look& look, size_t recovered) {
    if (part.emitter < 0) return fmt::format("component {}", part.component);
    const RelitEmitter& emitter = geometry.emitters[size_t(part.emitter)];
    std::string light = emitter.shadows ? "" : " without shadows";
    if (!emitter.link.everything()) light += " " + dumpJson(linkToJson(emitter.link));
    if (size_t(part.emitter) < recovered) return fmt::format("emitter {}{}", emitter.id, light);
    const AddedEmitter& a = look.added[size_t(part.emitter) - recovered];
    std::string key =
        fmt::format("added {} {} {} {} {}{}", int(a.shape), a.size.x, a.size.y, a.seedVertex, a.source, light);
    if (!a.shaping.plain()) key += dumpJson(shapingToJson(a.shaping));
    return key;
}

bool nearRay(const Ray& ray, const Vec3& centre, float radius) {
    const Vec3 to = centre - ray.origin;
    const float along = glm::dot(to, ray.direction), r2 = radius * radius;
    const float d2 = glm::dot(to, to);
    if (d2 < r2) return true;
    return along > 0 && along - radius < ray.far && d2 - along * along < r2;
}

}  // namespace

Mesh partMesh(const Mesh& mesh, const std::vector<uint32_t>& partOfTriangle, uint32_t part, const Mat4& matrix) {
    Mesh m;
    std::vector<uint32_t> place(mesh.vertexCount(), EditedPart::none);
    for (size_t t = 0; t < mesh.triangles.size(); ++t) {
        if (partOfTriangle[t] != part) continue;
        Triangle triangle = mesh.triangles[t];
        for (uint32_t& v : triangle) {
            if (place[v] == EditedPart::none) {
                place[v] = uint32_t(m.positions.size());
                m.positions.push_back(matrix == Mat4(1) ? mesh.positions[v]
                                                        : Vec3(matrix * Vec4(mesh.positions[v], 1)));
            }
            v = place[v];
        }
        if (std::binary_search(mesh.shadowless.begin(), mesh.shadowless.end(), uint32_t(t)))
            m.shadowless.push_back(uint32_t(m.triangles.size()));
        m.triangles.push_back(triangle);
    }
    return m;
}

void LivePart::cone(const Vec3& point, Vec3& axis, float& angle) const {
    const Vec3 to = centre - point;
    const float d = glm::length(to);
    if (d <= radius * 1.0001f) {
        axis = Vec3(0, 0, 1);
        angle = pi;
        return;
    }
    axis = to / d;
    angle = std::asin(radius / d);
}

bool LivePart::mayCover(const Vec3& point, const Vec3& axis, float angle, float far) const {
    const Vec3 to = centre - point;
    const float d = glm::length(to);
    if (d <= radius * 1.0001f) return true;
    if (d - radius > far) return false;
    const float reach = angle + std::asin(radius / d);
    return reach >= pi || glm::dot(to, axis) >= d * std::cos(reach);
}

uint32_t LivePart::occluded8(std::span<const Ray> rays) const {
    if (!tracer) return 0;
    Ray carried[8];
    uint32_t place[8], count = 0;
    const Mat3 turn(inverse);
    for (uint32_t i = 0; i < rays.size(); ++i) {
        if (!nearRay(rays[i], centre, radius)) continue;
        // The direction keeps the length the matrix gives it, so distances along it stay those of the world.
        carried[count] = {Vec3(inverse * Vec4(rays[i].origin, 1)), turn * rays[i].direction, rays[i].near, rays[i].far};
        place[count++] = i;
    }
    if (!count) return 0;
    const uint32_t hit = tracer->occluded8({carried, count});
    uint32_t bits = 0;
    for (uint32_t i = 0; i < count; ++i) bits |= (hit >> i & 1) << place[i];
    return bits;
}

Hit LivePart::closest(const Ray& ray, bool& facing) const {
    if (!tracer || !nearRay(ray, centre, radius)) return {};
    const Vec3 direction = Mat3(inverse) * ray.direction;
    const Hit hit = tracer->closest({Vec3(inverse * Vec4(ray.origin, 1)), direction, ray.near, ray.far});
    facing = hit && glm::dot(faceNormals[hit.triangle], direction) < 0;
    return hit;
}

std::shared_ptr<const RayTracer> tracerOf(const EditedGeometry& geometry, uint32_t part) {
    const Mesh mesh = partMesh(geometry.mesh, geometry.partOfTriangle, part, Mat4(1));
    return mesh.triangles.empty() ? nullptr : std::make_shared<const RayTracer>(mesh);
}

std::vector<LivePart> liveParts(const EditedGeometry& geometry, const Look& look,
                                const std::vector<LivePart>& previous) {
    const size_t recovered = geometry.emitters.size() - look.added.size();
    std::vector<LivePart> parts(geometry.parts.size());
    std::vector<Box> box(parts.size());
    for (size_t t = 0; t < geometry.mesh.triangles.size(); ++t) {
        const uint32_t b = geometry.partOfTriangle[t];
        if (b == 0) continue;
        for (uint32_t v : geometry.mesh.triangles[t]) box[b].grow(geometry.mesh.positions[v]);
    }
    for (uint32_t b = 1; b < parts.size(); ++b) {
        const EditedPart& edited = geometry.parts[b];
        LivePart& part = parts[b];
        part.emitter = edited.emitter;
        part.matrix = edited.matrix;
        part.inverse = glm::inverse(edited.matrix);
        part.key = keyOf(geometry, edited, look, recovered);
        if (!box[b].empty()) part.centre = box[b].centre();
        for (const LivePart& old : previous)
            if (old.tracer && old.key == part.key) {
                part.tracer = old.tracer;
                part.faceNormals = old.faceNormals;
            }
        if (part.tracer) continue;
        const Mesh mesh = partMesh(geometry.mesh, geometry.partOfTriangle, b, part.inverse);
        if (mesh.triangles.empty()) continue;
        part.tracer = std::make_shared<const RayTracer>(mesh);
        const bool mirrored = glm::determinant(Mat3(edited.matrix)) < 0;
        for (size_t t = 0; t < mesh.triangles.size(); ++t)
            part.faceNormals.push_back(mirrored ? -mesh.faceNormal(t) : mesh.faceNormal(t));
    }
    for (size_t t = 0; t < geometry.mesh.triangles.size(); ++t)
        if (const uint32_t b = geometry.partOfTriangle[t])
            for (uint32_t v : geometry.mesh.triangles[t])
                parts[b].radius = std::max(parts[b].radius, glm::length(geometry.mesh.positions[v] - parts[b].centre));
    // Suns have no triangles: where their light comes from is what they cover.
    for (LivePart& b : parts)
        if (b.emitter >= 0 && geometry.emitters[size_t(b.emitter)].sunDegrees > 0) {
            b.centre = geometry.emitters[size_t(b.emitter)].surface.centroid;
            b.radius = geometry.emitters[size_t(b.emitter)].surface.radius;
        }
    for (LivePart& b : parts) b.radius *= 1.0001f;
    return parts;
}

uint32_t LiveOccluders::occluded8(std::span<const Ray> rays) const {
    uint32_t bits = groundOccluded8(rays);
    const uint32_t all = (1u << rays.size()) - 1;
    for (size_t b = 1; b < parts.size() && bits != all; ++b) bits |= parts[b].occluded8(rays);
    return bits;
}

}  // namespace relamp
