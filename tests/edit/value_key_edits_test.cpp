#include "edit/value_key_edits.h"

#include <gtest/gtest.h>

#include "edit/emitter_edits.h"
#include "edit/group_edits.h"
#include "edit/look_keys.h"
#include "relight/placement.h"
#include "support/estimates.h"

namespace relamp {
namespace {

const KeyedOf ofYaw{KeyedValue::yaw, {}}, ofPower{KeyedValue::powerScale, "emitter-1"},
    ofTurn{KeyedValue::rotation, "emitter-1"};

std::vector<int> keyedFrames(const Look& look, const KeyedOf& what) {
    std::vector<int> frames;
    if (const ValueCurve* curve = curveOf(look, what))
        for (const ValueKey& key : curve->keys) frames.push_back(key.frame);
    return frames;
}

/// The look at a frame, changed there as the window changes it.
Look editedAt(const Look& look, int frame, const std::function<void(Look&)>& change) {
    Look before = look;
    applyValueKeys(before, frame, {});
    Look after = before;
    change(after);
    keyEdit(before, after, frame);
    return after;
}

TEST(ValueKeyEdits, AnEditGoesIntoTheKeysOfItsValueAlone) {
    Look look;
    setValueKey(look, ofYaw, 10, {});
    look = editedAt(look, 20, [](Look& l) { l.environment.yawDegrees = 40; });
    EXPECT_EQ(keyedFrames(look, ofYaw), (std::vector<int>{10, 20}));
    EXPECT_EQ(look.environment.yawDegrees, 40) << "a drag shows what is dragged";
    look = editedAt(look, 15, [](Look& l) { l.environment.exposureStops = 2; });
    EXPECT_EQ(keyedFrames(look, ofYaw), (std::vector<int>{10, 20})) << "another value was edited";
    EXPECT_TRUE(look.keys.empty());
    EXPECT_EQ(look.environment.exposureStops, 2);
    EXPECT_EQ(look.environment.yawDegrees, 20);
    // Beside keys of the look: these get what has no keys of its own.
    setKey(look, 1);
    look = editedAt(look, 30, [](Look& l) { l.environment.yawDegrees = 100; });
    EXPECT_EQ(look.keys.size(), 1u);
    look = editedAt(look, 30, [](Look& l) { l.environment.exposureStops = 3; });
    EXPECT_EQ(look.keys.size(), 2u);
    EXPECT_EQ(keyedFrames(look, ofYaw), (std::vector<int>{10, 20, 30}));
    EXPECT_EQ(keyFrames(look), (std::vector<int>{1, 10, 20, 30}));
}

TEST(ValueKeyEdits, ATurnIsKeyedWithoutTheMoveThatCameWithIt) {
    Look look;
    setValueKey(look, ofTurn, 1, {});
    setKey(look, 1);
    const Mat4 step = test::translation({0, 0, 2});
    look = editedAt(look, 9, [&](Look& l) { moveEmitter(l, "emitter-1", step); });
    EXPECT_EQ(keyedFrames(look, ofTurn), (std::vector<int>{1})) << "it did not ofTurn";
    EXPECT_EQ(look.keys.size(), 2u);
    Mat4 quarter(1);
    quarter[0] = Vec4(0, 1, 0, 0), quarter[1] = Vec4(-1, 0, 0, 0);
    look = editedAt(look, 20, [&](Look& l) { moveEmitter(l, "emitter-1", quarter); });
    EXPECT_EQ(keyedFrames(look, ofTurn), (std::vector<int>{1, 20}));
    EXPECT_EQ(look.keys.size(), 2u) << "it turned where it stood";
    EXPECT_NEAR(curveOf(look, ofTurn)->keys[1].value.z, 90, 1e-3);
}

TEST(ValueKeyEdits, WhatTurnsAndGrowsWhereItStandsKeepsItsPlaceWithoutAKey) {
    LookPivots pivots;
    pivots.emitter = [](const std::string&) { return Vec3(5.3f, 4.1f, 1.7f); };
    const KeyedOf place{KeyedValue::position, "emitter-1"};
    Look look;
    setValueKey(look, place, 1, pivots);
    setValueKey(look, ofTurn, 1, pivots);
    for (int step = 2; step < 30; ++step) {
        Look after = look;
        const Mat4 now = after.emitters.empty() ? Mat4(1) : after.emitters[0].matrix;
        const Vec3 stands(now * Vec4(pivots.emitter(""), 1));
        const Mat3 change = step % 2 ? rotationOf({3, 7, 11}) : 1.07f * Mat3(1);
        Mat4 about(change);
        about[3] = Vec4(stands - change * stands, 1);
        moveEmitter(after, "emitter-1", about);
        keyEdit(look, after, step, pivots);
        look = after;
    }
    EXPECT_EQ(keyedFrames(look, place), std::vector<int>{1});
    EXPECT_EQ(keyedFrames(look, ofTurn).size(), 15u) << "at every turn, and at no growth";
}

TEST(ValueKeyEdits, DragsMoveSeveralKeysInTimeAndValue) {
    Look look;
    for (const int frame : {1, 5, 9}) {
        look.environment.yawDegrees = float(frame);
        setValueKey(look, ofYaw, frame, {});
        look.emitters = {{"emitter-1", true, Mat4(1), Rgb(float(frame))}};
        setValueKey(look, ofPower, frame, {});
    }
    easeValueKeys(look, {{ofYaw, 5}}, KeyEase::hold);
    const auto moved = dragValueKeys(look, {{ofYaw, 1}, {ofYaw, 5}, {ofPower, 9}, {ofPower, 77}}, {4, 1, 0});
    EXPECT_EQ(moved, (std::vector<KeyPick>{{ofYaw, 5}, {ofYaw, 9}, {ofPower, 13}}));
    EXPECT_EQ(keyedFrames(look, ofYaw), (std::vector<int>{5, 9})) << "the one it lands on gives way";
    EXPECT_EQ(curveOf(look, ofYaw)->keys[0].value.x, 2);
    EXPECT_EQ(curveOf(look, ofYaw)->keys[1].value.x, 6);
    EXPECT_EQ(curveOf(look, ofYaw)->keys[1].ease, KeyEase::hold);
    EXPECT_EQ(curveOf(look, ofPower)->keys[2].value, Vec3(18)) << "a stop up in every channel";
    dragValueKeys(look, {{ofYaw, 5}}, {-100, 0, 0});
    EXPECT_EQ(keyedFrames(look, ofYaw), (std::vector<int>{0, 9}));
    deleteValueKeys(look, {{ofYaw, 0}, {ofYaw, 9}});
    EXPECT_EQ(curveOf(look, ofYaw), nullptr);
    putOnCurve(look, ofPower, 3);
    EXPECT_EQ(keyedFrames(look, ofPower), (std::vector<int>{1, 3, 5, 13}));
    EXPECT_NEAR(curveOf(look, ofPower)->keys[1].value.x, std::sqrt(5.0f), 1e-5);
}

TEST(ValueKeyEdits, KeysGoWithTheirLightAndFollowTheirGroup) {
    Look look;
    AddedEmitter disk;
    disk.shape = EmitterShape::disk;
    disk.id = "disk-1";
    look.added.push_back(disk);
    look.groups.push_back({"Desk", {"emitter-1"}});
    const KeyedOf group{KeyedValue::groupPower, "Desk"}, place{KeyedValue::position, "disk-1"};
    setValueKey(look, group, 1, {});
    setValueKey(look, place, 1, {});
    setValueKey(look, {KeyedValue::size, "emitter-1"}, 1, {});
    EXPECT_EQ(look.curves.size(), 2u) << "a recovered light has no size of its own";
    look = editedAt(look, 1, [](Look& l) { renameGroup(l, "Desk", "Table"); });
    EXPECT_NE(curveOf(look, {KeyedValue::groupPower, "Table"}), nullptr);
    look = editedAt(look, 1, [](Look& l) { removeEmitter(l, "disk-1"); });
    EXPECT_EQ(curveOf(look, place), nullptr);
    look = editedAt(look, 1, [](Look& l) { dissolveGroup(l, "Table"); });
    EXPECT_TRUE(look.curves.empty());
}

TEST(ValueKeyEdits, ACopyOfALightGoesThroughTheSame) {
    Mesh mesh = test::sheet({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, 4, 4);
    const auto square = test::append(mesh, test::squareAbove(0.2f, 0, 0, 1, 2));
    const Scene scene = test::sceneOf(mesh);
    const Estimate estimate =
        test::matteEstimate(scene, Rgb(0.5f), Rgb(0), test::emittersOf(scene, {square}, {Rgb(4, 2, 1)}));
    const Vec3 aside(0.5f, 0, 0);
    Look look;
    setValueKey(look, ofPower, 1, {});
    setValueKey(look, {KeyedValue::position, "emitter-1"}, 1, {});
    look = editedAt(look, 9, [&](Look& l) {
        setRadiance(l, estimate, "emitter-1", Rgb(16, 8, 4));
        moveEmitter(l, "emitter-1", test::translation({0, 0, 2}));
    });
    setKey(look, 1);
    const std::vector<ValueCurve> own = look.curves;
    std::string copy, second;
    look = editedAt(look, 5, [&](Look& l) { copy = duplicateEmitter(l, estimate, "emitter-1", aside); });
    look = editedAt(look, 5, [&](Look& l) { second = duplicateEmitter(l, estimate, copy, aside); });
    ASSERT_EQ(look.curves.size(), 6u);
    EXPECT_TRUE(std::equal(own.begin(), own.end(), look.curves.begin())) << "the light itself keeps its keys";
    ASSERT_EQ(look.keys.size(), 2u) << "the edit is in the key of its frame";
    EXPECT_EQ(look.keys[0].look.added.size(), 2u) << "and the copies are there in every frame";
    const LookTrack track(look);
    for (const int frame : {1, 5, 9}) {
        const Look at = track.at(frame, {});
        ASSERT_EQ(at.added.size(), 2u) << frame;
        for (int i = 0; i < 2; ++i) {
            const AddedEmitter& light = at.added[size_t(i)];
            EXPECT_LT(glm::distance(light.radiance, *radianceOf(at, estimate, "emitter-1")), 1e-3f) << frame;
            EXPECT_LT(glm::distance(Vec3(light.matrix[3]), float(i + 1) * aside + Vec3(0, 0, 0.25f * float(frame - 1))),
                      1e-4f)
                << frame;
        }
    }
    look = editedAt(look, 5, [&](Look& l) { removeEmitter(l, second); });
    EXPECT_EQ(look.curves.size(), 4u);
}

}  // namespace
}  // namespace relamp
