#include "capture/capture_formats.h"

#include <algorithm>

#include "base/is_there.h"
#include "capture/colmap.h"
#include "capture/formats/readers.h"

namespace relamp {
namespace fs = std::filesystem;
namespace {

/// The second is what NeRF's own data sets call the photographs to fit.
constexpr const char* transformsNames[] = {"transforms.json", "transforms_train.json"};

std::optional<fs::path> findTransforms(const fs::path& folder) {
    for (const char* name : transformsNames)
        if (isFile(folder / name)) return folder / name;
    return std::nullopt;
}

bool ownsTransforms(const std::string& name) {
    return std::find(std::begin(transformsNames), std::end(transformsNames), name) != std::end(transformsNames);
}

bool isFolder(const fs::path& path) {
    std::error_code ignored;
    return fs::is_directory(path, ignored);
}

/// Whether a folder has one called 0 to 99, as COLMAP numbers its models.
bool hasNumberedFolder(const fs::path& folder) {
    std::error_code failed;
    for (fs::directory_iterator at(folder, failed); !failed && at != fs::directory_iterator(); at.increment(failed)) {
        const std::string name = at->path().filename().string();
        const auto digit = [](char c) { return c >= '0' && c <= '9'; };
        if (name.size() <= 2 && std::all_of(name.begin(), name.end(), digit) && isFolder(at->path())) return true;
    }
    return false;
}

std::optional<fs::path> findColmap(const fs::path& folder) {
    // Most folders are no model: a browser asks about every row it shows, and the search tries hundreds of names.
    const bool possible = isFile(folder / "cameras.bin") || isFile(folder / "cameras.txt") ||
                          isFolder(folder / "sparse") || isFolder(folder / "colmap/sparse") ||
                          hasNumberedFolder(folder);
    return possible ? findColmapModel(folder) : std::nullopt;
}

bool ownsColmap(const std::string& name) {
    for (const char* part : {"cameras", "images", "points3D"})
        if (name == part + std::string(".bin") || name == part + std::string(".txt")) return true;
    return false;
}

/// The row of a foreign reader.
template <const ForeignReader& reader>
constexpr CaptureFormat rowOf(const char* name, const char* marks, const char* reading) {
    return {name,
            marks,
            reading,
            [](const fs::path& folder) { return reader.find(folder); },
            [](const std::string& fileName) { return reader.owns(fileName); },
            [](const fs::path& folder, const fs::path& cameras, const CaptureFix& fix, Progress& progress) {
                return sourceFromForeign(reader, folder, cameras, fix, progress);
            }};
}

const CaptureFormat formats[] = {
    {"transforms.json", "transforms.json", "Reading transforms.json", findTransforms, ownsTransforms,
     sourceFromTransforms},
    {"COLMAP model", "a COLMAP model (sparse/0)", "Reading the COLMAP model", findColmap, ownsColmap, sourceFromColmap,
     &CaptureFix::colmap},
    rowOf<metashapeReader>("Metashape cameras", "Metashape's XML", "Reading Metashape's cameras"),
    rowOf<meshroomReader>("Meshroom cameras", "Meshroom's .sfm", "Reading Meshroom's cameras"),
    rowOf<realityCaptureReader>("RealityCapture cameras", "RealityCapture's CSV", "Reading RealityCapture's cameras"),
    rowOf<bundlerReader>("Bundler cameras", "bundle.out", "Reading Bundler's cameras"),
    rowOf<openMvgReader>("OpenMVG cameras", "OpenMVG's JSON", "Reading OpenMVG's cameras"),
    rowOf<nvmReader>("VisualSFM cameras", "VisualSFM's NVM", "Reading VisualSFM's cameras"),
    rowOf<llffReader>("LLFF poses", "poses_bounds.npy", "Reading LLFF's poses"),
    rowOf<polycamReader>("Polycam scan", "a Polycam scan", "Reading the Polycam scan"),
    rowOf<record3dReader>("Record3D scan", "a Record3D scan", "Reading the Record3D scan"),
    rowOf<scannerAppReader>("3D Scanner App scan", "a 3D Scanner App scan", "Reading the 3D Scanner App scan"),
};

}  // namespace

std::span<const CaptureFormat> captureFormats() { return formats; }

std::optional<FoundCapture> findCapture(const fs::path& folder) {
    for (const CaptureFormat& format : formats)
        if (const auto cameras = format.find(folder)) return FoundCapture{&format, *cameras};
    return std::nullopt;
}

fs::path captureFolderOf(const fs::path& path) {
    const std::string name = path.filename().string();
    for (const CaptureFormat& format : formats) {
        if (!format.owns(name) || !isFile(path)) continue;
        fs::path folder = path.parent_path();
        const auto cameras = format.find(folder);
        if (!cameras) continue;
        // Images and mesh lie beside a model, not in it.
        fs::path around = folder;
        for (int up = 0; up < 3 && around.has_relative_path(); ++up) {
            around = around.parent_path();
            std::error_code different;
            if (const auto same = format.find(around); same && fs::equivalent(*same, *cameras, different))
                folder = around;
        }
        return folder;
    }
    return path;
}

std::string captureMarks() {
    std::string words;
    for (size_t i = 0; i < std::size(formats); ++i)
        words += std::string(i == 0 ? "" : i + 1 < std::size(formats) ? ", " : " or ") + formats[i].marks;
    return words;
}

}  // namespace relamp
