// Files that mean another unit, axis or hand than they are read with are told by how photographs agree, and set right
// by what is advised.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "capture/check.h"
#include "capture/load_capture.h"
#include "scene/mesh_io.h"
#include "support/known_world.h"
#include "support/measured.h"

namespace relamp {
namespace {

using nlohmann::json;

/// One painted room for all of these; its files are written anew by each.
class Placement : public testing::Test {
protected:
    static const test::TemporaryFolder& folder() {
        static const test::TemporaryFolder folder;
        return folder;
    }
    static const test::KnownWorld& world() {
        static const test::KnownWorld world = test::paintKnownWorld(folder() / "room", true, 6, 16);
        return world;
    }
    static const json& file() {
        static const json file = (world(), json::parse(test::TemporaryFolder::read(folder() / "room/transforms.json")));
        return file;
    }

    /// `camera` of each pose, a 4 x 4 matrix; `mesh` of each position.
    void write(const std::function<glm::dmat4(const glm::dmat4&)>& camera,
               const std::function<Vec3(const Vec3&)>& mesh) {
        json changed = file();
        for (json& frame : changed["frames"]) {
            json& rows = frame["transform_matrix"];
            glm::dmat4 m(1.0);
            for (int r = 0; r < 4; ++r)
                for (int c = 0; c < 4; ++c) m[c][r] = rows[size_t(r)][size_t(c)].get<double>();
            m = camera(m);
            for (int r = 0; r < 4; ++r)
                for (int c = 0; c < 4; ++c) rows[size_t(r)][size_t(c)] = m[c][r];
        }
        folder().write("room/transforms.json", changed.dump());
        Mesh placed = world().mesh;
        for (Vec3& p : placed.positions) p = mesh(p);
        for (Vec3& n : placed.normals) n = glm::normalize(mesh(n));
        writeVertexPly(folder() / "room/mesh.ply", placed, {});
    }
    CaptureCheck check(const CaptureFix& fix = {}) {
        Progress progress;
        LoadOptions options;
        options.fix = fix;
        return checkCapture(loadCapture(folder() / "room", options, progress), progress);
    }
    /// The one advice, which leads to a capture without any; nothing is said of axes or poses beside it.
    CaptureFix followed(const std::string& option, const CaptureFix& from = {}) {
        const CaptureCheck found = check(from);
        EXPECT_TRUE(found.advice) << option;
        if (!found.advice) return {};
        EXPECT_EQ(found.advice->option, option);
        EXPECT_EQ(found.warnings.empty() ? "" : found.warnings[0], found.advice->words);
        for (const std::string& warning : found.warnings)
            for (const char* other : {"--up", "OpenCV axes", "stops", "covers", "two views"})
                EXPECT_EQ(warning.find(other), std::string::npos) << option << ": " << warning;
        const CaptureFix fix = advised(from, *found.advice);
        const CaptureCheck after = check(fix);
        EXPECT_FALSE(after.advice) << option << ", then " << (after.advice ? after.advice->option : "");
        EXPECT_GT(after.seenTwiceFraction, 0.6) << option;
        EXPECT_LT(after.exposureSpreadStops, 0.2) << option;
        return fix;
    }
};

glm::dmat4 same(const glm::dmat4& m) { return m; }
glm::dmat4 mirror(int axis) {
    glm::dmat4 m(1.0);
    m[axis][axis] = -1;
    return m;
}

TEST_F(Placement, AGoodCaptureGetsNoAdvice) {
    write(same, [](const Vec3& p) { return p; });
    const CaptureCheck good = check();
    EXPECT_FALSE(good.advice) << good.advice->words;
    EXPECT_FALSE(good.unitQuestion);
}

TEST_F(Placement, AMeshInAnotherUnitIsTold) {
    for (const auto& [factor, option, unit] : {std::tuple{100.0f, "--mesh-scale 0.01", "centimetres"},
                                               {1000.0f, "--mesh-scale 0.001", "millimetres"},
                                               {10.0f, "--mesh-scale 0.1", "decimetres"}}) {
        write(same, [&, factor = factor](const Vec3& p) { return factor * p; });
        EXPECT_EQ(followed(option).scale, 1);
        EXPECT_NE(check().warnings.at(0).find(unit), std::string::npos);
    }
}

TEST_F(Placement, CamerasInAnotherUnitAreTold) {
    const auto centimetres = [](glm::dmat4 m) {
        for (int r = 0; r < 3; ++r) m[3][r] *= 100;
        return m;
    };
    write(centimetres, [](const Vec3& p) { return p; });
    const CaptureFix fix = followed("--mesh-scale 100 --scale 0.01");
    Progress progress;
    LoadOptions options;
    options.fix = fix;
    const Capture capture = loadCapture(folder() / "room", options, progress);
    EXPECT_NEAR(glm::distance(capture.mesh.positions[5], world().mesh.positions[5]), 0, 1e-5) << "in metres again";
    // Both: nothing contradicts it, so it is asked.
    write(centimetres, [](const Vec3& p) { return 100.0f * p; });
    const CaptureCheck both = check();
    EXPECT_FALSE(both.advice);
    ASSERT_TRUE(both.unitQuestion);
    EXPECT_EQ(both.unitQuestion->scale, 0.01);
    EXPECT_EQ(both.unitQuestion->button, "Lengths are centimetres");
}

TEST_F(Placement, AMeshInAnotherUnitWithAnotherAxisUpIsTold) {
    write(same, [](const Vec3& p) { return 100.0f * Vec3(p.x, p.z, -p.y); });
    followed("--mesh-scale 0.01 --mesh-up y");
}

TEST_F(Placement, ALeftHandedWorldIsTold) {
    // Cameras alone, mirrored in the world and in themselves.
    write([](const glm::dmat4& m) { return mirror(0) * m * mirror(0); }, [](const Vec3& p) { return p; });
    followed("--mirror x");
    write([](const glm::dmat4& m) { return mirror(1) * m * mirror(1); }, [](const Vec3& p) { return p; });
    followed("--mirror y");
    // The whole world.
    write([](const glm::dmat4& m) { return mirror(1) * m * mirror(1); },
          [](const Vec3& p) { return Vec3(p.x, -p.y, p.z); });
    const CaptureFix fix = followed("--mirror y --mesh-mirror y");
    Progress progress;
    LoadOptions options;
    options.fix = fix;
    const Capture capture = loadCapture(folder() / "room", options, progress);
    EXPECT_EQ(capture.mesh.positions[5], world().mesh.positions[5]);
    EXPECT_NEAR(glm::distance(capture.mesh.normals[5], world().mesh.normals[5]), 0, 1e-5);
    // The mesh alone.
    write(same, [](const Vec3& p) { return Vec3(p.x, -p.y, p.z); });
    followed("--mesh-mirror y");
}

TEST_F(Placement, MatricesThatMirrorAreReadWhereThatIsSaid) {
    write([](const glm::dmat4& m) { return mirror(1) * m; }, [](const Vec3& p) { return p; });
    const std::string refused = test::messageOf([&] { check(); });
    EXPECT_NE(refused.find("frame 0: transform_matrix mirrors the world"), std::string::npos) << refused;
    EXPECT_NE(refused.find("--mirror"), std::string::npos) << refused;
    CaptureFix right;
    right.mirror = "y";
    EXPECT_FALSE(check(right).advice);
    CaptureFix wrong;
    wrong.mirror = "x";
    followed("--mirror y", wrong);
    wrong.mirror = "w";
    EXPECT_NE(test::messageOf([&] { check(wrong); }).find("--mirror: expected \"x\", \"y\" or \"z\""),
              std::string::npos);
}

}  // namespace
}  // namespace relamp
