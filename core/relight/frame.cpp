#include "relight/frame.h"

#include "base/parallel.h"
#include "base/random.h"
#include "relight/denoise.h"
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
    Gather light[2];        ///< on a white matte surface, from either half of the samples
    Vec3 normal, position;  ///< of the matte surface, means
    float matte = 0;        ///< fraction of the samples that see one
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
          spread_(1 / float(std::max(camera.focalX, camera.focalY) * std::sqrt(double(options.samplesPerPixel)))),
          shader_(lights, options) {}

    /// Renders pixel (x, y). Stops within 64 samples.
    void render(int x, int y, const Progress& progress) {
        const uint64_t seed = mixBits(options_.seed * 0x9e37 + size_t(y) * size_t(camera_.width) + size_t(x));
        const float fraction = 1 / float(options_.samplesPerPixel);
        emitterSeen = false;
        alpha = 0;
        albedo = Rgb(0);
        gather.clear(relit_.emitters.size());
        for (Gather& half : light) half.clear(relit_.emitters.size());
        normal = position = Vec3(0);
        float seen[2] = {0, 0};
        std::fill(hits.begin(), hits.end(), 0);
        for (int i = 0; i < options_.samplesPerPixel; ++i) {
            if (i % 64 == 0) progress.check();
            const Vec2 inside = r2Point(uint32_t(i), randomShift(seed, 0, 0));
            const Vec3 d = camera_.rayDirection(Vec2(float(x), float(y)) + inside);
            const Hit hit = relit_.scene.cameraTracer->closest({origin_, d, 0, 1e30f});
            if (!hit) {
                if (options_.background) gather.world += relit_.distant->background(d);
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
            shader_.surfaceAt(hit, d, spread_, surface_);
            albedo += surface_.albedo * fraction;
            once_.clear(relit_.emitters.size());
            shader_.gather(surface_, uint32_t(i), seed, gather, once_);
            if (!(maxChannel(surface_.albedo) > 0)) continue;
            Gather& half = light[i % 2];
            ++seen[i % 2];
            normal += surface_.normal;
            position += surface_.position;
            half.world += once_.world;
            gather.world += surface_.albedo * once_.world;
            for (size_t l = 0; l < half.byEmitter.size(); ++l) {
                half.byEmitter[l] += once_.byEmitter[l];
                gather.byEmitter[l] += surface_.albedo * once_.byEmitter[l];
            }
        }
        finish(seen);
        world = gather.world * fraction;
        beauty = world;
        for (Rgb& group : gather.byEmitter) {
            group = glm::max(group * fraction, Rgb(0));  // addedFactor may be below 0
            beauty += group;
        }
    }

private:
    const RelitScene& relit_;
    const Camera& camera_;
    const FrameOptions& options_;
    Vec3 origin_;
    float spread_;  ///< radians that a sample stands for
    PointShader shader_;
    ShadedPoint surface_;
    Gather once_;

    /// Sums become means; a half without a sample is like the other.
    void finish(const float (&seen)[2]) {
        const float all = seen[0] + seen[1];
        matte = all / float(options_.samplesPerPixel);
        if (!(all > 0)) return;
        if (const float length = glm::length(normal); length > 1e-3f * all) normal /= length;
        else matte = 0;  // surfaces that face each other: the pixel is left alone
        position /= all;
        for (size_t h = 0; h < 2; ++h) {
            if (!(seen[h] > 0)) continue;
            light[h].world /= seen[h];
            for (Rgb& l : light[h].byEmitter) l /= seen[h];
        }
        for (size_t h = 0; h < 2; ++h)
            if (!(seen[h] > 0)) light[h] = light[1 - h];
    }
};

template <class T>
std::vector<T> cut(const std::vector<T>& whole, size_t first, size_t count) {
    if (whole.size() < first + count) return {};
    return std::vector<T>(whole.begin() + std::ptrdiff_t(first), whole.begin() + std::ptrdiff_t(first + count));
}

}  // namespace

