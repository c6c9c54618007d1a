#include "relight/emitter_shape.h"

#include <gtest/gtest.h>

#include <set>

namespace relamp {
namespace {

double areaOf(const Mesh& mesh) {
    double area = 0;
    for (size_t t = 0; t < mesh.triangles.size(); ++t) area += double(mesh.triangleArea(t));
    return area;
}

TEST(EmitterShapes, HaveARowEachUnderTheirOwnName) {
    std::set<std::string> names, edits;
    size_t at = 0;
    for (const EmitterShapeInfo& info : emitterShapes()) {
        EXPECT_EQ(size_t(info.shape), at++) << info.name << ": the rows stand in the order of the enum";
        EXPECT_EQ(&infoOf(info.shape), &info);
        EXPECT_EQ(emitterShapeNamed(info.name), &info);
        EXPECT_TRUE(names.insert(info.name).second) << info.name;
        EXPECT_TRUE(edits.insert(info.edit).second) << info.edit;
    }
    EXPECT_EQ(emitterShapeNamed("cone"), nullptr);
}

TEST(EmitterShapes, OfTheirOwnHaveAMeshOfTheAreaTheySayForEverySize) {
    for (const EmitterShapeInfo& info : emitterShapes()) {
        EXPECT_EQ(info.own(), info.mesh != nullptr) << info.name;
        EXPECT_EQ(info.own(), info.area != nullptr) << info.name;
        EXPECT_EQ(info.own(), info.sizes > 0) << info.name;
        if (!info.own()) continue;
        for (const float size : {0.01f, 1.0f, 7.0f}) {
            const Mesh mesh = info.mesh(Vec2(size));
            EXPECT_EQ(mesh.normals.size(), mesh.positions.size()) << info.name;
            const double said = double(info.area(Vec2(size)));
            EXPECT_NEAR(areaOf(mesh), said, 1e-3 * said) << info.name;
        }
    }
}

TEST(EmitterShapes, ThatAreFlatLieInTheirPlaneAndFaceMinusZ) {
    for (const EmitterShapeInfo& info : emitterShapes()) {
        if (!info.flat) continue;
        const Mesh mesh = info.mesh(Vec2(2, 3));
        for (const Vec3& p : mesh.positions) EXPECT_EQ(p.z, 0) << info.name;
        for (const Vec3& n : mesh.normals) EXPECT_EQ(n, Vec3(0, 0, -1)) << info.name;
        for (size_t t = 0; t < mesh.triangles.size(); ++t) EXPECT_LT(mesh.faceNormal(t).z, -0.99f) << info.name;
    }
}

}  // namespace
}  // namespace relamp
