#include "pipeline/stand_mend.h"

#include <fmt/format.h>

#include "solve/registration/tube_fit.h"

namespace relamp {
namespace {

/// Where photographs show a tube of the mesh; the truer its axis, the farther the mesh is seen to follow it.
std::optional<StraightTube> measuredStand(const Mesh& mesh, const StraightTube& tube, const Capture& capture,
                                          const Scene& scene, float floor, const Progress& progress) {
    std::optional<StraightTube> measured = fitTube(capture, scene, tube, floor, progress);
    for (int round = 0; round < 3 && measured; ++round) {
        StraightTube farther = *measured;
        farther.to = tubeEnd(mesh, farther);
        if (!(farther.to > measured->to + measured->radius)) break;
        const std::optional<StraightTube> again = fitTube(capture, scene, farther, floor, progress);
        if (!again) break;
        measured = again;
    }
    return measured;
}

/// Where a tube or cone of light may stand on what is below or above it, on its axis: meshes lose thin posts.
std::vector<LightStand> standsOnAxis(const HeldLight& light, const Scene& scene) {
    constexpr double reach = 3, thin = 0.1, first = 0.1, last = 0.85;  // sizes; of the way
    std::vector<LightStand> stands;
    if (!light.body || !light.body->round) return stands;
    for (const double side : {-1.0, 1.0}) {
        StraightTube tube;
        tube.axes = light.body->axes;
        tube.axes[0] *= side;
        tube.axes[1] *= side;
        tube.through = light.centre + light.body->half.x * tube.axes[0];
        tube.radius = thin * light.size;
        const Vec3 begin(tube.onAxis(first * light.size));
        const Hit hit = scene.cameraTracer->closest({begin, Vec3(tube.axes[0])});
        if (!hit || double(hit.distance) > reach * light.size) continue;
        const double way = first * light.size + double(hit.distance);
        tube.from = first * way;
        tube.to = last * way;
        stands.push_back({tube, light, false, {}});
    }
    return stands;
}

/// Where a stand that the mesh ends in the air stands, metres along it: nothing floats a few radii above a surface.
std::optional<double> groundOf(const StraightTube& tube, const Scene& scene) {
    constexpr double past = 1.5, gap = 6;  // radii
    const double from = tube.to + past * tube.radius;
    const Hit hit = scene.cameraTracer->closest({Vec3(tube.onAxis(from)), Vec3(tube.axes[0])});
    if (!hit || double(hit.distance) > gap * tube.radius) return {};
    const Triangle& t = scene.mesh.triangles[hit.triangle];
    const Vec3 &a = scene.mesh.positions[t[0]], &b = scene.mesh.positions[t[1]], &c = scene.mesh.positions[t[2]];
    const bool faces = glm::dot(DVec3(glm::cross(b - a, c - a)), tube.axes[0]) < 0;
    return faces ? std::optional(from + double(hit.distance)) : std::nullopt;
}

}  // namespace

std::vector<HeldLight> heldBalls(const EmitterMend& mend) {
    std::vector<HeldLight> held;
    for (const ProxyLight& ball : mend.balls) held.push_back(HeldLight::of(ball));
    return held;
}

std::vector<HeldLight> heldBodies(const EmitterMend& mend) {
    std::vector<HeldLight> held;
    for (const EmitterReplacement& r : mend.bodies) held.push_back(HeldLight::of(r.body));
    return held;
}

MendedStands mendStands(const Mesh& file, const MeshMend& before, const std::vector<HeldLight>& lights, bool sleeves,
                        const Capture& capture, const Scene& scene, float floor, const Progress& progress) {
    Mesh mesh = file;
    applyMend(before, mesh);
    const std::vector<uint32_t> numbers = trianglesLeft(before, file.triangles.size());
    mesh.triangles.resize(numbers.size());  // without what mends added
    MendedStands mended;
    const auto mend = [&](const LightStand& stand) {
        const auto measured = measuredStand(mesh, stand.tube, capture, scene, floor, progress);
        if (!measured && !(sleeves && stand.around)) return false;
        mended.surfaces.push_back(measured ? wholeStandOf(mesh, stand, *measured, groundOf(*measured, scene))
                                           : sleeveOf(mesh, stand));
        for (const uint32_t t : mended.surfaces.back().replaced) mended.replaced.push_back(numbers[t]);
        mended.words.push_back(
            measured ? fmt::format("what holds a light is a tube of {:.1f} mm radius in the photographs: measured",
                                   1000 * measured->radius)
                     : "what holds a light ended before it, or wrapped it: it reaches into it");
        return true;
    };
    for (const HeldLight& light : lights) {
        bool any = false;
        for (const LightStand& stand : lightStands(mesh, light)) any |= mend(stand);
        for (const LightStand& stand : any ? std::vector<LightStand>{} : standsOnAxis(light, scene)) mend(stand);
    }
    return mended;
}

}  // namespace relamp
