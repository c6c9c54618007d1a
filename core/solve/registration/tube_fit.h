// A straight tube where photographs show its two sides. Meshes make thin posts 5 to 15 % too thick or too thin.
#pragma once
#include <optional>

#include "base/progress.h"
#include "capture/capture.h"
#include "scene/scene.h"
#include "scene/straight_tube.h"

namespace relamp {

/// The tube near `start` that explains best what photographs show across it: background, tube and background, each
/// smooth, with blurred steps between them. The axis' two ends and the radius are free; a coordinate search of a robust
/// sum over places along the tube and views. `floor`: radiance that counts as dark. None where fewer than 60 profiles
/// show the tube, or where a tube a quarter thicker or thinner explains them nearly as well; 1.6 times where the radius
/// of `start` is off by more. O(places x views); about a second. Throws Cancelled.
std::optional<StraightTube> fitTube(const Capture& capture, const Scene& scene, const StraightTube& start, float floor,
                                    const Progress& progress);

}  // namespace relamp
