#include "edit/emitter_edits.h"

#include <gtest/gtest.h>

#include "support/estimates.h"

namespace relamp {
namespace {

/// A floor, a box on it, and a square emitter of radiance (4, 2, 1) at height 1 that faces down.
struct Room {
    Scene scene;
    Estimate estimate;
    uint32_t floorVertex = 0, boxVertex = 0, emitterVertex = 0;

    Room() {
        Mesh mesh = test::sheet({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, 8, 8);
        boxVertex = uint32_t(mesh.vertexCount());
        test::append(mesh, test::box({0.1f, -0.05f, 0.95f}, {0.2f, 0.05f, 1.1f}, 2));
        emitterVertex = uint32_t(mesh.vertexCount());
        const std::vector<uint32_t> emitter = test::append(mesh, test::squareAbove(0.2f, 0, 0, 1, 2));
        scene = test::sceneOf(mesh);
        estimate = test::matteEstimate(scene, Rgb(0.5f), Rgb(0.1f), test::emittersOf(scene, {emitter}, {Rgb(4, 2, 1)}));
    }
};

const Room& room() {
    static const Room one;
    return one;
}

EmitterState stateOf(const Look& look, const std::string& id) {
    return findEmitter(room().scene, room().estimate, look, id).value();
}

void expectNear(const Vec3& a, const Vec3& b, float tolerance = 1e-5f) {
    EXPECT_LT(glm::distance(a, b), tolerance) << a.x << ' ' << a.y << ' ' << a.z;
}

TEST(EmitterEdits, anUntouchedLookShowsWhatWasRecovered) {
    const EmitterState s = stateOf({}, "emitter-1");
    EXPECT_TRUE(s.recovered && s.enabled && !s.changed);
    expectNear(s.radiance, Rgb(4, 2, 1));
    expectNear(s.pivot, Vec3(0, 0, 1));
    expectNear(s.axes[2], Vec3(0, 0, -1));
    EXPECT_NEAR(s.area, 0.04f, 1e-6f);
    EXPECT_FALSE(findEmitter(room().scene, room().estimate, {}, "emitter-2"));
}

TEST(EmitterEdits, radianceIsScaledSoThatTheWantedOneComesOut) {
    Look look;
    setRadiance(look, room().estimate, "emitter-1", Rgb(8, 1, 1));
    expectNear(stateOf(look, "emitter-1").radiance, Rgb(8, 1, 1));
    expectNear(look.emitters.at(0).powerScale, Rgb(2, 0.5f, 1));
}

TEST(EmitterEdits, aResetLookEqualsAnUntouchedOne) {
    Look look;
    setRadiance(look, room().estimate, "emitter-1", Rgb(8, 1, 1));
    setEnabled(look, "emitter-1", false);
    moveEmitter(look, "emitter-1", test::translation({1, 2, 3}));
    EXPECT_FALSE(look == Look{});
    resetEmitter(look, "emitter-1", EmitterValue::place);
    EXPECT_EQ(look.emitters.at(0).matrix, Mat4(1));
    resetEmitter(look, "emitter-1", EmitterValue::all);
    EXPECT_TRUE(look == Look{});
}

TEST(EmitterEdits, attachedPartsFollowAndStayWhenDetached) {
    Look look;
    attachPart(look, room().scene, room().boxVertex, "emitter-1");
    moveEmitter(look, "emitter-1", test::translation({0.5f, 0, 0}));
    ASSERT_EQ(look.parts.size(), 1u);
    EXPECT_EQ(look.parts[0].matrix, test::translation({0.5f, 0, 0}));
    detachPart(look, room().scene, room().boxVertex + 1);  // any vertex of the component
    moveEmitter(look, "emitter-1", test::translation({0.5f, 0, 0}));
    EXPECT_EQ(look.parts[0].matrix, test::translation({0.5f, 0, 0}));
    resetPart(look, room().scene, room().boxVertex);
    EXPECT_TRUE(look.parts.empty());
}

TEST(EmitterEdits, resettingThePlaceBringsAttachedPartsBack) {
    Look look;
    attachPart(look, room().scene, room().boxVertex, "emitter-1");
    moveEmitter(look, "emitter-1", test::translation({0.5f, 0.25f, 0}));
    resetEmitter(look, "emitter-1", EmitterValue::place);
    EXPECT_EQ(look.parts.at(0).matrix, Mat4(1));
}

TEST(EmitterEdits, likelyPartsAreWhatTouchesTheEmitterButNotTheFloor) {
    const std::vector<uint32_t> seeds = likelyParts(room().scene, room().estimate, "emitter-1");
    ASSERT_EQ(seeds.size(), 1u);
    EXPECT_EQ(room().scene.component[seeds[0]], room().scene.component[room().boxVertex]);
}

TEST(EmitterEdits, addedEmittersGetIdsOfTheirOwn) {
    Look look;
    EXPECT_EQ(addEmitter(look, room().estimate, {}), "rectangle-1");
    EXPECT_EQ(addEmitter(look, room().estimate, {}), "rectangle-2");
    removeEmitter(look, "rectangle-1");
    ASSERT_EQ(look.added.size(), 1u);
    EXPECT_EQ(addEmitter(look, room().estimate, {}), "rectangle-1");
}

TEST(EmitterEdits, aCopyShinesAsItsSourceDoesNow) {
    Look look;
    setRadiance(look, room().estimate, "emitter-1", Rgb(8, 4, 2));
    const std::string id = duplicateEmitter(look, room().estimate, "emitter-1", {0.3f, 0, 0});
    EXPECT_EQ(id, "copy-1");
    expectNear(stateOf(look, id).radiance, Rgb(8, 4, 2));
    expectNear(stateOf(look, id).pivot, Vec3(0.3f, 0, 1));
    EXPECT_TRUE(duplicateEmitter(look, room().estimate, "nobody", {}).empty());
}

TEST(EmitterEdits, aNameIsNoChangeOfTheLightAndSurvivesResets) {
    Look look;
    renameEmitter(look, "emitter-1", " Key ");
    EXPECT_EQ(stateOf(look, "emitter-1").name, "Key");
    EXPECT_FALSE(stateOf(look, "emitter-1").changed);
    moveEmitter(look, "emitter-1", test::translation({1, 0, 0}));
    EXPECT_TRUE(stateOf(look, "emitter-1").changed);
    resetEmitter(look, "emitter-1", EmitterValue::all);
    EXPECT_EQ(stateOf(look, "emitter-1").name, "Key");
    const std::string copy = duplicateEmitter(look, room().estimate, "emitter-1", Vec3(0));
    EXPECT_EQ(stateOf(look, copy).name, copy);
    renameEmitter(look, copy, "Fill");
    EXPECT_EQ(stateOf(look, copy).name, "Fill");
    EXPECT_EQ(stateOf(look, duplicateEmitter(look, room().estimate, copy, Vec3(0))).name, "copy-2");
    look.neutralMaterials = true;
    resetLook(look);
    EXPECT_TRUE(look.added.empty() && !look.neutralMaterials);
    EXPECT_EQ(stateOf(look, "emitter-1").name, "Key");
    for (const char* none : {"", "  ", "emitter-1"}) {
        renameEmitter(look, "emitter-1", none);
        EXPECT_EQ(look, Look{});
    }
}

TEST(EmitterEdits, deletingARecoveredEmitterSwitchesItOff) {
    Look look;
    removeEmitter(look, "emitter-1");
    EXPECT_FALSE(stateOf(look, "emitter-1").enabled);
}

TEST(EmitterEdits, aimingTurnsAboutThePivot) {
    for (const Vec3& target : {Vec3(1, 0, 1), Vec3(-0.3f, 0.7f, 0.2f), Vec3(0, 0, 5), Vec3(0, 0, -5)}) {
        Look look;
        aimEmitter(look, room().scene, room().estimate, "emitter-1", target);
        const EmitterState s = stateOf(look, "emitter-1");
        expectNear(s.pivot, Vec3(0, 0, 1));
        expectNear(s.axes[2], glm::normalize(target - Vec3(0, 0, 1)), 1e-4f);
    }
}

TEST(EmitterEdits, aPlacedReflectionMirrorsTheEyeAtThePoint) {
    Look look;
    const Vec3 point(0.2f, 0.1f, 0), normal(0, 0, 1), eye(1, -1, 1);
    const float distance = glm::distance(point, Vec3(0, 0, 1));
    placeByReflection(look, room().scene, room().estimate, "emitter-1", point, normal, eye);
    const EmitterState s = stateOf(look, "emitter-1");
    const Vec3 toward = glm::normalize(s.pivot - point), towardEye = glm::normalize(eye - point);
    expectNear(glm::normalize(toward + towardEye), normal, 1e-4f);
    EXPECT_NEAR(glm::distance(s.pivot, point), distance, 1e-4f);
    expectNear(s.axes[2], -toward, 1e-4f);
}

TEST(EmitterEdits, placedByItsLightItStandsAboveThePointAndFacesIt) {
    Look look;
    placeByLight(look, room().scene, room().estimate, "emitter-1", {0.5f, 0.5f, 0}, {0, 0, 1});
    const EmitterState s = stateOf(look, "emitter-1");
    EXPECT_NEAR(s.pivot.x, 0.5f, 1e-5f);
    EXPECT_NEAR(s.pivot.y, 0.5f, 1e-5f);
    EXPECT_GT(s.pivot.z, 0.9f);
    expectNear(s.axes[2], Vec3(0, 0, -1), 1e-4f);
}

TEST(EmitterEdits, axesStayUnitUnderScaling) {
    Look look;
    moveEmitter(look, "emitter-1", Mat4(Vec4(3, 0, 0, 0), Vec4(0, 0.5f, 0, 0), Vec4(0, 0, 2, 0), Vec4(0, 0, 0, 1)));
    const EmitterState s = stateOf(look, "emitter-1");
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(glm::length(s.axes[k]), 1, 1e-5f);
    EXPECT_NEAR(glm::dot(s.axes[0], s.axes[2]), 0, 1e-5f);
    expectNear(s.axes[2], Vec3(0, 0, -1));
}

}  // namespace
}  // namespace relamp
