// How an estimate stands against known truth: the folder of a rendered capture's truth (vertices.ply, env.exr,
// relight.json, masks/).
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "base/progress.h"
#include "scene/scene.h"
#include "shot/shot_file.h"

namespace relamp {

struct TruthFigure {
    std::string what, value, about;  ///< for a table
};

/// One relit image against the true one.
struct TruthEdit {
    std::string name, about;
    double psnr = 0;  ///< dB, display values inside the object mask, nothing divided out
};

struct TruthFigures {
    std::vector<TruthFigure> figures;
    std::vector<TruthEdit> edits;
    double meanPsnr = 0;  ///< dB over the edits that change something
};

/// What is there is measured: every file of the folder may be missing, but not all. Emitters are matched by their
/// centroids. Cost: a frame for each entry of relight.json, 4 samples a pixel. Throws Error naming file and field,
/// Cancelled.
TruthFigures truthFigures(const std::filesystem::path& folder, const Shot& shot, const Scene& scene,
                          Progress& progress);

}  // namespace relamp
