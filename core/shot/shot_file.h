// The project folder NAME.relamp: open formats, written whole, opened even when a stage is missing.
#pragma once
#include <filesystem>
#include <nlohmann/json_fwd.hpp>

#include "base/input_files.h"
#include "base/progress.h"
#include "capture/capture.h"
#include "capture/orientation.h"
#include "relight/look.h"
#include "scene/scene.h"
#include "shot/shot_places.h"
#include "solve/estimate.h"

namespace relamp {

struct Resources {
    double seconds = 0;
    double peakMib = 0;
    int threads = 0;
};

/// A shot in memory.
struct Shot {
    std::filesystem::path folder;
    std::filesystem::path captureFolder;
    Capture capture;  ///< cameras and mesh; photographs only when asked for; to save a shot its origin is enough
    Estimate estimate;
    CaptureFix fix;  ///< how the capture's files are to be read
    Look look;
    std::string quality = "standard";
    uint64_t seed = 1;
    Resources resources;
};

/// Peak resident memory of this process, MiB.
double peakMib();

/// What shot.json holds beside the look, the seed and how to find and read the capture.
nlohmann::json shotInfo(const Shot& shot);

/// Writes shot.json, environment.exr (float, 1024 x 512), reflectance.ply, albedo.exr into a new folder beside the
/// target and exchanges the two, so that the old shot stays whole until the new one is. Unknown keys of an existing
/// shot.json are kept. A link to a shot stays a link: the shot it leads to is replaced. Throws Error when the folder
/// exists and `overwrite` is false; OutOfResources when the disk is full. A process killed in the middle leaves a
/// hidden folder beside the shot, which the next saveShot or openShot clears away.
void saveShot(const Shot& shot, const Mesh& mesh, const std::filesystem::path& folder, bool overwrite);

/// Throws Error when saveShot would find no place there that this user may write, or something that is no shot, or a
/// file of `inputs` to replace: asked before a long calculation.
void checkShotCanBeWritten(const std::filesystem::path& folder, const InputFiles& inputs = {});

/// Every file that an opened shot was read from, its capture's too. Throws Error as openShot does.
InputFiles shotFiles(const Shot& shot, Progress& progress);

/// Opens a shot, after setting right what a killed save left beside it. `places` says where things are that are not
/// where shot.json says. Throws Error naming file and field.
Shot openShot(const std::filesystem::path& folder, bool withImages, Progress& progress, const ShotPlaces& places = {});

}  // namespace relamp
