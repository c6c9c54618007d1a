#include "radiance/background_cells.h"

#include <algorithm>
#include <cmath>

namespace relamp {

BackgroundCells backgroundCells(const View& view, const ViewGeometry& g, const DirectionGrid& grid) {
    BackgroundCells cells{std::vector<Rgb>(size_t(grid.cells()), Rgb(0)),
                          std::vector<uint32_t>(size_t(grid.cells()), 0)};
    for (int y = 1; y + 1 < g.height; ++y)
        for (int x = 1; x + 1 < g.width; ++x) {
            if (!view.image.usableAt(x, y) || !g.open(x, y)) continue;
            const auto cell = size_t(grid.cellOf(view.camera.rayDirection(Vec2(float(x) + 0.5f, float(y) + 0.5f))));
            cells.sum[cell] += view.image.at(x, y);
            ++cells.pixels[cell];
        }
    return cells;
}

float logDistance(const Rgb& radiance, const Rgb& low, const Rgb& high, float floor) {
    float sum = 0;
    for (int c = 0; c < 3; ++c) {
        const float shown = std::max(radiance[c], floor);
        if (shown > high[c]) sum += std::log(shown / std::max(high[c], floor));
        if (shown < low[c]) sum += std::log(std::max(low[c], floor) / shown);
    }
    return sum / 3;
}

}  // namespace relamp
