// The jagged end of a shade comes back to the circle that its photographs show.
#include "solve/registration/round_rim.h"

#include <gtest/gtest.h>

#include "base/random.h"
#include "solve/registration/rim_circle.h"
#include "support/estimates.h"

namespace relamp {
namespace {

/// A shade that widens downwards from 0.3 m to 0.5 m and ends at height 0; `jag`: metres that its end is off by, one
/// place and another.
Mesh shade(float jag) {
    constexpr int rows = 24, around = 96;
    Mesh mesh;
    for (int row = 0; row <= rows; ++row)
        for (int k = 0; k < around; ++k) {
            const float off = row == 0 ? jag * (2 * randomShift(7, uint64_t(k), 0).x - 1) : 0;
            const float z = 0.4f * float(row) / rows + off, radius = 0.5f - 0.5f * z, turn = 2 * pi * float(k) / around;
            mesh.positions.push_back({radius * std::cos(turn), radius * std::sin(turn), z});
        }
    for (int row = 0; row < rows; ++row)
        for (int k = 0; k < around; ++k) {
            const auto at = [&](int r, int c) { return uint32_t(r * around + c % around); };
            mesh.triangles.push_back({at(row, k), at(row, k + 1), at(row + 1, k + 1)});
            mesh.triangles.push_back({at(row, k), at(row + 1, k + 1), at(row + 1, k)});
        }
    mesh.normals = vertexNormalsFromFaces(mesh);
    return mesh;
}

RevolutionSurface cone() {
    RevolutionSurface surface;
    surface.radius = 0.5;
    surface.slope = -0.5;
    return surface;
}

/// Photographs of the whole shade: dark outside, bright inside.
Capture photographed() {
    const Scene truth = test::sceneOf(shade(0));
    Capture capture;
    for (int i = 0; i < 6; ++i) {
        const double turn = 2 * double(pi) * i / 6;
        View view;
        view.camera =
            test::cameraAt({2 * std::cos(turn), 2 * std::sin(turn), 0.5 - 0.6 * (i % 3)}, {0, 0, 0.2}, 160, 120, 200);
        view.image = Image(160, 120);
        for (int y = 0; y < 120; ++y)
            for (int x = 0; x < 160; ++x)
                for (int k = 0; k < 16; ++k) {
                    const Vec3 ray = view.camera.rayDirection(
                        Vec2(float(x) + (float(k % 4) + 0.5f) / 4, float(y) + (float(k / 4) + 0.5f) / 4));
                    const Hit hit = truth.tracer->closest({Vec3(view.camera.position()), ray});
                    const float inside = hit ? glm::dot(truth.mesh.faceNormal(hit.triangle), ray) : 0;
                    view.image.at(x, y) += Rgb(!hit ? 0.3f : inside > 0 ? 2.0f : 0.1f) / 16.0f;
                }
        capture.views.push_back(std::move(view));
    }
    return capture;
}

TEST(RoundRim, LiesWherePhotographsShowIt) {
    const Capture capture = photographed();
    const Scene scene = test::sceneOf(shade(0.012f));
    for (const double guess : {-0.012, 0.0, 0.012}) {
        const std::optional<double> height = rimHeight(capture, scene, cone(), guess, 1e-3f);
        ASSERT_TRUE(height) << guess;
        EXPECT_NEAR(*height, 0, 0.0015);  // a seventh of a pixel
    }
}

TEST(RimCircle, ComesToItsTrueTiltAndRadius) {
    const Capture capture = photographed();
    const Scene scene = test::sceneOf(shade(0.012f));
    RimCircle start{cone(), 0, 0.49, 0.51};
    start.surface.axis = glm::normalize(DVec3(0.02, -0.01, 1));
    start.surface.across = glm::normalize(DVec3(1, 0, -0.02));
    start.surface.centre = DVec3(0.005, -0.003, 0.004);
    const auto circle = fitRimCircle(capture, scene, start, true, 1e-3f);
    ASSERT_TRUE(circle);
    constexpr double seventhOfPixel = 0.0015;  // metres
    const RevolutionSurface& found = circle->surface;
    const DVec3 middle = found.centre + circle->height * found.axis;
    EXPECT_LT(glm::length(middle), seventhOfPixel);
    EXPECT_GT(found.axis.z, std::cos(0.002));
    EXPECT_NEAR(circle->inner, 0.5, seventhOfPixel);
    EXPECT_NEAR(circle->outer, 0.5, seventhOfPixel);
}

TEST(RimCircle, IsNoneWherePhotographsShowNoEdge) {
    Capture capture = photographed();
    for (View& view : capture.views) std::fill(view.image.pixels.begin(), view.image.pixels.end(), Rgb(0.5f));
    EXPECT_FALSE(fitRimCircle(capture, test::sceneOf(shade(0.012f)), {cone(), 0, 0.5, 0.5}, true, 1e-3f));
}

TEST(RoundRim, IsNoneWherePhotographsShowNoEdge) {
    Capture capture = photographed();
    for (View& view : capture.views) std::fill(view.image.pixels.begin(), view.image.pixels.end(), Rgb(0.5f));
    EXPECT_FALSE(rimHeight(capture, test::sceneOf(shade(0.012f)), cone(), 0.005, 1e-3f));
}

TEST(RoundRim, IsEvenAfterwards) {
    const Scene scene = test::sceneOf(shade(0.012f));
    Mesh even = scene.mesh;
    for (const MeshMend::MovedVertex& m : evenRim(scene, scene.mesh.vertexCount(), cone(), 0, true))
        even.positions[m.vertex] = m.position;
    for (size_t v = 0; v < 96; ++v) {
        EXPECT_NEAR(even.positions[v].z, 0, 1e-5f);
        EXPECT_NEAR(glm::length(Vec2(even.positions[v])), 0.5f, 1e-5f);
    }
    EXPECT_TRUE(evenRim(scene, 0, cone(), 0, true).empty());
    // The other end and what lies between stay.
    for (size_t v = 96; v < even.positions.size(); ++v) EXPECT_EQ(even.positions[v], scene.mesh.positions[v]);
}

}  // namespace
}  // namespace relamp
