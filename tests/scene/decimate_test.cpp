#include "scene/decimate.h"

#include <gtest/gtest.h>

#include <map>

#include "base/random.h"

namespace relamp {
namespace {

/// A square of side 1 at z = 0 with a hole of half that side in the middle, finely cut.
Mesh squareWithHole(int cells) {
    Mesh mesh;
    for (int y = 0; y <= cells; ++y)
        for (int x = 0; x <= cells; ++x)
            mesh.positions.push_back({float(x) / float(cells), float(y) / float(cells), 0});
    const auto at = [&](int x, int y) { return uint32_t(y * (cells + 1) + x); };
    for (int y = 0; y < cells; ++y)
        for (int x = 0; x < cells; ++x) {
            if (4 * x >= cells && 4 * x < 3 * cells && 4 * y >= cells && 4 * y < 3 * cells) continue;
            mesh.triangles.push_back({at(x, y), at(x + 1, y), at(x + 1, y + 1)});
            mesh.triangles.push_back({at(x, y), at(x + 1, y + 1), at(x, y + 1)});
        }
    mesh.normals = vertexNormalsFromFaces(mesh);
    return mesh;
}

Mesh ball(int rings, int sectors, Vec3 centre = Vec3(0), float radius = 1) {
    Mesh mesh;
    for (int i = 0; i <= rings; ++i)
        for (int k = 0; k < sectors; ++k) {
            const float theta = float(i) / float(rings) * pi, phi = float(k) / float(sectors) * 2 * pi;
            const float across = i == 0 || i == rings ? 0.0f : std::sin(theta);  // the poles' vertices lie at one place
            mesh.positions.push_back(centre +
                                     radius * Vec3(across * std::cos(phi), across * std::sin(phi), std::cos(theta)));
        }
    const auto at = [&](int i, int k) { return uint32_t(i * sectors + k % sectors); };
    for (int i = 0; i < rings; ++i)
        for (int k = 0; k < sectors; ++k) {
            if (i + 1 < rings) mesh.triangles.push_back({at(i, k), at(i + 1, k), at(i + 1, k + 1)});
            if (i > 0) mesh.triangles.push_back({at(i, k), at(i + 1, k + 1), at(i, k + 1)});
        }
    for (const Vec3& p : mesh.positions) mesh.normals.push_back((p - centre) / radius);
    return mesh;
}

double areaOf(const Mesh& mesh) {
    double area = 0;
    for (size_t t = 0; t < mesh.triangles.size(); ++t) area += double(mesh.triangleArea(t));
    return area;
}

size_t rimEdges(const Mesh& mesh) {
    std::map<std::pair<uint32_t, uint32_t>, int> edges;
    for (const Triangle& t : mesh.triangles)
        for (size_t k = 0; k < 3; ++k) ++edges[std::minmax(t[k], t[(k + 1) % 3])];
    return size_t(std::count_if(edges.begin(), edges.end(), [](const auto& e) { return e.second == 1; }));
}

DecimatedMesh decimated(const Mesh& mesh, size_t triangles) {
    Progress progress;
    return decimate(mesh, triangles, progress);
}

TEST(Decimate, KeepsTheShapeOfABall) {
    const Mesh mesh = ball(90, 180);
    const DecimatedMesh d = decimated(mesh, 2000);
    EXPECT_LE(d.mesh.triangles.size(), 2000u);
    EXPECT_GT(d.mesh.triangles.size(), 1900u);
    EXPECT_NEAR(areaOf(d.mesh) / areaOf(mesh), 1, 0.01);
    for (size_t v = 0; v < d.mesh.vertexCount(); ++v) {
        EXPECT_EQ(d.mesh.positions[v], mesh.positions[d.vertex[v]]);
        EXPECT_GT(glm::dot(d.mesh.normals[v], d.mesh.positions[v]), 0.995f);
    }
    for (size_t t = 0; t < d.mesh.triangles.size(); ++t)
        EXPECT_GT(glm::dot(d.mesh.faceNormal(t), d.mesh.positions[d.mesh.triangles[t][0]]), 0.8f);
}

TEST(Decimate, KeepsTheRimsOfHoles) {
    const Mesh mesh = squareWithHole(80);
    const DecimatedMesh d = decimated(mesh, 600);
    EXPECT_LE(d.mesh.triangles.size(), 600u);
    EXPECT_NEAR(areaOf(d.mesh), 0.75, 1e-3);
    EXPECT_GT(rimEdges(d.mesh), 8u);
}

TEST(Decimate, PlacesLieOnTheDecimatedMeshWhereTheVertexWas) {
    const Mesh mesh = ball(90, 180);
    const DecimatedMesh d = decimated(mesh, 2000);
    ASSERT_EQ(d.places.size(), mesh.vertexCount());
    for (size_t v = 0; v < mesh.vertexCount(); ++v) {
        ASSERT_NE(d.places[v].triangle, SurfacePlace::none);
        Vec3 p(0);
        for (int k = 0; k < 3; ++k)
            p += d.places[v].weight[k] * d.mesh.positions[d.mesh.triangles[d.places[v].triangle][size_t(k)]];
        EXPECT_LT(glm::length(p - mesh.positions[v]), 0.012f);
    }
}

TEST(Decimate, FacesTurnedEitherWayAndSeamsAreNoObstacle) {
    // A fifth of the faces flipped, and every face with vertices of its own, as flat shading writes them.
    const Mesh whole = ball(60, 120);
    Mesh torn;
    for (size_t t = 0; t < whole.triangles.size(); ++t) {
        Triangle corners = whole.triangles[t];
        if (mixBits(t) % 5 == 0) std::swap(corners[1], corners[2]);
        Triangle face{};
        for (size_t k = 0; k < 3; ++k) {
            face[k] = uint32_t(torn.positions.size());
            torn.positions.push_back(whole.positions[corners[k]]);
            torn.normals.push_back(whole.normals[corners[k]]);
        }
        torn.triangles.push_back(face);
    }
    const DecimatedMesh d = decimated(torn, 2000);
    EXPECT_LE(d.mesh.triangles.size(), 2000u);
    EXPECT_NEAR(areaOf(d.mesh) / areaOf(whole), 1, 0.01);
    EXPECT_LE(d.mesh.vertexCount(), 1100u);
    EXPECT_EQ(rimEdges(d.mesh), 0u);
}

TEST(Decimate, ASmallEmitterBesideALargeSurfaceStays) {
    Mesh mesh = squareWithHole(120);
    const Mesh emitter = ball(16, 24, Vec3(0.5f, 0.5f, 0.3f), 0.01f);
    const auto first = uint32_t(mesh.vertexCount());
    mesh.positions.insert(mesh.positions.end(), emitter.positions.begin(), emitter.positions.end());
    mesh.normals.insert(mesh.normals.end(), emitter.normals.begin(), emitter.normals.end());
    for (const Triangle& t : emitter.triangles) mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
    const DecimatedMesh d = decimated(mesh, 1000);
    size_t ofEmitter = 0;
    for (const Triangle& t : d.mesh.triangles) ofEmitter += d.mesh.positions[t[0]].z > 0.1f;
    EXPECT_GE(ofEmitter, 60u);
}

TEST(Decimate, CanBeCancelled) {
    const Mesh mesh = ball(90, 180);
    Progress progress;
    progress.requestStop();
    EXPECT_THROW(decimate(mesh, 500, progress), Cancelled);
}

}  // namespace
}  // namespace relamp
