#include "relight/relit_scene.h"

#include <gtest/gtest.h>

#include "base/random.h"
#include "image/environment_map.h"
#include "image/image_io.h"
#include "relight/frame.h"
#include "support/estimates.h"
#include "support/temporary_folder.h"
#include "texture/coarser_texels.h"

namespace relamp {
namespace {

using test::append;

/// A sheet of 4 x 4 quads at z = 0 whose middle four quads are an emitter that shares its rim with the rest, and a
/// floor below.
struct World {
    Scene scene;
    EmitterClusters clusters;
    Estimate estimate;
    size_t sheetVertices = 0, floorVertices = 0;
};

World world() {
    World w;
    Mesh mesh = test::sheet({-2, -2, 0}, {0, 4, 0}, {4, 0, 0}, 4, 4);  // faces down
    w.sheetVertices = mesh.vertexCount();
    std::vector<uint32_t> emitter;
    for (uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        const Vec3 c = (mesh.positions[mesh.triangles[t][0]] + mesh.positions[mesh.triangles[t][1]] +
                        mesh.positions[mesh.triangles[t][2]]) /
                       3.0f;
        if (std::abs(c.x) < 1 && std::abs(c.y) < 1) emitter.push_back(t);
    }
    append(mesh, test::sheet({-2, -2, -3}, {4, 0, 0}, {0, 4, 0}, 2, 2));
    w.floorVertices = 9;
    w.scene = test::sceneOf(mesh);
    w.clusters = test::emittersOf(w.scene, {emitter}, {Rgb(10, 20, 30)});
    w.estimate = test::matteEstimate(w.scene, Rgb(0.5f, 0.4f, 0.3f), Rgb(1), w.clusters);
    return w;
}

TEST(ApplyLook, OfAnEmptyLookIsTheScene) {
    const World w = world();
    const RelitScene relit = test::relitOf(w.scene, w.estimate);
    EXPECT_EQ(relit.scene.mesh.positions, w.scene.mesh.positions);
    EXPECT_EQ(relit.scene.mesh.triangles, w.scene.mesh.triangles);
    ASSERT_EQ(relit.emitters.size(), 1u);
    EXPECT_EQ(relit.emitters[0].id, "emitter-1");
    EXPECT_EQ(relit.emitters[0].emission.level, Rgb(10, 20, 30));
    EXPECT_NEAR(relit.emitters[0].surface.area(), 4, 1e-5);
    EXPECT_EQ(relit.distant->cells(), w.estimate.environment);
}

TEST(ApplyLook, MovesAnEmitterAndDoublesTheVerticesItFractions) {
    const World w = world();
    Look look;
    look.emitters.push_back({"emitter-1", true, test::translation({0, 0, -1}), Rgb(2, 1, 0.5f)});
    const RelitScene relit = test::relitOf(w.scene, w.estimate, look);
    EXPECT_EQ(relit.emitters[0].emission.level, Rgb(20, 20, 15));
    EXPECT_LT(glm::length(relit.emitters[0].surface.centroid - Vec3(0, 0, -1)), 1e-5f);
    // The emitter has 9 vertices: its middle is its own, the 8 of the rim are shared. The place it leaves has a middle.
    EXPECT_EQ(relit.scene.mesh.vertexCount(), w.scene.mesh.vertexCount() + 9);
    EXPECT_EQ(relit.weight[0].size(), relit.scene.mesh.vertexCount());
    ASSERT_EQ(relit.scene.mesh.triangles.size(), w.scene.mesh.triangles.size() + 8) << "a flat light has no underside";
    for (size_t t = 0; t < w.scene.mesh.triangles.size(); ++t) {
        const bool emitter = relit.emitterOfTriangle[t] == 0;
        EXPECT_EQ(relit.emitterOfTriangle[t], w.clusters.emitterOfTriangle[t]);
        EXPECT_NEAR(relit.scene.mesh.triangleArea(t), w.scene.mesh.triangleArea(t), 1e-5)
            << "triangle " << t << " was stretched";
        for (int k = 0; k < 3; ++k) {
            const Vec3 before = w.scene.mesh.positions[w.scene.mesh.triangles[t][size_t(k)]],
                       now = relit.scene.mesh.positions[relit.scene.mesh.triangles[t][size_t(k)]];
            EXPECT_LT(glm::length(now - before - Vec3(0, 0, emitter ? -1 : 0)), 1e-5f);
        }
    }
    // The place it leaves is closed, and where it went it is hit.
    EXPECT_NEAR(relit.scene.tracer->closest({Vec3(0.3f, 0.2f, 5), Vec3(0, 0, -1)}).distance, 5, 1e-4);
    EXPECT_NEAR(relit.scene.tracer->closest({Vec3(0.3f, 0.2f, -0.5f), Vec3(0, 0, -1)}).distance, 0.5, 1e-4);
    EXPECT_NEAR(relit.scene.tracer->closest({Vec3(1.5f, 0.2f, 5), Vec3(0, 0, -1)}).distance, 5, 1e-4);
    EXPECT_EQ(w.scene.mesh.vertexCount(), 25u + 9u) << "the capture's scene is untouched";
}

TEST(ApplyLook, TakesTheEmitterAlongWithItsPartOnlyByItsOwnMatrix) {
    const World w = world();
    const Mat4 down = test::translation({0, 0, -1});
    Look look;
    look.parts.push_back({0, down});
    {
        // The sheet goes, the emitter stays: nothing between them is stretched.
        const RelitScene relit = test::relitOf(w.scene, w.estimate, look);
        for (size_t t = 0; t < relit.scene.mesh.triangles.size(); ++t) {
            const bool moves = t < 32 && relit.emitterOfTriangle[t] < 0;
            for (int k = 0; k < 3; ++k) {
                const Vec3 before = w.scene.mesh.positions[w.scene.mesh.triangles[t][size_t(k)]],
                           now = relit.scene.mesh.positions[relit.scene.mesh.triangles[t][size_t(k)]];
                EXPECT_LT(glm::length(now - before - Vec3(0, 0, moves ? -1 : 0)), 1e-5f) << t;
            }
        }
    }
    // With both moved alike the whole component goes as one.
    look.emitters.push_back({"emitter-1", true, down, Rgb(1)});
    const RelitScene relit = test::relitOf(w.scene, w.estimate, look);
    for (size_t t = 0; t < w.scene.mesh.triangles.size(); ++t)
        for (int k = 0; k < 3; ++k) {
            const Vec3 before = w.scene.mesh.positions[w.scene.mesh.triangles[t][size_t(k)]],
                       now = relit.scene.mesh.positions[relit.scene.mesh.triangles[t][size_t(k)]];
            EXPECT_LT(glm::length(now - before - Vec3(0, 0, t < 32 ? -1 : 0)), 1e-5f) << t;
        }
}

TEST(ApplyLook, KeepsAMirroredEmitterFacingAsItsSurfaceDoes) {
    const World w = world();
    Look look;
    Mat4 mirror(1);
    mirror[0][0] = -1;
    look.emitters.push_back({"emitter-1", true, mirror, Rgb(1)});
    const RelitScene relit = test::relitOf(w.scene, w.estimate, look);
    for (const Vec3& n : relit.emitters[0].surface.normals) EXPECT_LT(n.z, -0.99f);
    for (size_t t = 0; t < relit.scene.mesh.triangles.size(); ++t)
        if (relit.emitterOfTriangle[t] == 0) { EXPECT_LT(relit.scene.mesh.faceNormal(t).z, -0.99f); }
}

TEST(ApplyLook, WhatFormFactorsLackIsAddedUntilTheEmitterMoves) {
    World w = world();
    w.estimate.lighting.emitterRadiance = {Rgb(10, 20, 30)};
    w.estimate.environment.assign(w.estimate.environment.size(), Rgb(0));
    const Camera camera = test::cameraAt({0, 0, -1}, {0, 0, -3}, 8, 8, 16, {0, 1, 0});
    const auto middle = [&](const Look& look) {
        FrameOptions options;
        options.samplesPerPixel = 64;
        Progress progress;
        return renderFrame(test::relitOf(w.scene, w.estimate, look), camera, options, progress).beauty[4 * 8 + 4];
    };
    Look moved;
    moved.emitters.emplace_back();
    moved.emitters[0].id = "emitter-1";
    moved.emitters[0].matrix = test::translation({0, 0, 0.01f});
    const Rgb before = middle({}), beforeMoved = middle(moved);
    w.estimate.nearFieldCorrection.emitter.assign(w.scene.mesh.vertexCount(), -1);
    w.estimate.nearFieldCorrection.formFactor.assign(w.scene.mesh.vertexCount(), 0);
    for (size_t v = w.sheetVertices; v < w.scene.mesh.vertexCount(); ++v) {
        w.estimate.nearFieldCorrection.emitter[v] = 0;
        w.estimate.nearFieldCorrection.formFactor[v] = 0.1f;
    }
    const Rgb added = middle({}) - before;
    const Rgb expected = Rgb(0.5f, 0.4f, 0.3f) * 0.1f * Rgb(10, 20, 30);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(added[c], expected[c], 1e-4f * expected[c]);
    EXPECT_EQ(middle(moved), beforeMoved);
    Look off;
    off.emitters.emplace_back();
    off.emitters[0].id = "emitter-1";
    off.emitters[0].enabled = false;
    EXPECT_EQ(middle(off), Rgb(0));
}

TEST(ApplyLook, AnUnevenEmitterAndItsCopyTakeTheirPatternAlong) {
    World w = world();
    EmitterCluster& emitter = w.estimate.emitters.emitters[0];
    for (const uint32_t v : emitter.vertices) emitter.level.push_back(1 + 0.5f * w.scene.mesh.positions[v].x);
    rebuildPattern(w.scene.mesh, emitter);
    Look look;
    // A quarter turn about z, and up: what was its +X side faces +Y.
    const Mat4 turned(Vec4(0, 1, 0, 0), Vec4(-1, 0, 0, 0), Vec4(0, 0, 1, 0), Vec4(0, 0, 0.5f, 1));
    look.emitters.push_back({emitter.id, true, turned});
    AddedEmitter copy;
    copy.id = "new-1";
    copy.shape = EmitterShape::copy;
    copy.source = emitter.id;
    copy.radiance = Rgb(1);
    copy.matrix[3] = Vec4(0, 0, -1, 1);
    look.added.push_back(copy);
    Progress progress;
    const RelitScene relit = applyLook(w.scene, w.estimate, look, progress);
    const Vec3 down(0, 0, -1);
    const auto sent = [&](size_t e, const Vec3& at) { return relit.emitters[e].emission.radiance(down, at).x; };
    EXPECT_NEAR(sent(0, {0.1f, 0.8f, 0.5f}), 14, 0.3f);
    EXPECT_NEAR(sent(0, {0.1f, -0.8f, 0.5f}), 6, 0.3f);
    EXPECT_NEAR(sent(1, {0.8f, 0.1f, -1}), 1.4f, 0.03f);
    EXPECT_NEAR(sent(1, {-0.8f, 0.1f, -1}), 0.6f, 0.03f);
    EXPECT_NEAR(relit.emitters[0].surface.levelAt({0, 0.8f, 0.5f}, {0, 0, -1}), 1.4f, 0.03f);
    EXPECT_EQ(relit.emitters[0].emission.shaped->mean(), Rgb(1));
}

TEST(ApplyLook, SwitchesAnEmitterOffWithoutTakingItAway) {
    const World w = world();
    Look look;
    look.emitters.push_back({"emitter-1", false, Mat4(1), Rgb(1)});
    const RelitScene relit = test::relitOf(w.scene, w.estimate, look);
    EXPECT_EQ(relit.emitters[0].emission.level, Rgb(0));
    EXPECT_EQ(relit.scene.mesh.triangles.size(), w.scene.mesh.triangles.size());
}

TEST(ApplyLook, AddsEmittersOfTheSizeAskedForThatFaceDown) {
    const World w = world();
    Look look;
    look.added.push_back({EmitterShape::rectangle, "r", test::translation({0, 0, 2}), Vec2(2, 3), Rgb(1)});
    look.added.push_back({EmitterShape::disk, "d", test::translation({3, 0, 2}), Vec2(2, 2), Rgb(2)});
    look.added.push_back({EmitterShape::sphere, "s", test::translation({6, 0, 2}), Vec2(2, 2), Rgb(3)});
    const RelitScene relit = test::relitOf(w.scene, w.estimate, look);
    ASSERT_EQ(relit.emitters.size(), 4u);
    EXPECT_EQ(relit.emitters[1].id, "r");
    EXPECT_NEAR(relit.emitters[1].surface.area(), 6, 1e-5);
    EXPECT_NEAR(relit.emitters[2].surface.area(), piD, 1e-4) << "the polygon has the disc's area";
    EXPECT_NEAR(relit.emitters[3].surface.area(), 4 * piD, 2e-3) << "the polyhedron has the sphere's area";
    for (const size_t e : {1u, 2u})
        for (const Vec3& n : relit.emitters[e].surface.normals) EXPECT_LT(n.z, -0.99f);
    for (size_t t = 0; t < relit.emitters[3].surface.centres.size(); ++t)
        EXPECT_GT(glm::dot(relit.emitters[3].surface.normals[t], relit.emitters[3].surface.centres[t] - Vec3(6, 0, 2)),
                  0.9f);
    EXPECT_EQ(relit.emitterOfTriangle.size(), relit.scene.mesh.triangles.size());
    EXPECT_EQ(relit.weight[0].size(), relit.scene.mesh.vertexCount());
    EXPECT_EQ(relit.emitterOfTriangle.back(), 3);
}

TEST(ApplyLook, NeutralMaterialsKeepTheirBrightness) {
    const World w = world();
    Look look;
    look.neutralMaterials = true;
    const Rgb now = test::relitOf(w.scene, w.estimate, look).weight[0].back();
    EXPECT_EQ(now.x, now.y);
    EXPECT_EQ(now.x, now.z);
    EXPECT_NEAR(now.x, luminance(Rgb(0.5f, 0.4f, 0.3f)), 1e-6);
}

TEST(ApplyLook, NamesWhatDoesNotExist) {
    const World w = world();
    Look unknown, outside, noFile;
    unknown.emitters.push_back({"emitter-7", true, Mat4(1), Rgb(1)});
    EXPECT_EQ(test::messageOf([&] { test::relitOf(w.scene, w.estimate, unknown); }),
              "emitters: there is no emitter named emitter-7");
    outside.parts.push_back({34, Mat4(1)});
    EXPECT_EQ(test::messageOf([&] { test::relitOf(w.scene, w.estimate, outside); }),
              "parts: seed_vertex 34 does not exist, the mesh has 34 vertices");
    noFile.environment.source = EnvironmentLook::Source::file;
    noFile.environment.file = "/nowhere/sky.exr";
    EXPECT_NE(test::messageOf([&] { test::relitOf(w.scene, w.estimate, noFile); }).find("/nowhere/sky.exr"),
              std::string::npos);
}

TEST(ApplyLook, EnvironmentIsScaledTintedTurnedOrReplaced) {
    const World w = world();
    Look look;
    look.environment.exposureStops = 2;
    look.environment.tint = {1, 0.5f, 0};
    EXPECT_EQ(test::relitOf(w.scene, w.estimate, look).distant->radiance({0, 0, 1}), Rgb(4, 2, 0));
    look.environment.source = EnvironmentLook::Source::none;
    EXPECT_TRUE(test::relitOf(w.scene, w.estimate, look).distant->black());

    // A file with a bright patch towards +X; turned by 90 degrees it stands towards +Y.
    const test::TemporaryFolder folder;
    Image map(128, 64, Rgb(0.01f));
    for (int y = 28; y < 36; ++y)
        for (int x = 60; x < 68; ++x) map.at(x, y) = Rgb(50);
    writeImage(folder / "sky.exr", map);
    look = {};
    look.environment.source = EnvironmentLook::Source::file;
    look.environment.file = folder / "sky.exr";
    EXPECT_GT(test::relitOf(w.scene, w.estimate, look).distant->radiance({1, 0, 0}).x, 40);
    EXPECT_LT(test::relitOf(w.scene, w.estimate, look).distant->radiance({0, 1, 0}).x, 0.1f);
    look.environment.yawDegrees = 90;
    EXPECT_GT(test::relitOf(w.scene, w.estimate, look).distant->radiance({0, 1, 0}).x, 40);
    EXPECT_LT(test::relitOf(w.scene, w.estimate, look).distant->radiance({1, 0, 0}).x, 0.1f);
}

TEST(DistantLight, OfAFileShowsTheFileBehindTheScene) {
    const test::TemporaryFolder folder;
    Image map(2048, 1024);
    for (int y = 0; y < map.height; ++y)
        for (int x = 0; x < map.width; ++x) map.at(x, y) = Rgb(x / 2 % 2 ? 1.0f : 0.1f);  // third of a degree
    writeImage(folder / "sky.exr", map);
    const Scene scene = test::sceneOf(test::sheet({0, 0, 0}, {1, 0, 0}, {0, 1, 0}));
    Look look;
    look.environment.source = EnvironmentLook::Source::file;
    look.environment.file = folder / "sky.exr";
    const auto distant = test::relitOf(scene, test::matteEstimate(scene, Rgb(0.5f), Rgb(1)), look).distant;
    for (int x = 300; x < 308; ++x) {
        const Vec3 d = directionFromLatLong({(float(x) + 0.5f) / 2048, 400.5f / 1024});
        EXPECT_NEAR(distant->background(d).x, x / 2 % 2 ? 1.0f : 0.1f, 0.02f) << x;
    }
}

TEST(DistantLight, IsSmoothBetweenCellCentresAndExactAtThem) {
    const DirectionGrid grid{16};
    std::vector<Rgb> cells(size_t(grid.cells()), Rgb(0.2f));
    cells[37] = Rgb(90);
    const DistantLight light(grid, cells);
    EXPECT_NEAR(light.background(grid.direction(37)).x, 90, 0.1);
    EXPECT_NEAR(light.background(grid.direction(37, Vec2(1.0f, 0.5f))).x, 45.1, 0.1);
    EXPECT_TRUE(DistantLight(grid, std::vector<Rgb>(256, Rgb(0))).black());
    EXPECT_FALSE(light.black());
}

/// Two sheets apart; the first has a texture that tells its corners from each other.
TEST(RelitScene, ATextureGoesWithItsTrianglesAlsoWhereTheyAreMirrored) {
    Mesh mesh = test::sheet({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    append(mesh, test::sheet({5, 0, 0}, {1, 0, 0}, {0, 1, 0}));
    const Scene scene = test::sceneOf(mesh);
    Estimate estimate = test::matteEstimate(scene, Rgb(0.5f), Rgb(1));
    auto texture = std::make_shared<AlbedoTexture>();
    texture->width = texture->height = 8;
    for (int y = 0; y < 8; ++y)
        for (int x = 0; x < 8; ++x) texture->texels.push_back(Rgb(float(x) / 8, float(y) / 8, 0.5f));
    texture->corners.assign(mesh.triangles.size(), {Vec2(-1), Vec2(-1), Vec2(-1)});
    texture->corners[0] = {Vec2(1, 1), Vec2(7, 1), Vec2(7, 7)};
    estimate.reflectance.texture = texture;
    Look look;
    Mat4 mirror(1);
    mirror[0][0] = -1;
    look.parts.push_back({mesh.triangles[0][0], mirror, ""});
    const RelitScene plain = test::relitOf(scene, estimate), turned = test::relitOf(scene, estimate, look);
    const auto albedoBelow = [](const RelitScene& relit, float x, float y) {
        const Hit hit = relit.scene.cameraTracer->closest({Vec3(x, y, 1), Vec3(0, 0, -1), 0, 1e30f});
        return relit.albedoAt(hit);
    };
    ASSERT_EQ(plain.scene.mesh.triangles[0], mesh.triangles[0]);
    for (const Vec2 at : {Vec2(0.5f, 0.2f), Vec2(0.8f, 0.7f)}) {
        const Rgb here = albedoBelow(plain, at.x, at.y), there = albedoBelow(turned, -at.x, at.y);
        EXPECT_LT(glm::length(here - there), 1e-4f);
        EXPECT_GT(std::abs(here.x - here.y), 0.05f);
    }
    EXPECT_EQ(albedoBelow(plain, 5.5f, 0.5f), Rgb(0.5f));  // no texels
    look.neutralMaterials = true;
    const Rgb neutral = albedoBelow(test::relitOf(scene, estimate, look), -0.5f, 0.2f);
    EXPECT_FLOAT_EQ(neutral.x, neutral.z);
}

/// A board of light and dark squares, far away: every pixel covers many of them.
TEST(RelitScene, TextureIsAveragedOverWhatARayStandsFor) {
    const Mesh mesh = test::sheet({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    const Scene scene = test::sceneOf(mesh);
    Estimate estimate = test::matteEstimate(scene, Rgb(0.5f), Rgb(1));
    auto texture = std::make_shared<AlbedoTexture>();
    texture->width = texture->height = 128;
    for (int y = 0; y < 128; ++y)
        for (int x = 0; x < 128; ++x) texture->texels.push_back(Rgb((x + y) % 2 ? 0.9f : 0.1f));
    for (const Triangle& t : mesh.triangles) {
        texture->corners.emplace_back();
        for (size_t k = 0; k < 3; ++k)
            texture->corners.back()[k] = 4.0f + 120.0f * Vec2(mesh.positions[t[k]].x, mesh.positions[t[k]].y);
    }
    addCoarser(*texture);
    estimate.reflectance.texture = texture;
    Look look;
    Mat4 mirror(1);
    mirror[0][0] = -1;
    look.parts.push_back({mesh.triangles[0][0], mirror, ""});
    for (const bool mirrored : {false, true}) {
        const RelitScene relit = test::relitOf(scene, estimate, mirrored ? look : Look{});
        float far = 0, near = 0;
        for (const Vec3& eye : {Vec3(0.5f, 0.5f, 40), Vec3(0.5f, -7, 2)})
            for (uint32_t i = 0; i < 100; ++i) {
                Vec2 p = Vec2(0.2f) + 0.6f * r2Point(i, Vec2(0));
                if (mirrored) p.x = -p.x;
                const Vec3 d = glm::normalize(Vec3(p, 0) - eye);
                const Hit hit = relit.scene.cameraTracer->closest({eye, d, 0, 1e30f});
                ASSERT_TRUE(hit);
                // From above a cone of 8 texels; from aside one of 1 x 4.
                const float spread = 8.0f / 120 / (eye.z > 10 ? hit.distance : 8 * hit.distance);
                far = std::max(far, std::abs(relit.albedoAt(hit, d, spread).x - 0.5f));
                near = std::max(near, std::abs(relit.albedoAt(hit, d, 0.01f * spread).x - 0.5f));
                EXPECT_EQ(relit.albedoAt(hit, d, 0.01f * spread), relit.albedoAt(hit));
            }
        EXPECT_LT(far, 0.15f) << mirrored;
        EXPECT_GT(near, 0.3f) << mirrored;
    }
}

TEST(RelitScene, ConfidenceIsThatOfTheTexelsWhereThereAreSome) {
    Mesh mesh = test::sheet({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    append(mesh, test::sheet({5, 0, 0}, {1, 0, 0}, {0, 1, 0}));
    const Scene scene = test::sceneOf(mesh);
    Estimate estimate = test::matteEstimate(scene, Rgb(0.5f), Rgb(1));
    estimate.reflectance.confidence.assign(mesh.vertexCount(), 0.25f);
    auto texture = std::make_shared<AlbedoTexture>();
    texture->width = texture->height = 8;
    texture->texels.assign(64, Rgb(0.5f));
    for (size_t i = 0; i < 64; ++i) texture->confidence.push_back(i % 8 < 4 ? 0 : 255);
    texture->corners.assign(mesh.triangles.size(), {Vec2(-1), Vec2(-1), Vec2(-1)});
    for (size_t t = 0; t < 2; ++t)
        for (size_t k = 0; k < 3; ++k)
            texture->corners[t][k] = 8.0f * Vec2(mesh.positions[mesh.triangles[t][k]].x, 0.5f);
    estimate.reflectance.texture = texture;
    const RelitScene relit = test::relitOf(scene, estimate);
    const auto below = [&](float x) {
        return relit.confidenceAt(relit.scene.cameraTracer->closest({Vec3(x, 0.4f, 1), Vec3(0, 0, -1), 0, 1e30f}));
    };
    EXPECT_FLOAT_EQ(below(0.2f), 0);
    EXPECT_FLOAT_EQ(below(0.8f), 1);
    EXPECT_FLOAT_EQ(below(5.5f), 0.25f);
}

}  // namespace
}  // namespace relamp
