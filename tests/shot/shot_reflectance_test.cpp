// Surfaces that were added to the capture's mesh, in a shot.
#include "shot/shot_reflectance.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "base/error.h"
#include "image/image_io.h"
#include "support/estimates.h"
#include "support/one_view_capture.h"
#include "support/temporary_folder.h"

namespace relamp {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// A shot of a floor to which two triangles were added, and a ball that was told.
class AddedSurfaces : public testing::Test {
protected:
    void SetUp() override {
        file = test::sheet({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, 4, 4);
        test::writeOneViewCapture(folder, file);
        shot.captureFolder = folder / "capture";
        shot.fix.mend.removed = {0};
        shot.fix.mend.bothSides = {3, 5};
        shot.fix.mend.turned = {{7, {0, 0.6f, 0.8f}}};
        shot.fix.mend.addedPositions = {{0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
        shot.fix.mend.added = {{0, 1, 2}, {0, 2, 3}};
        ProxyLight told;
        told.centre = {0, 0, 2};
        told.radius = 0.1f;
        shot.fix.proxies.push_back(told);
        mesh = file;
        applyMend(shot.fix.mend, mesh);
        addProxies(shot.fix.proxies, mesh);
        shot.estimate = test::matteEstimate(test::sceneOf(mesh), Rgb(0.5f), Rgb(0.25f));
        std::vector<Rgb>& albedo = shot.estimate.reflectance.weight[0];
        for (size_t v = 0; v < albedo.size(); ++v) albedo[v] = Rgb(0.001f * float(v), 0.5f, 0.25f);
        auto texture = std::make_shared<AlbedoTexture>();
        texture->width = texture->height = 8;
        texture->texels.assign(64, Rgb(0.5f));
        for (size_t t = 0; t < mesh.triangles.size(); ++t)
            texture->corners.push_back({Vec2(1 + 0.1f * float(t % 10), 1), Vec2(3, 1), Vec2(1, 4)});
        shot.estimate.reflectance.texture = texture;
        saveShot(shot, mesh, target(), false);
    }
    fs::path target() const { return folder / "out.relamp"; }
    Shot open(const ShotPlaces& places = {}) const {
        Progress progress;
        return openShot(target(), false, progress, places);
    }
    std::string openError() const {
        try {
            open();
        } catch (const Error& error) { return error.what(); }
        return "";
    }
    void edit(const std::function<void(json& mend)>& change) {
        json document = json::parse(test::TemporaryFolder::read(target() / "shot.json"));
        change(document["capture_fix"]["mesh_mend"]);
        folder.write("out.relamp/shot.json", document.dump());
    }

    test::TemporaryFolder folder;
    Mesh file, mesh;
    Shot shot;
};

TEST_F(AddedSurfaces, SurviveARoundTrip) {
    const Shot back = open();
    EXPECT_EQ(back.fix.mend, shot.fix.mend);
    EXPECT_EQ(back.capture.mesh.positions, mesh.positions);
    EXPECT_EQ(back.capture.mesh.triangles, mesh.triangles);
    EXPECT_EQ(back.estimate.reflectance.weight, shot.estimate.reflectance.weight) << "in the mesh's order";
    ASSERT_TRUE(back.estimate.reflectance.texture);
    const AlbedoTexture &a = *shot.estimate.reflectance.texture, &b = *back.estimate.reflectance.texture;
    ASSERT_EQ(a.corners.size(), b.corners.size());
    for (size_t t = 0; t < a.corners.size(); ++t)
        for (size_t k = 0; k < 3; ++k)
            EXPECT_NEAR(glm::length(a.corners[t][k] - b.corners[t][k]), 0, 1e-4f) << t << " " << k;
}

TEST_F(AddedSurfaces, ReflectancePlyKeepsTheVerticesOfTheFile) {
    const auto columns = [&](const char* name) { return readVertexPly(target() / name); };
    ASSERT_FALSE(columns("reflectance.ply").empty());
    EXPECT_EQ(columns("reflectance.ply")[0].values.size(), file.vertexCount() + proxyVertices);
    EXPECT_EQ(columns("added.ply")[0].values.size(), 4u);
}

TEST_F(AddedSurfaces, OpenWithoutTheCapture) {
    ShotPlaces places;
    places.withoutCapture = true;
    const Shot back = open(places);
    EXPECT_EQ(back.capture.mesh.vertexCount(), mesh.vertexCount());
    EXPECT_EQ(back.capture.mesh.triangles.size(), mesh.triangles.size());
    EXPECT_EQ(back.capture.mesh.positions.back(), Vec3(0, 1, 1));
}

TEST_F(AddedSurfaces, BadOnesAreNamed) {
    edit([](json& mend) { mend["added_triangles"][2] = 4; });
    EXPECT_NE(openError().find("added_triangles: vertex 4 of 4"), std::string::npos) << openError();
    edit([](json& mend) { mend["added_triangles"] = {0, 1}; });
    EXPECT_NE(openError().find("added_triangles: expected three numbers a triangle"), std::string::npos) << openError();
    edit([](json& mend) { mend["added_triangles"] = {0, 1, -2}; });
    EXPECT_NE(openError().find("added_triangles: expected whole numbers"), std::string::npos) << openError();
    edit([](json& mend) {
        mend["added_triangles"] = {0, 1, 2};
        mend["added_positions"].erase(0);
    });
    EXPECT_NE(openError().find("added_positions: expected three numbers a vertex"), std::string::npos) << openError();
    edit([](json& mend) { mend["added_positions"] = {0, 0, 1, 1, 0, 1, 1, 1, 1}; });
    EXPECT_NE(openError().find("values"), std::string::npos) << openError() << ": added.ply has four vertices";
    fs::remove(target() / "added.ply");
    EXPECT_NE(openError().find("added.ply"), std::string::npos) << openError();
}

TEST_F(AddedSurfaces, WhatFormFactorsLackComesBack) {
    EXPECT_TRUE(open().estimate.nearFieldCorrection.empty());
    NearFieldCorrection& fix = shot.estimate.nearFieldCorrection;
    shot.estimate.emitters.emitters.resize(1);
    shot.estimate.emitters.emitters[0].id = "emitter-1";
    shot.estimate.emitters.emitters[0].vertices = {0};
    shot.estimate.lighting.emitterRadiance = {Rgb(1)};
    fix.emitter.assign(mesh.vertexCount(), -1);
    fix.formFactor.assign(mesh.vertexCount(), 0);
    fix.emitter[3] = 0;
    fix.formFactor[3] = -0.125f;
    const size_t added = file.vertexCount() + 1;
    fix.emitter[added] = 0;
    fix.formFactor[added] = 0.5f;
    saveShot(shot, mesh, target(), true);
    const NearFieldCorrection back = open().estimate.nearFieldCorrection;
    EXPECT_EQ(back.emitter, fix.emitter);
    EXPECT_EQ(back.formFactor, fix.formFactor);
}

TEST_F(AddedSurfaces, HowUnevenlyAnEmitterShinesComesBack) {
    EmitterClusters& clusters = shot.estimate.emitters;
    clusters.emitters.resize(1);
    EmitterCluster& emitter = clusters.emitters[0];
    emitter.id = "emitter-1";
    emitter.vertices = {0, 1, 2};
    emitter.level = {0.5f, 1.25f, 1.5f};
    shot.estimate.lighting.emitterRadiance = {Rgb(1)};
    for (const uint32_t v : emitter.vertices) clusters.emitterOfVertex[v] = 0;
    saveShot(shot, mesh, target(), true);
    EXPECT_EQ(json::parse(test::TemporaryFolder::read(target() / "shot.json"))["emitters"][0]["level_range"].size(),
              2u);
    const EmitterCluster back = open().estimate.emitters.emitters[0];
    EXPECT_EQ(back.vertices, emitter.vertices);
    EXPECT_EQ(back.level, emitter.level);
    ASSERT_TRUE(back.pattern);
    EXPECT_NEAR(back.pattern->at(mesh.positions[0]), 0.5f, 0.1f);
    // Even ones have no column, and values that cannot be are named.
    emitter.level = {-1, 1, 1};
    saveShot(shot, mesh, target(), true);
    EXPECT_NE(openError().find("emission_level of vertex 0 is -1"), std::string::npos) << openError();
    emitter.level.clear();
    saveShot(shot, mesh, target(), true);
    EXPECT_EQ(test::TemporaryFolder::read(target() / "reflectance.ply").find("emission_level"), std::string::npos);
    EXPECT_FALSE(open().estimate.emitters.emitters[0].pattern);
}

}  // namespace
}  // namespace relamp
