// Photographs of what stands before a background, and a mesh that may hold more of it or less.
#pragma once
#include "radiance/free_space.h"
#include "radiance/gather.h"
#include "support/estimates.h"

namespace relamp::test {

using Sky = std::function<Rgb(const Vec3&)>;
using Surface = std::function<Rgb(const Vec3& position, const Vec3& direction)>;

/// Bright and dark, of several hues.
inline Rgb pattern(const Vec3& d) {
    return Rgb(0.6f + 0.5f * std::sin(5 * d.x + 2 * d.z), 0.6f + 0.5f * std::sin(6 * d.y),
               0.6f + 0.5f * std::sin(4 * d.z));
}
/// As fine as a cell of the background, and uneven below a capture.
inline Rgb fine(const Vec3& d) { return pattern(d) * (1 + 0.6f * std::sin(70 * d.x) * std::sin(70 * d.y)); }
inline Rgb even(const Vec3&) { return Rgb(0.4f, 0.5f, 0.6f); }
inline Rgb wood(const Vec3& at, const Vec3&) { return Rgb(0.3f, 0.2f, 0.1f) * (1 + 0.2f * std::sin(20 * at.x)); }
inline Rgb mirror(const Vec3&, const Vec3& d) { return 0.9f * pattern(Vec3(d.x, d.y, -d.z)); }

/// Photographs of what there is, and a mesh that may hold more.
struct MeshBefore {
    Capture capture;
    Scene scene;
    RadianceSamples samples;
    std::vector<uint32_t> free;

    MeshBefore(const Mesh& there, const Mesh& mesh, const Sky& sky, const Surface& surface, double focal, int views,
               const std::function<bool(const Vec3&)>& shines = {}) {
        const Scene real = sceneOf(there);
        capture.mesh = mesh;
        scene = sceneOf(capture.mesh);
        for (int i = 0; i < views; ++i) {
            const double turn = 2 * piD * i / views;
            View view;
            view.camera = cameraAt({3 * std::cos(turn), 3 * std::sin(turn), 1.4}, {0, 0, 0}, 200, 150, focal);
            view.image = Image(200, 150);
            const Vec3 eye(view.camera.position());
            for (int y = 0; y < 150; ++y)
                for (int x = 0; x < 200; ++x) {
                    const Vec3 d = view.camera.rayDirection({float(x) + 0.5f, float(y) + 0.5f});
                    const Hit hit = real.tracer->closest({eye, d, 0, 1e30f});
                    view.image.at(x, y) = hit ? surface(eye + d * hit.distance, d) : sky(d);
                }
            capture.views.push_back(view);
        }
        Progress progress;
        samples = gatherRadiance(capture, scene, {}, progress);
        std::vector<uint8_t> isLight(scene.mesh.vertexCount(), 0);
        for (size_t v = 0; v < isLight.size(); ++v) isLight[v] = shines && shines(scene.mesh.positions[v]);
        free = freeSpaceTriangles(scene, capture, samples, isLight, progress);
    }
    Vec3 middleOf(uint32_t t) const {
        Vec3 middle(0);
        for (const uint32_t v : scene.mesh.triangles[t]) middle += scene.mesh.positions[v] / 3.0f;
        return middle;
    }
};

}  // namespace relamp::test
