// What an artist brings: photographs with cameras, and a mesh. The first product; never changes afterwards.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "capture/camera.h"
#include "image/image.h"
#include "image/image_io.h"
#include "scene/mesh.h"

namespace relamp {

/// One photograph with its camera, linear Rec.709 radiance up to the gauge.
struct View {
    std::string name;            ///< file name as in transforms.json
    std::filesystem::path file;
    Camera camera;
    Image image;                 ///< `usable` marks masked, NaN, Inf and negative pixels as 0
    ImageReport imageReport;
    float saturation = 0;        ///< radiance at and above which a pixel counts as clipped; 0: the file has no clip level
};

/// Photographs, cameras, mesh.
struct Capture {
    std::filesystem::path folder;
    std::vector<View> views;     ///< in the order of transforms.json; --camera N counts from 0
    Mesh mesh;
    MeshReport meshReport;
    Vec3 up{0, 0, 1};            ///< axis of the files that is up; mesh and cameras here are turned so that it is +Z
    Mat3 worldFromFile{1};       ///< that turn
    std::vector<std::string> notes;  ///< what was masked, repaired or ignored, one sentence each
};

}  // namespace relamp
