// Final frames, per pixel: rays cast, reflectance interpolated from the vertices, light gathered at the pixel itself.
// Vertices alone would blur every shadow edge by their spacing.
#pragma once
#include <array>
#include <memory>

#include "capture/camera.h"
#include "relight/relit_scene.h"

namespace relamp {

struct FrameOptions {
    int samplesPerPixel = 8;  ///< positions inside the pixel (one-pixel box filter)
    int distantSamples = 8;   ///< per position, towards the environment
    int lobeSamples = 4;      ///< per position and glossy lobe, four times as many on bare metal
    int emitterSamples = 6;   ///< per position and emitter, fewer (at least 2) when there are many emitters
    uint64_t seed = 1;
    bool background = true;  ///< show the environment where no surface is
    bool denoise = false;    ///< filter the light on matte surfaces (denoise.h); needs two samples a pixel
    bool groups = true;      ///< denoise each light by itself; false: the beauty alone, in less time
};

/// How much of a pixel shows one emitter's surface.
struct EmitterContribution {
    int emitter = -1;    ///< index into the scene's emitters; -1: none
    float fraction = 0;  ///< of the pixel's samples, in [0, 1]
};

/// Linear radiance per pixel; the groups (world, each emitter, what is seen directly) add up to the beauty.
struct Frame {
    static constexpr size_t ranks = 6;
    int width = 0, height = 0;
    std::vector<Rgb> beauty;
    std::vector<float> alpha;
    std::vector<Rgb> world;                   ///< lit by the environment, and the environment itself
    std::vector<std::vector<Rgb>> byEmitter;  ///< lit by each emitter, and the emitter itself
    std::vector<Rgb> albedo;
    std::vector<Vec3> normal, position;  ///< of the pixel's centre
    std::vector<float> depth;            ///< along the camera's axis, metres; 1e30 where nothing is
    /// The emitters seen, largest fraction first; at most six a pixel, as Cryptomatte has it.
    std::vector<std::array<EmitterContribution, ranks>> emittersSeen;

    /// Rows [first, first + count) of this one; layers that are empty stay so.
    Frame rows(int first, int count) const;
};

struct PixelAt {
    int x = 0, y = 0;
};

/// Renders a frame in strips, so that an image of any size needs the memory of a few rows. Keeps references to
/// scene and camera.
class FrameRenderer {
public:
    FrameRenderer(const RelitScene& relit, const Camera& camera, const FrameOptions& options);
    ~FrameRenderer();
    FrameRenderer(const FrameRenderer&) = delete;
    FrameRenderer& operator=(const FrameRenderer&) = delete;

    /// Rows [first, first + count) as a frame `count` high: the same bits as those rows of the whole, however it is
    /// cut. Advances `progress` by one a row. Throws Cancelled. May be called from one thread at a time (it uses all
    /// cores itself).
    Frame rows(int first, int count, Progress& progress) const;

    /// The beauty of some pixels of any camera: the same bits as in its whole frame that is not denoised. Throws
    /// Cancelled. Threads: as rows().
    std::vector<Rgb> pixels(const Camera& camera, const std::vector<PixelAt>& at, Progress& progress) const;

private:
    struct MatteLight;
    /// Without the filter; what the filter needs goes into `matte`, when there is one.
    Frame noisyRows(int first, int count, MatteLight* matte, Progress& progress) const;

    const RelitScene& relit_;
    const Camera& camera_;
    FrameOptions options_;
    std::unique_ptr<const struct SceneLights> lights_;
};

/// Monte Carlo direct lighting with multiple importance sampling (Veach 1997) over low-discrepancy points; unbiased
/// unless denoised, the same bits on any number of threads. 640x480 in about 3 s on two cores. Throws Cancelled.
Frame renderFrame(const RelitScene& relit, const Camera& camera, const FrameOptions& options, Progress& progress);

}  // namespace relamp
