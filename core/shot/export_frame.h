// One frame on disk (docs/interface.md 5): EXR with light groups and layers, or an image to look at. Rendered and
// written strip by strip, so that its size is not bounded by memory.
#pragma once
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>

#include "image/image_region.h"
#include "relight/frame.h"
#include "shot/frame_jobs.h"
#include "shot/frame_layers.h"
#include "shot/ratio_frame.h"

namespace relamp {

class OtherPhotographs;

/// What PNG and JPEG show of scene-linear radiance.
enum class DisplayView {
    standard,   ///< exposed by one stop-factor, clipped, sRGB curve
    automatic,  ///< the same, exposed so that the 99th percentile of the photograph (else of the frame's first strip)
                ///< is white
    raw         ///< clipped, no curve
};

/// Throws BadOption when `name` is none of standard, auto, raw.
DisplayView displayView(const std::string& name);

/// How an EXR is packed.
struct ExrFormat {
    std::string compression = "zip";  ///< one of exrCompressions
    bool floats = false;              ///< colours as float; false: as half, data as float
    bool operator==(const ExrFormat&) const = default;
};
inline constexpr const char* exrCompressions[] = {"none", "rle", "zips", "zip", "piz", "pxr24", "dwaa", "dwab"};
/// Whether values come back as they were: all but pxr24, dwaa and dwab.
bool isLossless(const ExrFormat& format);

/// Throws BadOption when `depth` is neither half nor float, or `compression` none of those above, or one that would
/// change the numbers of a Cryptomatte among `layers`.
ExrFormat exrFormat(const std::string& compression, const std::string& depth, const std::string& layers);

struct FrameFileOptions {
    std::string layers;  ///< "", "all", or names (frame_layers.h)
    LayerNaming naming = LayerNaming::blender;
    bool multipart = false;
    Ratio ratio = Ratio::none;
    DisplayView view = DisplayView::standard;
    std::map<std::string, std::string> header;  ///< more entries for the EXR's header
    /// In place of `view`: turns scene-linear radiance into the values of PNG and JPEG, in [0, 1], in place.
    std::function<void(Rgb* pixels, size_t count)> display{};
    ExrFormat exr{};
};

/// What a frame is made from. `captured` and `photograph` may be null: without them there is no residual and no ratio,
/// and the correction is that of the look.
struct FrameSources {
    const RelitScene* look = nullptr;
    const RelitScene* captured = nullptr;      ///< the light as photographed; may be the same scene as `look`
    const Image* photograph = nullptr;         ///< of the camera, at its size
    const OtherPhotographs* others = nullptr;  ///< in its place, for ratio frames: those of other cameras
    const Image* finished = nullptr;           ///< the beauty, relit already (a plate): light groups are scaled to it
    float saturation = 0;                      ///< of the photograph: clipped from here on; 0: none
    DVec3 origin{0};                           ///< Capture::origin: added to positions and the header's cameras
};

/// Renders and writes the frame, whole or not at all. EXR: root RGBA and the layers asked for; PNG, JPEG, HDR: the
/// beauty. Returns the largest difference between the beauty and the sum of its groups (a ratio frame: groups + rest),
/// relative to the brightest value. Memory: about 400 bytes for each of half a million pixels, whatever the size (with
/// 3 emitters); time: the rendering, twice when the captured light is needed beside the look's. Bits do not depend on
/// threads. Throws BadOption when a layer or ratio needs a photograph and there is none, Error, OutOfResources,
/// Cancelled.
double writeFrameFile(const std::filesystem::path& file, const Camera& camera, const FrameSources& sources,
                      const FrameOptions& options, const FrameFileOptions& fileOptions, Progress& progress);

/// Throws BadOption when `layers` names one that does not exist.
void checkLayers(const std::string& layers);

/// The same for a frame that is rendered already: root RGBA and the layers it can give (no residual; the correction is
/// that of the frame's own light). Of `how` PNG and JPEG take `view` and `display`, EXR `exr`. With a `region` the
/// frame is that part of the camera's image: EXR keeps it in its place (data window in display window), PNG and JPEG
/// hold it alone.
double writeFrame(const std::filesystem::path& file, const Frame& frame, const RelitScene& relit, const Camera& camera,
                  const std::string& layers, const DVec3& origin = DVec3(0), const std::optional<ImageBox>& region = {},
                  const FrameFileOptions& how = {});

/// worldToCamera and worldToNDC for an EXR's header, as 16 numbers each, rows times matrix as OpenEXR has it. Camera
/// axes: +X right, +Y up, looks down -Z; NDC in [-1, 1], y up, z from -1 (1 cm) to 1 (1 km); distortion is left out.
std::map<std::string, std::string> cameraHeader(const Camera& camera);

}  // namespace relamp
