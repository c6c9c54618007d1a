// The environment behind the viewport against the backdrop that frames have. Needs OpenGL 4.3 without a window,
// llvmpipe too; without EGL it says so.
#include <gtest/gtest.h>

#include "image/environment_map.h"
#include "relight/backdrop.h"
#include "support/estimates.h"
#include "viewport/gpu_context.h"
#include "viewport/renderer.h"

namespace relamp::ui {
namespace {

/// A slope in every channel, without an edge that two ways to interpolate could differ at.
std::shared_ptr<const Panorama> slopes() {
    Image map(256, 128);
    for (int y = 0; y < map.height; ++y)
        for (int x = 0; x < map.width; ++x) {
            const Vec3 d = directionFromLatLong({(float(x) + 0.5f) / 256, (float(y) + 0.5f) / 128});
            map.at(x, y) = Rgb(0.3f) + 0.25f * d;
        }
    return std::make_shared<const Panorama>(map);
}

TEST(EnvironmentLayer, isTurnedAndColouredAsFramesHaveIt) {
    std::string why;
    const auto context = openGpuContext(true, &why);
    if (why.find("EGL is not installed") != std::string::npos || why == "EGL offers no display") GTEST_SKIP() << why;
    ASSERT_TRUE(context) << why;
    context->makeCurrent();
    {
        Backdrop backdrop;
        backdrop.layers = {{slopes(), 1}};
        backdrop.yawDegrees = 70;
        backdrop.gain = Rgb(1, 0.8f, 0.6f);
        backdrop.sides = {Rgb(0.5f), Rgb(1), Rgb(1, 0.5f, 1), Rgb(1.5f), Rgb(1), Rgb(0.7f)};
        Image baked(1024, 512);
        for (int y = 0; y < baked.height; ++y)
            for (int x = 0; x < baked.width; ++x)
                baked.at(x, y) =
                    backdrop.radiance(directionFromLatLong({(float(x) + 0.5f) / 1024, (float(y) + 0.5f) / 512}));
        const Panorama expected(baked);

        Renderer renderer;
        GlTexture plain, whole;
        const Panorama& panorama = *backdrop.layers[0].panorama;
        uploadHalf(plain, panorama.width(), panorama.height(), panorama.halves().data());
        uploadHalf(whole, expected.width(), expected.height(), expected.halves().data());
        const auto imageOf = [&](const DVec3& target, const EnvironmentLayer& environment) {
            ImageJob job;
            job.eye = eyeOf(test::cameraAt({0, 0, 0}, target, 80, 60, 40), {0, 0}, {80, 60}, {1, 1}, {0, 0, 0}, 4);
            SceneLayer layer;
            layer.environment = environment;
            job.layers = {layer};
            renderer.draw(job, 0);
            int width = 0, height = 0;
            return renderer.readBack(width, height);
        };
        for (const DVec3& target : {DVec3(1, 0, 0.2), DVec3(-1, 0.3, -0.5), DVec3(0.1, -1, 0.9)}) {
            const auto shown =
                imageOf(target, {plain.id(), backdrop.yawDegrees, panorama.scale() * backdrop.gain, backdrop.sides});
            const auto wanted = imageOf(target, {whole.id(), 0, Rgb(expected.scale()), evenSides});
            ASSERT_EQ(shown.size(), wanted.size());
            int most = 0, brightest = 0;
            for (size_t i = 0; i < shown.size(); ++i) {
                most = std::max(most, std::abs(int(shown[i]) - int(wanted[i])));
                if (i % 4 < 3) brightest = std::max(brightest, int(wanted[i]));
            }
            EXPECT_LE(most, 2);
            EXPECT_GT(brightest, 60) << "something is shown";
        }
    }
    context->release();
}

}  // namespace
}  // namespace relamp::ui
