#include "radiance/gather.h"

#include <gtest/gtest.h>

#include "base/parallel.h"
#include "base/random.h"
#include "base/statistics.h"
#include "support/estimates.h"
#include "support/stopping.h"

namespace relamp {
namespace {

/// What an image shows: by the position and triangle of what is seen, or by direction where nothing is.
using OnSurface = std::function<Rgb(const Vec3& position, uint32_t triangle)>;
using InSky = std::function<Rgb(const Vec3& direction)>;

View viewOf(const Scene& scene, const Camera& camera, const OnSurface& surface, const InSky& sky) {
    View view;
    view.camera = camera;
    view.image = Image(camera.width, camera.height);
    for (int y = 0; y < camera.height; ++y)
        for (int x = 0; x < camera.width; ++x) {
            const Vec3 d = camera.rayDirection({x + 0.5f, y + 0.5f});
            const Hit hit = scene.tracer->closest({Vec3(camera.position()), d, 0, 1e30f});
            view.image.at(x, y) = hit ? surface(scene.pointOf(hit), hit.triangle) : sky(d);
        }
    return view;
}

RadianceSamples gather(const Scene& scene, const std::vector<View>& views) {
    Capture capture;
    capture.views = views;
    capture.mesh = scene.mesh;
    Progress progress;
    return gatherRadiance(capture, scene, {}, progress);
}

const InSky blackSky = [](const Vec3&) { return Rgb(0); };

/// A floor with a shelf over its half x < 0, seen from straight above.
struct Shelf {
    Scene scene;
    size_t floorVertices = 0;
    uint32_t firstShelfTriangle = 0;
    Shelf() {
        Mesh mesh = test::sheet({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, 40, 40);
        floorVertices = mesh.vertexCount();
        firstShelfTriangle = uint32_t(mesh.triangles.size());
        test::append(mesh, test::sheet({-1, -1, 0.5f}, {0.97f, 0, 0}, {0, 2, 0}, 10, 10));
        scene = test::sceneOf(mesh);
    }
    Camera above() const { return test::cameraAt({0, 0, 4}, {0, 0, 0}, 120, 120, 200, {0, 1, 0}); }
};

TEST(Gather, GivesNoSampleToWhatIsHidden) {
    const Shelf shelf;
    const RadianceSamples samples =
        gather(shelf.scene, {viewOf(
                                shelf.scene, shelf.above(), [](const Vec3&, uint32_t) { return Rgb(1); }, blackSky)});
    ASSERT_EQ(samples.start.size(), shelf.scene.mesh.vertexCount() + 1);
    size_t hidden = 0, seen = 0;
    for (uint32_t v = 0; v < shelf.floorVertices; ++v) {
        const Vec3 p = shelf.scene.mesh.positions[v];
        if (p.x < -0.1f) {
            EXPECT_EQ(samples.countOf(v), 0u) << p.x;
            ++hidden;
        } else if (p.x > 0.1f && p.x < 0.98f && std::abs(p.y) < 0.98f) {
            EXPECT_EQ(samples.countOf(v), 1u) << p.x << " " << p.y;
            ++seen;
        }
    }
    EXPECT_GT(hidden, 500u);
    EXPECT_GT(seen, 500u);
}

TEST(Gather, DoesNotMixAcrossDepthEdges) {
    const Shelf shelf;
    const View view = viewOf(
        shelf.scene, shelf.above(),
        [&](const Vec3&, uint32_t t) { return t >= shelf.firstShelfTriangle ? Rgb(1000, 0, 0) : Rgb(0, 1, 0); },
        blackSky);
    const RadianceSamples samples = gather(shelf.scene, {view});
    size_t floor = 0, above = 0;
    for (uint32_t v = 0; v < shelf.scene.mesh.vertexCount(); ++v)
        for (uint32_t s = samples.start[v]; s < samples.start[v + 1]; ++s) {
            const bool isFloor = v < shelf.floorVertices;
            EXPECT_LT(glm::length(samples.samples[s].radiance - (isFloor ? Rgb(0, 1, 0) : Rgb(1000, 0, 0))), 1e-3f)
                << shelf.scene.mesh.positions[v].x;
            (isFloor ? floor : above) += 1;
        }
    EXPECT_GT(floor, 500u);
    EXPECT_GT(above, 50u);
}

TEST(Gather, ReadsBetweenPixels) {
    const Scene scene = test::sceneOf(test::sheet({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, 12, 12));
    const Camera camera = test::cameraAt({0, 0, 4}, {0, 0, 0}, 120, 120, 200, {0, 1, 0});
    const auto ramp = [](const Vec3& p) { return Rgb(2 + p.x, 3 - p.y, 2 + 0.5f * p.x + 0.5f * p.y); };
    const RadianceSamples samples =
        gather(scene, {viewOf(
                          scene, camera, [&](const Vec3& p, uint32_t) { return ramp(p); }, blackSky)});
    for (uint32_t v = 0; v < scene.mesh.vertexCount(); ++v) {
        const Vec3 p = scene.mesh.positions[v];
        if (std::max(std::abs(p.x), std::abs(p.y)) > 0.9f) continue;
        ASSERT_EQ(samples.countOf(v), 1u);
        // The mean over a footprint has its middle within a hundredth of a pixel (0.02 on this ramp) of the vertex.
        EXPECT_LT(glm::length(samples.samples[samples.start[v]].radiance - ramp(p)), 2e-3f);
        EXPECT_GT(samples.samples[samples.start[v]].weight, 0.9f);
        EXPECT_FALSE(samples.samples[samples.start[v]].clipped);
    }
}

TEST(Gather, MarksClippedPixelsAndLeavesOutUnusableOnes) {
    const Scene scene = test::sceneOf(test::sheet({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, 12, 12));
    const Camera camera = test::cameraAt({0, 0, 4}, {0, 0, 0}, 120, 120, 200, {0, 1, 0});
    View view = viewOf(
        scene, camera, [](const Vec3& p, uint32_t) { return Rgb(p.x > 0 ? 1.0f : 0.5f); }, blackSky);
    view.saturation = 0.99f;
    view.image.usable.assign(view.image.pixels.size(), 1);
    for (int y = 0; y < 120; ++y)
        for (int x = 0; x < 120; ++x)
            if (camera.rayDirection({x + 0.5f, y + 0.5f}).y > 0) view.image.usable[size_t(y) * 120 + size_t(x)] = 0;
    const RadianceSamples samples = gather(scene, {view});
    for (uint32_t v = 0; v < scene.mesh.vertexCount(); ++v) {
        const Vec3 p = scene.mesh.positions[v];
        if (std::min(std::abs(p.x), std::abs(p.y)) < 0.1f || std::max(std::abs(p.x), std::abs(p.y)) > 0.9f) continue;
        ASSERT_EQ(samples.countOf(v), p.y > 0 ? 0u : 1u);
        if (p.y < 0) { EXPECT_EQ(samples.samples[samples.start[v]].clipped, p.x > 0); }
    }
}

TEST(Gather, LeavesOutGrazingLooksAndBacks) {
    const Scene scene = test::sceneOf(test::sheet({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, 12, 12));
    const OnSurface grey = [](const Vec3&, uint32_t) { return Rgb(1); };
    const RadianceSamples grazing =
        gather(scene, {viewOf(scene, test::cameraAt({5, 0, 0.2}, {0, 0, 0}, 120, 120, 200), grey, blackSky)});
    EXPECT_EQ(grazing.samples.size(), 0u);
    const RadianceSamples back =
        gather(scene, {viewOf(scene, test::cameraAt({0, 0.1, -4}, {0, 0, 0}, 120, 120, 200), grey, blackSky)});
    EXPECT_EQ(back.samples.size(), 0u);
}

TEST(Gather, TakesTheBackgroundForTheEnvironment) {
    const Scene scene = test::sceneOf(test::sheet({-0.3f, -0.3f, 0}, {0.6f, 0, 0}, {0, 0.6f, 0}, 4, 4));
    const auto sky = [](const Vec3& d) { return Rgb(1 + d.x, 1 + d.y, 1 + d.z); };
    std::vector<View> views;
    for (int i = 0; i < 6; ++i) {
        const double a = i * piD / 3;
        views.push_back(viewOf(
            scene, test::cameraAt({3 * std::cos(a), 3 * std::sin(a), 1.0}, {0, 0, 0.5}, 80, 60, 60),
            [](const Vec3&, uint32_t) { return Rgb(500); }, sky));
    }
    const RadianceSamples samples = gather(scene, views);
    size_t seen = 0;
    for (int c = 0; c < samples.backgroundGrid.cells(); ++c) {
        if (samples.backgroundPixels[size_t(c)] < 4) continue;
        ++seen;
        // A cell of side 64 is 3 degrees wide.
        EXPECT_LT(glm::length(samples.background[size_t(c)] - sky(samples.backgroundGrid.direction(c))), 0.06f) << c;
        EXPECT_FALSE(samples.backgroundClipped[size_t(c)]);
    }
    EXPECT_GT(seen, 300u);
    // Nobody looked straight up.
    EXPECT_EQ(samples.backgroundPixels[size_t(samples.backgroundGrid.cellOf({0, 0, 1}))], 0u);
}

/// Noise of a pixel, relative: a sum of four uniform numbers of standard deviation `noise`.
float noiseAt(uint64_t pixel, float noise) {
    float sum = -2;
    for (uint64_t k = 0; k < 4; ++k) sum += unitFloat(mixBits(pixel * 4 + k));
    return noise * sum * 1.732f;
}

TEST(Gather, EstimatesTheNoiseThatIsThere) {
    const Scene scene = test::sceneOf(test::sheet({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, 12, 12));
    const Camera camera = test::cameraAt({0, 0, 4}, {0, 0, 0}, 160, 160, 400, {0, 1, 0});
    for (const float noise : {0.0f, 0.05f}) {
        View view = viewOf(
            scene, camera, [](const Vec3&, uint32_t) { return Rgb(2); }, blackSky);
        for (size_t p = 0; p < view.image.pixels.size(); ++p) { view.image.pixels[p] *= 1 + noiseAt(p, noise); }
        const RadianceSamples samples = gather(scene, {view});
        EXPECT_NEAR(samples.pixelNoise, std::max(noise, 0.003f), 0.01f) << noise;
        // What the noise of the median sample is said to be is how far the median sample is off.
        std::vector<float> off;
        for (const RadianceSample& s : samples.samples) off.push_back(std::abs(s.radiance.y / 2 - 1));
        EXPECT_NEAR(1.4826f * medianOf(off), noise > 0 ? samples.relativeNoise : 0, 0.002) << noise;
    }
}

/// A sheet with edges of six pixels, dark where x < 0, in three views of 5 % noise.
struct HalfDark {
    Scene scene = test::sceneOf(test::sheet({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, 24, 24));
    RadianceSamples samples;
    explicit HalfDark(float dark) {
        std::vector<View> views;
        for (int i = -1; i <= 1; ++i) {
            views.push_back(viewOf(
                scene, test::cameraAt({0.4 * i, 0, 4}, {0, 0, 0}, 180, 180, 280, {0, 1, 0}),
                [&](const Vec3& p, uint32_t) { return Rgb(p.x < 0 ? dark : 2.0f); }, blackSky));
            Image& image = views.back().image;
            for (size_t p = 0; p < image.pixels.size(); ++p)
                image.pixels[p] *= 1 + noiseAt(p + image.pixels.size() * size_t(i + 1), 0.05f);
        }
        samples = gather(scene, views);
    }
    /// Root mean square of the relative error of all samples with lowest <= |x| < highest.
    double error(float dark, float lowest, float highest) const {
        double squares = 0, count = 0;
        for (uint32_t v = 0; v < scene.mesh.vertexCount(); ++v) {
            const float x = scene.mesh.positions[v].x;
            if (std::abs(x) < lowest || std::abs(x) >= highest) continue;
            for (uint32_t k = samples.start[v]; k < samples.start[v + 1]; ++k, ++count)
                squares += std::pow(double(samples.samples[k].radiance.y / (x < 0 ? dark : 2.0f) - 1), 2);
        }
        return std::sqrt(squares / std::max(1.0, count));
    }
};

TEST(Gather, AveragesNoiseOverAVertexsFootprint) {
    // Bilinear alone leaves 0.67 of a pixel's noise, the mean over six by six pixels less than a third.
    EXPECT_LT(HalfDark(2.0f).error(2.0f, 0, 0.9f), 0.33 * 0.05);
}

TEST(Gather, DoesNotAverageOverAnEdge) {
    // Vertices beside the edge of a shadow or a print, four of six pixels away: 30 % of the footprint is beyond it.
    for (const float dark : {0.02f, 1.0f, 1.6f}) EXPECT_LT(HalfDark(dark).error(dark, 0.05f, 0.1f), 0.05) << dark;
}

TEST(Gather, HasTheSameBitsOnOneAndManyThreads) {
    const Shelf shelf;
    std::vector<View> views;
    for (int i = 0; i < 3; ++i)
        views.push_back(viewOf(
            shelf.scene, test::cameraAt({1.0 - i, -2, 3}, {0, 0, 0}, 60, 50, 60),
            [](const Vec3& p, uint32_t) { return Rgb(1.1f + p.x); }, blackSky));
    const auto bits = [&](int threads) {
        const ThreadLimit limit(threads);
        std::vector<float> all;
        const RadianceSamples samples = gather(shelf.scene, views);
        for (const RadianceSample& s : samples.samples) all.insert(all.end(), {s.radiance.x, s.weight, float(s.view)});
        all.push_back(samples.relativeNoise);
        return std::pair(samples.start, all);
    };
    EXPECT_EQ(bits(1), bits(4));
}

}  // namespace
}  // namespace relamp
