// Where the light at one point of the present image comes from, for the inspector.
#include "base/error.h"
#include "relight/live/state.h"

namespace relamp {

PointLight LiveScene::lightAt(uint32_t triangle, const Vec2& barycentric) const {
    const State& s = *state_;
    const Mesh& mesh = *s.vertices.mesh;
    if (triangle >= mesh.triangles.size())
        throw Error("triangle {} does not exist, the mesh has {}", triangle, mesh.triangles.size());
    const Triangle& t = mesh.triangles[triangle];
    const float fraction[3] = {1 - barycentric.x - barycentric.y, barycentric.x, barycentric.y};
    PointLight out;
    out.fromEmitter.assign(s.near.size(), Rgb(0));
    out.weights.assign(s.estimate->reflectance.lobes(), Rgb(0));
    for (int k = 0; k < 3; ++k) {
        const uint32_t v = t[size_t(k)];
        out.point += fraction[k] * mesh.positions[v];
        out.normal += fraction[k] * mesh.normals[v];
        if (!s.vertices.lit(v)) continue;
        const uint32_t origin = s.vertices.origin[v];
        const Rgb albedo = s.albedo(v);
        out.fromEnvironment +=
            fraction[k] * s.gain * (albedo * s.distantMatte[v] + (s.gloss.empty() ? Rgb(0) : s.gloss.distant()[v]));
        for (size_t e = 0; e < s.near.size(); ++e) {
            Rgb transport = albedo * s.near[e].light(v);
            if (!s.gloss.empty()) transport += s.gloss.near(e)[v] * (s.gloss.shadowed(e, v) ? 1.0f : s.near[e].seen(v));
            out.fromEmitter[e] += fraction[k] * transport * s.geometry.emitters[e].emission.level;
        }
        if (origin == EditedPart::none) continue;
        const LobesAtVertex weights = s.estimate->reflectance.at(origin);
        for (size_t lobe = 0; lobe < weights.size(); ++lobe) {
            const Rgb w = weights[lobe];
            out.weights[lobe] += fraction[k] * (s.look.neutralMaterials ? Rgb(luminance(w)) : w);
        }
    }
    const float length = glm::length(out.normal);
    out.normal = length > 1e-6f ? out.normal / length : mesh.faceNormal(triangle);

    const size_t cells = size_t(out.grid.cells());
    out.incident.assign(cells, Rgb(0));
    const LiveLight environment = liveLight(*s.distant, out.grid.side);
    const Vec3 origin = s.occluders.origin(out.point, out.normal);
    for (size_t c = 0; c < cells; ++c) {
        const Vec3 d = out.grid.direction(int(c));
        if (glm::dot(d, out.normal) <= 0) continue;
        const Ray ray{origin, d, 0, 1e30f};
        Hit nearest = s.occluders.ground ? s.occluders.ground->closest(ray) : Hit{};
        int emitter = -1;
        bool front = false, any = bool(nearest);
        for (size_t b = 1; b < s.occluders.parts.size(); ++b) {
            bool facing = false;
            const Hit hit = s.occluders.parts[b].closest(ray, facing);
            if (!hit || (any && hit.distance >= nearest.distance)) continue;
            nearest = hit;
            any = true;
            emitter = s.occluders.parts[b].emitter;
            front = facing;
        }
        if (!any) out.incident[c] = environment.cells[c];
        else if (emitter >= 0 && s.near[size_t(emitter)].reaches(t[0]) &&
                 (front || s.geometry.emitters[size_t(emitter)].surface.twoSided))
            out.incident[c] = s.geometry.emitters[size_t(emitter)].emission.radiance(-d, origin + nearest.distance * d);
    }
    // An emitter smaller than a cell falls between the rays: where it lies it counts with the fraction of the cell it
    // covers.
    EmitterComponents components;
    for (size_t e = 0; e < s.near.size(); ++e) {
        const NearEmitter& emitter = s.near[e];
        const float distance = glm::length(emitter.centre - out.point);
        if (s.geometry.emitters[e].emission.dark() || !emitter.reaches(t[0]) || distance <= emitter.radius ||
            pi * emitter.radius * emitter.radius > 4 * distance * distance * out.grid.cellSolidAngle())
            continue;
        float open = 0;
        const float seen = nearFactor(emitter, s.occluders, out.point, out.normal, fineCut, 64, s.options.seed, open);
        const Vec3 toward = (emitter.centre - out.point) / distance;
        const float cosine = glm::dot(toward, out.normal);
        if (!(seen > 0) || cosine < 1e-3f) continue;
        Rgb& place = out.incident[size_t(out.grid.cellOf(toward))];
        const float fraction2 = std::min(1.0f, seen * pi / (cosine * out.grid.cellSolidAngle()));
        place = glm::max(place, fraction2 * s.geometry.emitters[e].emission.radiance(-toward, emitter.centre));
    }
    return out;
}

}  // namespace relamp
