// A screen that hangs off a wall, which a reconstruction has made a bump of the wall.
#include "pipeline/flat_emitters.h"

#include <gtest/gtest.h>

#include "clusters/shining_sides.h"
#include "radiance/gather.h"
#include "support/estimates.h"

namespace relamp {
namespace {

const Rgb light(2, 3, 5);
constexpr float halfWidth = 0.4f, halfHeight = 0.25f, front = 0.05f, back = 0.02f;
constexpr float bump = 0.035f;  ///< how far the reconstruction's front stands off the wall

/// The wall lies in z = 0. Height of the reconstruction: its screen has rounded sides of 6 cm.
float rounded(float x, float y) {
    const float inside = std::min(halfWidth - std::abs(x), halfHeight - std::abs(y));
    const float t = std::clamp((inside + 0.03f) / 0.06f, 0.0f, 1.0f);
    return bump * t * t * (3 - 2 * t);
}

Mesh wall() { return test::sheet({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, 100, 100); }

struct Screen {
    Capture capture;
    Scene scene;
    RadianceSamples samples;
    EmitterClusters clusters;

    /// `exact`: the mesh is what was photographed.
    explicit Screen(bool exact) : scene(test::sceneOf(exact ? real() : reconstructed())) {
        const Scene truth = test::sceneOf(real());
        const size_t wallVertices = wall().vertexCount();
        for (int i = 0; i < 8; ++i) {
            const double turn = 2 * piD * i / 8, out = i % 2 ? 1.4 : 0.7;
            const Camera camera =
                test::cameraAt({out * std::cos(turn), out * std::sin(turn), 1.4}, {0, 0, 0}, 240, 180, 150);
            capture.views.push_back(test::photographOf(truth, camera, [&](const Hit& hit) {
                if (!hit) return Rgb(0);
                return truth.mesh.triangles[hit.triangle][0] >= wallVertices ? light : Rgb(0.1f);
            }));
        }
        capture.mesh = scene.mesh;
        look();
    }

    static Mesh real() {
        Mesh mesh = wall();
        test::append(mesh, test::box({-halfWidth, -halfHeight, back}, {halfWidth, halfHeight, front}, 20));
        return mesh;
    }
    static Mesh reconstructed() {
        Mesh mesh = wall();
        for (Vec3& p : mesh.positions) p.z = rounded(p.x, p.y);
        return mesh;
    }
    void look() {
        Progress progress;
        samples = gatherRadiance(capture, scene, {}, progress);
        clusters = clusterEmitters(scene, capture, samples, {}, progress);
    }
    std::vector<EmitterMove> lifted() const { return liftedFronts(scene, capture, samples, clusters); }
    void apply(const EmitterMove& move) {
        MeshMend mend;
        mend.moved = move.vertices;
        applyMend(mend, capture.mesh);
        scene = test::sceneOf(capture.mesh);
        look();
    }
    /// Area of what shines and looks along the wall.
    float sides() const {
        float area = 0;
        for (const uint32_t t : clusters.emitters.at(0).triangles) {
            const Triangle& at = scene.mesh.triangles[t];
            const Vec3 a = scene.mesh.positions[at[0]],
                       across = glm::cross(scene.mesh.positions[at[1]] - a, scene.mesh.positions[at[2]] - a);
            if (std::abs(across.z) < 0.7f * glm::length(across)) area += scene.mesh.triangleArea(t);
        }
        return area;
    }
};

TEST(FlatEmitters, AScreensFrontGoesWhereItsOutlinesMeet) {
    Screen screen(false);
    ASSERT_EQ(screen.clusters.emitters.size(), 1u);
    const std::vector<EmitterMove> moves = screen.lifted();
    ASSERT_EQ(moves.size(), 1u);
    float error = 0, rim = 0;
    size_t count = 0;
    for (const MeshMend::MovedVertex& m : moves[0].vertices) {
        if (std::abs(m.position.x) < 0.3f && std::abs(m.position.y) < 0.15f) {
            error += std::abs(m.position.z - front);
            ++count;
        }
        rim = std::max(rim, std::abs(m.position.x));
    }
    ASSERT_GT(count, 100u);
    EXPECT_LT(error / float(count), 0.003f);  // from 15 mm
    EXPECT_NEAR(rim, halfWidth, 0.006f);
    const float before = moves[0].overlap;
    screen.apply(moves[0]);
    EXPECT_GE(overlapAfter(moves[0], screen.scene, screen.capture, screen.samples, screen.clusters), before);
}

TEST(FlatEmitters, ItsSidesShineWithIt) {
    Screen screen(false);
    const std::vector<EmitterMove> moves = screen.lifted();
    ASSERT_EQ(moves.size(), 1u);
    screen.apply(moves[0]);
    letSidesShine(screen.scene, moves[0].shining, screen.clusters);
    const float real = 4 * (halfWidth + halfHeight) * (front - back);
    EXPECT_GT(screen.sides(), 0.8f * real);
    EXPECT_LT(screen.sides(), 1.8f * real);  // down to the wall
    // Every corner of what shines is known as the emitter's.
    const EmitterCluster& e = screen.clusters.emitters[0];
    for (const uint32_t t : e.triangles) {
        EXPECT_EQ(screen.clusters.emitterOfTriangle[t], 0);
        for (const uint32_t v : screen.scene.mesh.triangles[t])
            EXPECT_TRUE(std::binary_search(e.vertices.begin(), e.vertices.end(), v));
    }
}

TEST(FlatEmitters, SidesThatNoEmitterReachesStayDark) {
    Screen screen(false);
    std::vector<uint32_t> shining;
    for (uint32_t v = 0; v < screen.scene.mesh.vertexCount(); ++v)
        if (screen.scene.mesh.positions[v].x > 0.6f) shining.push_back(v);  // the wall beside it
    const size_t before = screen.clusters.emitters.at(0).vertices.size();
    letSidesShine(screen.scene, shining, screen.clusters);
    EXPECT_EQ(screen.clusters.emitters.at(0).vertices.size(), before);
}

TEST(FlatEmitters, AnExactScreenStays) {
    const Screen screen(true);
    ASSERT_EQ(screen.clusters.emitters.size(), 1u);
    // Its box has nothing around it that could be the surface behind.
    EXPECT_TRUE(screen.lifted().empty());
}

}  // namespace
}  // namespace relamp
