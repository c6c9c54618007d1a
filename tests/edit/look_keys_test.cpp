#include "edit/look_keys.h"

#include <gtest/gtest.h>

namespace relamp {
namespace {

Look turned(float degrees) {
    Look look;
    look.environment.yawDegrees = degrees;
    return look;
}

std::vector<int> framesOf(const Look& look) {
    std::vector<int> frames;
    for (const LookKey& key : look.keys) frames.push_back(key.frame);
    return frames;
}

TEST(LookKeys, StandInOrderWithTheLookOfTheirFrame) {
    Look look = turned(10);
    setKey(look, 20);
    look.environment.yawDegrees = 5;
    setKey(look, 1);
    look.environment.yawDegrees = 7;
    setKey(look, 20);
    EXPECT_EQ(framesOf(look), (std::vector<int>{1, 20}));
    EXPECT_EQ(look.keys[1].look, turned(7));
    EXPECT_EQ(keyAt(look, 20), 1);
    EXPECT_EQ(keyAt(look, 2), -1);
}

TEST(LookKeys, MoveOverOthersAndKeepTheirEase) {
    Look look;
    for (int frame : {1, 10, 20}) {
        look.environment.yawDegrees = float(frame);
        setKey(look, frame);
    }
    easeKey(look, 1, KeyEase::hold);
    moveKey(look, 1, 10);
    EXPECT_EQ(framesOf(look), (std::vector<int>{10, 20}));
    EXPECT_EQ(look.keys[0].look.environment.yawDegrees, 1);
    EXPECT_EQ(look.keys[0].ease, KeyEase::hold);
    moveKey(look, 5, 6);
    deleteKey(look, 99);
    EXPECT_EQ(framesOf(look), (std::vector<int>{10, 20}));
    deleteKey(look, 10);
    EXPECT_EQ(framesOf(look), (std::vector<int>{20}));
}

TEST(LookKeys, ANewKeyBetweenTwoGoesOnAsBefore) {
    Look look;
    setKey(look, 1);
    setKey(look, 9);
    easeKey(look, 1, KeyEase::smooth);
    setKey(look, 5);
    EXPECT_EQ(look.keys[1].ease, KeyEase::smooth);
}

TEST(KeyEdit, SetsTheKeyOfItsFrameOnlyWhereThereAreKeys) {
    Look before = turned(0), after = turned(3);
    keyEdit(before, after, 4);
    EXPECT_TRUE(after.keys.empty());
    setKey(before, 1);
    after = before;
    keyEdit(before, after, 4);
    EXPECT_EQ(framesOf(after), (std::vector<int>{1})) << "nothing changed";
    after.environment.yawDegrees = 3;
    keyEdit(before, after, 4);
    EXPECT_EQ(framesOf(after), (std::vector<int>{1, 4}));
    EXPECT_EQ(after.keys[0].look.environment.yawDegrees, 0);
    EXPECT_EQ(after.keys[1].look.environment.yawDegrees, 3);
}

TEST(KeyEdit, APlateIsOfNoKey) {
    Look before = turned(0);
    setKey(before, 1);
    Look after = before;
    after.plate = PlateLook{"plate.####.exr", "track.usda"};
    keyEdit(before, after, 4);
    EXPECT_EQ(framesOf(after), (std::vector<int>{1}));
    setKey(after, 4);
    EXPECT_FALSE(after.keys[1].look.plate);
    EXPECT_TRUE(after.plate);
}

TEST(KeyEdit, LightsComeGoAndAreNamedInEveryKey) {
    Look before;
    AddedEmitter disk;
    disk.shape = EmitterShape::disk;
    disk.id = "disk-1";
    before.added.push_back(disk);
    setKey(before, 1);
    setKey(before, 9);
    Look after = before;
    after.added.clear();
    disk.id = "disk-2";
    disk.name = "Rim";
    after.added.push_back(disk);
    EmitterLook named;
    named.id = "emitter-1";
    named.name = "Key light";
    after.emitters.push_back(named);
    keyEdit(before, after, 9);
    for (const LookKey& key : after.keys) {
        ASSERT_EQ(key.look.added.size(), 1u);
        EXPECT_EQ(key.look.added[0].id, "disk-2");
        ASSERT_EQ(key.look.emitters.size(), 1u);
        EXPECT_EQ(key.look.emitters[0].name, "Key light");
    }
}

}  // namespace
}  // namespace relamp
