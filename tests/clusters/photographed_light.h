// Photographs of a light over a floor, and a capture whose mesh has another shape in its place.
#pragma once
#include "clusters/body_obstacles.h"
#include "clusters/emitter_mend.h"
#include "radiance/gather.h"
#include "support/estimates.h"

namespace relamp::test {

inline const Rgb light(30, 20, 10);

inline Mesh ballOf(const Vec3& centre, float radius) { return ball(centre, radius, 12, 24); }
inline Mesh boxOf(const Vec3& centre, const Vec3& size) { return box(centre - size, centre + size, 8); }

/// Photographs of a floor, with `screens` on it, and `truth` shining above it, and a capture whose mesh has
/// `reconstructed` in its place.
struct PhotographedLight {
    Capture capture;
    Scene scene;
    RadianceSamples samples;
    EmitterClusters clusters;
    size_t floorTriangles = 0;

    PhotographedLight(const Mesh& truth, const Mesh& reconstructed, const Mesh& screens = {})
        : scene(sceneWith(reconstructed, screens)) {
        const Scene real = sceneWith(truth, screens);
        floorTriangles = floor(screens).triangles.size();
        const size_t floorVertices = floor(screens).vertexCount();
        for (int i = 0; i < 6; ++i) {
            const double turn = 2 * piD * i / 6;
            const Camera camera =
                cameraAt({1.5 * std::cos(turn), 1.5 * std::sin(turn), 1.0}, {0, 0, 0.3}, 320, 240, 320);
            capture.views.push_back(photographOf(real, camera, [&](const Hit& hit) {
                if (!hit) return Rgb(0.02f);
                return real.mesh.triangles[hit.triangle][0] >= floorVertices ? light : Rgb(0.2f, 0.18f, 0.15f);
            }));
        }
        capture.mesh = scene.mesh;
        Progress progress;
        samples = gatherRadiance(capture, scene, {}, progress);
        clusters = clusterEmitters(scene, capture, samples, {}, progress);
    }

    static Mesh floor(const Mesh& screens) {
        Mesh mesh = sheet({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, 40, 40);
        if (!screens.positions.empty()) append(mesh, screens);
        return mesh;
    }
    static Scene sceneWith(const Mesh& emitter, const Mesh& screens) {
        Mesh mesh = floor(screens);
        if (!emitter.positions.empty()) append(mesh, emitter);
        return sceneOf(std::move(mesh));
    }
    EmitterMend mend() const { return mendEmitters(scene, capture, samples, clusters); }
};
/// What no ball, tube or box is like.
inline Mesh eggOf(const Vec3& centre, const Vec3& size) {
    Mesh egg = ball(Vec3(0), 1, 24, 48);
    for (Vec3& p : egg.positions) p = centre + p * size;
    egg.normals = vertexNormalsFromFaces(egg);
    return egg;
}
inline EmitterBody tubeOf(const DVec3& centre, const DVec3& along, double length, double radius) {
    EmitterBody tube;
    tube.round = true;
    tube.centre = centre;
    tube.axes = glm::dmat3(frameAround(Vec3(glm::normalize(along))));
    std::swap(tube.axes[0], tube.axes[2]);
    tube.axes[1] = -tube.axes[1];
    tube.half = {0.5 * length, radius, radius};
    return tube;
}

inline Mesh surfaceOf(const EmitterBody& body) {
    Mesh mesh;
    body.surface(mesh.positions, mesh.triangles);
    mesh.normals = vertexNormalsFromFaces(mesh);
    return mesh;
}
}  // namespace relamp::test
