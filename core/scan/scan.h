// The door of the room: photographs of projected Gray codes become points, a mesh, and the projector's place.
#pragma once
#include "image/image.h"
#include "scan/range_mesh.h"
#include "scan/resection.h"
#include "scan/scan_calibration.h"

namespace relamp {

struct ScanOptions {
    ScanBits bits{};                     ///< 0: by the number of photographs
    std::array<int, 2> projectorSize{};  ///< pixels; 0: of the calibration, else as many as the bits have
    double mostGap = 0;  ///< metres by which rays may miss each other; 0: four times their median, two pixels at least
    RangeMeshOptions mesh{};
    DecodeOptions decode{};
    size_t maxPixels = size_t(1) << 26;  ///< of a photograph
};

/// Where photographs come from: the files, or what a test paints. One for each camera.
using ScanInput = std::vector<PatternStack>;

/// What was found of one camera.
struct ScanCameraFigures {
    std::string name;
    size_t pixels = 0, lit = 0, decoded = 0, coarse = 0;
    size_t matched = 0;         ///< that another camera sees too, within the allowed gap
    size_t points = 0;          ///< with a place in space
    size_t filled = 0;          ///< between such pixels, with one from those around them
    double medianGap = 0;       ///< metres, to the other cameras; 0: there are none
    double projectorGap = 0;    ///< metres, to the projector; 0: it is not known
    double noise = 0;           ///< of distances, metres, before smoothing
    float photographNoise = 0;  ///< relative
    float global = 0;           ///< median fraction of indirect light in white
    float slope = 0;            ///< projector pixels from a pixel to the next
    LostBits lost;
};

/// How the projector is known.
enum class ProjectorFrom { nowhere, calibration, resection };

struct ScanResult {
    ScanBits bits{};
    std::array<int, 2> projectorSize{};
    std::vector<ScanCameraFigures> cameras;
    std::vector<DecodedView> views;
    std::vector<RangeImage> ranges;
    ProjectorFrom projectorFrom = ProjectorFrom::nowhere;
    std::optional<Camera> projector;  ///< metres, axes of the calibration
    Resection resection;              ///< where it was tried; the reason why the projector is not known
    RangeMesh mesh;
    std::vector<std::string> notes;  ///< what is missing or left out, one sentence each
    double seconds = 0;
};

/// Decodes every camera, triangulates by all pairs, calibrates the projector from points of two cameras where the
/// calibration does not know it, triangulates again with it, smooths and meshes. Throws Error naming camera and
/// photograph; Cancelled. Cost: 1 us a pixel and photograph, and 20 us a pixel. Same bits on any number of threads.
ScanResult scanSurface(const ScanCalibration& calibration, const ScanInput& input, const ScanOptions& options,
                       Progress& progress);

/// The stacks of the calibration's folders; `options.bits` are filled in. Throws Error naming the folder.
ScanInput openScan(const ScanCalibration& calibration, ScanOptions& options, std::vector<ScanPhotographs>& photographs);

}  // namespace relamp
