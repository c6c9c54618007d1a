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
            confidence[row * size_t(camera.width) + size_t(x)] =
                relit.emitterOfTriangle[hit.triangle] >= 0 ? 1 : relit.confidenceAt(hit);
        }
    });
    return confidence;
}

}  // namespace relamp
