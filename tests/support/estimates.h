// Estimates and cameras put together by hand.
#pragma once
#include "capture/camera.h"
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

Mat4 translation(const Vec3& by);

}  // namespace relamp::test
