// What Blender makes of what leaves relamp; skipped where Blender is not installed.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>

#include "relight/backdrop.h"
#include "shot/export_frame.h"
#include "shot/export_scene.h"
#include "support/estimates.h"
#include "support/run_program.h"

namespace relamp {
namespace {

constexpr const char* blender = "/usr/bin/blender";

class Blender : public testing::Test {
protected:
    void SetUp() override {
        if (!std::filesystem::exists(blender)) GTEST_SKIP() << "Blender is not installed";
        const Scene scene = test::sceneOf(test::sheet({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, 2, 2));
        shot.estimate = test::matteEstimate(scene, Rgb(0.5f), Rgb(1));
        shot.capture.mesh = scene.mesh;
        View view;
        view.name = "view";
        view.camera = test::cameraAt({0, -2, 1.5}, {0, 0, 0}, 24, 18, 20);
        shot.capture.views.push_back(view);
        Look look;
        look.added.push_back({EmitterShape::rectangle, "lamp", test::translation({0.25f, 0.5f, 1}), Vec2(0.5f, 0.25f),
                              Rgb(150, 98, 50)});
        relit = test::relitOf(scene, shot.estimate, look);
    }
    nlohmann::json opened(const std::filesystem::path& file) {
        const test::ProgramResult r =
            test::runProgram({blender, "-b", "--factory-startup", "--python",
                              RELAMP_SOURCE_DIR "/tests/shot/blender_import.py", "--", file.string()});
        const size_t at = r.out.find("RELAMP ");
        if (at == std::string::npos) {
            ADD_FAILURE() << r.out << r.error;
            return {};
        }
        return nlohmann::json::parse(r.out.substr(at + 7, r.out.find('\n', at) - at - 7));
    }
    test::TemporaryFolder folder;
    Shot shot;
    RelitScene relit;
};

/// Brightest in its middle, redder to the top.
Image rampPanorama() {
    Image image(256, 128);
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x)
            image.at(x, y) = Rgb(3 - float(y) / 64, 1, 0.5f) * (0.5f + float(std::min(x, 256 - x)) / 64);
    return image;
}

TEST_F(Blender, FindsTheEmitterWhereItStoodWithItsRadiance) {
    exportScene(shot, relit, folder / "out", false);
    const nlohmann::json emitter = opened(folder / "out/lights.gltf").at("lamp");
    const float place[3] = {0.25f, 0.5f, 1}, half[3] = {0.25f, 0.125f, 0}, radiance[3] = {150, 98, 50};
    for (size_t k = 0; k < 3; ++k) {
        EXPECT_NEAR(emitter["location"][k].get<double>(), place[k], 1e-5);
        EXPECT_NEAR(emitter["low"][k].get<double>(), place[k] - half[k], 1e-5);
        EXPECT_NEAR(emitter["high"][k].get<double>(), place[k] + half[k], 1e-5);
        EXPECT_NEAR(emitter["radiance"][k].get<double>(), radiance[k], 1e-3);
    }
    EXPECT_NEAR(emitter["area"].get<double>(), 0.125, 1e-6);
}

TEST_F(Blender, RendersTheRebuiltSceneAsRelampDoes) {
    // A principal point off the centre, so that the camera's shifts take part.
    shot.capture.views[0].camera.centreX += 2;
    shot.capture.views[0].camera.centreY -= 1.5;
    // One end of the lamp shines twice as brightly as the other.
    const std::vector<Vec3> ends{{0, 0.375f, 1}, {0, 0.625f, 1}, {0.5f, 0.375f, 1}, {0.5f, 0.625f, 1}};
    relit.emitters[0].emission.shaped = std::make_shared<const ShapedEmission>(
        std::make_shared<const EmissionPattern>(ends, std::vector<float>{1.33f, 1.33f, 0.67f, 0.67f}), Mat4(1));
    // What is seen behind the scene, turned, is not what lights it.
    Backdrop backdrop;
    backdrop.layers.push_back({std::make_shared<const Panorama>(rampPanorama()), 1});
    backdrop.yawDegrees = 40;
    relit.distant = std::make_shared<const DistantLight>(relit.distant->grid(), relit.distant->cells(),
                                                         std::make_shared<const Backdrop>(backdrop));
    exportScene(shot, relit, folder / "out", false);
    const auto rendered = folder / "cycles.exr";
    const test::ProgramResult r =
        test::runProgram({blender, "-b", "--factory-startup", "--python-exit-code", "1", "--python",
                          (folder / "out/scene.py").string(), "--", "--samples", "256", "--render", rendered.string()});
    ASSERT_EQ(r.exitCode, 0) << r.out << r.error;
    const Image cycles = readImage(rendered);
    FrameOptions options;
    options.samplesPerPixel = 64;
    Progress progress;
    const Frame frame = renderFrame(relit, shot.capture.views[0].camera, options, progress);
    ASSERT_EQ(cycles.pixels.size(), frame.beauty.size());
    // The floor, its edges left out; the environment; the lamp, which nobody sees from below its edge.
    Rgb ours(0), theirs(0);
    size_t floor = 0;
    for (int y = 1; y + 1 < cycles.height; ++y)
        for (int x = 1; x + 1 < cycles.width; ++x) {
            const auto whole = [&](int dx, int dy) {
                const size_t at = size_t((y + dy) * cycles.width + x + dx);
                return frame.alpha[at] > 0.999f && frame.emittersSeen[at][0].emitter < 0;
            };
            if (!whole(0, 0) || !whole(1, 0) || !whole(-1, 0) || !whole(0, 1) || !whole(0, -1)) continue;
            const size_t at = size_t(y * cycles.width + x);
            ++floor;
            ours += frame.beauty[at];
            theirs += cycles.pixels[at];
            EXPECT_NEAR(cycles.pixels[at].x / frame.beauty[at].x, 1, 0.06) << x << " " << y;
        }
    EXPECT_GT(floor, 60u);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(theirs[c] / ours[c], 1, 0.01) << c;
    for (const int x : {0, cycles.width - 1})
        for (int c = 0; c < 3; ++c) {
            const Rgb behind = frame.beauty[size_t(x)];
            EXPECT_NEAR(cycles.pixels[size_t(x)][c] / behind[c], 1, 0.01) << "the backdrop at pixel " << x;
        }
    EXPECT_GT(std::abs(frame.beauty[0].x / frame.beauty[size_t(cycles.width - 1)].x - 1), 0.1) << "its ends differ";
}

TEST_F(Blender, OpensEveryLayerOfAFrame) {
    for (const bool multipart : {false, true}) {
        FrameFileOptions how;
        how.layers = "all";
        how.multipart = multipart;
        FrameOptions options;
        options.samplesPerPixel = 1;
        Progress progress;
        writeFrameFile(folder / "frame.exr", shot.capture.views[0].camera, {&relit, nullptr, nullptr, 0}, options, how,
                       progress);
        const nlohmann::json image = opened(folder / "frame.exr");
        EXPECT_EQ(image["type"], "MULTILAYER");
        std::set<std::string> layers;
        for (const auto& name : image["layers"]) layers.insert(name.get<std::string>());
        for (const char* name : {"Combined", "Combined_world", "Combined_lamp", "Combined_rest", "albedo", "correction",
                                 "normal", "position", "depth", "CryptoEmitter00"})
            EXPECT_TRUE(layers.contains(name)) << name << (multipart ? " of a multi-part file" : "");
    }
}

}  // namespace
}  // namespace relamp
