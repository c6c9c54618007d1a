// A room of which photographs show a part of the walls.
#include "radiance/cut_surfaces.h"

#include <gtest/gtest.h>

#include "radiance/gather.h"
#include "support/estimates.h"
#include "support/shapes.h"

namespace relamp {
namespace {

constexpr float roomHalf = 1;  ///< metres: of the square floor
constexpr float shownHeight = 0.5f;

/// A floor, a wall behind it and one on its right; the mesh ends at `height`.
Mesh room(float wallHeight, float sideHeight) {
    Mesh mesh = test::sheet({-roomHalf, -roomHalf, 0}, {2 * roomHalf, 0, 0}, {0, 2 * roomHalf, 0}, 80, 80);
    test::append(mesh, test::sheet({-roomHalf, roomHalf, 0}, {2 * roomHalf, 0, 0}, {0, 0, wallHeight}, 80, 20));
    test::append(mesh, test::sheet({roomHalf, roomHalf, 0}, {0, -2 * roomHalf, 0}, {0, 0, sideHeight}, 80, 20));
    return mesh;
}

/// Photographs of `real` that look down, so that nothing at `shownHeight` is in a frame; `high`: one looks up.
std::vector<CutSurface> cutIn(const Mesh& real, const Mesh& mesh, bool high = false) {
    const Scene world = test::sceneOf(real), scene = test::sceneOf(mesh);
    Capture capture;
    capture.mesh = mesh;
    for (int i = 0; i < 6; ++i) {
        View view;
        const double x = -0.9 + 0.3 * i;
        view.camera = test::cameraAt({x, -1.6, 0.8}, {0.4, 0.3, high && i == 3 ? 0.4 : -0.85}, 320, 240, 230);
        const Vec3 eye(view.camera.position());
        view.image = Image(320, 240);
        for (int row = 0; row < 240; ++row)
            for (int column = 0; column < 320; ++column) {
                const Vec3 d = view.camera.rayDirection({float(column) + 0.5f, float(row) + 0.5f});
                const Hit hit = world.tracer->closest({eye, d, 0, 1e30f});
                const Vec3 p = eye + d * hit.distance;
                view.image.at(column, row) = hit ? Rgb(0.5f, 0.4f, 0.3f) * (1 + 0.1f * std::sin(20 * (p.x + p.y + p.z)))
                                                 : Rgb(0.1f + 0.05f * std::sin(5 * d.x), 0.1f, 2);
            }
        capture.views.push_back(view);
    }
    Progress progress;
    return cutSurfaces(scene, capture, gatherRadiance(capture, scene, {}, progress),
                       std::vector<uint8_t>(mesh.vertexCount(), 0));
}

const CutSurface* upwards(const std::vector<CutSurface>& sides, const Vec3& facing) {
    for (const CutSurface& s : sides)
        if (s.out.z > 0.9 && glm::dot(Vec3(s.surface.up), facing) > 0.9f) return &s;
    return nullptr;
}

TEST(CutSurfaces, WallsThatFramesCutGoOn) {
    const std::vector<CutSurface> sides = cutIn(room(1.2f, 1.2f), room(shownHeight, shownHeight));
    const CutSurface* wall = upwards(sides, {0, -1, 0});
    ASSERT_NE(wall, nullptr);
    EXPECT_FALSE(wall->level);
    EXPECT_NEAR(wall->likely, 0.4 * wall->shown, 1e-9);
    const SurfacePatch patch = wall->continued();
    double top = 0, left = 0, right = 0;
    for (const Vec3& p : patch.positions) {
        EXPECT_NEAR(p.y, roomHalf, 0.002);
        top = std::max(top, double(p.z));
        left = std::min(left, double(p.x));
        right = std::max(right, double(p.x));
    }
    EXPECT_NEAR(top, wall->surface.point.z + wall->end + wall->likely, 1e-4);
    EXPECT_LT(top, shownHeight + wall->likely);
    EXPECT_FALSE(wall->replaced.empty());
    EXPECT_NEAR(left, -roomHalf, 0.06);
    EXPECT_NEAR(right, roomHalf, 0.03);  // to the corner, so that no light comes through it
    const Mesh strip{patch.positions, {}, patch.triangles};
    for (size_t t = 0; t < strip.triangles.size(); ++t)
        if (strip.triangleArea(t) > 1e-6f) { EXPECT_LT(strip.faceNormal(t).y, -0.9f); }
}

TEST(CutSurfaces, AWallThatAPhotographShowsToEndIsWhole) {
    const Mesh whole = room(shownHeight, shownHeight);
    const std::vector<CutSurface> sides = cutIn(whole, whole, true);
    EXPECT_EQ(upwards(sides, {0, -1, 0}), nullptr);
}

TEST(CutSurfaces, AMeshThatHasWhatNoPhotographShowsKeepsIt) {
    const Mesh whole = room(1.2f, 1.2f);
    EXPECT_EQ(upwards(cutIn(whole, whole), {0, -1, 0}), nullptr);
}

TEST(CutSurfaces, AFloorAloneIsLeftAsItIs) {
    const Mesh floor = test::sheet({-0.5f, -0.5f, 0}, {1, 0, 0}, {0, 1, 0}, 60, 60);
    EXPECT_TRUE(cutIn(test::sheet({-3, -3, 0}, {6, 0, 0}, {0, 6, 0}, 60, 60), floor).empty());
}

}  // namespace
}  // namespace relamp
