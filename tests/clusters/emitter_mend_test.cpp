// Emitters that the mesh does not show as the photographs do.
#include "clusters/emitter_mend.h"

#include <gtest/gtest.h>

#include "base/statistics.h"
#include "clusters/body_obstacles.h"
#include "clusters/emitter_pixels.h"
#include "clusters/emitter_sphere.h"
#include "radiance/gather.h"
#include "support/estimates.h"

namespace relamp {
namespace {

const Rgb light(30, 20, 10);

Mesh ballOf(const Vec3& centre, float radius) { return test::ball(centre, radius, 12, 24); }
Mesh boxOf(const Vec3& centre, const Vec3& size) { return test::box(centre - size, centre + size, 8); }

/// Photographs of a floor, with `screens` on it, and `truth` shining above it, and a capture whose mesh has
/// `reconstructed` in its place.
struct World {
    Capture capture;
    Scene scene;
    RadianceSamples samples;
    EmitterClusters clusters;
    size_t floorTriangles = 0;

    World(const Mesh& truth, const Mesh& reconstructed, const Mesh& screens = {})
        : scene(sceneWith(reconstructed, screens)) {
        const Scene real = sceneWith(truth, screens);
        floorTriangles = floor(screens).triangles.size();
        const size_t floorVertices = floor(screens).vertexCount();
        for (int i = 0; i < 6; ++i) {
            const double turn = 2 * piD * i / 6;
            const Camera camera =
                test::cameraAt({1.5 * std::cos(turn), 1.5 * std::sin(turn), 1.0}, {0, 0, 0.3}, 320, 240, 320);
            capture.views.push_back(test::photographOf(real, camera, [&](const Hit& hit) {
                if (!hit) return Rgb(0.02f);
                return real.mesh.triangles[hit.triangle][0] >= floorVertices ? light : Rgb(0.2f, 0.18f, 0.15f);
            }));
        }
        capture.mesh = scene.mesh;
        Progress progress;
        samples = gatherRadiance(capture, scene, {}, progress);
        clusters = clusterEmitters(scene, capture, samples, {}, progress);
    }

