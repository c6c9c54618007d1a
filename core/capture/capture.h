// What an artist brings: photographs with cameras, and a mesh. The first product; never changes afterwards.
#pragma once
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "capture/camera.h"
#include "capture/proxy_light.h"
#include "image/image.h"
#include "image/image_io.h"
#include "scene/mesh.h"

namespace relamp {

/// One photograph with its camera, linear Rec.709 radiance up to the gauge.
struct View {
    std::string name;  ///< file name as in transforms.json or COLMAP's model
    std::filesystem::path file;
    Camera camera;
    Image image;  ///< `usable` marks masked, NaN, Inf and negative pixels as 0
    ImageReport imageReport;
    float saturation = 0;  ///< radiance at and above which a pixel counts as clipped; 0: the file has no clip level
    uint32_t state = 0;    ///< in Capture::states, the lighting state it was taken in
};

/// What a COLMAP model says of its own fit; absent for other captures.
struct ReconstructionFigures {
    size_t points = 0, observations = 0;
    double errorPixels = 0;        ///< mean reprojection error of the points, computed with our lens models
    double statedErrorPixels = 0;  ///< the same as the model states it
    size_t behind = 0;             ///< observations that do not project at all
};

/// How the files of a capture were read, where they can be meant in several ways (CaptureFix).
struct ReadAs {
    double meshScale = 1;                ///< units of the cameras one unit of the mesh is long
    std::string meshUp{};                ///< as told
    bool flipCameras = false;            ///< the matrices have the other axes than their format says
    std::string mirror{}, meshMirror{};  ///< "x", "y", "z": axis of the files that was reversed
    bool leftHanded = false;             ///< the matrices mirror, so that `mirror` reverses the world alone
    Mat3 worldFromMesh{1};               ///< the turn of the mesh, after its mirroring
};

/// Photographs, cameras, mesh.
struct Capture {
    std::filesystem::path folder;
    DVec3 origin{
        0};  ///< where positions of mesh, cameras, points and proxies count from, metres, Z up: 0 unless the capture
             ///< lies far from its own origin. What leaves relamp or comes in has it added or taken off
    std::vector<View> views;          ///< in the order of transforms.json, COLMAP's by name; --camera N counts from 0
    std::vector<std::string> states;  ///< names of the lighting states of the photographs; empty: there is one
    /// Per state the number of its environment, in the order of states, -1: it has none; empty: all states share one.
    std::vector<int> environmentOfState;
    Mesh mesh;
    MeshReport meshReport;
    /// Faces of the mesh's file that have texture coordinates, by their vertices. Null where none has.
    std::shared_ptr<const std::vector<TexturedFace>> texcoords;
    std::shared_ptr<const MeshPaint>
        paint;                 ///< how the mesh's file paints it (capture/mesh_colours.h); null: it says nothing
    Vec3 up{0, 0, 1};          ///< axis of the files that is up; mesh and cameras here are turned so that it is +Z
    Mat3 worldFromFile{1};     ///< that turn
    double metresPerUnit = 1;  ///< how long one unit of the files is; cameras and mesh here are in metres
    std::string format;        ///< of the cameras, as captureFormats() names it; empty: not read from files
    ReadAs readAs;
    std::optional<ReconstructionFigures> reconstruction;
    std::vector<DVec3> points;        ///< up to 20000 of a reconstruction's points, turned and scaled as the mesh is
    std::vector<ProxyLight> proxies;  ///< the last proxyTriangles of the mesh for each, in this order
    std::vector<std::string> notes;   ///< what was masked, repaired or ignored, one sentence each
};

}  // namespace relamp
