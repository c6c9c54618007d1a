// A surface whose outlines lie where the photographs show them.
#pragma once
#include <string>

#include "base/progress.h"
#include "capture/registration_fix.h"
#include "scene/scene.h"
#include "solve/registration/contour_points.h"

namespace relamp {

/// What is 0.1 to 0.2 pixels on exact meshes.
constexpr double closeEnough = 0.3;
constexpr size_t leastPoints = 200;
/// Of what outlines are off by, that may be left: where photographs agree on the surface better as it is, outlines
/// alone have to tell clearly. Rims that fade into the dark leave 0.8 on an exact mesh.
constexpr double outlinesAlone = 0.7, outlinesBesides = 0.85;

struct ContourEstimate {
    RegistrationFix fix;            ///< all of it, what it started from included
    size_t points = 0;              ///< outlines that photographs show
    double before = 0, after = 0;   ///< median distance of the outlines of views that were left out, pixels
    double most = outlinesBesides;  ///< of `before`, that may be left
    /// Whether outlines lie clearly nearer to the photographs'.
    bool needed() const { return points >= leastPoints && before > closeEnough && after < most * before; }
};

/// "outlines of the mesh lie 0.45 pixels from the photographs' (1.30 before)".
std::string toText(const ContourEstimate& estimate);

/// Moves the surface, after `start`, so that its outlines lie where photographs show them; nodes are 0.4 % of the
/// diagonal apart. A displacement d along the normal moves an outline outwards by d times the focal length over the
/// distance, so each point measures d where two photographs cannot: where the surface turns away from them. Every
/// fourth view is left out at first. Poses stay: outlines that a reconstruction rounds off would turn them. `vertices`:
/// the first of the mesh, that may move. `emits`: per vertex 1 where an emitter lies, which room 4 gives its shape;
/// empty: nowhere. `floor`: radiance that counts as dark. `most`: see ContourEstimate. 1 to 4 s. Throws Cancelled.
ContourEstimate alignContours(const Capture& capture, const Scene& scene, const RegistrationFix& start, size_t vertices,
                              const std::vector<uint8_t>& emits, float floor, Progress& progress,
                              double most = outlinesBesides);

/// Outlines of the mesh after `fix` that photographs show within a pixel. Errors that photographs share, such as
/// reflections that move with the eye, may let poses or shapes agree that are wrong; outlines are not among them.
/// `floor`: radiance that counts as dark. 0.5 to 2 s. Throws Cancelled.
size_t outlinesInPlace(const Capture& capture, const Scene& scene, const RegistrationFix& fix, float floor,
                       Progress& progress);

}  // namespace relamp
