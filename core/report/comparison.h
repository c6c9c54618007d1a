// What both modes found on one capture, with the images that show it: what the comparison page is made from.
#pragma once
#include <array>
#include <string>
#include <vector>

#include "base/progress.h"
#include "capture/capture.h"
#include "image/image.h"
#include "scene/scene.h"
#include "shot/shot_file.h"

namespace relamp {

/// One solve. Index 0 is near-field, 1 is distant-only, everywhere in this room.
struct ComparedMode {
    std::string name;      ///< "near-field"
    Shot shot;             ///< without photographs; timeline in seconds from the start of this solve
    double psnr = 0;       ///< dB, display values over all compared views
    double worstPsnr = 0;  ///< of one view
    std::string worstView;
    std::vector<double> psnrOfState;  ///< dB, of the compared views of each lighting state
    double tintDegrees = 0;           ///< mean angle between albedo and grey
    Image environment;                ///< 512 x 256, exposed
    Image emittersOff, white;         ///< in the first view, exposed
};

/// One view with images, exposed and ready to be encoded.
struct ComparedView {
    std::string name, state;  ///< lighting state; empty: there is one
    Image photograph;
    std::array<Image, 2> model, difference, albedo, tint;
    std::array<double, 2> psnr{};
};

struct Comparison {
    std::string capture;  ///< name of its folder
    size_t views = 0, vertices = 0, triangles = 0;
    std::vector<std::string> states;  ///< lighting states of the photographs; empty: there is one
    std::string stateShown;           ///< of those, that of the images without edits of one view
    size_t measuredViews = 0;         ///< views the figures are taken over
    std::array<ComparedMode, 2> modes;
    std::vector<ComparedView> shown;
    float environmentStops = 0, offStops = 0;  ///< exposure against the first view's photograph
};

/// Renders both modes from the capture's cameras and fills everything of `comparison` that is an image or measured on
/// one. `capture` has its photographs, `scene` is its geometry. At most 12 views are measured and `maxViews` shown,
/// spread evenly. Cost: a frame of at most 400 x 400 pixels, 4 positions a pixel, a view and mode. Throws Cancelled.
void drawComparison(const Capture& capture, const Scene& scene, int maxViews, Comparison& comparison,
                    Progress& progress);

/// The page. Pure: the same comparison gives the same bytes.
std::string comparisonPage(const Comparison& comparison);

}  // namespace relamp
