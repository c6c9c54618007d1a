// Near-field against distant-only, side by side: one HTML page with images and figures.
#pragma once
#include <filesystem>
#include <string>

#include "base/progress.h"
#include "capture/orientation.h"
#include "solve/solve.h"

namespace relamp {

struct CompareOptions {
    SolveOptions solve;
    std::string quality = "standard";  ///< what `solve` was made from, for the shots' description
    CaptureFix fix{};                  ///< how the capture's files are to be read
    int maxViews = 3;                  ///< views with images
};

/// Solves the capture in both modes, renders views, writes DIR/index.html (images embedded, nothing else needed) and
/// both shots, DIR/near-field.relamp and DIR/distant-only.relamp (replaced when they exist). Returns the page. Throws
/// as runPipeline and saveShot.
std::filesystem::path writeComparison(const std::filesystem::path& capture, const std::filesystem::path& folder,
                                      const CompareOptions& options, Progress& progress);

}  // namespace relamp
