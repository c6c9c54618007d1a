// Room 3's product: what the photographs say of each vertex, of the distant environment and of each surface pixel.
#pragma once
#include <algorithm>
#include <vector>

#include "base/math.h"
#include "image/direction_grid.h"
#include "scene/ray_tracer.h"

namespace relamp {

/// One observation of a vertex in a view.
struct RadianceSample {
    uint32_t view = 0;
    Rgb radiance{0};  ///< linear Rec.709, gauge of the photographs
    float weight =
        0;  ///< in (0, 1]: grazing angle, distance from depth edges, fraction of the footprint on the surface
    bool clipped = false;  ///< at or above the view's clip level: a lower bound only
};

/// What a view's pixels see: the mesh, or the environment.
struct ViewGeometry {
    int width = 0, height = 0;
    std::vector<uint32_t> triangle;  ///< per pixel centre; Hit::none where no geometry is seen
    std::vector<float> depth;        ///< metres along the ray

    /// Whether neither the pixel nor those around it see geometry. Not for pixels at the image's edge.
    bool open(int x, int y) const {
        for (int k = 0; k < 9; ++k)
            if (triangle[size_t(y + k / 3 - 1) * size_t(width) + size_t(x + k % 3 - 1)] != Hit::none) return false;
        return true;
    }
};

struct RadianceSamples {
    /// Samples of vertex v: samples[start[v]] ... samples[start[v + 1] - 1].
    std::vector<uint32_t> start;
    std::vector<RadianceSample> samples;
    std::vector<ViewGeometry> geometry;  ///< per view
    uint32_t states = 1;                 ///< lighting states of the photographs
    std::vector<uint32_t> stateOfView;   ///< per view; empty: all are in one
    /// Per lighting state the number of its environment, -1: it has none; empty: all states have one, number 0.
    std::vector<int> environmentOfState;
    /// Distant light seen directly: mean radiance of background pixels per cell, and how many saw it (0: unobserved).
    /// One environment after the other.
    DirectionGrid backgroundGrid{128};
    std::vector<Rgb> background;
    std::vector<uint32_t> backgroundPixels;
    std::vector<uint8_t> backgroundClipped;  ///< 1: a lower bound only
    float relativeNoise = 0.01f;             ///< standard deviation of a sample over its radiance: of the median sample
    float pixelNoise = 0.015f;               ///< of a pixel over its radiance, from pixel differences
    float noiseFloor = 0;                    ///< radiance: standard deviation of a dark sample

    uint32_t stateOf(uint32_t view) const { return stateOfView.empty() ? 0 : stateOfView[view]; }
    int environmentOf(uint32_t state) const { return environmentOfState.empty() ? 0 : environmentOfState[state]; }
    size_t environments() const {
        int last = 0;
        for (const int environment : environmentOfState) last = std::max(last, environment);
        return size_t(last) + 1;
    }
    size_t countOf(uint32_t v) const { return start[v + 1] - start[v]; }
    /// Standard deviation of an observation of this radiance (one channel).
    float sigma(float radiance) const { return sigma(radiance, relativeNoise); }
    /// The same of a pixel.
    float sigmaOfPixel(float radiance) const { return sigma(radiance, pixelNoise); }

private:
    float sigma(float radiance, float relative) const {
        return std::sqrt(relative * relative * radiance * radiance + noiseFloor * noiseFloor);
    }
};

}  // namespace relamp
