// A thin board whose two sides errors of the mesh have moved through one another.
#include "radiance/crossed_sheets.h"

#include <gtest/gtest.h>

#include "radiance/gather.h"
#include "support/estimates.h"

namespace relamp {
namespace {

constexpr float halfBoard = 0.002f, wave = 0.006f;

/// A board of 80 x 60 cm in the plane y = 0, each side moved along its normal by waves: y > 0 and y < 0 faces.
Mesh boardOf(float waves, bool inward = false) {
    const auto off = [&](const Vec3& p) { return halfBoard + waves * std::sin(9 * p.x) * std::sin(7 * p.z); };
    Mesh front = test::sheet({0.4f, 0, 0.2f}, {-0.8f, 0, 0}, {0, 0, 0.6f}, 80, 60);
    Mesh back = test::sheet({-0.4f, 0, 0.2f}, {0.8f, 0, 0}, {0, 0, 0.6f}, 80, 60);
    for (Vec3& p : front.positions) p.y = off(p);
    for (Vec3& p : back.positions) p.y = -off(p);
    Mesh mesh = std::move(front);
    test::append(mesh, back);
    if (inward)
        for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
    mesh.normals = vertexNormalsFromFaces(mesh);
    return mesh;
}

struct PhotographedBoard {
    Capture capture;
    Scene scene;
    RadianceSamples samples;

    explicit PhotographedBoard(const Mesh& mesh) : scene(test::sceneOf(mesh)) {
        capture.mesh = mesh;
        for (int i = 0; i < 6; ++i) {
            const double turn = 2 * piD * (i + 0.3) / 6;
            View view;
            view.camera = test::cameraAt({1.5 * std::cos(turn), 1.5 * std::sin(turn), 0.8}, {0, 0, 0.4}, 240, 180, 220);
            view.image = Image(240, 180);
            for (Rgb& pixel : view.image.pixels) pixel = Rgb(0.4f);
            capture.views.push_back(view);
        }
        Progress progress;
        samples = gatherRadiance(capture, scene, {}, progress);
    }
    CrossedSheets crossed() const {
        return crossedSheets(scene, capture, samples, std::vector<uint8_t>(scene.mesh.vertexCount(), 0));
    }
};

/// Pixels that see a surface from behind.
size_t backsSeen(const PhotographedBoard& world) {
    size_t count = 0;
    for (size_t i = 0; i < world.capture.views.size(); ++i) {
        const ViewGeometry& g = world.samples.geometry[i];
        for (int y = 0; y < g.height; ++y)
            for (int x = 0; x < g.width; ++x) {
                const uint32_t t = g.triangle[size_t(y) * size_t(g.width) + size_t(x)];
                if (t == Hit::none) continue;
                const Vec3 ray = world.capture.views[i].camera.rayDirection({float(x) + 0.5f, float(y) + 0.5f});
                count += glm::dot(world.scene.mesh.faceNormal(t), ray) > 0.1f;
            }
    }
    return count;
}

TEST(CrossedSheets, ArePartedAndKeepTheirMiddle) {
    const PhotographedBoard world(boardOf(wave));
    const CrossedSheets found = world.crossed();
    ASSERT_GT(found.crossed, 1000u);
    EXPECT_NEAR(found.deepest, 2 * (wave - halfBoard), 0.003f);
    Mesh mesh = world.scene.mesh;
    for (const MeshMend::MovedVertex& m : found.moved) {
        EXPECT_NEAR(m.position.x, mesh.positions[m.vertex].x, 2e-3f);
        EXPECT_NEAR(m.position.y, 0, 2e-3f);
        mesh.positions[m.vertex] = m.position;
    }
    mesh.normals = vertexNormalsFromFaces(mesh);
    const size_t before = backsSeen(world), after = backsSeen(PhotographedBoard(mesh));
    EXPECT_GT(before, 2000u);
    EXPECT_LT(after, before / 20);
}

TEST(CrossedSheets, ABoardThatIsWholeStaysAsItIs) {
    EXPECT_TRUE(PhotographedBoard(boardOf(0)).crossed().moved.empty());
}

TEST(CrossedSheets, ABoardThatIsInsideOutIsNotCrossed) {
    const PhotographedBoard world(boardOf(0, true));
    ASSERT_GT(backsSeen(world), 2000u);
    EXPECT_TRUE(world.crossed().moved.empty());
}

TEST(CrossedSheets, WallsThatFaceEachOtherOverAHollowStayApart) {
    // Two single sheets, 2 cm apart, both seen from behind.
    Mesh mesh = boardOf(0, true);
    for (Vec3& p : mesh.positions) p.y *= 5;
    for (Vec3& p : mesh.positions)
        if (p.y > 0) p.x *= 0.5f;
    const PhotographedBoard world(mesh);
    ASSERT_GT(backsSeen(world), 2000u);
    EXPECT_TRUE(world.crossed().moved.empty());
}

}  // namespace
}  // namespace relamp
