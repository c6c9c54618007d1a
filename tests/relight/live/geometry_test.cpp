// Edited geometry without a ray tracer, and the added emitters that take their geometry from the scene.
#include <gtest/gtest.h>

#include "relight/relit_scene.h"
#include "support/estimates.h"
#include "support/temporary_folder.h"

namespace relamp {
namespace {

/// A floor, a box on it (six sheets: six components joined at their seams) and a square emitter above.
struct PartsWorld {
    Scene scene;
    EmitterClusters clusters;
    Estimate estimate;
    uint32_t boxVertex = 0;
    std::vector<uint32_t> boxTriangles, emitterTriangles;
};

PartsWorld partsWorld() {
    PartsWorld w;
    Mesh mesh = test::sheet({-2, -2, 0}, {4, 0, 0}, {0, 4, 0}, 4, 4);
    w.boxVertex = uint32_t(mesh.vertexCount());
    w.boxTriangles = test::append(mesh, test::box({-0.5f, -0.5f, 0.2f}, {0.5f, 0.5f, 1.2f}, 2));
    w.emitterTriangles = test::append(mesh, test::squareAbove(0.5f, 0, 0, 3, 2));
    w.scene = test::sceneOf(mesh);
    w.clusters = test::emittersOf(w.scene, {w.emitterTriangles}, {Rgb(10, 20, 30)});
    w.estimate = test::matteEstimate(w.scene, Rgb(0.5f), Rgb(1), w.clusters);
    return w;
}

AddedEmitter shiningPart(const PartsWorld& w, const Mat4& matrix) {
    AddedEmitter e;
    e.shape = EmitterShape::part;
    e.id = "glow";
    e.matrix = matrix;
    e.seedVertex = w.boxVertex;
    e.radiance = Rgb(3);
    return e;
}

TEST(LiveGeometry, APartThatShinesBelongsToItsEmitterAndMovesWithIt) {
    const PartsWorld w = partsWorld();
    Look look;
    look.added.push_back(shiningPart(w, test::translation({0, 0, 1})));
    const RelitScene relit = test::relitOf(w.scene, w.estimate, look);
    ASSERT_EQ(relit.emitters.size(), 2u);
    EXPECT_EQ(relit.emitters[1].emission.level, Rgb(3));
    EXPECT_NEAR(relit.emitters[1].surface.area(), 6, 1e-4);
    EXPECT_EQ(relit.scene.mesh.triangles.size(), w.scene.mesh.triangles.size()) << "nothing is added";
    for (uint32_t t : w.boxTriangles) {
        EXPECT_EQ(relit.emitterOfTriangle[t], 1);
        const Vec3 before = w.scene.mesh.positions[w.scene.mesh.triangles[t][0]],
                   now = relit.scene.mesh.positions[relit.scene.mesh.triangles[t][0]];
        EXPECT_LT(glm::length(now - before - Vec3(0, 0, 1)), 1e-5f);
    }
    EXPECT_EQ(relit.emitterOfTriangle[0], -1);
}

TEST(LiveGeometry, ADisabledAddedEmitterIsDarkButKeepsItsPart) {
    const PartsWorld w = partsWorld();
    Look look;
    look.added.push_back(shiningPart(w, Mat4(1)));
    look.added.push_back({EmitterShape::disk, "d", test::translation({0, 0, 2}), Vec2(1), Rgb(5)});
    look.added[0].enabled = look.added[1].enabled = false;
    const RelitScene relit = test::relitOf(w.scene, w.estimate, look);
    EXPECT_EQ(relit.emitters[1].emission.level, Rgb(0));
    EXPECT_EQ(relit.emitters[2].emission.level, Rgb(0));
    EXPECT_GT(relit.scene.mesh.triangles.size(), w.scene.mesh.triangles.size());
    EXPECT_EQ(relit.emitterOfTriangle[w.boxTriangles[0]], 1);
}

TEST(LiveGeometry, ACopyIsTheRecoveredEmitterAgainMovedFromWhereItWasFound) {
    PartsWorld w = partsWorld();
    w.estimate.emitters.emitters[0].twoSided = true;
    Look look;
    look.emitters.push_back({"emitter-1", true, test::translation({0, 5, 0}), Rgb(1)});
    AddedEmitter copy;
    copy.shape = EmitterShape::copy;
    copy.id = "twin";
    copy.source = "emitter-1";
    copy.matrix = test::translation({1, 0, 0});
    copy.radiance = Rgb(4, 5, 6);
    look.added.push_back(copy);
    const RelitScene relit = test::relitOf(w.scene, w.estimate, look);
    ASSERT_EQ(relit.emitters.size(), 2u);
    EXPECT_LT(glm::length(relit.emitters[1].surface.centroid - Vec3(1, 0, 3)), 1e-5f);
    EXPECT_TRUE(relit.emitters[1].surface.twoSided);
    EXPECT_EQ(relit.scene.mesh.triangles.size(), w.scene.mesh.triangles.size() + w.emitterTriangles.size());
    EXPECT_EQ(relit.emitterOfTriangle.back(), 1);
    EXPECT_NEAR(relit.scene.tracer->closest({Vec3(1.1f, 0.1f, 0.5f), Vec3(0, 0, 1)}).distance, 2.5f, 1e-4f);
}

TEST(LiveGeometry, NamesAPartThatShinesAlreadyAndASourceThatDoesNotExist) {
    const PartsWorld w = partsWorld();
    Look twice, emitter, outside, noSource;
    twice.added = {shiningPart(w, Mat4(1)), shiningPart(w, Mat4(1))};
    EXPECT_NE(test::messageOf([&] { test::relitOf(w.scene, w.estimate, twice); }).find("shines already"),
              std::string::npos);
    emitter.added = {shiningPart(w, Mat4(1))};
    emitter.added[0].seedVertex = w.scene.mesh.triangles[w.emitterTriangles[0]][0];
    EXPECT_NE(test::messageOf([&] { test::relitOf(w.scene, w.estimate, emitter); }).find("shines already"),
              std::string::npos);
    outside.added = {shiningPart(w, Mat4(1))};
    outside.added[0].seedVertex = 100000;
    EXPECT_NE(
        test::messageOf([&] { test::relitOf(w.scene, w.estimate, outside); }).find("seed_vertex 100000 does not exist"),
        std::string::npos);
    noSource.added = {shiningPart(w, Mat4(1))};
    noSource.added[0].shape = EmitterShape::copy;
    noSource.added[0].source = "emitter-9";
    EXPECT_EQ(test::messageOf([&] { test::relitOf(w.scene, w.estimate, noSource); }),
              "added_emitters: there is no emitter named emitter-9");
}

TEST(LiveGeometry, PartsKeptApartDoubleTheSameVerticesWhereverTheyStand) {
    const PartsWorld w = partsWorld();
    Look moved;
    moved.emitters.push_back({"emitter-1", true, test::translation({0, 1, 0}), Rgb(1)});
    moved.parts.push_back({w.boxVertex, test::translation({0, 0, 1})});
    const PartsApart apart{true, {w.scene.component[w.boxVertex]}};
    const EditedGeometry a = editGeometry(w.scene, w.estimate, {}, apart),
                         b = editGeometry(w.scene, w.estimate, moved, apart);
    ASSERT_EQ(a.parts.size(), 3u);
    EXPECT_EQ(a.mesh.triangles, b.mesh.triangles);
    EXPECT_EQ(a.vertexOrigin, b.vertexOrigin);
    EXPECT_EQ(a.partOfTriangle, b.partOfTriangle);
    for (size_t v = 0; v < a.mesh.vertexCount(); ++v)
        EXPECT_EQ(a.mesh.positions[v], w.scene.mesh.positions[a.vertexOrigin[v]]);
    EXPECT_FALSE(editGeometry(w.scene, w.estimate, {}).moved);
    // Steps of a drag share what closes the mesh; another set of leaving emitters does not.
    std::shared_ptr<const ClosedMesh> closed;
    EXPECT_EQ(editGeometry(w.scene, w.estimate, {}, apart, &closed).mesh.positions, a.mesh.positions);
    const std::shared_ptr<const ClosedMesh> first = closed;
    EXPECT_EQ(editGeometry(w.scene, w.estimate, moved, apart, &closed).mesh.positions, b.mesh.positions);
    EXPECT_EQ(closed, first);
    EXPECT_EQ(editGeometry(w.scene, w.estimate, {}, {}, &closed).mesh.positions, w.scene.mesh.positions);
    EXPECT_NE(closed, first);
}

}  // namespace
}  // namespace relamp
