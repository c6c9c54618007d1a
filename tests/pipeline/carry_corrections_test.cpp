// What was put right on a working mesh, on the large mesh that it stands for.
#include "pipeline/carry_corrections.h"

#include <gtest/gtest.h>

#include <set>

#include "pipeline/mend_mesh.h"
#include "pipeline/working_mesh.h"
#include "support/shapes.h"

namespace relamp {
namespace {

/// A sheet of two metres, finely cut and a little rough; a tenth of its triangles make the working mesh.
struct LargeSheet {
    Capture capture;
    DecimatedMesh working;

    LargeSheet() {
        capture.mesh = test::sheet({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, 120, 120);
        for (size_t v = 0; v < capture.mesh.vertexCount(); ++v)
            capture.mesh.positions[v].z = 1e-4f * std::sin(float(v));
        Progress progress;
        working = *workingMesh(capture, 2880, progress);
    }
    /// What is left of the large mesh with `found`, whose working mesh has its vertices at `corrected`.
    Mesh corrected(const Corrections& found, const std::vector<Vec3>& places) const {
        const Corrections done = carriedBack(found, working, places, capture.mesh);
        Mesh mesh = capture.mesh;
        applyRegistration(done.registration, mesh);
        applyMend(done.mend, mesh);
        return mesh;
    }
    Vec3 middle(const Mesh& mesh, const Triangle& t) const {
        return (mesh.positions[t[0]] + mesh.positions[t[1]] + mesh.positions[t[2]]) / 3.0f;
    }
};

float wave(const Vec3& p) { return 0.02f * std::sin(3 * p.x) * std::cos(2 * p.y); }

TEST(CarryCorrections, DisplacementsAreThoseOfThePlaceBetweenCorners) {
    const LargeSheet sheet;
    Corrections found;
    found.registration.step = 1e-5f;
    found.registration.poses.push_back({"a", DVec3(0.01, 0, 0), DVec3(0)});
    for (const Vec3& p : sheet.working.mesh.positions)
        found.registration.steps.push_back(int(std::lround(wave(p) / 1e-5f)));
    Mesh small = sheet.working.mesh;
    RegistrationFix shape = found.registration;
    shape.poses.clear();
    applyRegistration(shape, small);
    const Corrections done = carriedBack(found, sheet.working, small.positions, sheet.capture.mesh);
    EXPECT_TRUE(done.registration.poses == found.registration.poses);
    EXPECT_TRUE(done.mend.moved.empty()) << "registration alone moved it";
    Mesh large = sheet.capture.mesh;
    shape = done.registration;
    shape.poses.clear();
    applyRegistration(shape, large);
    for (size_t v = 0; v < large.vertexCount(); ++v) {
        EXPECT_NEAR(large.positions[v].z, sheet.capture.mesh.positions[v].z + wave(large.positions[v]), 6e-4f);
        EXPECT_GT(glm::dot(large.normals[v], Vec3(0, 0, 1)), 0.99f);
    }
}

TEST(CarryCorrections, WhatGoesEndsWhereTheWorkingMeshEnds) {
    const LargeSheet sheet;
    Corrections found;
    const Mesh& small = sheet.working.mesh;
    float rim = -1;
    for (uint32_t t = 0; t < small.triangles.size(); ++t) {
        const bool goes = sheet.middle(small, small.triangles[t]).x > 0.4f;
        if (goes) found.mend.removed.push_back(t);
        for (const uint32_t v : small.triangles[t])
            if (!goes) rim = std::max(rim, small.positions[v].x);
    }
    const Mesh left = sheet.corrected(found, small.positions);
    ASSERT_LT(left.triangles.size(), sheet.capture.mesh.triangles.size());
    size_t beyond = 0, before = 0;
    for (const Triangle& t : left.triangles) {
        const float x = sheet.middle(left, t).x;
        before += x < 0.3f;
        for (const uint32_t v : t) beyond += left.positions[v].x > rim + 1e-5f;
    }
    EXPECT_EQ(beyond, 0u);
    size_t all = 0;
    for (const Triangle& t : sheet.capture.mesh.triangles) all += sheet.middle(sheet.capture.mesh, t).x < 0.3f;
    EXPECT_EQ(before, all) << "far from the rim nothing goes";
}

TEST(CarryCorrections, MovedVerticesTakeThoseAroundThemAlongAndAddedOnesFollow) {
    const LargeSheet sheet;
    Corrections found;
    std::vector<Vec3> places = sheet.working.mesh.positions;
    const auto added = uint32_t(places.size());
    for (uint32_t v = 0; v < places.size(); ++v)
        if (places[v].x < -0.5f) {
            places[v].y += 0.05f;
            found.mend.moved.push_back({v, places[v]});
            found.mend.turned.push_back({v, {0, 0.6f, 0.8f}});
            found.mend.shining.push_back(v);
        }
    found.mend.addedPositions = {{0, 0, 1}, {1, 0, 1}, {0, 1, 1}};
    found.mend.added = {{0, 1, 2}};
    found.mend.moved.push_back({added + 2, {0, 2, 1}});
    found.mend.shining.push_back(added + 1);
    const Corrections done = carriedBack(found, sheet.working, places, sheet.capture.mesh);
    const Mesh mesh = sheet.corrected(found, places);
    const size_t own = sheet.capture.mesh.vertexCount();
    ASSERT_EQ(mesh.vertexCount(), own + 3);
    EXPECT_EQ(mesh.positions[own + 2], Vec3(0, 2, 1));
    EXPECT_EQ(done.mend.shining.back(), own + 1);
    EXPECT_TRUE(std::is_sorted(done.mend.shining.begin(), done.mend.shining.end()));
    const std::set<uint32_t> shining(done.mend.shining.begin(), done.mend.shining.end());
    for (uint32_t v = 0; v < own; ++v) {
        const Vec3 was = sheet.capture.mesh.positions[v];
        if (was.x < -0.65f) {
            EXPECT_NEAR(mesh.positions[v].y, was.y + 0.05f, 1e-5f);
            EXPECT_NEAR(mesh.normals[v].y, 0.6f, 1e-5f);
        }
        EXPECT_TRUE(was.x < -0.35f || mesh.positions[v] == was);
        EXPECT_EQ(shining.count(v), size_t(mesh.normals[v].y > 0.5f));
    }
}

TEST(CarryCorrections, NormalsThatLeanKeepTheDetailOfTheLargeMesh) {
    LargeSheet sheet;
    for (size_t v = 0; v < sheet.capture.mesh.vertexCount(); ++v)
        sheet.capture.mesh.normals[v] = glm::normalize(Vec3(0.02f * std::sin(float(v)), 0, 1));
    for (Vec3& n : sheet.working.mesh.normals) n = Vec3(0, 0, 1);
    Corrections found;
    const Vec3 lean = glm::normalize(Vec3(0, 0.1f, 1));
    for (uint32_t v = 0; v < sheet.working.mesh.vertexCount(); ++v) found.mend.turned.push_back({v, lean});
    const Mesh mesh = sheet.corrected(found, sheet.working.mesh.positions);
    for (size_t v = 0; v < mesh.vertexCount(); ++v) {
        EXPECT_NEAR(mesh.normals[v].x, 0.02f * std::sin(float(v)), 0.001f);
        EXPECT_NEAR(mesh.normals[v].y, lean.y, 0.001f);
    }
}

TEST(WithoutProxies, IsTheMeshThatTheyWereAddedTo) {
    const Mesh mesh = LargeSheet().capture.mesh;
    Mesh with = mesh;
    addProxies({{{0, 0, 1}, 0.1f, Vec3(0), false}, {{1, 0, 1}, 0.2f, Vec3(0), false}}, with);
    ASSERT_GT(with.vertexCount(), mesh.vertexCount());
    const Mesh again = withoutProxies(with, 2);
    EXPECT_EQ(again.positions, mesh.positions);
    EXPECT_EQ(again.normals, mesh.normals);
    EXPECT_EQ(again.triangles, mesh.triangles);
}

TEST(CarryCorrections, MarksOfTheLargeMeshAreThoseOfItsVerticesInTheWorkingMesh) {
    const LargeSheet sheet;
    const std::vector<uint32_t> all = {3, 500, 501, 502, 7000, 14000};
    const std::vector<uint32_t> found = inWorkingMesh(all, sheet.working);
    size_t expected = 0;
    for (const uint32_t v : sheet.working.vertex) expected += std::binary_search(all.begin(), all.end(), v);
    ASSERT_EQ(found.size(), expected);
    for (const uint32_t v : found) EXPECT_TRUE(std::binary_search(all.begin(), all.end(), sheet.working.vertex[v]));
}

}  // namespace
}  // namespace relamp
