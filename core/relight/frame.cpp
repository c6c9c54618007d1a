#include "relight/frame.h"

#include "base/parallel.h"
#include "base/random.h"
#include "relight/point_shader.h"

namespace relamp {

namespace {

/// Counts of samples by emitter, largest first.
void rank(const std::vector<int>& hits, float fraction, std::array<EmitterContribution, Frame::ranks>& seen) {
    for (size_t e = 0; e < hits.size(); ++e) {
        if (!hits[e]) continue;
        EmitterContribution next{int(e), float(hits[e]) * fraction};
        for (EmitterContribution& place : seen)
            if (place.emitter < 0 || next.fraction > place.fraction) std::swap(place, next);
    }
}

/// One pixel after the other, by one thread.
class PixelRenderer {
public:
    // What render() found.
    Gather gather;          ///< byEmitter: radiance of the pixel from each emitter
    std::vector<int> hits;  ///< per emitter: samples that see it
    bool emitterSeen = false;
    float alpha = 0;
    Rgb albedo{0}, world{0}, beauty{0};

    PixelRenderer(const SceneLights& lights, const Camera& camera, const FrameOptions& options)
        : hits(lights.relit.emitters.size(), 0),
          relit_(lights.relit),
          camera_(camera),
          options_(options),
          origin_(camera.position()),
          shader_(lights, options) {}

    /// Renders pixel (x, y). Stops within 64 samples.
    void render(int x, int y, const Progress& progress) {
        const uint64_t seed = mixBits(options_.seed * 0x9e37 + size_t(y) * size_t(camera_.width) + size_t(x));
        const float fraction = 1 / float(options_.samplesPerPixel);
        emitterSeen = false;
        alpha = 0;
        albedo = Rgb(0);
        gather.world = Rgb(0);
        gather.byEmitter.assign(relit_.emitters.size(), Rgb(0));
        std::fill(hits.begin(), hits.end(), 0);
        for (int i = 0; i < options_.samplesPerPixel; ++i) {
            if (i % 64 == 0) progress.check();
            const Vec2 inside = r2Point(uint32_t(i), randomShift(seed, 0, 0));
            const Vec3 d = camera_.rayDirection(Vec2(float(x), float(y)) + inside);
            const Hit hit = relit_.scene.cameraTracer->closest({origin_, d, 0, 1e30f});
            if (!hit) {
                if (options_.background) gather.world += relit_.distant->smoothRadiance(d);
                continue;
            }
            alpha += fraction;
            const int e = relit_.emitterOfTriangle[hit.triangle];
            if (e >= 0) {
                const RelitEmitter& emitter = relit_.emitters[size_t(e)];
                ++hits[size_t(e)];
                emitterSeen = true;
                if (emitter.surface.twoSided || glm::dot(relit_.scene.mesh.faceNormal(hit.triangle), d) < 0)
                    gather.byEmitter[size_t(e)] += emitter.emission.radiance(-d, origin_ + hit.distance * d);
                continue;
            }
            shader_.surfaceAt(hit, d, surface_);
            albedo += surface_.albedo * fraction;
            shader_.gather(surface_, uint32_t(i), seed, gather);
        }
        world = gather.world * fraction;
        beauty = world;
        for (Rgb& light : gather.byEmitter) {
            light *= fraction;
            beauty += light;
        }
    }

private:
    const RelitScene& relit_;
    const Camera& camera_;
    const FrameOptions& options_;
    Vec3 origin_;
    PointShader shader_;
    ShadedPoint surface_;
};

}  // namespace

FrameRenderer::FrameRenderer(const RelitScene& relit, const Camera& camera, const FrameOptions& options)
    : relit_(relit), camera_(camera), options_(options), lights_(std::make_unique<const SceneLights>(relit)) {}

FrameRenderer::~FrameRenderer() = default;

Frame FrameRenderer::rows(int first, int count, Progress& progress) const {
    const RelitScene& relit = relit_;
    const Camera& camera = camera_;
    Frame frame;
    frame.width = camera.width;
    frame.height = count;
    const size_t pixels = size_t(frame.width) * size_t(count), emitters = relit.emitters.size();
    frame.beauty.assign(pixels, Rgb(0));
    frame.alpha.assign(pixels, 0);
    frame.world.assign(pixels, Rgb(0));
    frame.byEmitter.assign(emitters, std::vector<Rgb>(pixels, Rgb(0)));
    frame.albedo.assign(pixels, Rgb(0));
    frame.normal.assign(pixels, Vec3(0));
    frame.position.assign(pixels, Vec3(0));
    frame.depth.assign(pixels, 1e30f);
    frame.emittersSeen.assign(pixels, {});
    const Vec3 origin(camera.position());
    parallelBlocks(size_t(count), 2, [&](size_t begin, size_t end) {
        PixelRenderer pixel(*lights_, camera, options_);
        for (size_t y = begin; y < end; ++y)
            for (int x = 0; x < frame.width; ++x) {
                const size_t p = y * size_t(frame.width) + size_t(x);
                const int row = first + int(y);
                pixel.render(x, row, progress);
                frame.alpha[p] = pixel.alpha;
                frame.albedo[p] = pixel.albedo;
                const Hit centre = relit.scene.cameraTracer->closest(
                    {origin, camera.rayDirection(Vec2(float(x) + 0.5f, float(row) + 0.5f)), 0, 1e30f});
                if (centre) {
                    frame.position[p] = relit.scene.pointOf(centre);
                    frame.normal[p] = relit.scene.normalOf(centre);
                    frame.depth[p] = float(camera.depthOf(DVec3(frame.position[p])));
                }
                if (pixel.emitterSeen) rank(pixel.hits, 1 / float(options_.samplesPerPixel), frame.emittersSeen[p]);
                frame.world[p] = pixel.world;
                frame.beauty[p] = pixel.beauty;
                for (size_t e = 0; e < emitters; ++e) frame.byEmitter[e][p] = pixel.gather.byEmitter[e];
            }
        progress.advance(end - begin);
    });
    return frame;
}

std::vector<Rgb> FrameRenderer::pixels(const Camera& camera, const std::vector<PixelAt>& at, Progress& progress) const {
    std::vector<Rgb> beauty(at.size());
    parallelBlocks(at.size(), 256, [&](size_t begin, size_t end) {
        PixelRenderer pixel(*lights_, camera, options_);
        for (size_t i = begin; i < end; ++i) {
            pixel.render(at[i].x, at[i].y, progress);
            beauty[i] = pixel.beauty;
        }
    });
    return beauty;
}

Frame renderFrame(const RelitScene& relit, const Camera& camera, const FrameOptions& options, Progress& progress) {
    const FrameRenderer renderer(relit, camera, options);
    progress.begin("Frame", size_t(camera.height));
    return renderer.rows(0, camera.height, progress);
}

}  // namespace relamp
