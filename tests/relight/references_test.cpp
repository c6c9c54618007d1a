// Frames against images path traced by Mitsuba's authors (direct light only). The folder is test data beside the
// source tree; MANIFEST.md there describes the scenes.
#include <gtest/gtest.h>

#include <filesystem>

#include "image/environment_map.h"
#include "image/image_io.h"
#include "relight/frame.h"
#include "support/estimates.h"

namespace relamp {
namespace {

namespace fs = std::filesystem;

class References : public testing::Test {
protected:
    void SetUp() override {
        if (!fs::exists(folder))
            GTEST_SKIP() << folder << " does not exist: the reference images are test data that is not shipped.";
    }
    /// Origin (0, 0, 4), looks at the origin, tan of half the field of view 0.305941.
    static Camera camera(int side) {
        return test::cameraAt({0, 0, 4}, {0, 0, 0}, side, side, side / 2 / 0.305941, {0, 1, 0});
    }
    static Frame render(const Scene& scene, const Estimate& estimate, const Look& look, int side,
                        bool background = false) {
        FrameOptions options;
        options.samplesPerPixel = 16;
        options.background = background;
        Progress progress;
        return renderFrame(test::relitOf(scene, estimate, look), camera(side), options, progress);
    }
    /// Differences over the image, relative to the reference's mean: of the means, and the median and 95th percentile
    /// of pixels.
    struct Difference {
        double mean = 0, median = 0, p95 = 0;
    };
    static Difference compare(const Frame& frame, const std::string& name) {
        const Image reference = readImage(fs::path(folder) / name);
        EXPECT_EQ(reference.width, frame.width);
        EXPECT_EQ(reference.height, frame.height);
        double sumA = 0, sumB = 0;
        std::vector<double> off;
        for (size_t p = 0; p < frame.beauty.size(); ++p) {
            sumA += luminance(frame.beauty[p]);
            sumB += luminance(reference.pixels[p]);
            off.push_back(std::abs(double(luminance(frame.beauty[p])) - luminance(reference.pixels[p])));
        }
        std::sort(off.begin(), off.end());
        const double scale = sumB / double(off.size());
        const Difference d{sumA / sumB - 1, off[off.size() / 2] / scale, off[off.size() * 95 / 100] / scale};
        std::printf("%s: means differ by %.2f %%, pixels by %.2f %% (median), %.2f %% (95th percentile)\n",
                    name.c_str(), d.mean * 100, d.median * 100, d.p95 * 100);
        return d;
    }
    static Mesh plane(float half) { return test::sheet({-half, -half, 0}, {2 * half, 0, 0}, {0, 2 * half, 0}, 2, 2); }

    static constexpr const char* folder = RELAMP_SOURCE_DIR "/../shared/data/refs";
};

TEST_F(References, NearFieldSquareEmitterBesideAPlaneAndASphere) {
    Mesh mesh = plane(1);
    const size_t onPlane = mesh.vertexCount();
    test::append(mesh, test::ball({0, 0, 0}, 0.25f, 64, 128));
    const Scene scene = test::sceneOf(mesh);
    Estimate estimate = test::matteEstimate(scene, Rgb(0.5f), Rgb(0));
    for (size_t v = 0; v < onPlane; ++v) estimate.reflectance.weight[0][v] = Rgb(1);
    Look look;
    // From facing -Z to facing -X.
    Mat4 matrix(Vec4(0, 0, -1, 0), Vec4(0, 1, 0, 0), Vec4(1, 0, 0, 0), Vec4(1.25f, 0, 1, 1));
    look.added.push_back({EmitterShape::rectangle, "lamp", matrix, Vec2(2), Rgb(3)});
    const Difference d = compare(render(scene, estimate, look, 128), "mitsuba_area_light_radiance.exr");
    EXPECT_NEAR(d.mean, 0, 0.005);
    EXPECT_LT(d.median, 0.02);
    EXPECT_LT(d.p95, 0.2);
}

TEST_F(References, ConstantEnvironmentOverAPlaneAndASphere) {
    Mesh mesh = plane(1);
    test::append(mesh, test::ball({0, 0, 0}, 0.25f, 64, 128));
    const Scene scene = test::sceneOf(mesh);
    const Difference d = compare(render(scene, test::matteEstimate(scene, Rgb(0.5f), Rgb(1)), {}, 128, true),
                                 "mitsuba_constant_emitter_radiance.exr");
    EXPECT_NEAR(d.mean, 0, 0.005);
    EXPECT_LT(d.median, 0.02);
    EXPECT_LT(d.p95, 0.2);
}

TEST_F(References, ShadowOfASphereUnderASmallFarBulb) {
    Mesh mesh = plane(1);
    test::append(mesh, test::ball({2, 0, 2}, 0.25f, 64, 128));
    const Scene scene = test::sceneOf(mesh);
    Look look;
    look.added.push_back({EmitterShape::sphere, "bulb", test::translation({4, 0, 4}), Vec2(0.1f), Rgb(1000)});
    const Difference d = compare(render(scene, test::matteEstimate(scene, Rgb(0.5f), Rgb(0)), look, 128),
                                 "mitsuba_translate_occluder_area_light.exr");
    EXPECT_NEAR(d.mean, 0, 0.01);
    EXPECT_LT(d.median, 0.02);
    EXPECT_LT(d.p95, 0.2);
}

TEST_F(References, PlaneUnderAPhotographedEnvironment) {
    const Image theirs = readImage(fs::path(folder) / "museum_envmap.exr");
    // Theirs has +Y up: direction (sin p sin t, cos t, -cos p sin t) at row t, column p.
    Image ours(1024, 512);
    for (int y = 0; y < ours.height; ++y)
        for (int x = 0; x < ours.width; ++x) {
            const Vec3 d = directionFromLatLong({(x + 0.5f) / ours.width, (y + 0.5f) / ours.height});
            float p = std::atan2(d.x, -d.z) / (2 * pi);
            p -= std::floor(p);
            const int u = std::min(int(p * theirs.width), theirs.width - 1),
                      v = std::min(int(std::acos(std::clamp(d.y, -1.0f, 1.0f)) / pi * theirs.height),
                                   theirs.height - 1);
            ours.at(x, y) = theirs.at(u, v);
        }
    const Scene scene = test::sceneOf(plane(3));
    Estimate estimate = test::matteEstimate(scene, Rgb(0.5f), Rgb(0));
    estimate.environmentSide = 256;
    estimate.environment = integrateOverCells(ours, DirectionGrid{256});
    const Difference d = compare(render(scene, estimate, {}, 64), "mitsuba_translate_plane_under_envmap.exr");
    EXPECT_NEAR(d.mean, 0, 0.01);
    EXPECT_LT(d.median, 0.05);
}

}  // namespace
}  // namespace relamp
