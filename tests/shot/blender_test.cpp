// What Blender makes of what leaves relamp; skipped where Blender is not installed.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>

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
