#include "radiance/seen_past.h"

#include <cmath>

#include "base/parallel.h"
#include "radiance/background_cells.h"

namespace relamp {
namespace {

constexpr uint32_t leastPixels = 4;  ///< of a cell

}  // namespace

SeenPast::SeenPast(const Scene& scene, const Capture& capture, const RadianceSamples& samples)
    : scene_(scene),
      capture_(capture),
      samples_(samples),
      floor_(std::max(samples.noiseFloor, 1e-8f)),
      background_(capture.views.size()) {
    parallelFor(capture.views.size(), 1, [&](size_t i) {
        const BackgroundCells cells = backgroundCells(capture.views[i], samples.geometry[i], grid_);
        background_[i].assign(size_t(grid_.cells()), Rgb(-1));
        for (size_t cell = 0; cell < background_[i].size(); ++cell)
            if (cells.pixels[cell] >= leastPixels) background_[i][cell] = cells.mean(cell);
    });
}

std::optional<float> SeenPast::difference(size_t view, const Vec3& direction, float from, const Rgb& shown) const {
    Rgb low(1e30f), high(-1);
    const Vec3 eye(capture_.views[view].camera.position());
    if (const Hit hit = scene_.cameraTracer->closest({eye, direction, from, 1e30f})) {
        for (const uint32_t v : scene_.mesh.triangles[hit.triangle])
            for (uint32_t k = samples_.start[v]; k < samples_.start[v + 1]; ++k) {
                if (samples_.samples[k].view == view) continue;
                low = glm::min(low, samples_.samples[k].radiance);
                high = glm::max(high, samples_.samples[k].radiance);
            }
        if (high.x < 0) return {};
    } else {
        const int cell = grid_.cellOf(direction), x = cell % grid_.side, y = cell / grid_.side;
        for (int ny = std::max(0, y - 1); ny <= std::min(grid_.side - 1, y + 1); ++ny)
            for (int nx = std::max(0, x - 1); nx <= std::min(grid_.side - 1, x + 1); ++nx)
                for (size_t i = 0; i < background_.size(); ++i) {
                    const Rgb& seen = background_[i][size_t(ny * grid_.side + nx)];
                    if (i == view || seen.x < 0) continue;
                    low = glm::min(low, seen);
                    high = glm::max(high, seen);
                }
        if (high.x < 0) return {};
    }
    return logDistance(shown, low, high, floor_);
}

}  // namespace relamp
