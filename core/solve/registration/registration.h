// Cameras and mesh brought together by what the photographs show.
#pragma once
#include <string>

#include "base/progress.h"
#include "solve/registration/contour_fit.h"
#include "solve/registration/registration_fit.h"

namespace relamp {

struct RegistrationEstimate {
    RegistrationFix fix;
    double before = 0, after = 0;            ///< misfit in regions that are left out: mean loss, squared log luminance
    double pixels = 0;                       ///< root mean square of what the mesh moves by in the photographs
    double displacement = 0;                 ///< root mean square, of the diagonal
    double viewsBefore = 0, viewsAfter = 0;  ///< misfit of views left out without and with another shape; 0: not tried
    ContourEstimate contours;                ///< its fix is moved to `fix`
    /// Whether photographs agree better (exact captures: by -1 to 1 %), by what can be seen (a thousandth of the
    /// luminance), and with a motion of more than a third of a pixel.
    bool moved() const { return after < 0.97 * before && before > after + 1e-6 && pixels > 0.35; }
    /// Whether another shape lets the views that were left out agree clearly better.
    bool reshaped() const { return viewsAfter < 0.9 * viewsBefore; }
    bool needed() const { return moved() || reshaped() || contours.needed(); }
};

/// "the photographs agree 32 % better with cameras moved by 0.65 pixels and the mesh by 0.02 % of its diagonal".
std::string toText(const RegistrationEstimate& estimate);

/// From blurred photographs to sharp ones, first with every other region left out; where that is needed, once more with
/// all. Where photographs differ by more than 3 % then, a shape at large is tried with every fourth view left out. In
/// the end outlines are brought to where photographs show them (solve/registration/contour_fit.h). `vertices`: the
/// first of the mesh, that may move; `shape`: false holds them. `emits`: see alignContours. Photometric refinement of
/// poses and surface as in [Schops17], differences between near places in the place of patches' descriptors. Cost: see
/// RegistrationFit, 1 to 5 s for ten photographs. Ends early when the time is out. Throws Cancelled.
RegistrationEstimate estimateRegistration(const Capture& capture, const Scene& scene, const RadianceSamples& samples,
                                          size_t vertices, bool shape, const std::vector<uint8_t>& emits,
                                          Progress& progress);

}  // namespace relamp
