#include "capture/proxy_light.h"

#include <gtest/gtest.h>

#include <limits>

#include "base/error.h"

namespace relamp {
namespace {

TEST(ProxyLight, IsAClosedSphereOfTheRightAreaBehindEverythingElse) {
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.normals.assign(3, Vec3(0, 0, 1));
    mesh.triangles = {{0, 1, 2}};
    addProxies({{Vec3(1, 2, 3), 0.2f, Vec3(0), false}, {Vec3(-1, 0, 0), 0.1f, Vec3(0), false}}, mesh);
    ASSERT_EQ(mesh.vertexCount(), 3 + 2 * proxyVertices);
    ASSERT_EQ(mesh.normals.size(), mesh.vertexCount());
    ASSERT_EQ(mesh.triangles.size(), 1 + 2 * proxyTriangles);
    double area = 0;
    for (size_t t = 1; t <= proxyTriangles; ++t) {
        area += double(mesh.triangleArea(t));
        const Vec3 middle = (mesh.positions[mesh.triangles[t][0]] + mesh.positions[mesh.triangles[t][1]] +
                             mesh.positions[mesh.triangles[t][2]]) /
                            3.0f;
        EXPECT_GT(glm::dot(mesh.faceNormal(t), middle - Vec3(1, 2, 3)), 0.0f);
    }
    EXPECT_NEAR(area, 4 * piD * 0.04, 1e-5);
}

TEST(ProxyLight, FarOutsideTheMeshIsRefusedAndTheMeshStaysAsItIs) {
    Mesh mesh;
    mesh.positions = {Vec3(0), Vec3(1, 0, 0), Vec3(0, 1, 0)};
    mesh.normals.assign(3, Vec3(0, 0, 1));
    mesh.triangles = {{0, 1, 2}};
    for (const ProxyLight& bad : {ProxyLight{Vec3(1e30f, 0, 0), 1}, ProxyLight{Vec3(0, 0, 1), 1e9f},
                                  ProxyLight{Vec3(0, 3000, 0), 1}, ProxyLight{Vec3(0, 0, 1), 1e-20f}}) {
        EXPECT_THROW(addProxies({bad}, mesh), Error);
        EXPECT_EQ(mesh.positions.size(), 3u);
    }
    EXPECT_NO_THROW(addProxies({ProxyLight{Vec3(0, 1000, 0), 1}}, mesh));
}

TEST(ProxyLight, WithoutAPlaceOrASizeIsRefused) {
    Mesh mesh;
    const float infinite = std::numeric_limits<float>::infinity();
    for (const ProxyLight& bad : {ProxyLight{Vec3(infinite), 1}, ProxyLight{Vec3(0), 0}, ProxyLight{Vec3(0), -1},
                                  ProxyLight{Vec3(0), infinite}})
        EXPECT_THROW(addProxies({bad}, mesh), Error);
    EXPECT_EQ(mesh.vertexCount(), 0u);
}

}  // namespace
}  // namespace relamp
