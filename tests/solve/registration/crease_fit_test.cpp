// A wall that the mesh has beside its place comes to where photographs show that it meets the floor.
#include "solve/registration/crease_fit.h"

#include <gtest/gtest.h>

#include "base/parallel.h"
#include "support/estimates.h"
#include "support/shapes.h"

namespace relamp {
namespace {

constexpr float spacing = 0.01f;  // metres between vertices

/// A floor z = 0 for x < 0 and a wall x = 0 above it, in photographs, and a mesh whose wall is at x = `off`.
struct PhotographedCorner {
    static constexpr int side = 160, views = 8;
    Capture capture;
    Scene scene;
    std::vector<CreaseVertex> creases;
    std::vector<uint8_t> floor;

    explicit PhotographedCorner(float off) {
        Mesh& mesh = capture.mesh;
        mesh = test::sheet({-0.295f, -0.2f, 0}, {0.6f, 0, 0}, {0, 0.4f, 0}, 60, 40);
        for (size_t v = 0; v < mesh.vertexCount(); ++v) {
            Vec3& p = mesh.positions[v];
            const float along = p.x, beside = std::abs(along) - 0.44f * spacing;
            floor.push_back(along < 0);
            mesh.normals[v] = along < 0 ? Vec3(0, 0, 1) : Vec3(-1, 0, 0);
            p = along < 0 ? Vec3(off - beside, p.y, 0) : Vec3(off, p.y, beside);
            if (beside < 0.1f * spacing)
                creases.push_back({uint32_t(v), p, mesh.normals[v], glm::normalize(Vec3(-1, 0, 1))});
        }
        scene = test::sceneOf(mesh);
        for (int i = 0; i < views; ++i) {
            const double turn = 0.15 * (i - views / 2);
            View view;
            view.name = std::to_string(i);
            view.camera = test::cameraAt({-1.2 * std::cos(turn), 1.2 * std::sin(turn), 0.7 + 0.1 * (i % 3)}, {0, 0, 0},
                                         side, side, 400);
            view.image = Image(side, side);
            for (int y = 0; y < side; ++y)
                for (int x = 0; x < side; ++x) view.image.at(x, y) = pixel(view.camera, x, y);
            capture.views.push_back(std::move(view));
        }
    }
    /// Mean over 4 x 4 rays.
    static Rgb pixel(const Camera& camera, int x, int y) {
        Rgb sum(0);
        for (int k = 0; k < 16; ++k) {
            const DVec3 d(
                camera.rayDirection(Vec2(float(x) + (float(k % 4) + 0.5f) / 4, float(y) + (float(k / 4) + 0.5f) / 4)));
            const DVec3 eye = camera.position();
            const double atFloor = eye.x - d.x * eye.z / d.z;
            sum += d.z < 0 && atFloor < 0 ? Rgb(0.3f, 0.32f, 0.35f) : Rgb(0.6f, 0.58f, 0.5f);
        }
        return sum / 16.0f;
    }
    CreaseEstimate aligned(const std::vector<uint8_t>& still, int threads = 0) const {
        const ThreadLimit limit(threads);
        Progress progress;
        return alignCreases(capture, scene, creases, still, scene.mesh.vertexCount(), 1e-3f, progress);
    }
};

TEST(Creases, OfAnExactMeshStay) {
    const PhotographedCorner corner(0);
    const CreaseEstimate found = corner.aligned(corner.floor);
    EXPECT_GT(found.points, 400u);
    EXPECT_LT(found.before, 0.1);
    EXPECT_TRUE(found.positions.empty());
}

TEST(Creases, BringASideToThePhotographs) {
    for (const float off : {0.006f, -0.005f}) {
        const PhotographedCorner corner(off);
        const CreaseEstimate found = corner.aligned(corner.floor);
        ASSERT_TRUE(found.needed()) << toText(found);
        EXPECT_LT(found.after, 0.3 * found.before);
        for (const CreaseVertex& c : corner.creases) {
            const Vec3& p = found.positions[c.vertex];
            if (std::abs(p.y) > 0.15f) continue;  // at the ends no photograph shows three pixels along it
            EXPECT_NEAR(p.x, 0, 0.0015f);
            EXPECT_TRUE(!corner.floor[c.vertex] || p.z == 0) << "what is flat stays flat";
        }
        // What is far from the crease tells nothing.
        for (size_t v = 0; v < found.positions.size(); ++v) {
            const Vec3& was = corner.scene.mesh.positions[v];
            const bool far = glm::length(was - Vec3(off, 0, 0)) > 0.29f;
            EXPECT_LT(glm::length(found.positions[v] - was), (far ? 0.2f : 1.3f) * std::abs(off));
        }
    }
}

TEST(Creases, BetweenSidesThatAreKnownStay) {
    const PhotographedCorner corner(0.006f);
    const CreaseEstimate found = corner.aligned(std::vector<uint8_t>(corner.floor.size(), 1));
    EXPECT_GT(found.before, 0.8);
    EXPECT_FALSE(found.needed());
    EXPECT_TRUE(found.positions.empty());
}

TEST(Creases, AreTheSameOnAnyNumberOfThreads) {
    const PhotographedCorner corner(0.006f);
    EXPECT_EQ(corner.aligned(corner.floor, 1).positions, corner.aligned(corner.floor, 3).positions);
}

}  // namespace
}  // namespace relamp
