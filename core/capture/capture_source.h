// What the files of a capture folder say before images and mesh are opened, whichever format they have.
#pragma once
#include <optional>
#include <span>

#include "base/progress.h"
#include "capture/capture.h"
#include "capture/orientation.h"
#include "capture/transforms_json.h"

namespace relamp {

/// One photograph before it is read.
struct FrameSource {
    std::string where;  ///< for errors: "transforms.json: frame 3"
    std::string name;
    std::filesystem::path file;
    Camera camera;
    std::vector<Exposure> exposures;
    bool fitSize = false;             ///< an image of the same shape and another size scales the camera
    std::filesystem::path mask = {};  ///< that the file names; empty: those of the usual names
    std::string state = {};           ///< lighting state that the file names; empty: none
    uint32_t stateIndex = 0;          ///< in CaptureSource::states
};

struct CaptureSource {
    std::string where = "transforms.json";  ///< for errors
    std::vector<FrameSource> frames;
    std::vector<std::string> states;                ///< lighting states; empty: none is named
    std::vector<StateEnvironment> environments;     ///< that the file names for states
    std::vector<int> environmentOfState;            ///< see Capture
    std::string format;                             ///< CaptureFormat::name
    std::filesystem::path cameras;                  ///< the file or folder that holds them
    std::vector<std::filesystem::path> otherFiles;  ///< read beside it: lists, frames, where the mesh was aligned to
    std::filesystem::path mesh;
    Vec3 up{0, 0, 1};
    bool leftHanded = false;  ///< the matrices mirror; the cameras here have CaptureFix::mirror's axis reversed
    std::vector<std::string> notes;
    std::optional<ReconstructionFigures> reconstruction;
    std::vector<DVec3> points;
};

/// Reads the first format of captureFormats() that FOLDER holds, or the one whose place `fix` names. Throws Error
/// naming file and field.
CaptureSource captureSource(const std::filesystem::path& folder, const CaptureFix& fix, Progress& progress);

/// The image a file_path names: relative to the capture folder, backslashes allowed, and, as in some NeRF data sets,
/// without its ending. Where nothing is found the path is returned as written, for the error message.
std::filesystem::path findImage(const std::filesystem::path& folder, const std::string& filePath);

/// The mesh in the first of these places that has one: mesh.ply, .obj, .glb, .gltf, .stl or .off, else one of `names`.
std::optional<std::filesystem::path> findMeshIn(std::span<const std::filesystem::path> places,
                                                std::span<const char* const> names = {});

/// What is up where no file says it: from how the cameras were held (guessUp), or the axis within two degrees of that.
Vec3 upOfCameras(const std::vector<Camera>& cameras);

/// A place the user names: in the capture folder, in the current one, or absolute.
std::filesystem::path placeOf(const std::filesystem::path& folder, const std::string& named);

}  // namespace relamp
