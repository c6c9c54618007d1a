// Estimates and cameras put together by hand.
#pragma once
#include <functional>

#include "capture/capture.h"
#include "relight/relit_scene.h"
#include "support/shapes.h"

namespace relamp::test {

/// Lambert everywhere, the environment constant, the emitters as given (their vertices reflect nothing).
Estimate matteEstimate(const Scene& scene, const Rgb& albedo, const Rgb& environment,
                       const EmitterClusters& clusters = {});

RelitScene relitOf(const Scene& scene, const Estimate& estimate, const Look& look = {});

/// A pinhole camera at `eye` that looks at `target`.
Camera cameraAt(const DVec3& eye, const DVec3& target, int width, int height, double focalPixels,
                const DVec3& upHint = {0, 0, 1});

/// A photograph of the scene with edges as a lens sees them, 16 rays a pixel; `radiance` of what a ray hits.
View photographOf(const Scene& scene, const Camera& camera, const std::function<Rgb(const Hit&)>& radiance);

Mat4 translation(const Vec3& by);

}  // namespace relamp::test
