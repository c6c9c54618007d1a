// Small images of views and environments for the panels. Files are read in the background.
#pragma once
#include <memory>

#include "editor.h"
#include "image/image.h"

namespace relamp::ui {

/// Texture of a view's photograph, all views at one exposure; 0 without a window.
uint64_t viewImage(const Document& document, size_t view);

/// The file's name within `width` pixels: whole, else without its ending, else the end of that, which tells numbered
/// files apart.
std::string captionOf(const std::filesystem::path& file, float width);

/// A photograph as large as a dialog shows it, at most 2048 pixels. It is made in the background, and kept until
/// dropPhotographs().
struct PhotographImage {
    uint64_t texture = 0;
    int width = 0, height = 0;  ///< pixels of the photograph itself; 0: not known yet
    bool loading = false;
    std::string error;  ///< why the file cannot be shown
};
PhotographImage viewPhotograph(const Document& document, size_t view);
PhotographImage filePhotograph(const std::filesystem::path& file);
/// Frees them: they are large.
void dropPhotographs();

struct EnvironmentImage {
    uint64_t texture = 0;
    bool loading = false;
    std::string error;  ///< why the file cannot be shown
};
EnvironmentImage recoveredEnvironmentImage(const std::shared_ptr<const Estimate>& estimate,
                                           const EnvironmentLook& look);
/// Of a file; the first call starts to read it.
EnvironmentImage environmentImage(const std::filesystem::path& file);

/// Display values (sRGB, 0 to 1) of a linear image, at most `longestSide` pixels, exposed so that its brightest
/// percent just clips unless `exposure` is given.
Image displayImage(const Image& linear, int longestSide, float exposure = 0);

}  // namespace relamp::ui
