#include "edit/history.h"

#include <gtest/gtest.h>

namespace relamp {
namespace {

Look yaw(float degrees) {
    Look look;
    look.environment.yawDegrees = degrees;
    return look;
}
float yawOf(const History& history) { return history.present().look.environment.yawDegrees; }

TEST(History, undoAndRedoWalkThroughTheEntries) {
    History history;
    history.pushLook("one", yaw(1));
    history.pushLook("two", yaw(2));
    EXPECT_EQ(yawOf(history), 2);
    history.undo();
    EXPECT_EQ(yawOf(history), 1);
    history.undo();
    EXPECT_EQ(yawOf(history), 0);
    EXPECT_FALSE(history.canUndo());
    history.undo();
    EXPECT_EQ(yawOf(history), 0);
    history.redo();
    history.redo();
    EXPECT_EQ(yawOf(history), 2);
    EXPECT_FALSE(history.canRedo());
}

TEST(History, anEditAfterAnUndoDropsWhatWasUndone) {
    History history;
    history.pushLook("one", yaw(1));
    history.pushLook("two", yaw(2));
    history.undo();
    history.pushLook("three", yaw(3));
    ASSERT_EQ(history.entries().size(), 3u);
    EXPECT_EQ(history.entries()[2].label, "three");
    EXPECT_FALSE(history.canRedo());
}

TEST(History, anEditThatChangesNothingMakesNoEntry) {
    History history;
    history.pushLook("same", yaw(0));
    EXPECT_EQ(history.entries().size(), 1u);
}

TEST(History, aGestureIsOneEntryHoweverManyPreviewsItHas) {
    History history;
    history.begin("turn");
    for (int i = 1; i <= 50; ++i) history.preview(yaw(float(i)));
    EXPECT_EQ(yawOf(history), 50);
    EXPECT_EQ(history.gestureStart().environment.yawDegrees, 0);
    EXPECT_EQ(history.entries().size(), 1u);
    history.commit();
    EXPECT_EQ(history.entries().size(), 2u);
    EXPECT_EQ(yawOf(history), 50);
    history.undo();
    EXPECT_EQ(yawOf(history), 0);
}

TEST(History, anAbandonedGestureLeavesNothing) {
    History history;
    history.begin("turn");
    history.preview(yaw(9));
    const uint64_t during = history.revision();
    history.abandon();
    EXPECT_GT(history.revision(), during);
    EXPECT_EQ(yawOf(history), 0);
    EXPECT_EQ(history.entries().size(), 1u);
    history.preview(yaw(5));  // outside a gesture nothing happens
    EXPECT_EQ(yawOf(history), 0);
}

TEST(History, undoDuringAGestureTakesTheGestureBackOnly) {
    History history;
    history.pushLook("one", yaw(1));
    history.begin("turn");
    history.preview(yaw(7));
    history.undo();
    EXPECT_EQ(yawOf(history), 1);
    EXPECT_FALSE(history.inGesture());
}

TEST(History, knowsWhatWasSavedThroughUndoAndRedo) {
    History history;
    EXPECT_FALSE(history.unsavedChanges());
    history.pushLook("one", yaw(1));
    EXPECT_TRUE(history.unsavedChanges());
    history.markSaved();
    EXPECT_FALSE(history.unsavedChanges());
    history.undo();
    EXPECT_TRUE(history.unsavedChanges());
    history.pushLook("other", yaw(2));  // the saved entry is gone for good
    EXPECT_TRUE(history.unsavedChanges());
    history.undo();
    EXPECT_TRUE(history.unsavedChanges());
}

TEST(History, keepsAtMostItsCapacityAndDropsTheOldest) {
    History history({}, "start", 5);
    for (int i = 1; i <= 20; ++i) history.pushLook(std::to_string(i), yaw(float(i)));
    ASSERT_EQ(history.entries().size(), 5u);
    EXPECT_EQ(history.entries().front().label, "16");
    EXPECT_EQ(yawOf(history), 20);
}

TEST(History, aFinishedSolveIsAnEntryThatUndoTakesBack) {
    History history;
    Version version;
    version.estimate = std::make_shared<const Estimate>();
    history.push("Estimate", version);
    EXPECT_TRUE(history.present().estimate);
    history.undo();
    EXPECT_FALSE(history.present().estimate);
}

TEST(History, InputsComeBackWithTheirEntryAndLeadBackOverTwoOthersAtMost) {
    const auto inputs = [](int n) { return std::make_shared<const int>(n); };
    const auto now = [](const History& h) { return *static_cast<const int*>(h.present().inputs.get()); };
    Version start;
    start.inputs = inputs(0);
    History history(start);
    const auto push = [&](int n) {
        Version version;
        version.inputs = inputs(n);
        history.push("read", version);
    };
    push(1);
    EXPECT_EQ(history.entries().size(), 2u) << "other inputs alone are an entry";
    history.pushLook("edit", yaw(2));
    EXPECT_EQ(now(history), 1) << "an edit is made on the present inputs";
    history.undo();
    history.undo();
    EXPECT_EQ(now(history), 0);
    history.redo();
    history.redo();
    EXPECT_EQ(now(history), 1);
    push(2);
    EXPECT_EQ(history.entries().size(), 4u);
    push(3);
    ASSERT_EQ(history.entries().size(), 4u) << "the entry on inputs 0 has gone";
    EXPECT_EQ(history.index(), 3u);
    for (int i = 0; i < 3; ++i) history.undo();
    EXPECT_EQ(now(history), 1);
    EXPECT_FALSE(history.canUndo());
}

}  // namespace
}  // namespace relamp
