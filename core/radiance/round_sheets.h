// Surfaces that photographs show and the mesh lacks: thin sheets whose two sides cancelled in a reconstruction.
#pragma once
#include <vector>

#include "base/progress.h"
#include "capture/capture.h"
#include "radiance/samples.h"
#include "scene/revolution_surface.h"

namespace relamp {

/// What completes a surface of the mesh: a thin shell, because its two sides may differ.
struct SurfacePatch {
    std::vector<Vec3> positions;
    std::vector<Triangle> triangles;  ///< of `positions`
    std::vector<uint32_t> replaced;   ///< triangles of the scene: shreds in the patch's place, ascending
    float area = 0;                   ///< m2, of one side
};

/// A surface of revolution (shade, tin, post) of which the mesh has a third.
struct RoundSheet {
    RevolutionSurface surface;
    double low = 0, high = 0;  ///< metres: heights between which the mesh has it
    SurfacePatch missing;      ///< what completes it; often empty
};

/// The round sheets of a mesh, completed as far as photographs show them: what they show there differs from what other
/// photographs show behind, and agrees between views of one side. O(trials x vertices + cells x views rays). Throws
/// Cancelled.
std::vector<RoundSheet> roundSheets(const Scene& scene, const Capture& capture, const RadianceSamples& samples,
                                    Progress& progress);

/// `triangles` and, where one of them lies within the sheet and faces its opening, all others that do: a reconstruction
/// fills a shade. Triangles with a vertex that `stays` are left out. Ascending; O(triangles).
std::vector<uint32_t> withFilling(const RoundSheet& sheet, const Scene& scene, const std::vector<uint8_t>& stays,
                                  const std::vector<uint32_t>& triangles);

/// The largest of the sheets that a ball of light stands in: its shade; null where there is none.
const RoundSheet* sheetAbout(const std::vector<RoundSheet>& sheets, const ProxyLight& ball);
/// Of all balls, each sheet once.
std::vector<const RoundSheet*> sheetsAbout(const std::vector<RoundSheet>& sheets, const std::vector<ProxyLight>& balls);

}  // namespace relamp
