// The open end of a round sheet, such as a shade's: a circle, where photographs show it.
#pragma once
#include <optional>

#include "capture/capture.h"
#include "capture/mesh_mend.h"
#include "scene/revolution_surface.h"

namespace relamp {

/// Height of the rim, metres along the surface's axis, near `guess`: the median over places around it and over views of
/// where photographs show a step across it. None where fewer than 40 places show one, or where they do not agree within
/// two pixels. `floor`: radiance that counts as dark.
std::optional<double> rimHeight(const Capture& capture, const Scene& scene, const RevolutionSurface& surface,
                                double guess, float floor);

/// Vertices on the surface that the rim moves: those beyond it come back to it, and those where the mesh ends before it
/// go on to it, within 1.5 % of the diagonal. Only the first `vertices` of the scene. `low`: the rim is the lower end.
/// Ascending.
std::vector<MeshMend::MovedVertex> evenRim(const Scene& scene, size_t vertices, const RevolutionSurface& surface,
                                           double height, bool low);

}  // namespace relamp
