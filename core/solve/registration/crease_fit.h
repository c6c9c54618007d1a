// Creases of a surface, such as where objects stand on a table, brought to where the photographs show them.
#pragma once
#include <string>
#include <vector>

#include "base/progress.h"
#include "capture/capture.h"
#include "scene/scene.h"
#include "scene/sharp_creases.h"

namespace relamp {

struct CreaseEstimate {
    std::vector<Vec3> positions;   ///< metres, of each vertex; empty: they stay
    size_t points = 0;             ///< places at which a photograph shows the crease
    double before = 0, after = 0;  ///< median distance of those in views that were left out, pixels
    /// Whether creases lie clearly nearer to the photographs'.
    bool needed() const;
};

/// "creases of the mesh lie 0.45 pixels from the photographs' (1.30 before)".
std::string toText(const CreaseEstimate& estimate);

/// Where a photograph shows both sides of a crease, radiance has a step along it (solve/registration/step_edge.h).
/// Either side moves along its normal, smoothly over its surface, and the crease follows: it stays where both sides
/// meet. Every fourth view is left out at first. `scene`: with sharp creases; its normals are those of the sides.
/// `still`: vertices whose side does not move (lights, surfaces that are flat). `vertices`: the first of the mesh, that
/// may move. `floor`: radiance that counts as dark. 1 to 3 s. Throws Cancelled.
CreaseEstimate alignCreases(const Capture& capture, const Scene& scene, const std::vector<CreaseVertex>& creases,
                            const std::vector<uint8_t>& still, size_t vertices, float floor, Progress& progress);

}  // namespace relamp