Frame Frame::rows(int first, int count) const {
    const size_t from = size_t(first) * size_t(width), size = size_t(count) * size_t(width);
    Frame part;
    part.width = width;
    part.height = count;
    part.beauty = cut(beauty, from, size);
    part.alpha = cut(alpha, from, size);
    part.world = cut(world, from, size);
    for (const auto& group : byEmitter) part.byEmitter.push_back(cut(group, from, size));
    part.albedo = cut(albedo, from, size);
    part.normal = cut(normal, from, size);
    part.position = cut(position, from, size);
    part.depth = cut(depth, from, size);
    part.emittersSeen = cut(emittersSeen, from, size);
    return part;
}

FrameRenderer::FrameRenderer(const RelitScene& relit, const Camera& camera, const FrameOptions& options)
    : relit_(relit), camera_(camera), options_(options), lights_(std::make_unique<const SceneLights>(relit)) {}

FrameRenderer::~FrameRenderer() = default;

struct FrameRenderer::MatteLight {
    SurfaceGuide guide;
    std::vector<HalfLight> groups;  ///< the world, then each emitter
    int above = 0, below = 0;       ///< rows of the margin, which no progress is told of
};

Frame FrameRenderer::rows(int first, int count, Progress& progress) const {
    if (!options_.denoise || options_.samplesPerPixel < 2) return noisyRows(first, count, nullptr, progress);
    const int from = std::max(0, first - denoiseMargin), to = std::min(camera_.height, first + count + denoiseMargin);
    MatteLight matte;
    matte.above = first - from;
    matte.below = to - first - count;
    const Frame wide = noisyRows(from, to - from, &matte, progress);
    const auto quiet = denoisedLight(matte.guide, matte.groups, first - from, count);
    Frame frame = wide.rows(first - from, count);
    const size_t skipped = size_t(first - from) * size_t(frame.width);
    for (size_t g = 0; g < quiet.size(); ++g) {
        const HalfLight& noisy = matte.groups[g];
        std::vector<Rgb>& group = !options_.groups ? frame.beauty : g == 0 ? frame.world : frame.byEmitter[g - 1];
        for (size_t p = 0; p < group.size(); ++p) {
            const Rgb before = 0.5f * (noisy[0][skipped + p] + noisy[1][skipped + p]);
            const Rgb after = glm::max(group[p] + frame.albedo[p] * (quiet[g][p] - before), Rgb(0));
            if (options_.groups) frame.beauty[p] += after - group[p];
            group[p] = after;
        }
    }
    return frame;
}

Frame FrameRenderer::noisyRows(int first, int count, MatteLight* matte, Progress& progress) const {
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
    if (matte) {
        matte->guide = {camera.width, count, std::vector<Vec3>(pixels, Vec3(0)), std::vector<Vec3>(pixels, Vec3(0)),
                        std::vector<float>(pixels, 0)};
        matte->groups.assign(options_.groups ? emitters + 1 : 1,
                             {std::vector<Rgb>(pixels, Rgb(0)), std::vector<Rgb>(pixels, Rgb(0))});
    }
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
                if (!matte || !(pixel.matte > 0)) continue;
                matte->guide.normal[p] = pixel.normal;
                matte->guide.position[p] = pixel.position;
                matte->guide.footprint[p] = float(camera.depthOf(DVec3(pixel.position)) / camera.focalX);
                for (size_t h = 0; h < 2; ++h) {
                    matte->groups[0][h][p] = pixel.light[h].world;
                    for (size_t e = 0; e < emitters; ++e)
                        matte->groups[options_.groups ? e + 1 : 0][h][p] += pixel.light[h].byEmitter[e];
                }
            }
        const size_t above = size_t(matte ? matte->above : 0), shown = size_t(count - (matte ? matte->below : 0));
        progress.advance(std::min(end, shown) - std::min(std::max(begin, above), std::min(end, shown)));
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
