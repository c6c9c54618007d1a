#include "edit/emitter_edits.h"

#include <algorithm>
#include <glm/gtc/matrix_transform.hpp>
#include <set>

#include "base/box.h"
#include "edit/group_edits.h"
#include "edit/value_key_edits.h"

namespace relamp {
namespace {

EmitterLook* recoveredLook(Look& look, const std::string& id, bool create) {
    for (EmitterLook& e : look.emitters)
        if (e.id == id) return &e;
    if (!create) return nullptr;
    look.emitters.push_back({});
    look.emitters.back().id = id;
    return &look.emitters.back();
}

AddedEmitter* addedLook(Look& look, const std::string& id) {
    for (AddedEmitter& e : look.added)
        if (e.id == id) return &e;
    return nullptr;
}

int clusterIndex(const Estimate& estimate, const std::string& id) {
    const std::vector<EmitterCluster>& clusters = estimate.emitters.emitters;
    for (size_t i = 0; i < clusters.size(); ++i)
        if (clusters[i].id == id) return int(i);
    return -1;
}

bool nothingChanged(const EmitterLook& e) {
    return e.enabled && e.shadows && e.link.everything() && e.matrix == Mat4(1) && e.powerScale == Rgb(1);
}

/// Entries that say nothing are left out, so that a reset look equals an untouched one.
void tidy(Look& look) {
    std::erase_if(look.emitters, [](const EmitterLook& e) { return nothingChanged(e) && e.name.empty(); });
}

/// Columns: two axes across, and where it faces.
Mat3 axesFrom(const Mat4& matrix, const Vec3& facing) {
    const Mat3 m(matrix);
    Vec3 z = glm::transpose(glm::inverse(m)) * facing;
    if (const float length = glm::length(z); length > 0) z /= length;
    else z = Vec3(0, 0, -1);
    Vec3 x = m * frameAround(facing)[0];
    x -= z * glm::dot(x, z);
    const float length = glm::length(x);
    x = length > 1e-12f ? x / length : frameAround(z)[0];
    return Mat3(x, glm::cross(z, x), z);
}

struct Part {
    Vec3 centroid{0}, facing{0, 0, -1};
    float area = 0;
};

/// The capture's triangles of the component that holds the vertex.
Part partOfComponent(const Scene& scene, uint32_t seed) {
    Part part;
    if (seed >= scene.mesh.vertexCount()) return part;
    Vec3 normal(0);
    for (size_t t = 0; t < scene.mesh.triangles.size(); ++t) {
        const Triangle& i = scene.mesh.triangles[t];
        if (scene.component[i[0]] != scene.component[seed]) continue;
        const float area = scene.mesh.triangleArea(t);
        part.centroid +=
            area / 3 * (scene.mesh.positions[i[0]] + scene.mesh.positions[i[1]] + scene.mesh.positions[i[2]]);
        normal += area * scene.mesh.faceNormal(t);
        part.area += area;
    }
    if (part.area > 0) part.centroid /= part.area;
    if (glm::length(normal) > 0.1f * part.area) part.facing = glm::normalize(normal);
    return part;
}

Vec3 facingOf(const EmitterCluster& cluster) {
    return glm::length(cluster.normal) > 0.5f ? glm::normalize(cluster.normal) : Vec3(0, 0, -1);
}

Mat4 about(const Vec3& pivot, const Mat3& rotation) {
    return glm::translate(Mat4(1), pivot) * Mat4(rotation) * glm::translate(Mat4(1), -pivot);
}

/// The shortest rotation that takes unit vector a to b.
Mat3 rotationBetween(const Vec3& a, const Vec3& b) {
    const float c = glm::dot(a, b);
    if (c > 0.9999999f) return Mat3(1);
    const Vec3 axis = c < -0.9999999f ? frameAround(a)[0] : glm::normalize(glm::cross(a, b));
    return Mat3(glm::rotate(Mat4(1), std::acos(std::clamp(c, -1.0f, 1.0f)), axis));
}

float extentOf(const Mesh& mesh, const EmitterCluster& cluster) {
    float r = 0;
    for (uint32_t v : cluster.vertices) r = std::max(r, glm::distance(mesh.positions[v], cluster.centroid));
    return r;
}

std::string freshId(const Look& look, const Estimate& estimate, const std::string& stem) {
    for (int n = 1;; ++n) {
        std::string id = fmt::format("{}-{}", stem, n);
        const bool taken =
            clusterIndex(estimate, id) >= 0 ||
            std::any_of(look.added.begin(), look.added.end(), [&](const AddedEmitter& e) { return e.id == id; });
        if (!taken) return id;
    }
}

}  // namespace

std::vector<EmitterState> emittersOf(const Scene& scene, const Estimate& estimate, const Look& look) {
    std::vector<EmitterState> out;
    const std::vector<EmitterCluster>& clusters = estimate.emitters.emitters;
    for (size_t i = 0; i < clusters.size(); ++i) {
        EmitterState s;
        s.id = s.name = clusters[i].id;
        s.index = int(i);
        s.recoveredRadiance = s.radiance =
            i < estimate.lighting.emitterRadiance.size() ? estimate.lighting.emitterRadiance[i] : clusters[i].radiance;
        for (const EmitterLook& e : look.emitters)
            if (e.id == s.id) {
                s.enabled = e.enabled;
                s.shadows = e.shadows;
                s.link = e.link;
                s.matrix = e.matrix;
                s.radiance *= e.powerScale;
                s.changed = !nothingChanged(e);
                if (!e.name.empty()) s.name = e.name;
            }
        s.pivot = Vec3(s.matrix * Vec4(clusters[i].centroid, 1));
        s.axes = axesFrom(s.matrix, facingOf(clusters[i]));
        s.area = clusters[i].area;
        s.groupFactor = groupFactor(look.groups, s.id);
        out.push_back(s);
    }
    for (size_t i = 0; i < look.added.size(); ++i) {
        const AddedEmitter& e = look.added[i];
        EmitterState s;
        s.id = e.id;
        s.name = e.name.empty() ? e.id : e.name;
        s.recovered = false;
        s.index = int(i);
        s.enabled = e.enabled;
        s.shadows = e.shadows;
        s.link = e.link;
        s.matrix = e.matrix;
        s.radiance = s.recoveredRadiance = e.radiance;
        s.changed = true;
        Part part;
        const EmitterShapeInfo& info = infoOf(e.shape);
        s.sun = info.distant;
        if (info.own()) part.area = info.area(e.size);
        else if (info.geometry == EmitterShapeInfo::Geometry::component) part = partOfComponent(scene, e.seedVertex);
        else if (const int c = clusterIndex(estimate, e.source); c >= 0)
            part = {clusters[size_t(c)].centroid, facingOf(clusters[size_t(c)]), clusters[size_t(c)].area};
        s.pivot = Vec3(s.matrix * Vec4(part.centroid, 1));
        s.axes = axesFrom(s.matrix, part.facing);
        s.area = part.area;
        s.groupFactor = groupFactor(look.groups, s.id);
        out.push_back(s);
    }
    return out;
}

std::optional<EmitterState> findEmitter(const Scene& scene, const Estimate& estimate, const Look& look,
                                        const std::string& id) {
    for (EmitterState& s : emittersOf(scene, estimate, look))
        if (s.id == id) return s;
    return std::nullopt;
}

std::optional<Rgb> radianceOf(const Look& look, const Estimate& estimate, const std::string& id) {
    for (const AddedEmitter& e : look.added)
        if (e.id == id) return e.radiance;
    const int c = clusterIndex(estimate, id);
    if (c < 0) return std::nullopt;
    Rgb radiance = estimate.lighting.emitterRadiance[size_t(c)];
    for (const EmitterLook& e : look.emitters)
        if (e.id == id) radiance *= e.powerScale;
    return radiance;
}

void setEnabled(Look& look, const std::string& id, bool enabled) {
    if (AddedEmitter* added = addedLook(look, id)) added->enabled = enabled;
    else recoveredLook(look, id, true)->enabled = enabled;
    tidy(look);
}

void setRadiance(Look& look, const Estimate& estimate, const std::string& id, const Rgb& radiance) {
    const Rgb wanted = glm::max(radiance, Rgb(0));
    if (AddedEmitter* added = addedLook(look, id)) {
        added->radiance = wanted;
        return;
    }
    const int c = clusterIndex(estimate, id);
    if (c < 0) return;
    const Rgb recovered = estimate.lighting.emitterRadiance[size_t(c)];
    EmitterLook& e = *recoveredLook(look, id, true);
    // A channel that was found black cannot be scaled up; it stays as it is.
    for (int k = 0; k < 3; ++k)
        if (recovered[k] > 0) e.powerScale[k] = wanted[k] == recovered[k] ? 1 : wanted[k] / recovered[k];
    tidy(look);
}

void moveEmitter(Look& look, const std::string& id, const Mat4& change) {
    if (AddedEmitter* added = addedLook(look, id)) {
        added->matrix = change * added->matrix;
    } else {
        EmitterLook& e = *recoveredLook(look, id, true);
        e.matrix = change * e.matrix;
    }
    for (PartLook& part : look.parts)
        if (part.attachedTo == id) part.matrix = change * part.matrix;
    tidy(look);
}

void setSize(Look& look, const std::string& id, const Vec2& size) {
    if (AddedEmitter* added = addedLook(look, id)) added->size = glm::max(size, Vec2(1e-4f));
}

void setShadows(Look& look, const std::string& id, bool shadows) {
    if (AddedEmitter* added = addedLook(look, id)) added->shadows = shadows;
    else recoveredLook(look, id, true)->shadows = shadows;
    tidy(look);
}

void setLink(Look& look, const std::string& id, const LightLink& link) {
    if (AddedEmitter* added = addedLook(look, id)) added->link = link;
    else recoveredLook(look, id, true)->link = link;
    tidy(look);
}

void shapeEmitter(Look& look, const std::string& id, const std::function<void(LightShaping&)>& change) {
    if (AddedEmitter* added = addedLook(look, id)) change(added->shaping);
}

void resetEmitter(Look& look, const std::string& id, EmitterValue value) {
    const bool place = value == EmitterValue::place || value == EmitterValue::all;
    if (AddedEmitter* added = addedLook(look, id)) {
        if (place) {
            for (PartLook& part : look.parts)
                if (part.attachedTo == id) part.matrix = glm::inverse(added->matrix) * part.matrix;
            added->matrix = Mat4(1);
        }
        if (value == EmitterValue::enabled || value == EmitterValue::all) added->enabled = true;
        return;
    }
    EmitterLook* e = recoveredLook(look, id, false);
    if (!e) return;
    if (place) {
        for (PartLook& part : look.parts)
            if (part.attachedTo == id)
                part.matrix = part.matrix == e->matrix ? Mat4(1) : glm::inverse(e->matrix) * part.matrix;
        e->matrix = Mat4(1);
    }
    if (value == EmitterValue::radiance || value == EmitterValue::all) e->powerScale = Rgb(1);
    if (value == EmitterValue::enabled || value == EmitterValue::all) e->enabled = true;
    if (value == EmitterValue::all) e->shadows = true, e->link = {};
    tidy(look);
}

void renameEmitter(Look& look, const std::string& id, const std::string& name) {
    std::string wanted = tidyName(name);
    if (wanted == id) wanted.clear();
    if (AddedEmitter* added = addedLook(look, id)) added->name = wanted;
    else recoveredLook(look, id, true)->name = wanted;
    tidy(look);
}

void resetLook(Look& look) {
    Look fresh;
    fresh.plate = look.plate;
    fresh.bookmarks = look.bookmarks;
    for (const EmitterLook& e : look.emitters)
        if (!e.name.empty()) recoveredLook(fresh, e.id, true)->name = e.name;
    look = fresh;
}

std::string addEmitter(Look& look, const Estimate& estimate, AddedEmitter emitter) {
    emitter.id = freshId(look, estimate, infoOf(emitter.shape).name);
    look.added.push_back(std::move(emitter));
    return look.added.back().id;
}

std::string duplicateEmitter(Look& look, const Estimate& estimate, const std::string& id, const Vec3& offset) {
    const Mat4 aside = glm::translate(Mat4(1), offset);
    if (const AddedEmitter* added = addedLook(look, id)) {
        AddedEmitter copy = *added;
        if (infoOf(copy.shape).geometry == EmitterShapeInfo::Geometry::component)
            return {};  // a component of mesh exists once
        copy.matrix = aside * copy.matrix;
        copy.name.clear();
        const std::string made = addEmitter(look, estimate, std::move(copy));
        joinGroupOf(look, id, made);
        copyValueKeys(look, id, made, offset, {});
        return made;
    }
    const int c = clusterIndex(estimate, id);
    if (c < 0) return {};
    AddedEmitter copy;
    copy.shape = EmitterShape::copy;
    copy.source = id;
    copy.matrix = aside;
    copy.radiance = estimate.lighting.emitterRadiance[size_t(c)];
    if (const EmitterLook* e = recoveredLook(look, id, false)) {
        copy.matrix = aside * e->matrix;
        copy.radiance *= e->powerScale;
        copy.shadows = e->shadows;
        copy.link = e->link;
    }
    const std::string made = addEmitter(look, estimate, std::move(copy));
    joinGroupOf(look, id, made);
    copyValueKeys(look, id, made, offset, estimate.lighting.emitterRadiance[size_t(c)]);
    return made;
}

void removeEmitter(Look& look, const std::string& id) {
    if (addedLook(look, id)) {
        std::erase_if(look.added, [&](const AddedEmitter& e) { return e.id == id; });
        for (PartLook& part : look.parts)
            if (part.attachedTo == id) part.attachedTo.clear();
        dropMembers(look.groups, [&](const std::string& member) { return member == id; });
    } else {
        setEnabled(look, id, false);
    }
}

void attachPart(Look& look, const Scene& scene, uint32_t seedVertex, const std::string& id) {
    if (seedVertex >= scene.mesh.vertexCount()) return;
    for (PartLook& part : look.parts)
        if (part.seedVertex < scene.mesh.vertexCount() &&
            scene.component[part.seedVertex] == scene.component[seedVertex]) {
            part.attachedTo = id;
            return;
        }
    look.parts.push_back({seedVertex, Mat4(1), id});
}

void detachPart(Look& look, const Scene& scene, uint32_t seedVertex) {
    for (PartLook& part : look.parts)
        if (scene.component[part.seedVertex] == scene.component[seedVertex]) part.attachedTo.clear();
    std::erase_if(look.parts, [](const PartLook& part) { return part.attachedTo.empty() && part.matrix == Mat4(1); });
}

void resetPart(Look& look, const Scene& scene, uint32_t seedVertex) {
    std::erase_if(look.parts, [&](const PartLook& part) {
        return scene.component[part.seedVertex] == scene.component[seedVertex];
    });
}

std::vector<uint32_t> likelyParts(const Scene& scene, const Estimate& estimate, const std::string& id) {
    const int c = clusterIndex(estimate, id);
    if (c < 0) return {};
    const EmitterCluster& cluster = estimate.emitters.emitters[size_t(c)];
    Box box;
    std::set<uint32_t> own;
    for (uint32_t v : cluster.vertices) {
        box.grow(scene.mesh.positions[v]);
        own.insert(scene.component[v]);
    }
    box.widen(extentOf(scene.mesh, cluster));
    std::vector<uint32_t> size(scene.components, 0), inside(scene.components, ~0u);
    for (uint32_t v = 0; v < scene.mesh.vertexCount(); ++v) {
        if (!scene.referenced[v]) continue;
        const uint32_t component = scene.component[v];
        ++size[component];
        if (box.contains(scene.mesh.positions[v]) && inside[component] == ~0u &&
            estimate.emitters.emitterOfVertex[v] < 0)
            inside[component] = v;
    }
    // The floor also passes near many emitters: the largest component stays where it is, unless the emitter is a patch
    // of it.
    const uint32_t largest = uint32_t(std::max_element(size.begin(), size.end()) - size.begin());
    std::vector<uint32_t> seeds;
    for (uint32_t component = 0; component < scene.components; ++component)
        if (inside[component] != ~0u && component != largest) seeds.push_back(inside[component]);
    return seeds;
}

void aimEmitter(Look& look, const Scene& scene, const Estimate& estimate, const std::string& id, const Vec3& target) {
    const auto emitter = findEmitter(scene, estimate, look, id);
    if (!emitter) return;
    const Vec3 toTarget = target - emitter->pivot;
    const float distance = glm::length(toTarget);
    if (!(distance > 1e-6f)) return;
    moveEmitter(look, id, about(emitter->pivot, rotationBetween(emitter->axes[2], toTarget / distance)));
}

namespace {
void placeAt(Look& look, const Scene& scene, const Estimate& estimate, const std::string& id, const Vec3& point,
             const Vec3& direction) {
    const auto emitter = findEmitter(scene, estimate, look, id);
    if (!emitter) return;
    const float distance = std::max(glm::distance(emitter->pivot, point), 1e-3f * scene.diagonal);
    moveEmitter(look, id, glm::translate(Mat4(1), point + direction * distance - emitter->pivot));
    aimEmitter(look, scene, estimate, id, point);
}
}  // namespace

void placeByReflection(Look& look, const Scene& scene, const Estimate& estimate, const std::string& id,
                       const Vec3& point, const Vec3& normal, const Vec3& eye) {
    if (!(glm::distance(eye, point) > 0)) return;
    const Vec3 towardEye = glm::normalize(eye - point);
    placeAt(look, scene, estimate, id, point, glm::normalize(2 * glm::dot(towardEye, normal) * normal - towardEye));
}

void placeByLight(Look& look, const Scene& scene, const Estimate& estimate, const std::string& id, const Vec3& point,
                  const Vec3& normal) {
    placeAt(look, scene, estimate, id, point, normal);
}

}  // namespace relamp
