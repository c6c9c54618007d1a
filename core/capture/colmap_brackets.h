// Brackets among the photographs of a COLMAP model, or of another program's cameras, by how files are named.
#pragma once
#include <filesystem>
#include <vector>

#include "capture/colmap.h"
#include "capture/transforms_json.h"

namespace relamp {

/// A registered view, and its exposures where there are at least two (absolute paths).
struct ColmapBracket {
    ColmapView view;
    std::vector<Exposure> exposures;
};

/// Exposures of the view STEM.EXT are the images of the same ending STEM_evN.EXT beside it, N a number of stops with
/// or without sign and fraction (IMG_7_ev-2.JPG, IMG_7_ev+1.5.JPG); STEM.EXT itself counts as +0 where it exists.
/// Registered images that differ in nothing but _evN are one view: that nearest to +0 is kept. Exposure times are
/// EXIF's; where one image of a view has none, the stops are taken for all of it, a second at +0. In the order of the
/// views; exposures from the shortest by name.
std::vector<ColmapBracket> colmapBrackets(const std::filesystem::path& images, const std::vector<ColmapView>& views);

}  // namespace relamp
