// Cameras and mesh brought together by what the photographs show.
#pragma once
#include <string>

#include "base/progress.h"
#include "solve/registration/contour_fit.h"
#include "solve/registration/registration_fit.h"

namespace relamp {

struct RegistrationEstimate {
    /// Not empty: cameras are off by so much that what they see has to be found anew with these poses, and all else
    /// after that.
    std::vector<PoseFix> farPoses;
    double farPixels = 0;                ///< root mean square of what the mesh moves by under them
    double farBefore = 0, farAfter = 0;  ///< misfit without and with them, as `before`; 0: not tried
    RegistrationFix fix;
    double before = 0, after = 0;            ///< misfit in regions that are left out: mean loss, squared log luminance
    double pixels = 0;                       ///< root mean square of what the mesh moves by in the photographs
    double displacement = 0;                 ///< root mean square, of the diagonal
    double viewsBefore = 0, viewsAfter = 0;  ///< misfit of views left out without and with another shape; 0: not tried
    bool outlinesLost = false;  ///< the other shape takes outlines from where photographs show them: given up
    ContourEstimate contours;   ///< its fix is moved to `fix`
    /// Whether photographs agree better (exact captures: by -1 to 1 %), by what can be seen (a thousandth of the
    /// luminance), and with a motion of more than a third of a pixel.
    bool moved() const { return after < 0.97 * before && before > after + 1e-6 && pixels > 0.35; }
    /// Whether another shape lets the views that were left out agree clearly better, and keeps outlines.
    bool reshaped() const { return viewsAfter < 0.9 * viewsBefore && !outlinesLost; }
    bool needed() const { return moved() || reshaped() || contours.needed(); }
};

/// "the photographs agree 32 % better with cameras moved by 0.65 pixels and the mesh by 0.02 % of its diagonal".
std::string toText(const RegistrationEstimate& estimate);
/// "cameras stand 14.3 pixels from where photographs agree 78 % better: moved there".
std::string farText(const RegistrationEstimate& estimate);

struct RegistrationTask {
    size_t vertices = 0;             ///< the first of the mesh, that may move
    bool shape = true;               ///< false holds them
    bool farCameras = true;          ///< whether cameras may be off by a hundredth of the photographs' width
    bool afterFar = false;           ///< whether they were, and may still be off by a third of that
    std::vector<uint8_t> emits{};    ///< see alignContours
    std::vector<uint8_t> mirrors{};  ///< see choosePlaces
};

/// What mirrors is left out. From blurred photographs to sharp ones, first with every other region left out; where that
/// is needed, once more with all. Where photographs differ by more than 3 % then, cameras that are far off are looked
/// for, then a shape at large, with every fourth view left out; neither may take outlines from where photographs show
/// them. In the end outlines are brought to where photographs show them (solve/registration/contour_fit.h). Photometric
/// refinement of poses and surface as in [Schops17], differences between near places in the place of patches'
/// descriptors. Cost: see RegistrationFit, 1 to 5 s for ten photographs. Ends early when the time is out. Throws
/// Cancelled.
RegistrationEstimate estimateRegistration(const Capture& capture, const Scene& scene, const RadianceSamples& samples,
                                          const RegistrationTask& task, Progress& progress);

}  // namespace relamp
