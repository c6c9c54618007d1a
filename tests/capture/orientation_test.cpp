#include "capture/orientation.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "capture/check.h"
#include "capture/load_capture.h"
#include "support/known_world.h"
#include "support/temporary_folder.h"

namespace relamp {
namespace {

TEST(Orientation, everyAxisTurnsToZAndNothingIsMirrored) {
    for (const char* name : {"x", "y", "z", "-x", "-y", "-z"}) {
        const Vec3 up = axisFromName(name);
        const Mat3 turn = rotationToZUp(up);
        EXPECT_EQ(turn * up, Vec3(0, 0, 1)) << name;
        EXPECT_FLOAT_EQ(glm::determinant(turn), 1) << name;
    }
    EXPECT_THROW(axisFromName("w"), Error);
    for (const char* name : {"1,2", "1,2,3,4", "0,0,0", "nan,1,1", "1,inf,0", "a,b,c"})
        EXPECT_THROW(axisFromName(name), Error) << name;
    EXPECT_THROW(axisFromName(""), Error);
}

TEST(Orientation, anyDirectionTurnsToZAndNothingIsMirrored) {
    for (const Vec3 given :
         {Vec3(1, 2, 3), Vec3(-1, 2, -3), Vec3(0.01f, 0.02f, -1), Vec3(1, -1, 0), Vec3(0, 0.1f, 1)}) {
        const Vec3 up = axisFromName(fmt::format("{},{},{}", given.x, given.y, given.z));
        EXPECT_NEAR(glm::distance(up, glm::normalize(given)), 0, 1e-6);
        const Mat3 turn = rotationToZUp(up);
        EXPECT_NEAR(glm::distance(turn * up, Vec3(0, 0, 1)), 0, 1e-6);
        EXPECT_NEAR(glm::determinant(turn), 1, 1e-5);
        EXPECT_NEAR(glm::length(turn * Vec3(0.3f, -0.4f, 1.2f)), 1.3f, 1e-5);
        EXPECT_NEAR(glm::distance(axisFromName(nameFromAxis(up)), up), 0, 1e-4);
    }
    EXPECT_EQ(nameFromAxis({0, -1, 0}), "-y");
}

/// The same world written with Y up loads as the world with Z up.
TEST(Orientation, aCaptureWithYUpLoadsAsTheSameWorld) {
    const test::TemporaryFolder folder;
    test::paintKnownWorld(folder / "room", true, 3, 4);
    Progress progress;
    const Capture upright = loadCapture(folder / "room", {}, progress);

    // Turned files: what was z is now y.
    const Mat3 fileFromWorld = glm::transpose(rotationToZUp({0, 1, 0}));
    nlohmann::json file = nlohmann::json::parse(test::TemporaryFolder::read(folder / "room/transforms.json"));
    file["up"] = "y";
    for (auto& frame : file["frames"])
        for (int c = 0; c < 4; ++c) {
            auto& m = frame["transform_matrix"];
            const Vec3 column = fileFromWorld * Vec3(m[0][size_t(c)].get<float>(), m[1][size_t(c)].get<float>(),
                                                     m[2][size_t(c)].get<float>());
            for (int r = 0; r < 3; ++r) m[size_t(r)][size_t(c)] = column[r];
        }
    Mesh turned = upright.mesh;
    for (Vec3& p : turned.positions) p = fileFromWorld * p;
    for (Vec3& n : turned.normals) n = fileFromWorld * n;
    writeVertexPly(folder / "room/mesh.ply", turned, {});
    folder.write("room/transforms.json", file.dump());
    const Capture again = loadCapture(folder / "room", {}, progress);
    for (size_t v = 0; v < turned.vertexCount(); ++v)
        EXPECT_LT(glm::distance(again.mesh.positions[v], upright.mesh.positions[v]), 1e-6f);
    for (size_t i = 0; i < 3; ++i)
        for (int c = 0; c < 4; ++c)
            EXPECT_LT(
                glm::length(again.views[i].camera.worldFromCamera[c] - upright.views[i].camera.worldFromCamera[c]),
                1e-6);
    EXPECT_EQ(again.up, Vec3(0, 1, 0));

    // Without the key the doctor names the file's axis, and saying so sets it right.
    file.erase("up");
    folder.write("room/transforms.json", file.dump());
    const CaptureCheck wrong = checkCapture(loadCapture(folder / "room", {}, progress), progress);
    EXPECT_EQ(wrong.up, "z");
    EXPECT_EQ(wrong.upGuess, "y");
    LoadOptions fixed;
    fixed.fix.up = "y";
    const CaptureCheck right = checkCapture(loadCapture(folder / "room", fixed, progress), progress);
    EXPECT_EQ(right.up, "y");
    EXPECT_EQ(right.upGuess, "y");
}

TEST(Orientation, flippedCamerasLookTheOtherWay) {
    const test::TemporaryFolder folder;
    test::paintKnownWorld(folder / "room", true, 3, 4);
    Progress progress;
    LoadOptions flip;
    flip.fix.flipCameras = true;
    const Capture a = loadCapture(folder / "room", {}, progress), b = loadCapture(folder / "room", flip, progress);
    EXPECT_LT(glm::length(a.views[0].camera.forward() + b.views[0].camera.forward()), 1e-12);
    EXPECT_TRUE(checkCapture(b, progress).lookBackwards);
    EXPECT_FALSE(checkCapture(a, progress).lookBackwards);
}

}  // namespace
}  // namespace relamp
