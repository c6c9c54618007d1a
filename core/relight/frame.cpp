#include "relight/frame.h"

#include "base/parallel.h"
#include "base/random.h"
#include "relight/point_shader.h"

namespace relamp {

namespace {

/// Counts of samples by emitter, largest first.
void rank(const std::vector<int>& hits, float share, std::array<EmitterShare, Frame::ranks>& seen) {
    for (size_t e = 0; e < hits.size(); ++e) {
        if (!hits[e]) continue;
        EmitterShare next{int(e), float(hits[e]) * share};
        for (EmitterShare& place : seen)
            if (place.emitter < 0 || next.share > place.share) std::swap(place, next);
    }
}

}  // namespace

FrameRenderer::FrameRenderer(const RelitScene& relit, const Camera& camera, const FrameOptions& options)
    : relit_(relit), camera_(camera), options_(options), lights_(std::make_unique<const SceneLights>(relit)) {}

FrameRenderer::~FrameRenderer() = default;

Frame FrameRenderer::rows(int first, int count, Progress& progress) const {
    const RelitScene& relit = relit_;
    const Camera& camera = camera_;
    const FrameOptions& options = options_;
    Frame frame;
    frame.width = camera.width;
    frame.height = count;
    const size_t pixels = size_t(frame.width) * size_t(count), emitters = relit.emitters.size(), above = size_t(first) * size_t(frame.width);
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
    const float share = 1 / float(options.samplesPerPixel);
    parallelBlocks(size_t(count), 2, [&](size_t begin, size_t end) {
        PointShader shader(*lights_, options);
        ShadedPoint surface;
        Gather gather;
        std::vector<int> hits(emitters, 0);
        for (size_t y = begin; y < end; ++y)
            for (int x = 0; x < frame.width; ++x) {
                if (x % 64 == 0) progress.check();
                const size_t p = y * size_t(frame.width) + size_t(x);
                const uint64_t seed = mixBits(options.seed * 0x9e37 + above + p);
                const float row = float(first) + float(y);
                bool emitterSeen = false;
                gather.world = Rgb(0);
                gather.byEmitter.assign(emitters, Rgb(0));
                for (int i = 0; i < options.samplesPerPixel; ++i) {
                    const Vec2 inside = r2Point(uint32_t(i), randomShift(seed, 0, 0));
                    const Vec3 d = camera.rayDirection(Vec2(float(x), row) + inside);
                    const Hit hit = relit.scene.tracer->closest({origin, d, 0, 1e30f});
                    if (!hit) {
                        if (options.background) gather.world += relit.distant->smoothRadiance(d);
                        continue;
                    }
                    frame.alpha[p] += share;
                    const int e = relit.emitterOfTriangle[hit.triangle];
                    if (e >= 0) {
                        ++hits[size_t(e)];
                        emitterSeen = true;
                        if (relit.emitters[size_t(e)].surface.twoSided || glm::dot(relit.scene.mesh.faceNormal(hit.triangle), d) < 0) gather.byEmitter[size_t(e)] += relit.emitters[size_t(e)].radiance;
                        continue;
                    }
                    shader.surfaceAt(hit, d, surface);
                    frame.albedo[p] += surface.albedo * share;
                    shader.gather(surface, uint32_t(i), seed, gather);
                }
                const Hit centre = relit.scene.tracer->closest({origin, camera.rayDirection(Vec2(float(x) + 0.5f, row + 0.5f)), 0, 1e30f});
                if (centre) {
                    frame.position[p] = relit.scene.pointOf(centre);
                    frame.normal[p] = relit.scene.normalOf(centre);
                    frame.depth[p] = float(camera.depthOf(DVec3(frame.position[p])));
                }
                if (emitterSeen) {
                    rank(hits, share, frame.emittersSeen[p]);
                    std::fill(hits.begin(), hits.end(), 0);
                }
                frame.world[p] = gather.world * share;
                frame.beauty[p] = frame.world[p];
                for (size_t e = 0; e < emitters; ++e) {
                    frame.byEmitter[e][p] = gather.byEmitter[e] * share;
                    frame.beauty[p] += frame.byEmitter[e][p];
                }
            }
        progress.advance(end - begin);
    });
    return frame;
}

Frame renderFrame(const RelitScene& relit, const Camera& camera, const FrameOptions& options, Progress& progress) {
    const FrameRenderer renderer(relit, camera, options);
    progress.begin("Frame", size_t(camera.height));
    return renderer.rows(0, camera.height, progress);
}

}  // namespace relamp
