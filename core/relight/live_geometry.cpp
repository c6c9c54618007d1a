// What an edit of the geometry changes: which bodies moved, whose light has to be taken again, what leaves the ground.
#include <algorithm>

#include "relight/live_state.h"

namespace relamp {
namespace {

std::string nameOf(const EditedGeometry& geometry, const EditedBody& body) {
    return body.emitter >= 0 ? "emitter " + geometry.emitters[size_t(body.emitter)].id
                             : "piece " + std::to_string(body.piece);
}

}  // namespace

void LiveScene::State::takeGeometry(const Look& next, EditedGeometry edited, BodiesApart nextApart) {
    std::vector<LiveBody> bodies = liveBodies(edited, next, occluders.bodies);
    std::vector<std::string> names{"ground"};
    for (size_t b = 1; b < edited.bodies.size(); ++b) names.push_back(nameOf(edited, edited.bodies[b]));
    // Where each body was before: 0 is nowhere.
    std::vector<uint32_t> before(names.size(), 0);
    std::vector<uint8_t> moved(names.size(), 1), kept(bodyNames.size(), 0);
    for (size_t b = 1; b < names.size(); ++b)
        for (uint32_t o = 1; o < bodyNames.size(); ++o)
            if (names[b] == bodyNames[o]) {
                before[b] = o;
                moved[b] =
                    !(bodies[b].key == occluders.bodies[o].key && bodies[b].matrix == occluders.bodies[o].matrix &&
                      bool(bodies[b].tracer) == bool(occluders.bodies[o].tracer));
                kept[o] = 1;
            }
    bool anyMoved = names != bodyNames;
    for (size_t b = 1; b < names.size(); ++b) anyMoved |= moved[b] != 0;
    const bool renumbered = vertices.origin != edited.vertexOrigin || geometry.bodyOfTriangle != edited.bodyOfTriangle;
    anyMoved |= renumbered;
    const bool first = bodyNames.empty();
    if (!anyMoved) {
        edited.mesh = Mesh();
        geometry.emitters = std::move(edited.emitters);
        newValues = true;
        return;
    }

    LiveVertices now;
    now.mesh = std::make_shared<const Mesh>(edited.mesh);
    now.origin = edited.vertexOrigin;
    now.kind.assign(now.mesh->vertexCount(), LiveVertices::none);
    now.body.assign(now.mesh->vertexCount(), 0);
    for (size_t t = 0; t < edited.mesh.triangles.size(); ++t)
        for (uint32_t v : edited.mesh.triangles[t]) {
            now.body[v] = edited.bodyOfTriangle[t];
            now.kind[v] = edited.emitterOfTriangle[t] >= 0 ? LiveVertices::emitting
                          : edited.bodyOfTriangle[t]       ? LiveVertices::carried
                                                           : LiveVertices::ground;
        }

    // Pieces that leave the ground.
    const bool groundShrank =
        !first && std::count(edited.bodyOfTriangle.begin(), edited.bodyOfTriangle.end(), 0u) !=
                      std::count(geometry.bodyOfTriangle.begin(), geometry.bodyOfTriangle.end(), 0u);
    if (first || groundShrank) occluders.ground = tracerOf(edited, 0);
    if (groundShrank) {
        for (uint32_t b = 1; b < edited.bodies.size(); ++b) {
            LiveBody sphere;
            Vec3 low(1e30f), high(-1e30f);
            for (size_t t = 0; t < scene->mesh.triangles.size(); ++t)
                if (edited.bodyOfTriangle[t] == b && geometry.bodyOfTriangle[t] == 0)
                    for (uint32_t v : scene->mesh.triangles[t]) {
                        low = glm::min(low, scene->mesh.positions[v]);
                        high = glm::max(high, scene->mesh.positions[v]);
                    }
            if (low.x > high.x) continue;
            sphere.centre = (low + high) / 2.0f;
            sphere.radius = 1.0001f * glm::length(high - low) / 2;
            released.push_back(sphere);
        }
    }

    // Emitters: those that stay where they were keep their light, but for the shadows of what moved.
    std::vector<NearEmitter> emitters(edited.emitters.size());
    std::vector<uint8_t> emitterMoved(emitters.size(), 1);
    for (size_t e = 0; e < emitters.size(); ++e) {
        NearEmitter& out = emitters[e];
        out.id = edited.emitters[e].id;
        for (uint32_t b = 1; b < edited.bodies.size(); ++b)
            if (edited.bodies[b].emitter == int(e)) out.body = b;
        NearEmitter* old = nullptr;
        for (NearEmitter& o : near)
            if (o.id == out.id && !o.level.empty()) old = &o;
        const bool same = old && out.body && !moved[out.body];
        emitterMoved[e] = !same;
        if (same) {
            const uint32_t body = out.body;
            out = std::move(*old);
            out.body = body;
        } else {
            const LiveBody& body = bodies[out.body];
            const LiveBody* was = old && old->body < occluders.bodies.size() ? &occluders.bodies[old->body] : nullptr;
            out.tree = LiveEmitterTree(edited.emitters[e].surface,
                                       was && was->key == body.key ? std::optional(old->tree.convex()) : std::nullopt);
            out.centre = edited.emitters[e].surface.centroid;
            out.radius = edited.emitters[e].surface.radius;
        }
        out.factor.resize(now.count(), 0);
        out.open.resize(now.count(), 0);
        out.level.resize(now.count(), 0);
        for (size_t v = 0; v < now.count(); ++v) {
            // Whoever stands elsewhere, or is lit for the first time, starts again.
            const bool carriedAlong = now.kind[v] == LiveVertices::carried && moved[now.body[v]];
            const bool other =
                v >= vertices.count() || vertices.kind[v] != now.kind[v] || vertices.origin[v] != now.origin[v];
            if (!same || carriedAlong || other) out.markStale(v);
            if (!now.lit(v)) out.factor[v] = out.open[v] = 0;
        }
        if (!same) continue;
        for (uint32_t b = 1; b < bodies.size(); ++b) {
            if (!moved[b]) continue;
            markShadowed(out, now, bodies[b]);
            if (before[b]) markShadowed(out, now, occluders.bodies[before[b]]);
        }
        for (uint32_t o = 1; o < kept.size(); ++o)
            if (!kept[o]) markShadowed(out, now, occluders.bodies[o]);
        for (const LiveBody& piece : released) markShadowed(out, now, piece);
    }
    const size_t emittersBefore = near.size();
    near = std::move(emitters);
    // Two edits before a picture stir what both of them moved.
    const bool sameVertices =
        !first && !renumbered && names == bodyNames && vertices.kind == now.kind && emittersBefore == near.size();
    const bool known = sameVertices && !(newGeometry && stirred.empty());
    if (!newGeometry || !known) stirred.clear();
    if (known)
        for (uint32_t b = 1; b < bodies.size(); ++b)
            if (moved[b]) {
                stirred.push_back(occluders.bodies[before[b]]);
                stirred.push_back(bodies[b]);
            }
    occluders.bodies = std::move(bodies);
    if (!first) {
        matte.setBodies(names);
        for (uint32_t b = 1; b < names.size(); ++b)
            if (moved[b]) matte.markMoved(b);
    }
    bodyNames = std::move(names);
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
