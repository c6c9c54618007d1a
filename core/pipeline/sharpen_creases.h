// Edges of boxes, plinths and walls, and lines along which objects stand on something: a reconstruction rounds them.
#pragma once
#include "base/progress.h"
#include "capture/capture.h"
#include "scene/scene.h"

namespace relamp {

struct SharpenedMesh {
    std::vector<Vec3> positions;  ///< metres, of each vertex
    std::vector<Vec3> sides;      ///< unit, of each vertex beside a crease: its side's normal; 0 of others
    bool empty() const { return sides.empty(); }
};

struct SharpenOptions {
    size_t vertices = 0;           ///< the first of the mesh: the file's own
    std::vector<uint8_t> lights;   ///< per vertex non-zero where a light is
    std::vector<uint8_t> leftOut;  ///< the same where nothing is to be sharpened, lights among it
    float floor = 0;               ///< radiance that counts as dark
};

/// Sharpens creases (scene/sharp_creases.h) and brings them and the outlines to where the photographs show them
/// (solve/registration/contour_fit.h, crease_fit.h). `places`: where the vertices are without what registration did to
/// outlines, which pushed what is rounded off out on either side; empty: where the scene has them. Empty where fewer
/// than 50 vertices lie beside creases. 2 to 6 s. Throws Cancelled.
SharpenedMesh sharpenedCreases(const Capture& capture, const Scene& scene, const std::vector<Vec3>& places,
                               const SharpenOptions& options, Progress& progress);

}  // namespace relamp
