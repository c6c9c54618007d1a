// Straight bodies in the place of lights, and what of the mesh makes way for them.
#include "clusters/emitter_body.h"

#include <gtest/gtest.h>

#include "clusters/photographed_light.h"

namespace relamp {
namespace {

using World = test::PhotographedLight;
using test::ballOf, test::boxOf, test::eggOf, test::light, test::surfaceOf, test::tubeOf;

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
    EmitterBody cone = tube;
    cone.taper = 0.4;
    check(cone, piD * (0.1 * std::hypot(0.6, 0.04) + 0.03 * 0.03 + 0.07 * 0.07));
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

TEST(EmitterBody, RaysEnterAndLeaveAConeWhereItsSidesAre) {
    EmitterBody cone = tubeOf({0, 0, 0}, {1, 0, 0}, 0.6, 0.05);
    cone.taper = -0.5;
    EXPECT_NEAR(cone.chord({-0.3 + 1e-9, 0, 5}, {0, 0, -1}).x, 5 - 0.075, 1e-8);
    EXPECT_NEAR(cone.distance({0.3 + 0.02, 0, 0}), 0.02, 1e-12);
    size_t hits = 0, along = 0;
    for (uint32_t n = 0; n < 3000; ++n) {
        const auto random = [&](uint32_t k) { return 2.0 * double(unitFloat(mixBits(7 * n + k))) - 1; };
        const DVec3 eye(random(0), 0.3 * random(1), 0.3 * random(2));
        const DVec3 to(0.4 * random(3), 0.08 * random(4), 0.08 * random(5)), direction = glm::normalize(to - eye);
        const glm::dvec2 chord = cone.chord(eye, direction);
        double least = 1e30;
        for (int k = 0; k <= 400; ++k) least = std::min(least, cone.distance(eye + (k * 0.005) * direction));
        if (chord.x > chord.y) {
            EXPECT_GT(least, -0.003) << n;
            continue;
        }
        ++hits;
        along += std::abs(direction.x) > 0.999;
        EXPECT_LT(cone.distance(eye + 0.5 * (chord.x + chord.y) * direction), 1e-9) << n;
        if (chord.x > 0) { EXPECT_NEAR(cone.distance(eye + chord.x * direction), 0, 1e-9) << n; }
        EXPECT_NEAR(cone.distance(eye + chord.y * direction), 0, 1e-9) << n;
    }
    EXPECT_GT(hits, 300u);
    EXPECT_GT(along, 3u) << "steeper than the cone";
}

/// What takes the place of the one light that the mesh has.
EmitterReplacement onlyBody(const World& world) {
    EXPECT_EQ(world.clusters.emitters.size(), 1u);
    const EmitterMend mend = world.mend();
    EXPECT_EQ(mend.bodies.size(), 1u);
    return mend.bodies.empty() ? EmitterReplacement() : mend.bodies[0];
}

TEST(EmitterMend, AShadeThatGlowsIsACone) {
    EmitterBody truth = tubeOf({0, 0, 0.35}, {0, 0, 1}, 0.2, 0.08);
    truth.taper = -0.3;
    EmitterBody thin = truth;
    thin.half = {0.09, 0.065, 0.065};
    const EmitterBody found = onlyBody(World(surfaceOf(truth), surfaceOf(thin))).body;
    EXPECT_TRUE(found.round);
    EXPECT_NEAR(glm::length(found.centre - truth.centre), 0, 0.003);
    EXPECT_GT(std::abs(found.axes[0].z), 0.999);
    EXPECT_NEAR(found.taper * (found.axes[0].z > 0 ? 1 : -1), truth.taper, 0.02);
    EXPECT_NEAR(found.half.x, truth.half.x, 0.002);
    EXPECT_NEAR(found.half.y, truth.half.y, 0.001);
    EXPECT_EQ(wordsOf(found).substr(0, 7), "a cone ");
}

TEST(EmitterMend, ATubeTakesThePlaceOfAThinOne) {
    const EmitterBody truth = tubeOf({0.05, -0.1, 0.35}, {1, 0.4, 0.1}, 0.5, 0.03);
    EmitterBody thin = truth;
    thin.half = {0.23, 0.018, 0.018};
    const World world(surfaceOf(truth), surfaceOf(thin));
    const EmitterReplacement only = onlyBody(world);
    const EmitterBody& found = only.body;
    EXPECT_TRUE(found.round);
    EXPECT_NEAR(glm::length(found.centre - truth.centre), 0, 0.004);
    EXPECT_GT(std::abs(glm::dot(found.axes[0], truth.axes[0])), 0.9995);
    EXPECT_NEAR(found.half.x, truth.half.x, 0.002);
    EXPECT_NEAR(found.half.y, truth.half.y, 0.0006);
    EXPECT_EQ(only.place.removed.size(), surfaceOf(thin).triangles.size());
    EXPECT_GE(only.place.removed.front(), world.floorTriangles);
    EXPECT_TRUE(only.setBack.empty());
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
    EXPECT_EQ(mend.bodies[0].place.removed.size(), shreds.triangles.size());
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
    EXPECT_TRUE(mend.bodies[0].place.removed.empty());
    for (const MeshMend::MovedVertex& m : mend.bodies[0].setBack) EXPECT_NEAR(m.position.z, 0, 0.001);
}
TEST(EmitterBody, ANarrowStripHasVerticesAwayFromItsEdges) {
    // On an edge a photograph shows what lies beside it as well.
    EmitterBody strip;
    strip.half = {0.4, 0.012, 0.012};
    std::vector<Vec3> positions;
    std::vector<Triangle> triangles;
    std::vector<uint32_t> ends = strip.surface(positions, triangles);
    ends.push_back(uint32_t(positions.size()));
    ASSERT_EQ(ends.size(), 7u);
    for (size_t side = 0; side + 1 < ends.size(); ++side)
        EXPECT_TRUE(std::any_of(positions.begin() + ends[side], positions.begin() + ends[side + 1], [&](const Vec3& p) {
            int onEdges = 0;
            for (int k = 0; k < 3; ++k) onEdges += std::abs(std::abs(double(p[k])) - strip.half[k]) < 1e-6;
            return onEdges == 1;
        })) << side;
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
    EXPECT_EQ(scrapsBehind(scene, {}, samples, {}, box, removed).sure.size(),
              scene.mesh.triangles.size() - removed.size());
    // One view is not enough to reconstruct anything.
    for (uint32_t t = 0; t < scene.mesh.triangles.size(); ++t) samples.geometry[0].triangle.push_back(t);
    EXPECT_EQ(scrapsBehind(scene, {}, samples, {}, box, removed).sure.size(),
              scene.mesh.triangles.size() - removed.size());
    // Were it seen by two, it would stay.
    samples.samples.resize(2 * scene.mesh.vertexCount());
    for (uint32_t v = 0; v <= scene.mesh.vertexCount(); ++v) samples.start[v] = 2 * v;
    EXPECT_TRUE(scrapsBehind(scene, {}, samples, {}, box, removed).sure.empty());
}

TEST(BodyObstacles, ABagThatHangsOnWhatIsSeenMayBeThere) {
    // Photographs see a panel's upper side, the lowest part of the egg below it and the floor, but no ring in between.
    const Vec3 centre(0, 0, 0.38f);
    Mesh mesh = test::sheet({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, 8, 8);
    const size_t floor = mesh.triangles.size();
    test::append(mesh, eggOf(centre, {0.2f, 0.15f, 0.06f}));
    const Scene scene = test::sceneOf(std::move(mesh));
    RadianceSamples samples;
    samples.geometry.resize(1);
    std::vector<uint8_t> low(scene.mesh.vertexCount());
    for (uint32_t v = 0; v < low.size(); ++v) {
        low[v] = scene.mesh.positions[v].z < centre.z - 0.03f;
        samples.start.push_back(uint32_t(samples.samples.size()));
        samples.samples.resize(samples.samples.size() + (low[v] ? 2 : 0));
    }
    samples.start.push_back(uint32_t(samples.samples.size()));
    std::set<uint32_t> removed;
    size_t ring = 0;
    for (uint32_t t = 0; t < scene.mesh.triangles.size(); ++t) {
        const auto& [a, b, c] = scene.mesh.triangles[t];
        const bool above =
            scene.mesh.positions[a].z + scene.mesh.positions[b].z + scene.mesh.positions[c].z >= 3 * centre.z;
        const bool seen = low[a] || low[b] || low[c];
        if (above) removed.insert(t);
        if (above || seen) samples.geometry[0].triangle.push_back(t);
        ring += !above && !seen;
    }
    ASSERT_GT(ring, 0u);
    EmitterBody box;
    box.centre = DVec3(centre);
    box.half = {0.2, 0.15, 0.015};
    const Scraps found = scrapsBehind(scene, {}, samples, {}, box, removed);
    EXPECT_TRUE(found.sure.empty());
    // Without the ring the lowest part hangs on nothing.
    EXPECT_EQ(found.doubtful.size(), scene.mesh.triangles.size() - floor - removed.size());
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
    EXPECT_GT(mend.bodies[0].place.removed.size(), 95 * shape.triangles.size() / 100);
    EXPECT_GE(mend.bodies[0].place.removed.front(), world.floorTriangles);
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

TEST(BodyObstacles, AFilletAboutAStandingLightLiesOnTheFlatGround) {
    // As a mesh rounds the corner between a box of 0.3 m and the floor; a thing stands a little off.
    EmitterBody box;
    box.centre = DVec3(0, 0, 0.15);
    box.half = DVec3(0.15);
    const auto heightAt = [&](const Vec3& p) {
        const double away = box.distance(DVec3(p.x, p.y, 0.1));
        return away > 0 && away < 0.03 ? float(0.4 * (0.03 - away)) : 0.0f;
    };
    Mesh mesh = test::sheet({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, 160, 160);
    for (Vec3& p : mesh.positions) p.z = heightAt(p);
    const auto floorVertices = mesh.vertexCount();
    test::append(mesh, test::box({0.2f, 0, 0}, {0.3f, 0.1f, 0.1f}, 4));
    mesh.normals = vertexNormalsFromFaces(mesh);
    const Scene scene = test::sceneOf(mesh);
    const std::optional<FlatGround> ground = flatGround(scene, box, {});
    ASSERT_TRUE(ground);
    EXPECT_GT(ground->normal.z, 0.9999);
    size_t raised = 0;
    for (uint32_t v = 0; v < mesh.vertexCount(); ++v) {
        const Vec3 p = mesh.positions[v];
        const std::optional<DVec3> level = ground->levelled(DVec3(p), box);
        if (v < floorVertices && p.z > 1e-4f && std::max(std::abs(p.x), std::abs(p.y)) > 0.15f) {
            ++raised;
            ASSERT_TRUE(level) << p.x << " " << p.y << " " << p.z;
            EXPECT_NEAR(level->z, 0, 1e-5);
        } else if (v >= floorVertices) {
            EXPECT_FALSE(level && level->z < double(p.z) - 0.02) << "no thing beside the light is pressed flat";
        }
    }
    EXPECT_GT(raised, 150u);
    // A wavy floor is none, nor is one that the light hangs over.
    Mesh wavy = mesh;
    for (uint32_t v = 0; v < floorVertices; ++v) wavy.positions[v].z += 0.002f * std::sin(40 * wavy.positions[v].x);
    EXPECT_FALSE(flatGround(test::sceneOf(wavy), box, {}));
    EmitterBody hanging = box;
    hanging.centre.z = 0.2;
    EXPECT_FALSE(flatGround(scene, hanging, {}));
}
}  // namespace
}  // namespace relamp
