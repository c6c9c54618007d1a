#include "solve/ratio/pairs.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/estimates.h"

namespace relamp {
namespace {

TEST(Pairs, SurfacesThatFaceAlikeDoNotOutvoteTheRest) {
    Mesh mesh = test::sheet({0, 0, 0}, {2, 0, 0}, {0, 2, 0}, 40, 40);
    const auto floor = uint32_t(mesh.vertexCount());
    test::append(mesh, test::sheet({0, 0, 1}, {0, 1, 0}, {0, 0, 1}, 6, 6));
    const auto all = uint32_t(mesh.vertexCount());
    const Scene scene = test::sceneOf(mesh);
    MatteObservations matte;
    for (uint32_t v = 0; v < all; ++v) matte.vertices.push_back(v);
    std::vector<AlbedoPair> pairs = {
        {0, 1, 1.0f}, {floor, floor + 1, 1.0f}, {2, floor + 2, 1.0f}, {3, 3, 2.0f, false, true}};
    weighOrientations(scene, matte, pairs);
    // The wall's 49 observations beside the floor's 1681, and the geometric mean between them.
    const double ratio = std::sqrt(double(floor) / double(all - floor));
    EXPECT_NEAR(pairs[1].weight / pairs[0].weight, ratio, 1e-4);
    EXPECT_NEAR(pairs[2].weight / pairs[0].weight, std::sqrt(ratio), 1e-4);
    EXPECT_NEAR(pairs[0].weight + pairs[1].weight + pairs[2].weight, 3, 1e-5);
    EXPECT_FLOAT_EQ(pairs[3].weight, 2);
}

}  // namespace
}  // namespace relamp
