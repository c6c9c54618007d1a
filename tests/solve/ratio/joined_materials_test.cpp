// The side of a slab has the albedo of its top, as a rule, though a mend added it as a component of its own.
#include "solve/ratio/joined_materials.h"

#include <gtest/gtest.h>

#include "solve/ratio/pairs.h"
#include "support/estimates.h"

namespace relamp {
namespace {

/// A table's top, the side below its front edge, and a wall that stands behind it.
Scene table(float gap) {
    Mesh mesh = test::sheet({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 40, 40);
    test::append(mesh, test::sheet({0, -gap, -0.06f}, {1, 0, 0}, {0, 0, 0.06f}, 40, 3));
    test::append(mesh, test::sheet({0, 1.002f, 0}, {1, 0, 0}, {0, 0, 0.8f}, 40, 32));
    mesh.normals = vertexNormalsFromFaces(mesh);
    return test::sceneOf(mesh);
}

TEST(JoinedMaterials, ANarrowSideGoesWithTheSurfaceAtWhoseRimItBegins) {
    const Scene scene = table(0.002f);
    ASSERT_EQ(scene.materials, 3u);
    const uint32_t top = scene.material[0], side = scene.material[41 * 41], wall = scene.material.back();
    const std::vector<uint32_t> joined = joinedMaterials(scene);
    EXPECT_EQ(joined[side], top);
    EXPECT_EQ(joined[top], top);
    EXPECT_EQ(joined[wall], wall) << "as large as the top: it may be of anything";
    const Scene apart = table(0.02f);
    EXPECT_EQ(joinedMaterials(apart)[side], side);
}

TEST(JoinedMaterials, AFootInAHoleOfTheFloorIsOfItsOwn) {
    Mesh mesh = test::sheet({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 160, 160);
    std::erase_if(mesh.triangles, [&](const Triangle& t) {
        const Vec3 middle = (mesh.positions[t[0]] + mesh.positions[t[1]] + mesh.positions[t[2]]) / 3.0f;
        return std::abs(middle.x - 0.5f) < 0.05f && std::abs(middle.y - 0.5f) < 0.05f;
    });
    for (const int side : {-1, 1})
        test::append(mesh, test::sheet({0.5f + 0.049f * float(side), 0.45f, 0}, {0, 0.1f, 0}, {0, 0, 0.05f}, 16, 4));
    mesh.normals = vertexNormalsFromFaces(mesh);
    const Scene scene = test::sceneOf(mesh);
    const std::vector<uint32_t> joined = joinedMaterials(scene);
    for (uint32_t m = 0; m < joined.size(); ++m) EXPECT_EQ(joined[m], m);
}

TEST(JoinedMaterials, PairsTieTheSideToTheTop) {
    // Nothing else does where light reaches the side alone.
    const Scene scene = table(0.002f);
    MatteObservations matte;
    for (uint32_t v = 0; v < scene.mesh.vertexCount(); ++v) {
        matte.vertices.push_back(v);
        matte.radiance.push_back(Rgb(1));
        matte.sigma.push_back(Rgb(0.01f));
    }
    matte.componentGlossy.assign(scene.materials, 0);
    size_t across = 0, others = 0;
    for (const AlbedoPair& p : albedoPairs(scene, matte, PairOptions{})) {
        const uint32_t a = scene.material[p.a], b = scene.material[p.b];
        if (a == b) continue;
        ++(a == scene.material.back() || b == scene.material.back() ? others : across);
    }
    EXPECT_GT(across, 100u);
    EXPECT_EQ(others, 0u);
}

}  // namespace
}  // namespace relamp
