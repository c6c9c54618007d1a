// Range images become one mesh.
#pragma once
#include "image/image.h"
#include "scan/range_image.h"
#include "scene/mesh.h"

namespace relamp {

struct RangeMeshOptions {
    size_t triangles = 300'000;  ///< about how many at most: then only every second pixel, every third ... is a vertex
    double slope = 6;            ///< steeper steps of distance are gaps, in pixels' sizes a pixel
    double leastIsland = 2e-4;   ///< pieces with less of all triangles are dropped
};

/// A smoothed range image with its camera.
struct RangeView {
    const Camera* camera = nullptr;
    const RangeImage* range = nullptr;
    double noise = 0;  ///< of its distances, metres
};

struct RangeMesh {
    Mesh mesh;  ///< metres, the axes of the calibration; faces turned towards the cameras
    int step = 1;
    size_t droppedIslands = 0;
};

/// Triangles between neighbouring pixels, not across steps of distance. Of a later view only what no view before it
/// holds is added. Cost: linear. Throws Error where no triangle is left, Cancelled.
RangeMesh meshRanges(const std::vector<RangeView>& views, const RangeMeshOptions& options, Progress& progress);

/// White where the camera sees the mesh. Throws Cancelled.
Image coverageOf(const Mesh& mesh, const Camera& camera, Progress& progress);

}  // namespace relamp