    static Mesh floor(const Mesh& screens) {
        Mesh mesh = test::sheet({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, 40, 40);
        if (!screens.positions.empty()) test::append(mesh, screens);
        return mesh;
    }
    static Scene sceneWith(const Mesh& emitter, const Mesh& screens) {
        Mesh mesh = floor(screens);
        if (!emitter.positions.empty()) test::append(mesh, emitter);
        return test::sceneOf(std::move(mesh));
    }
    EmitterMend mend() const { return mendEmitters(scene, capture, samples, clusters); }
};

TEST(EmitterMend, AnExactMeshStaysAsItIs) {
    for (const Mesh& truth : {ballOf({0, 0, 0.4f}, 0.1f), boxOf({0, 0, 0.4f}, {0.2f, 0.15f, 0.02f})}) {
        const World world(truth, truth);
        ASSERT_EQ(world.clusters.emitters.size(), 1u);
        EXPECT_FALSE(world.mend().needed());
    }
}

TEST(EmitterMend, ABallThatTheMeshHasHalfOfIsFoundWithItsSize) {
    const Vec3 centre(0.05f, -0.1f, 0.4f);
    Mesh half = ballOf(centre, 0.1f);
    std::erase_if(half.triangles, [&](const Triangle& t) {
        return half.positions[t[0]].x + half.positions[t[1]].x + half.positions[t[2]].x < 3 * centre.x;
    });
    const World world(ballOf(centre, 0.1f), half);
    ASSERT_EQ(world.clusters.emitters.size(), 1u);
    const EmitterMend mend = world.mend();
    ASSERT_EQ(mend.balls.size(), 1u);
    EXPECT_NEAR(glm::length(Vec3(mend.balls[0].centre) - centre), 0, 0.002);
    EXPECT_NEAR(mend.balls[0].radius, 0.1f, 0.002f);
    EXPECT_NEAR(mend.balls[0].radiance.x, light.x, 0.01f * light.x);
    // Its half of a mesh goes, the floor stays.
    EXPECT_EQ(mend.removed.size(), half.triangles.size());
    EXPECT_GE(mend.removed.front(), world.floorTriangles);
}

TEST(EmitterMend, WhatLiesBeforeABallThroughWhichItIsSeenGoes) {
    const Vec3 centre(0, 0, 0.4f);
    // A curtain of mesh all around, which no photograph knows of, open above.
    Mesh mesh = ballOf(centre, 0.05f);
    const size_t own = mesh.triangles.size();
    for (int i = 0; i < 6; ++i) {
        const double a = 2 * piD * i / 6 + piD / 6;
        const Vec3 out(float(0.12 * std::cos(a)), float(0.12 * std::sin(a)), 0),
            along(float(-0.05 * std::sin(a)), float(0.05 * std::cos(a)), 0);
        test::append(mesh, test::sheet(centre + out - along - Vec3(0, 0, 0.04f), 2.0f * along, {0, 0, 0.06f}, 6, 4));
    }
    const World world(ballOf(centre, 0.05f), mesh);
    ASSERT_EQ(world.clusters.emitters.size(), 1u);
    const EmitterMend mend = world.mend();
    ASSERT_EQ(mend.balls.size(), 1u);
    EXPECT_NEAR(mend.balls[0].radius, 0.05f, 0.002f);
    EXPECT_GT(mend.removed.size(), own + 10);
    EXPECT_GE(mend.removed.front(), world.floorTriangles);
}

TEST(EmitterMend, OneViewOfAllOfABallAndOneOfAPartAreEnough) {
    const Vec3 centre(0, 0, 0.4f);
    Mesh half = ballOf(centre, 0.1f), screens;
    std::erase_if(half.triangles, [&](const Triangle& t) { return half.positions[t[0]].z > centre.z; });
    // Of the six cameras the first sees all of it, the second 45 % of it, the others nothing.
    for (int i = 1; i < 6; ++i) {
        const double a = 2 * piD * i / 6;
        const Vec3 out(float(std::cos(a)), float(std::sin(a)), 0), along(-out.y, out.x, 0);
        const Vec3 corner = centre + 0.3f * out - (i == 1 ? 0.01f : 0.2f) * along - Vec3(0, 0, 0.08f);
        test::append(screens, test::sheet(corner, 0.4f * along, {0, 0, 0.4f}, 8, 8));
    }
    const World world(ballOf(centre, 0.1f), half, screens);
    ASSERT_EQ(world.clusters.emitters.size(), 1u);
    const EmitterMend mend = world.mend();
    ASSERT_EQ(mend.balls.size(), 1u);
    EXPECT_NEAR(glm::length(Vec3(mend.balls[0].centre) - centre), 0, 0.005);
    EXPECT_NEAR(mend.balls[0].radius, 0.1f, 0.003f);
}

/// Two balls of one light; from some of the cameras one hides part of the other.
constexpr float pairRadius = 0.06f;
const Vec3 nearer(-0.1f, 0, 0.4f), farther(0.1f, 0, 0.4f);

TEST(EmitterMend, LightsThatHideEachOtherAreNotOneBall) {
    Mesh both = ballOf(nearer, pairRadius);
    test::append(both, ballOf(farther, pairRadius));
    const World world(both, both);
    ASSERT_EQ(world.clusters.emitters.size(), 2u);
    EXPECT_FALSE(world.mend().needed());
}

TEST(EmitterMend, ALightBeforeABallIsNoObstacle) {
    Mesh both = ballOf(nearer, pairRadius), part = both;
    test::append(both, ballOf(farther, pairRadius));
    const size_t whole = part.triangles.size();
    Mesh half = ballOf(farther, pairRadius);
    std::erase_if(half.triangles, [&](const Triangle& t) { return half.positions[t[0]].z < farther.z; });
    test::append(part, half);
    const World world(both, part);
    ASSERT_EQ(world.clusters.emitters.size(), 2u);
    const EmitterMend mend = world.mend();
    ASSERT_EQ(mend.balls.size(), 1u);
    EXPECT_NEAR(glm::length(Vec3(mend.balls[0].centre) - farther), 0, 0.002);
    EXPECT_NEAR(mend.balls[0].radius, pairRadius, 0.002f);
    EXPECT_GE(mend.removed.front(), world.floorTriangles + whole);
}

/// What no ball, tube or box is like.
Mesh eggOf(const Vec3& centre, const Vec3& size) {
    Mesh egg = test::ball(Vec3(0), 1, 24, 48);
    for (Vec3& p : egg.positions) p = centre + p * size;
    egg.normals = vertexNormalsFromFaces(egg);
    return egg;
}

TEST(EmitterMend, AShrunkenEggMovesOutByWhatIsMissing) {
    const Vec3 size(0.24f, 0.12f, 0.06f);
    const World world(eggOf({0, 0, 0.4f}, size), eggOf({0, 0, 0.4f}, size - 0.012f));
    ASSERT_EQ(world.clusters.emitters.size(), 1u);
    const EmitterMend mend = world.mend();
    EXPECT_TRUE(mend.balls.empty());
    EXPECT_TRUE(mend.bodies.empty());
    ASSERT_EQ(mend.moves.size(), 1u);
    MeshMend moves;
    moves.moved = mend.moves[0].vertices;
    Mesh moved = world.capture.mesh;
    applyMend(moves, moved);
    float widest = 0;
    for (const MeshMend::MovedVertex& m : moves.moved) widest = std::max(widest, m.position.x);
    EXPECT_NEAR(widest, size.x, 0.006f);
    EXPECT_EQ(moved.triangles.size(), world.capture.mesh.triangles.size());
}

TEST(EmitterMend, AMoveIsJudgedByTheEmitterThatItIsFor) {
    const Vec3 size(0.24f, 0.12f, 0.06f);
    const Mesh truth = eggOf({0, 0, 0.4f}, size);
    const World before(truth, eggOf({0, 0, 0.4f}, size - 0.012f));
    const EmitterMend mend = before.mend();
    ASSERT_EQ(mend.moves.size(), 1u);
    const auto overlapIn = [&](const World& after) {
        return overlapAfter(mend.moves[0], after.scene, after.capture, after.samples, after.clusters);
    };
    EXPECT_GT(overlapIn(World(truth, truth)), 0.97f);
    EXPECT_NEAR(overlapIn(before), mend.moves[0].overlap, 1e-6f);
    EXPECT_EQ(overlapIn(World(truth, {})), 0);  // it was lost
}

EmitterBody tubeOf(const DVec3& centre, const DVec3& along, double length, double radius) {
    EmitterBody tube;
    tube.round = true;
    tube.centre = centre;
    tube.axes = glm::dmat3(frameAround(Vec3(glm::normalize(along))));
    std::swap(tube.axes[0], tube.axes[2]);
    tube.axes[1] = -tube.axes[1];
    tube.half = {0.5 * length, radius, radius};
    return tube;
}

Mesh surfaceOf(const EmitterBody& body) {
    Mesh mesh;
    body.surface(mesh.positions, mesh.triangles);
    return mesh;
}

TEST(EmitterBody, ItsSurfaceHasItsAreaAndFacesOutwards) {
    EmitterBody box;
    box.centre = {1, -2, 3};
    box.axes = tubeOf({0, 0, 0}, {1, 2, 3}, 1, 1).axes;
    box.half = {0.3, 0.1, 0.02};
    const EmitterBody tube = tubeOf({1, -2, 3}, {3, 1, -2}, 0.6, 0.05);
    const auto check = [](const EmitterBody& body, double area) {
        const Mesh mesh = surfaceOf(body);
        double sum = 0;
        for (size_t t = 0; t < mesh.triangles.size(); ++t) {
            const Triangle& c = mesh.triangles[t];
            const Vec3 middle = (mesh.positions[c[0]] + mesh.positions[c[1]] + mesh.positions[c[2]]) / 3.0f;
            EXPECT_GT(glm::dot(mesh.faceNormal(t), middle - Vec3(body.centre)), 0);
            EXPECT_NEAR(body.distance(DVec3(middle)), 0, 0.001);
            sum += double(mesh.triangleArea(t));
        }
        EXPECT_NEAR(sum, area, 0.005 * area);
    };
    check(box, 8 * (0.3 * 0.1 + 0.1 * 0.02 + 0.02 * 0.3));
    check(tube, 2 * piD * 0.05 * (0.6 + 0.05));
}

TEST(EmitterBody, RaysEnterAndLeaveWhereItsSidesAre) {
    EmitterBody box;
    box.half = {0.3, 0.1, 0.02};
    const glm::dvec2 chord = box.chord({0.1, 0.05, 5}, {0, 0, -1});
    EXPECT_DOUBLE_EQ(chord.x, 4.98);
    EXPECT_DOUBLE_EQ(chord.y, 5.02);
    EXPECT_GT(box.chord({0.1, 0.11, 5}, {0, 0, -1}).x, box.chord({0.1, 0.11, 5}, {0, 0, -1}).y);
    const EmitterBody tube = tubeOf({0, 0, 0}, {1, 0, 0}, 0.6, 0.05);
    EXPECT_NEAR(tube.chord({0, 0.03, 5}, {0, 0, -1}).x, 5 - 0.04, 1e-12);
    EXPECT_NEAR(tube.chord({-5, 0.03, 0}, {1, 0, 0}).x, 4.7, 1e-12);
    EXPECT_NEAR(tube.distance({0.3 + 0.03, 0, 0.05 + 0.04}), 0.05, 1e-12);
}

TEST(EmitterMend, ATubeTakesThePlaceOfAThinOne) {
    const EmitterBody truth = tubeOf({0.05, -0.1, 0.35}, {1, 0.4, 0.1}, 0.5, 0.03);
    EmitterBody thin = truth;
    thin.half = {0.23, 0.018, 0.018};
    const World world(surfaceOf(truth), surfaceOf(thin));
    ASSERT_EQ(world.clusters.emitters.size(), 1u);
    const EmitterMend mend = world.mend();
    ASSERT_EQ(mend.bodies.size(), 1u);
    const EmitterBody& found = mend.bodies[0].body;
    EXPECT_TRUE(found.round);
    EXPECT_NEAR(glm::length(found.centre - truth.centre), 0, 0.004);
    EXPECT_GT(std::abs(glm::dot(found.axes[0], truth.axes[0])), 0.9995);
    EXPECT_NEAR(found.half.x, truth.half.x, 0.002);
    EXPECT_NEAR(found.half.y, truth.half.y, 0.0006);
    EXPECT_EQ(mend.bodies[0].removed.size(), surfaceOf(thin).triangles.size());
    EXPECT_GE(mend.bodies[0].removed.front(), world.floorTriangles);
    EXPECT_TRUE(mend.bodies[0].setBack.empty());
}

TEST(EmitterMend, APanelInTwoShredsIsOneBox) {
    const Vec3 centre(0, 0, 0.4f), size(0.2f, 0.15f, 0.015f);
    Mesh shreds = test::sheet(centre + Vec3(-0.19f, -0.14f, 0.01f), {0.16f, 0, 0}, {0, 0.28f, 0}, 8, 12);
    test::append(shreds, test::sheet(centre + Vec3(0.03f, -0.14f, 0.01f), {0.16f, 0, 0}, {0, 0.28f, 0}, 8, 12));
    const World world(boxOf(centre, size), shreds);
    ASSERT_EQ(world.clusters.emitters.size(), 2u);
    const EmitterMend mend = world.mend();
    ASSERT_EQ(mend.bodies.size(), 1u);
    EXPECT_TRUE(mend.moves.empty());
    const EmitterBody& found = mend.bodies[0].body;
    EXPECT_FALSE(found.round);
    EXPECT_NEAR(glm::length(found.centre - DVec3(centre)), 0, 0.004);
    std::array<double, 3> half{found.half.x, found.half.y, found.half.z};
    std::sort(half.begin(), half.end());
    EXPECT_NEAR(half[0], double(size.z), 0.001);
    EXPECT_NEAR(half[1], double(size.y), 0.001);
    EXPECT_NEAR(half[2], double(size.x), 0.001);
    EXPECT_EQ(mend.bodies[0].removed.size(), shreds.triangles.size());
}

TEST(EmitterMend, AViewInWhichSomethingElseHidesAPartIsNotAsked) {
    const Vec3 centre(0, 0, 0.4f), size(0.2f, 0.15f, 0.015f);
    World world(boxOf(centre, size),
                test::sheet(centre + Vec3(-0.19f, -0.14f, 0.01f), {0.2f, 0, 0}, {0, 0.28f, 0}, 8, 12));
    // A curtain that the mesh does not have, before the left half of one photograph.
    Image& image = world.capture.views[0].image;
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width / 2; ++x) image.pixels[size_t(y) * size_t(image.width) + size_t(x)] = Rgb(0.1f);
    const EmitterMend mend = world.mend();
    ASSERT_EQ(mend.bodies.size(), 1u);
    EXPECT_EQ(mend.bodies[0].was.hiddenIn, std::vector<size_t>{0});
    const EmitterBody& found = mend.bodies[0].body;
    EXPECT_NEAR(8 * found.half.x * found.half.y * found.half.z, 8 * double(size.x * size.y * size.z),
                0.1 * 8 * double(size.x * size.y * size.z));
    EXPECT_NEAR(glm::length(found.centre - DVec3(centre)), 0, 0.004);
    // Two of six are too many to be a chance.
    Image& other = world.capture.views[1].image;
    for (int y = 0; y < other.height; ++y)
        for (int x = 0; x < other.width / 2; ++x) other.pixels[size_t(y) * size_t(other.width) + size_t(x)] = Rgb(0.1f);
    EXPECT_TRUE(world.mend().bodies.empty());
}

TEST(EmitterMend, ASideThatPhotographsShowDarkDoesNotShine) {
    EmitterReplacement panel;
    panel.body.centre = {0, 0, 0.4};
    panel.body.half = {0.2, 0.02, 0.15};
    panel.light.radiance = light;
    const World empty({}, {});
    panel.first = uint32_t(empty.capture.mesh.vertexCount());
    const Scene scene = World::sceneWith(surfaceOf(panel.body), {});
    Capture capture;
    for (const double side : {1.5, -1.5}) {
        const Camera camera = test::cameraAt({0.3, side, 0.9}, {0, 0, 0.4}, 320, 240, 320);
        capture.views.push_back(test::photographOf(scene, camera, [&](const Hit& hit) {
            const bool back = hit && scene.mesh.faceNormal(hit.triangle).y < -0.5f;
            return hit && !back && scene.mesh.triangles[hit.triangle][0] >= panel.first ? light : Rgb(0.2f);
        }));
    }
    Progress progress;
    const RadianceSamples samples = gatherRadiance(capture, scene, {}, progress);
    const std::vector<uint8_t> dark = darkSides(panel, scene, capture, samples);
    ASSERT_EQ(dark.size(), 6u);
    EXPECT_EQ(std::count(dark.begin(), dark.end(), 1), 1);
    EXPECT_EQ(dark[3], 1);  // towards -Y
}

TEST(EmitterMend, ARidgeGoesBackToTheSurfaceBehindTheTube) {
    const EmitterBody truth = tubeOf({0, 0.1, 0.05}, {1, 0, 0}, 0.6, 0.03);
    // The floor rises to a ridge, too narrow, that shines.
    const World plain({}, {});
    Mesh ridge = World::floor({});
    for (Vec3& p : ridge.positions)
        if (std::abs(p.x) < 0.31f && std::abs(p.y - 0.1f) < 0.03f) p.z = 0.07f;
    World world(surfaceOf(truth), {});
    world.capture.mesh = ridge;
    world.scene = test::sceneOf(std::move(ridge));
    Progress progress;
    world.samples = gatherRadiance(world.capture, world.scene, {}, progress);
    world.clusters = clusterEmitters(world.scene, world.capture, world.samples, {}, progress);
    ASSERT_EQ(world.clusters.emitters.size(), 1u);
    const EmitterMend mend = world.mend();
    ASSERT_EQ(mend.bodies.size(), 1u);
    EXPECT_NEAR(mend.bodies[0].body.half.y, truth.half.y, 0.003);
    ASSERT_FALSE(mend.bodies[0].setBack.empty());
    EXPECT_TRUE(mend.bodies[0].removed.empty());
    for (const MeshMend::MovedVertex& m : mend.bodies[0].setBack) EXPECT_NEAR(m.position.z, 0, 0.001);
}

TEST(BodyObstacles, ABagThatNoPhotographShowsGoes) {
    // A panel's upper side, and the bag that closes it below; no camera looks up to that.
    const Vec3 centre(0, 0, 0.38f);
    const Scene scene = test::sceneOf(eggOf(centre, {0.2f, 0.15f, 0.06f}));
    RadianceSamples samples;
    samples.start.assign(scene.mesh.vertexCount() + 1, 0);
    samples.geometry.resize(1);
    std::set<uint32_t> removed;
    for (uint32_t t = 0; t < scene.mesh.triangles.size(); ++t) {
        const Triangle& c = scene.mesh.triangles[t];
        if (scene.mesh.positions[c[0]].z + scene.mesh.positions[c[1]].z + scene.mesh.positions[c[2]].z < 3 * centre.z)
            continue;
        removed.insert(t);
        samples.geometry[0].triangle.push_back(t);
    }
    EmitterBody box;
    box.centre = DVec3(centre);
    box.half = {0.2, 0.15, 0.015};
    EXPECT_EQ(scrapsBehind(scene, {}, samples, {}, box, removed).size(), scene.mesh.triangles.size() - removed.size());
    // One view is not enough to reconstruct anything.
    for (uint32_t t = 0; t < scene.mesh.triangles.size(); ++t) samples.geometry[0].triangle.push_back(t);
    EXPECT_EQ(scrapsBehind(scene, {}, samples, {}, box, removed).size(), scene.mesh.triangles.size() - removed.size());
    // Were it seen by two, it would stay.
    samples.samples.resize(2 * scene.mesh.vertexCount());
    for (uint32_t v = 0; v <= scene.mesh.vertexCount(); ++v) samples.start[v] = 2 * v;
    EXPECT_TRUE(scrapsBehind(scene, {}, samples, {}, box, removed).empty());
}

TEST(BodyObstacles, ABagThroughWhichAPhotographShowsTheFloorGoes) {
    const Vec3 centre(0, 0, 0.4f), size(0.2f, 0.15f, 0.012f);
    Mesh shape = eggOf(centre, {0.19f, 0.14f, 0.1f});
    for (Vec3& p : shape.positions) p.z = std::min(p.z, centre.z + 0.011f);
    // The photographs know a panel and the floor below it.
    const World world(boxOf(centre, size), shape);
    ASSERT_EQ(world.clusters.emitters.size(), 1u);
    const EmitterMend mend = world.mend();
    ASSERT_EQ(mend.bodies.size(), 1u);
    EXPECT_GT(mend.bodies[0].removed.size(), 95 * shape.triangles.size() / 100);
    EXPECT_GE(mend.bodies[0].removed.front(), world.floorTriangles);
}

TEST(BodyObstacles, TheGroundUnderAStandingLightIsClosed) {
    Mesh mesh = test::sheet({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, 40, 40);
    std::set<uint32_t> removed;
    double hole = 0;
    for (uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        const Triangle& c = mesh.triangles[t];
        const Vec3 middle = (mesh.positions[c[0]] + mesh.positions[c[1]] + mesh.positions[c[2]]) / 3.0f;
        if (std::abs(middle.x) > 0.1f || std::abs(middle.y) > 0.1f) continue;
        removed.insert(t);
        hole += double(mesh.triangleArea(t));
    }
    const Scene scene = test::sceneOf(std::move(mesh));
    const EmitterBody standing = tubeOf({0, 0, 0.2}, {0, 0, 1}, 0.4, 0.08);
    Mesh ground;
    groundUnder(scene, standing, 0.08, removed, ground.positions, ground.triangles);
    double area = 0;
    for (size_t t = 0; t < ground.triangles.size(); ++t) {
        EXPECT_GT(ground.faceNormal(t).z, 0.99f);
        area += double(ground.triangleArea(t));
    }
    EXPECT_NEAR(area, hole, 1e-6);
    // A border far from the body is none of its business.
    Mesh none;
    groundUnder(scene, standing, 0.01, removed, none.positions, none.triangles);
    EXPECT_TRUE(none.triangles.empty());
}

TEST(ThinEmitters, AStripOfTwoPixelsIsAnEmitterWithItsRadiance) {
    const Mesh strip = boxOf({0.1f, 0, 0.4f}, {0.3f, 0.009f, 0.009f});
    const World world(strip, strip);
    ASSERT_EQ(world.clusters.emitters.size(), 1u);
    const EmitterCluster& e = world.clusters.emitters[0];
    EXPECT_EQ(e.triangles.size(), strip.triangles.size());
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(e.radiance[c], light[c], 0.02f * light[c]);
    EXPECT_FALSE(world.mend().needed());
}

TEST(ThinEmitters, AThinBarThatIsNoBrighterIsNone) {
    const Mesh bar = boxOf({0.1f, 0, 0.4f}, {0.3f, 0.009f, 0.009f});
    const World world({}, bar);  // photographs show the floor and the dark behind it
    EXPECT_TRUE(world.clusters.emitters.empty());
    EXPECT_TRUE(world.clusters.candidates.empty());
}

TEST(EmitterMend, ABallThatTheMeshLacksIsNoneWithoutPhotographsOfIt) {
    const World world({}, {});
    EXPECT_FALSE(world.mend().needed());
}

TEST(MeshMend, TriangleAndVertexNumbersAreChecked) {
    Mesh mesh = World::floor({});
    MeshMend mend;
    mend.removed = {0, 5};
    mend.moved = {{3, {1, 2, 3}}};
    const size_t before = mesh.triangles.size();
    applyMend(mend, mesh);
    EXPECT_EQ(mesh.triangles.size(), before - 2);
    const std::vector<uint32_t> left = trianglesLeft(mend, before);
    ASSERT_EQ(left.size(), before - 2);
    EXPECT_EQ(left[0], 1u);
    EXPECT_EQ(left[4], 6u);
    EXPECT_EQ(mesh.positions[3], Vec3(1, 2, 3));
    mend.removed = {uint32_t(before)};
    EXPECT_THROW(applyMend(mend, mesh), Error);
    mend = {};
    mend.moved = {{uint32_t(mesh.vertexCount()), {0, 0, 0}}};
    EXPECT_THROW(applyMend(mend, mesh), Error);
}

TEST(MeshMend, AddsVerticesAndTrianglesBehindTheFile) {
    Mesh mesh = World::floor({});
    const size_t vertices = mesh.vertexCount(), triangles = mesh.triangles.size();
    MeshMend mend;
    mend.removed = {0};
    mend.addedPositions = {{0, 0, 1}, {1, 0, 1}, {0, 1, 1}};
    mend.added = {{0, 1, 2}};
    mend.moved = {{uint32_t(vertices) + 2, {0, 2, 1}}};
    Mesh added = mesh;
    applyMend(mend, added);
    ASSERT_EQ(added.vertexCount(), vertices + 3);
    ASSERT_EQ(added.normals.size(), vertices + 3);
    ASSERT_EQ(added.triangles.size(), triangles);
    EXPECT_EQ(added.triangles.back()[0], vertices);
    EXPECT_EQ(added.normals.back(), Vec3(0, 0, 1));
    EXPECT_EQ(added.positions.back(), Vec3(0, 2, 1));
    mend.added = {{0, 1, 3}};
    EXPECT_THROW(applyMend(mend, added = mesh), Error);
    mend.added.clear();
    mend.addedPositions[0].x = std::nanf("");
    EXPECT_THROW(applyMend(mend, added = mesh), Error);
}

}  // namespace
}  // namespace relamp
