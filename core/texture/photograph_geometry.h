// What each pixel of a photograph sees, and how far from the edge of what it sees it lies.
#pragma once
#include "base/progress.h"
#include "capture/capture.h"
#include "scene/scene.h"

namespace relamp {

/// The triangles that rows of pixels see at their centres, as runs of pixels that see the same one. Few bytes a pixel.
class TriangleRuns {
public:
    /// Rows one after the other, each from left to right; `width` is at most 65536.
    void addRow(const uint32_t* triangles, size_t width);
    /// After the last row: gives back memory that was taken for more.
    void finish();
    bool empty() const { return rowStart_.empty(); }

    /// Goes along a row; pixels are asked for from left to right.
    class Row {
    public:
        Row(const TriangleRuns& runs, int y)
            : runs_(&runs), at_(runs.rowStart_[size_t(y)]), end_(runs.rowStart_[size_t(y) + 1]) {}
        uint32_t triangleAt(int x) {
            while (at_ + 1 < end_ && runs_->begin_[at_ + 1] <= x) ++at_;
            return runs_->triangle_[at_];
        }

    private:
        const TriangleRuns* runs_;
        size_t at_, end_;
    };

private:
    std::vector<size_t> rowStart_;
    std::vector<uint32_t> triangle_;
    std::vector<uint16_t> begin_;
};

struct PhotographGeometry {
    int width = 0, height = 0;
    std::vector<uint8_t> away;  ///< pixels to the nearest edge, 0 to 3; 0 where unusable or clipped too
    size_t surfacePixels = 0;   ///< that are not 0
    TriangleRuns triangles;     ///< where asked for

    /// Trust in a pixel, in [0, 1].
    float weight(int x, int y) const {
        constexpr std::array<float, 4> trust{0.0f, 0.05f, 0.4f, 1.0f};
        return trust[away[size_t(y) * size_t(width) + size_t(x)]];
    }
};

/// Of one view, without triangles. Cost, errors: as photographGeometry.
PhotographGeometry geometryOfView(const View& view, const Scene& scene, const std::vector<int>& emitterOfTriangle,
                                  Progress& progress);

/// One a view. Edges are where depth jumps, where the surface ends, and where an emitter begins. `density` becomes, per
/// vertex, pixels a metre in the view that sees it finest, 0 where none does; of large photographs some pixels tell it.
/// Cost: one ray a pixel. Memory: 1 B a pixel, 2 to 7 B with `keepTriangles`, 20 B while a view is looked at.
std::vector<PhotographGeometry> photographGeometry(const Capture& capture, const Scene& scene,
                                                   const std::vector<int>& emitterOfTriangle, bool keepTriangles,
                                                   std::vector<float>& density, Progress& progress);

}  // namespace relamp
