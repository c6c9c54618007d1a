// Photographs with one ray a pixel, by what is seen where.
#pragma once
#include "capture/capture.h"
#include "scene/scene.h"

namespace relamp::test {

/// `shown(hit, point, direction)`: radiance of what a pixel's ray hits, or of the sky where `hit` is none.
template <class Shown>
View pointPhotograph(const Scene& scene, const Camera& camera, Shown&& shown) {
    View view;
    view.camera = camera;
    view.image = Image(camera.width, camera.height);
    const Vec3 eye(camera.position());
    for (int y = 0; y < camera.height; ++y)
        for (int x = 0; x < camera.width; ++x) {
            const Vec3 direction = camera.rayDirection({float(x) + 0.5f, float(y) + 0.5f});
            const Hit hit = scene.tracer->closest({eye, direction, 0, 1e30f});
            view.image.at(x, y) = shown(hit, eye + direction * hit.distance, direction);
        }
    return view;
}

}  // namespace relamp::test
