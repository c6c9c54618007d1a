// What the first image of a dragged emitter takes from the baked masks in place of rays.
#include <gtest/gtest.h>

#include "base/random.h"
#include "relight/live/near.h"
#include "relight/live/visibility.h"
#include "support/shapes.h"

namespace relamp {
namespace {

Vec3 anyDirection(uint64_t seed) { return squareToSphere({unitFloat(mixBits(seed)), unitFloat(mixBits(seed + 1))}); }

TEST(LiveNear, AConeIsWholeOnlyWhereNoHiddenQuarterMeetsIt) {
    for (const int side : {8, 32, 64}) {
        const LiveGrid grid(side);
        int whole = 0;
        for (uint64_t i = 0; i < 400; ++i) {
            const Vec3 normal = anyDirection(mixBits(i) + 2), hole = anyDirection(mixBits(i) + 4),
                       axis = anyDirection(mixBits(i) + 6);
            const float angle = 0.05f + 0.5f * unitFloat(mixBits(i + 1000)),
                        holeAngle = 0.1f + 0.6f * unitFloat(mixBits(i + 2000));
            std::vector<uint8_t> masks(grid.nibbleBytes(), 0);
            for (size_t c = 0; c < grid.cells(); ++c) {
                unsigned seen = 0;
                for (int q = 0; q < 4; ++q)
                    if (glm::dot(grid.quarter(c, q), normal) > 0 &&
                        glm::dot(grid.quarter(c, q), hole) < std::cos(holeAngle))
                        seen |= 1u << q;
                setNibble(masks.data(), c, seen);
            }
            std::vector<uint16_t> entries;
            if (!traceCone(
                    grid, Vec3(0), normal, axis, angle, masks, true, [](std::span<const Ray>) { return 0u; }, entries))
                continue;
            ++whole;
            const Mat3 frame = frameAround(axis);
            for (uint32_t k = 0; k < 400; ++k) {
                const Vec2 u = r2Point(k, Vec2(0));
                const float z = 1 - u.x * (1 - std::cos(angle)), r = std::sqrt(1 - z * z);
                const Vec3 d = frame * Vec3(r * std::cos(2 * pi * u.y), r * std::sin(2 * pi * u.y), z);
                const size_t at = grid.quarterAt(sphereToSquare(d));
                const bool below = glm::dot(grid.quarter(at / 4, int(at % 4)), normal) <= 0;
                ASSERT_TRUE(below || nibbleOf(masks.data(), at / 4) >> (at % 4) & 1) << side << " " << i << " " << k;
            }
        }
        EXPECT_GT(whole, 50) << side;
    }
}

TEST(LiveNear, AVertexThatSeesAllOfAnEmitterNeedsNoRays) {
    const Scene wall =
        test::sceneOf(test::squareAbove(4, 0, 0, 0.5f));  // hides everything, so that rays would be noticed
    LiveOccluders occluders;
    occluders.ground = std::shared_ptr<const RayTracer>(std::shared_ptr<void>(), wall.tracer.get());
    occluders.offset = wall.tracer->surfaceOffset();
    occluders.parts.resize(2);
    const Mesh mesh = test::squareAbove(2, 0, 0, 1, 4);
    EmitterCluster cluster;
    for (uint32_t t = 0; t < mesh.triangles.size(); ++t) cluster.triangles.push_back(t);
    NearEmitter emitter;
    emitter.tree = LiveEmitterTree(emitterSurface(mesh, cluster), true);
    emitter.centre = {0, 0, 1};
    emitter.radius = emitter.tree.surface().radius;
    float open = 0;
    EXPECT_EQ(nearFactor(emitter, occluders, Vec3(0), {0, 0, 1}, fineCut, 16, 1, open), 0);
    EXPECT_EQ(nearFactor(emitter, occluders, Vec3(0), {0, 0, 1}, fineCut, 16, 1, open, true), open);
    EXPECT_NEAR(open, 0.554133f, 2e-3f);
    // A part between still hides it.
    const Scene part = test::sceneOf(test::squareAbove(4, 0, 0, 0.75f));
    occluders.parts[1].tracer = std::shared_ptr<const RayTracer>(std::shared_ptr<void>(), part.tracer.get());
    occluders.parts[1].centre = {0, 0, 0.75f};
    occluders.parts[1].radius = 3;
    emitter.part = 2;
    EXPECT_EQ(nearFactor(emitter, occluders, Vec3(0), {0, 0, 1}, fineCut, 16, 1, open, true), 0);
}

}  // namespace
}  // namespace relamp
