// The numbers that random patterns are drawn by: they rest on where vertices lie, not on units, origin, axes or the
// file's order.
#include <gtest/gtest.h>

#include <numeric>
#include <set>

#include "base/random.h"
#include "support/shapes.h"

namespace relamp {
namespace {

Mesh world() {
    Mesh mesh = test::sheet({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, 40, 40);
    test::append(mesh, test::box({-0.55f, -0.35f, 0.002f}, {-0.2f, 0.05f, 0.4f}, 5));
    test::append(mesh, test::ball({0.3f, -0.25f, 0.252f}, 0.25f, 24, 36));
    return mesh;
}

TEST(Rank, TellsVerticesApart) {
    const Scene scene = test::sceneOf(world());
    EXPECT_GT(std::set<uint32_t>(scene.rank.begin(), scene.rank.end()).size(), scene.rank.size() * 99 / 100);
}

TEST(Rank, HardlyFeelsUnitsAndOrigin) {
    const Scene scene = test::sceneOf(world());
    for (const double scale : {1000.0, 1e-3, 0.3048})
        for (const DVec3& offset : {DVec3(0), DVec3(1.7, -0.9, 0.4)}) {
            Mesh moved = world();
            for (Vec3& p : moved.positions) p = Vec3(scale * (DVec3(p) + offset));
            const Scene other = test::sceneOf(moved);
            size_t changed = 0;
            for (size_t v = 0; v < scene.rank.size(); ++v) changed += scene.rank[v] != other.rank[v];
            EXPECT_LE(changed, scene.rank.size() / 500) << scale << ", " << offset.x;
        }
}

TEST(Rank, HardlyFeelsHowTheWorldLies) {
    Progress progress;
    const Mat3 axes = frameAround(glm::normalize(Vec3(0.3f, -0.5f, 0.8f)));
    const Scene scene = buildScene(world(), progress, axes);
    for (const Vec3& z : {Vec3(1, 0, 0), glm::normalize(Vec3(1, 2, -1))}) {
        const Mat3 turn = frameAround(z);
        Mesh turned = world();
        for (Vec3& p : turned.positions) p = turn * p;
        for (Vec3& n : turned.normals) n = turn * n;
        const Scene other = buildScene(turned, progress, turn * axes);
        size_t changed = 0;
        for (size_t v = 0; v < scene.rank.size(); ++v) changed += scene.rank[v] != other.rank[v];
        EXPECT_LE(changed, scene.rank.size() / 500) << z.x;
        EXPECT_NEAR(scene.tracer->surfaceOffset() / other.tracer->surfaceOffset(), 1, 1e-5);
        EXPECT_EQ(scene.graph.to, other.graph.to);
    }
}

TEST(Rank, DoesNotRestOnTheOrderOfTheFile) {
    const Mesh mesh = world();
    std::vector<uint32_t> order(mesh.vertexCount());
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(), [](uint32_t a, uint32_t b) { return mixBits(a) < mixBits(b); });
    Mesh shuffled = mesh;
    std::vector<uint32_t> place(order.size());
    for (uint32_t i = 0; i < order.size(); ++i) {
        place[order[i]] = i;
        shuffled.positions[i] = mesh.positions[order[i]];
        shuffled.normals[i] = mesh.normals[order[i]];
    }
    for (Triangle& t : shuffled.triangles)
        for (uint32_t& v : t) v = place[v];
    const Scene a = test::sceneOf(mesh), b = test::sceneOf(shuffled);
    for (size_t v = 0; v < order.size(); ++v) EXPECT_EQ(a.rank[v], b.rank[place[v]]) << v;
}

}  // namespace
}  // namespace relamp
