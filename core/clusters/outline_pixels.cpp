#include "clusters/outline_pixels.h"

#include <algorithm>
#include <limits>

namespace relamp {
namespace {

/// Distance of each pixel from the outline, in steps to one of eight neighbours, up to `most`.
std::vector<uint16_t> stepsFrom(const EmitterOutline& outline, int width, int height, int most) {
    std::vector<uint16_t> steps(outline.shows.size(), uint16_t(most + 1));
    std::vector<size_t> front;
    for (size_t p = 0; p < steps.size(); ++p)
        if (outline.shows[p]) {
            steps[p] = 0;
            front.push_back(p);
        }
    for (int step = 1; step <= most && !front.empty(); ++step) {
        std::vector<size_t> next;
        for (const size_t p : front) {
            const int x = int(p % size_t(width)), y = int(p / size_t(width));
            for (int k = 0; k < 9; ++k) {
                const int qx = x + k % 3 - 1, qy = y + k / 3 - 1;
                if (qx < 0 || qy < 0 || qx >= width || qy >= height) continue;
                const size_t q = size_t(qy) * size_t(width) + size_t(qx);
                if (steps[q] <= step) continue;
                steps[q] = uint16_t(step);
                next.push_back(q);
            }
        }
        front.swap(next);
    }
    return steps;
}

}  // namespace

std::vector<OutlineView> pixelsAbout(const Capture& capture, const RadianceSamples& samples,
                                     const std::vector<EmitterOutline>& outlines, const std::vector<uint32_t>& own,
                                     const std::vector<float>& reach, size_t stride) {
    std::vector<OutlineView> result(outlines.size());
    parallelFor(outlines.size(), 1, [&](size_t i) {
        const EmitterOutline& outline = outlines[i];
        const Camera& camera = capture.views[outline.view].camera;
        const ViewGeometry& g = samples.geometry[outline.view];
        constexpr float farthest = 4000;
        const int most = int(std::clamp(reach[i], 1.0f, farthest));
        const std::vector<uint16_t> steps = stepsFrom(outline, g.width, g.height, most);
        result[i].eye = camera.position();
        size_t count = 0;
        for (int y = 0; y < g.height; ++y)
            for (int x = 0; x < g.width; ++x) {
                const size_t p = size_t(y) * size_t(g.width) + size_t(x);
                if (steps[p] > most || count++ % stride != 0) continue;
                OutlinePixel pixel;
                pixel.direction = camera.rayDirection(Vec2(float(x) + 0.5f, float(y) + 0.5f));
                const uint32_t t = g.triangle[p];
                const bool hides = t != Hit::none && !std::binary_search(own.begin(), own.end(), t);
                pixel.depth = hides ? g.depth[p] : std::numeric_limits<float>::infinity();
                pixel.shows = outline.shows[p] != 0;
                result[i].pixels.push_back(pixel);
            }
    });
    return result;
}

}  // namespace relamp
