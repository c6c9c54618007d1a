// The flat tree of boxes against Embree.
#include "scene/box_tree.h"

#include <gtest/gtest.h>

#include "base/random.h"
#include "image/direction_grid.h"
#include "support/shapes.h"

namespace relamp {
namespace {

Ray anyRay(uint64_t i) {
    const auto unit = [&](uint64_t k) { return unitFloat(mixBits(mixBits(i) + k)); };
    const Vec3 origin = 3.0f * Vec3(unit(1), unit(2), unit(3)) - Vec3(1.5f);
    return {origin, squareToSphere({unit(4), unit(5)}), 0, 0.2f + 3 * unit(6)};
}

TEST(BoxTree, BlocksTheSameRaysAsEmbree) {
    Mesh mesh = test::sheet({-1, -1, -0.5f}, {2, 0, 0.1f}, {0, 2, 0.2f}, 30, 20);
    test::append(mesh, test::ball({0.3f, 0.2f, 0.4f}, 0.5f, 12, 24));
    test::append(mesh, test::box({-0.8f, -0.7f, -0.2f}, {-0.3f, -0.1f, 0.9f}, 5));
    const RayTracer tracer(mesh);
    const BoxTree tree = BoxTree::of(mesh);
    int blocked = 0, differ = 0;
    for (uint64_t i = 0; i < 20000; ++i) {
        const Ray ray = anyRay(i);
        blocked += tracer.occluded(ray);
        differ += tracer.occluded(ray) != tree.occluded(ray);
    }
    EXPECT_GT(blocked, 3000);
    EXPECT_LE(differ, 3) << "but for rays that just meet an edge or just reach";
}

TEST(BoxTree, HoldsEveryTriangleOnceAndEndsWhereItsNodesSay) {
    const Mesh mesh = test::ball({0, 0, 0}, 1, 9, 17);
    const BoxTree tree = BoxTree::of(mesh);
    EXPECT_EQ(tree.triangles.size(), 3 * mesh.triangles.size());
    size_t counted = 0;
    for (size_t i = 0; i < tree.nodes.size(); ++i) {
        const BoxTree::Node& n = tree.nodes[i];
        EXPECT_GT(n.skip, i);
        EXPECT_LE(n.skip, tree.nodes.size());
        counted += n.leaf & 7;
        EXPECT_EQ(n.leaf == 0, n.skip > i + 1) << "leaves have no branch";
    }
    EXPECT_EQ(counted, mesh.triangles.size());
}

TEST(BoxTree, LeavesOutShadowlessTrianglesAndTakesManyInOnePlace) {
    Mesh mesh = test::squareAbove(2, 0, 0, 1);
    const Ray up{Vec3(0.1f, 0.05f, 0), Vec3(0, 0, 1), 0, 5};
    EXPECT_TRUE(BoxTree::of(mesh).occluded(up));
    for (uint32_t t = 0; t < mesh.triangles.size(); ++t) mesh.shadowless.push_back(t);
    EXPECT_FALSE(BoxTree::of(mesh).occluded(up));
    EXPECT_TRUE(BoxTree::of(mesh).nodes.empty());
    Mesh same = test::squareAbove(2, 0, 0, 1);
    for (int i = 0; i < 6; ++i)
        same.triangles.insert(same.triangles.end(), same.triangles.begin(), same.triangles.end());
    EXPECT_TRUE(BoxTree::of(same).occluded(up));
    EXPECT_FALSE(BoxTree::of(same).occluded({up.origin, up.direction, 0, 0.9f}));
}

}  // namespace
}  // namespace relamp
