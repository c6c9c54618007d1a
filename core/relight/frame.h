// Final frames, per pixel: rays cast, reflectance interpolated from the vertices, light gathered at the pixel itself. Vertices
// alone would blur every shadow edge by their spacing.
#pragma once
#include "capture/camera.h"
#include "relight/relit_scene.h"

namespace relamp {

struct FrameOptions {
    int samplesPerPixel = 8;       ///< positions inside the pixel (one-pixel box filter)
    int distantSamples = 8;        ///< per position, towards the environment
    int lobeSamples = 4;           ///< per position and glossy lobe, four times as many on bare metal
    int emitterSamples = 6;        ///< per position and emitter, fewer (at least 2) when there are many emitters
    uint64_t seed = 1;
    bool background = true;        ///< show the environment where no surface is
};

/// Linear radiance per pixel; the groups (world, each emitter, what is seen directly) add up to the beauty.
struct Frame {
    int width = 0, height = 0;
    std::vector<Rgb> beauty;
    std::vector<float> alpha;
    std::vector<Rgb> world;                     ///< lit by the environment, and the environment itself
    std::vector<std::vector<Rgb>> byEmitter;    ///< lit by each emitter, and the emitter itself
    std::vector<Rgb> albedo;
    std::vector<Vec3> normal, position;         ///< of the pixel's centre
    std::vector<float> depth;                   ///< along the camera's axis, metres; 1e30 where nothing is
};

/// Monte Carlo direct lighting with multiple importance sampling (Veach 1997) over low-discrepancy points; unbiased, the same bits
/// on any number of threads. 640x480 in about 3 s on two cores. Throws Cancelled.
Frame renderFrame(const RelitScene& relit, const Camera& camera, const FrameOptions& options, Progress& progress);

}  // namespace relamp
