// A capture whose files lie far from their origin: inside, positions count from near the scene; what comes in and goes
// out counts from the files' origin.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "capture/check.h"
#include "capture/load_capture.h"
#include "relight/frame.h"
#include "scene/mesh_io.h"
#include "shot/camera_path.h"
#include "shot/export_scene.h"
#include "shot/frame_layers.h"
#include "shot/shot_file.h"
#include "support/estimates.h"
#include "support/known_world.h"
#include "support/temporary_folder.h"

namespace relamp {
namespace {

using nlohmann::json;
const DVec3 away(448256.25, -5411904.5, 317.125);

DVec3 placeOf(const json& list) {
    return {list.at(0).get<double>(), list.at(1).get<double>(), list.at(2).get<double>()};
}

/// The same world in two folders, in the second moved by `away`.
class FarOrigin : public testing::Test {
protected:
    void SetUp() override {
        test::paintKnownWorld(folder / "near", true, 2, 4);
        std::filesystem::copy(folder / "near", folder / "far", std::filesystem::copy_options::recursive);
        const Mesh mesh = readMesh(folder / "near/mesh.ply");
        writeVertexPly(folder / "far/mesh.ply", mesh, {}, away);
        json file = json::parse(test::TemporaryFolder::read(folder / "near/transforms.json"));
        for (auto& frame : file["frames"])
            for (int r = 0; r < 3; ++r) {
                auto& x = frame["transform_matrix"][size_t(r)][3];
                x = x.get<double>() + away[r];
            }
        folder.write("far/transforms.json", file.dump());
        near = loadCapture(folder / "near", {}, progress);
        far = loadCapture(folder / "far", {}, progress);
    }
    test::TemporaryFolder folder;
    Progress progress;
    Capture near, far;
};

TEST_F(FarOrigin, LoadsAsTheSameWorldButForTheOrigin) {
    EXPECT_EQ(near.origin, DVec3(0));
    EXPECT_LT(glm::distance(far.origin, away), 4);
    const DVec3 moved = away - far.origin;
    ASSERT_EQ(far.mesh.vertexCount(), near.mesh.vertexCount());
    for (size_t v = 0; v < near.mesh.vertexCount(); ++v)
        ASSERT_LT(glm::distance(DVec3(far.mesh.positions[v]), DVec3(near.mesh.positions[v]) + moved), 1e-6) << v;
    EXPECT_EQ(far.mesh.triangles, near.mesh.triangles);
    for (size_t i = 0; i < near.views.size(); ++i)
        EXPECT_LT(glm::distance(far.views[i].camera.position(), near.views[i].camera.position() + moved), 1e-8);
    const json box = toJson(checkCapture(far, progress)).at("mesh"),
               nearBox = toJson(checkCapture(near, progress)).at("mesh");
    EXPECT_LT(glm::distance(placeOf(box.at("min")), placeOf(nearBox.at("min")) + away), 1e-6);
    EXPECT_LT(glm::distance(placeOf(box.at("max")), placeOf(nearBox.at("max")) + away), 1e-6);
}

TEST_F(FarOrigin, AnotherUnitAndAnotherAxisMoveItToo) {
    LoadOptions fixed;
    fixed.fix.up = "y";
    fixed.fix.scale = 0.01;
    const Capture a = loadCapture(folder / "near", fixed, progress), b = loadCapture(folder / "far", fixed, progress);
    const DVec3 turned = 0.01 * DVec3(away.x, -away.z, away.y);
    for (size_t v = 0; v < a.mesh.vertexCount(); v += 7)
        ASSERT_LT(glm::distance(b.origin + DVec3(b.mesh.positions[v]), DVec3(a.mesh.positions[v]) + turned), 1e-8) << v;
    EXPECT_LT(glm::distance(b.origin + b.views[0].camera.position(), a.views[0].camera.position() + turned), 1e-8);
}

TEST_F(FarOrigin, ProxyLightsAndCameraFilesCountFromTheFilesOrigin) {
    LoadOptions options;
    options.fix.proxies.push_back({away + DVec3(0.5, 0.25, 1.5), 0.05f, Vec3(0), false});
    const Capture with = loadCapture(folder / "far", options, progress);
    ASSERT_EQ(with.proxies.size(), 1u);
    EXPECT_LT(glm::distance(with.origin + with.proxies[0].centre, away + DVec3(0.5, 0.25, 1.5)), 1e-8);
    EXPECT_LT(glm::distance(with.origin + DVec3(with.mesh.positions.back()), away + DVec3(0.5, 0.25, 1.5)), 0.06);
    const CameraFile cameras = readCameraPath(far, folder / "far/transforms.json");
    ASSERT_EQ(cameras.cameras.size(), 2u);
    EXPECT_LT(glm::distance(cameras.cameras[1].position(), far.views[1].camera.position()), 1e-9);
}

TEST_F(FarOrigin, LooksAreWrittenForTheFilesOrigin) {
    // An emitter turned by 90 degrees about a point of the scene, one added, and a part that moves.
    Look inside;
    Mat4 turn(Vec4(0, 1, 0, 0), Vec4(-1, 0, 0, 0), Vec4(0, 0, 1, 0), Vec4(0.5f, -0.25f, 0, 1));
    inside.emitters.push_back({"emitter-1", true, turn, Rgb(1)});
    inside.added.push_back({EmitterShape::disk, "new", test::translation({0.25f, 0.5f, 1}), Vec2(1), Rgb(1)});
    inside.parts.push_back({3, test::translation({0, 0.125f, 0})});
    const json document = lookToJson(inside, far.origin);
    EXPECT_EQ(lookFromJson(document, "", far.origin), inside);
    const auto column = [](const json& m) {
        return DVec3(m[0][3].get<double>(), m[1][3].get<double>(), m[2][3].get<double>());
    };
    EXPECT_LT(glm::distance(column(document["added_emitters"][0]["matrix"]), far.origin + DVec3(0.25, 0.5, 1)), 1e-9);
    EXPECT_LT(glm::distance(column(document["parts"][0]["matrix"]), DVec3(0, 0.125, 0)), 1e-9)
        << "a shift is a shift everywhere";
    const DVec3 p(0.75, 0.5, 0.25), place = far.origin + p;
    const DVec3 went = glm::dmat3(glm::mat3(turn)) * place + column(document["emitters"][0]["matrix"]);
    EXPECT_LT(glm::distance(went, far.origin + DVec3(Vec3(turn * Vec4(Vec3(p), 1)))), 1e-8)
        << "the same point of the scene goes to the same place";
}

TEST_F(FarOrigin, ShotsAndWhatIsExportedLieWhereTheFilesDo) {
    const Scene scene = test::sceneOf(far.mesh);
    std::vector<uint32_t> emitter;
    for (uint32_t t = uint32_t(far.mesh.triangles.size()) - 8; t < far.mesh.triangles.size(); ++t) emitter.push_back(t);
    Shot shot;
    shot.captureFolder = folder / "far";
    shot.capture = far;
    shot.estimate =
        test::matteEstimate(scene, Rgb(0.5f), Rgb(1), test::emittersOf(scene, {emitter}, {Rgb(12, 11, 10)}));
    shot.estimate.environmentSide = 256;
    shot.estimate.environment.assign(256 * 256, Rgb(0.1f));
    shot.look.emitters.push_back({"emitter-1", true, test::translation({0, 0, -0.5f}), Rgb(2)});
    const DVec3 centroid = far.origin + DVec3(shot.estimate.emitters.emitters[0].centroid);
    saveShot(shot, scene.mesh, folder / "a.relamp", false);
    const json document = json::parse(test::TemporaryFolder::read(folder / "a.relamp/shot.json"));
    EXPECT_LT(glm::distance(placeOf(document["emitters"][0]["centroid"]), centroid), 1e-8);
    MeshReport report;
    const Mesh reflectance = readMesh(folder / "a.relamp/reflectance.ply", &report);
    EXPECT_LT(glm::distance(report.origin + DVec3(reflectance.positions[5]), far.origin + DVec3(far.mesh.positions[5])),
              1e-7);
    const Shot back = openShot(folder / "a.relamp", false, progress);
    EXPECT_EQ(back.capture.origin, far.origin);
    EXPECT_EQ(back.look, shot.look);
    EXPECT_EQ(back.estimate.emitters.emitters[0].centroid, shot.estimate.emitters.emitters[0].centroid);

    const RelitScene relit = test::relitOf(scene, shot.estimate, {});
    exportScene(shot, relit, folder / "out", false);
    const DVec3 emitterAt = far.origin + DVec3(relit.emitters[0].surface.centroid);
    EXPECT_LT(glm::distance(emitterAt, centroid), 1e-6);
    const json lights = json::parse(test::TemporaryFolder::read(folder / "out/lights.json"));
    EXPECT_LT(glm::distance(placeOf(lights["lights"][0]["centroid"]), emitterAt), 1e-8);
    const json gltf = json::parse(test::TemporaryFolder::read(folder / "out/lights.gltf"));
    EXPECT_LT(glm::distance(placeOf(gltf["nodes"][1]["translation"]), emitterAt), 1e-8);
    const std::string usd = test::TemporaryFolder::read(folder / "out/lights.usda");
    EXPECT_NE(usd.find(fmt::format("xformOp:translate = ({}, {}, {})", emitterAt.x, emitterAt.y, emitterAt.z)),
              std::string::npos);
    // What was exported is a capture of the same place.
    const CameraFile cameras = readCameraPath(far, folder / "out/transforms.json");
    EXPECT_LT(glm::distance(cameras.cameras[0].position(), far.views[0].camera.position()), 1e-8);
    readMesh(folder / "out/materials.ply", &report);
    EXPECT_EQ(report.origin, far.origin);

    FrameOptions options;
    options.samplesPerPixel = 1;
    FrameStrip strip;
    strip.frame = renderFrame(relit, far.views[0].camera, options, progress);
    const size_t pixels = strip.frame.beauty.size(),
                 hit = size_t(std::max_element(strip.frame.alpha.begin(), strip.frame.alpha.end()) -
                              strip.frame.alpha.begin());
    std::vector<std::vector<float>> channels(7, std::vector<float>(pixels));
    std::vector<float*> out;
    for (auto& channel : channels) out.push_back(channel.data());
    FrameLayers(layerRequest("position"), LayerNaming::blender, {}, far.origin).fill(strip, out);
    for (int c = 0; c < 3; ++c)
        EXPECT_EQ(channels[size_t(4 + c)][hit], float(far.origin[c] + double(strip.frame.position[hit][c]))) << c;
}

}  // namespace
}  // namespace relamp
