#include "relight/model_confidence.h"

#include "base/parallel.h"

namespace relamp {

std::vector<float> modelConfidence(const RelitScene& relit, const Camera& camera, int first, int count) {
    std::vector<float> confidence(size_t(count) * size_t(camera.width), 0);
    const Vec3 eye(camera.position());
    parallelFor(size_t(count), 4, [&](size_t row) {
        for (int x = 0; x < camera.width; ++x) {
            const Vec2 pixel(float(x) + 0.5f, float(first) + float(row) + 0.5f);
            const Hit hit = relit.scene.cameraTracer->closest({eye, camera.rayDirection(pixel), 0, 1e30f});
            if (!hit) continue;
            float& here = confidence[row * size_t(camera.width) + size_t(x)];
            here = 1;
            if (relit.emitterOfTriangle[hit.triangle] >= 0 || relit.confidence.empty()) continue;
            const auto& corners = relit.scene.mesh.triangles[hit.triangle];
            const Vec2 b = hit.barycentric;
            here = (1 - b.x - b.y) * relit.confidence[corners[0]] + b.x * relit.confidence[corners[1]] +
                   b.y * relit.confidence[corners[2]];
        }
    });
    return confidence;
}

}  // namespace relamp
