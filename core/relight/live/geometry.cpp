// What an edit of the geometry changes: which parts moved, whose light has to be taken again, what leaves the ground.
#include <algorithm>
#include <atomic>
#include <utility>

#include "base/box.h"
#include "base/parallel.h"
#include "relight/live/state.h"

namespace relamp {
namespace {

std::string nameOf(const EditedGeometry& geometry, const EditedPart& part) {
    return part.emitter >= 0 ? "emitter " + geometry.emitters[size_t(part.emitter)].id
                             : "component " + std::to_string(part.component);
}

/// Takes the mesh of `edited`. `before`: the vertices of a geometry whose triangles are of the same parts; null: there
/// is none.
LiveVertices verticesOf(EditedGeometry& edited, const LiveVertices* before) {
    LiveVertices now;
    now.mesh = std::make_shared<const Mesh>(std::exchange(edited.mesh, {}));
    now.origin = edited.vertexOrigin;
    if (before) {
        now.kind = before->kind;
        now.part = before->part;
        return now;
    }
    now.kind.assign(now.mesh->vertexCount(), LiveVertices::none);
    now.part.assign(now.mesh->vertexCount(), 0);
    for (size_t t = 0; t < now.mesh->triangles.size(); ++t)
        for (uint32_t v : now.mesh->triangles[t]) {
            now.part[v] = edited.partOfTriangle[t];
            now.kind[v] = edited.emitterOfTriangle[t] >= 0 ? LiveVertices::emitting
                          : edited.partOfTriangle[t]       ? LiveVertices::carried
                                                           : LiveVertices::ground;
        }
    return now;
}

/// Spheres about the parts that `edited` takes from the ground of `before`.
std::vector<LivePart> leavingGround(const Mesh& mesh, const EditedGeometry& before, const EditedGeometry& edited) {
    std::vector<LivePart> leaving;
    for (uint32_t b = 1; b < edited.parts.size(); ++b) {
        Box box;
        for (size_t t = 0; t < mesh.triangles.size(); ++t)
            if (edited.partOfTriangle[t] == b && before.partOfTriangle[t] == 0)
                for (uint32_t v : mesh.triangles[t]) box.grow(mesh.positions[v]);
        if (box.empty()) continue;
        LivePart sphere;
        sphere.centre = box.centre();
        sphere.radius = 1.0001f * box.diagonal() / 2;
        leaving.push_back(sphere);
    }
    return leaving;
}

/// Marks the vertices that stand elsewhere than `before` or are lit for the first time, all of them unless the emitter
/// stayed (`same`).
void markElsewhere(NearEmitter& emitter, const LiveVertices& now, const LiveVertices& before,
                   const std::vector<uint8_t>& moved, bool same) {
    std::atomic<bool> stale = false;
    parallelBlocks(now.count(), 16384, [&](size_t begin, size_t end) {
        bool any = false;
        for (size_t v = begin; v < end; ++v) {
            const bool carriedAlong = now.kind[v] == LiveVertices::carried && moved[now.part[v]];
            const bool other =
                v >= before.count() || before.kind[v] != now.kind[v] || before.origin[v] != now.origin[v];
            if (!same || carriedAlong || other) {
                emitter.level[v] = 0;
                any = true;
            }
            if (!now.lit(v)) emitter.factor[v] = emitter.open[v] = 0;
        }
        if (any) stale = true;
    });
    if (stale) emitter.restart();
}

/// NearEmitter::unreached.
std::vector<uint8_t> unreachedBy(const RelitEmitter& emitter, const Scene& scene, const LiveVertices& now) {
    std::vector<uint8_t> unreached;
    if (!emitter.reach) return unreached;
    unreached.reserve(now.count());
    for (const uint32_t origin : now.origin)
        unreached.push_back(origin != EditedPart::none && !emitter.reaches(scene.component[origin]));
    return unreached;
}

}  // namespace

void LiveScene::State::takeGeometry(const Look& next, EditedGeometry edited, PartsApart nextApart) {
    std::vector<LivePart> parts = liveParts(edited, next, occluders.parts);
    std::vector<std::string> names{"ground"};
    for (size_t b = 1; b < edited.parts.size(); ++b) names.push_back(nameOf(edited, edited.parts[b]));
    // Where each part was before: 0 is nowhere.
    std::vector<uint32_t> before(names.size(), 0);
    std::vector<uint8_t> moved(names.size(), 1), kept(partNames.size(), 0);
    for (size_t b = 1; b < names.size(); ++b)
        for (uint32_t o = 1; o < partNames.size(); ++o)
            if (names[b] == partNames[o]) {
                before[b] = o;
                moved[b] = !(parts[b].key == occluders.parts[o].key && parts[b].matrix == occluders.parts[o].matrix &&
                             bool(parts[b].tracer) == bool(occluders.parts[o].tracer));
                kept[o] = 1;
            }
    bool anyMoved = names != partNames;
    for (size_t b = 1; b < names.size(); ++b) anyMoved |= moved[b] != 0;
    const bool renumbered = vertices.origin != edited.vertexOrigin || geometry.partOfTriangle != edited.partOfTriangle;
    anyMoved |= renumbered;
    const bool first = partNames.empty();
    if (!anyMoved) {
        edited.mesh = Mesh();
        geometry.emitters = std::move(edited.emitters);
        newValues = true;
        return;
    }

    // Components that leave the ground.
    const bool groundShrank =
        !first && std::count(edited.partOfTriangle.begin(), edited.partOfTriangle.end(), 0u) !=
                      std::count(geometry.partOfTriangle.begin(), geometry.partOfTriangle.end(), 0u);
    if (first || groundShrank) occluders.ground = tracerOf(edited, 0);
    if (groundShrank)
        for (const LivePart& sphere : leavingGround(scene->mesh, geometry, edited)) released.push_back(sphere);
    const bool sameKinds = !renumbered && edited.mesh.vertexCount() == vertices.count() &&
                           edited.emitterOfTriangle == geometry.emitterOfTriangle;
    LiveVertices now = verticesOf(edited, sameKinds ? &vertices : nullptr);

    // Emitters: those that stay where they were keep their light, but for the shadows of what moved.
    std::vector<NearEmitter> emitters(edited.emitters.size());
    std::vector<uint8_t> emitterMoved(emitters.size(), 1);
    for (size_t e = 0; e < emitters.size(); ++e) {
        NearEmitter& out = emitters[e];
        out.id = edited.emitters[e].id;
        for (uint32_t b = 1; b < edited.parts.size(); ++b)
            if (edited.parts[b].emitter == int(e)) out.part = b;
        NearEmitter* old = nullptr;
        for (NearEmitter& o : near)
            if (o.id == out.id && !o.level.empty()) old = &o;
        const bool same = old && out.part && !moved[out.part];
        emitterMoved[e] = !same;
        if (same) {
            const uint32_t part = out.part;
            out = std::move(*old);
            out.part = part;
        } else {
            const LivePart& part = parts[out.part];
            const LivePart* was = old && old->part < occluders.parts.size() ? &occluders.parts[old->part] : nullptr;
            out.tree = LiveEmitterTree(edited.emitters[e].surface,
                                       was && was->key == part.key ? std::optional(old->tree.convex()) : std::nullopt);
            out.centre = edited.emitters[e].surface.centroid;
            out.radius = edited.emitters[e].surface.radius;
        }
        out.added = edited.addedFactor[e];
        out.shaped = edited.emitters[e].emission.shaped;
        out.shadows = edited.emitters[e].shadows;
        out.unreached = unreachedBy(edited.emitters[e], *scene, now);
        out.shape.resize(out.shaped ? now.count() : 0, Rgb(0));
        out.factor.resize(now.count(), 0);
        out.open.resize(now.count(), 0);
        out.level.resize(now.count(), 0);
        markElsewhere(out, now, vertices, moved, same);
        if (!same) continue;
        for (uint32_t b = 1; b < parts.size(); ++b) {
            if (!moved[b]) continue;
            markShadowed(out, now, parts[b]);
            if (before[b]) markShadowed(out, now, occluders.parts[before[b]]);
        }
        for (uint32_t o = 1; o < kept.size(); ++o)
            if (!kept[o]) markShadowed(out, now, occluders.parts[o]);
        for (const LivePart& component : released) markShadowed(out, now, component);
    }
    const size_t emittersBefore = near.size();
    near = std::move(emitters);
    // Two edits before an image stir what both of them moved.
    const bool sameVertices =
        !first && !renumbered && names == partNames && vertices.kind == now.kind && emittersBefore == near.size();
    const bool known = sameVertices && !(newGeometry && stirred.empty());
    if (!newGeometry || !known) stirred.clear();
    if (known)
        for (uint32_t b = 1; b < parts.size(); ++b)
            if (moved[b]) {
                stirred.push_back(occluders.parts[before[b]]);
                stirred.push_back(parts[b]);
            }
    occluders.parts = std::move(parts);
    if (!first) {
        matte.setParts(names);
        for (uint32_t b = 1; b < names.size(); ++b)
            if (moved[b]) matte.markMoved(b);
    }
    partNames = std::move(names);
    vertices = std::move(now);
    geometry = std::move(edited);
    apart = std::move(nextApart);
    emitterOfTriangle = std::make_shared<const std::vector<int>>(geometry.emitterOfTriangle);
    distantMatte.resize(vertices.count(), Rgb(0));
    carried.setVertices(vertices);
    if (sameVertices) gloss.moveVertices(vertices, moved, emitterMoved);
    else gloss.setVertices(vertices, near.size(), next.neutralMaterials);
    newGeometry = true;
}

}  // namespace relamp
