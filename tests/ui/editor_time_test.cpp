// Keys, frames and playing in the editor without a window.
#include <gtest/gtest.h>

#include "actions.h"
#include "edit/look_keys.h"
#include "relight/look_track.h"
#include "shot/shot_file.h"
#include "ui/editor_session.h"

namespace relamp::ui {
namespace {

struct KeyedSession : Session {
    KeyedSession() {
        openEstimated();
        editor->setEye(eyeAt(40, 30), false);
        settle();
    }
    void setYaw(float degrees) {
        editor->edit("Turn the environment", [&](Look& look) { look.environment.yawDegrees = degrees; });
    }
    float yaw() const { return editor->look().environment.yawDegrees; }
};

TEST(EditorTime, EditsSetTheKeyOfTheirFrameAndUndoBringsItBack) {
    KeyedSession s;
    Editor& e = *s.editor;
    e.goToFrame(10);
    s.setYaw(5);
    EXPECT_TRUE(e.look().keys.empty()) << "without keys an edit is an edit";
    EXPECT_TRUE(runAction(e, "time.setKey"));
    e.goToFrame(20);
    EXPECT_EQ(s.yaw(), 5);
    s.setYaw(45);
    ASSERT_EQ(e.look().keys.size(), 2u);
    e.goToFrame(15);
    EXPECT_NEAR(s.yaw(), 25, 1e-4);
    const size_t entries = e.history().entries().size();
    e.goToFrame(12);
    EXPECT_EQ(e.history().entries().size(), entries) << "going to a frame is no edit";
    EXPECT_NEAR(s.yaw(), 13, 1e-4);
    // A drag starts from what the frame shows; given up, it leaves no key.
    e.beginGesture("Turn");
    e.preview([](Look& look) { look.environment.yawDegrees += 100; });
    EXPECT_NEAR(s.yaw(), 113, 1e-4);
    e.abandonGesture();
    EXPECT_NEAR(s.yaw(), 13, 1e-4);
    e.beginGesture("Turn");
    e.commitGesture();
    EXPECT_EQ(e.history().entries().size(), entries);
    e.beginGesture("Turn");
    e.preview([](Look& look) { look.environment.yawDegrees += 100; });
    e.commitGesture();
    EXPECT_EQ(e.look().keys.size(), 3u);
    EXPECT_NEAR(s.yaw(), 113, 1e-4);
    e.undo();
    EXPECT_EQ(e.look().keys.size(), 2u);
    EXPECT_NEAR(s.yaw(), 13, 1e-4);
    e.goToKey(1);
    EXPECT_EQ(e.state.time.frame, 20);
    e.goToKey(-1);
    EXPECT_EQ(e.state.time.frame, 10);
    e.easeKey(10, KeyEase::hold);
    e.moveKey(20, 30);
    e.goToFrame(29);
    EXPECT_EQ(s.yaw(), 5);
    // A snapshot comes back with its keys and adds none.
    const std::vector<LookKey> keys = e.look().keys;
    e.storeSnapshot(0);
    e.deleteKey(10);
    e.recallSnapshot(0);
    EXPECT_EQ(e.look().keys, keys);
    e.deleteKey(10);
    e.goToFrame(1);
    EXPECT_EQ(s.yaw(), 45);
}

TEST(EditorTime, AShotKeepsItsKeysAndTheCommandLineReadsThem) {
    KeyedSession s;
    Editor& e = *s.editor;
    s.setYaw(10);
    e.setKey();
    e.goToFrame(24);
    s.setYaw(34);
    const auto folder = s.folder / "keyed.relamp";
    e.saveAs(folder);
    s.settle();
    Progress progress;
    const Shot shot = openShot(folder, false, progress);
    EXPECT_EQ(shot.look.keys, e.look().keys);
    EXPECT_NEAR(LookTrack(shot.look).at(13, {}).environment.yawDegrees, 22.5, 0.6);
    s.open(folder);
    EXPECT_EQ(e.look().keys.size(), 2u);
    EXPECT_EQ(e.state.time.frame, 1);
    e.goToFrame(24);
    EXPECT_EQ(s.yaw(), 34);
    EXPECT_FALSE(e.unsavedChanges());
}

TEST(EditorTime, PlayingShowsEveryFrameAndKeepsThem) {
    KeyedSession s;
    Editor& e = *s.editor;
    e.state.time.last = 4;
    e.state.time.loop = false;
    e.state.time.framesPerSecond = 120;
    e.setKey();
    e.goToFrame(4);
    e.edit("Off", [](Look& look) { setEnabled(look, "emitter-1", false); });
    e.goToFrame(4);
    EXPECT_TRUE(runAction(e, "time.play"));
    EXPECT_EQ(e.state.time.frame, 1) << "from the end it begins again";
    std::vector<double> brightness(5, 0);
    const auto watch = [&] {
        s.until([&] {
            if (const auto frame = e.liveFrame(); frame && e.frameKept(e.state.time.frame)) {
                double sum = 0;
                for (const Rgb& c : frame->radiance) sum += luminance(c);
                brightness[size_t(e.state.time.frame)] = sum;
            }
            return !e.state.time.playing;
        });
    };
    watch();
    for (int f = 1; f <= 4; ++f) EXPECT_TRUE(e.frameKept(f)) << f;
    for (int f = 2; f <= 4; ++f) EXPECT_LT(brightness[size_t(f)], brightness[size_t(f) - 1]) << f;
    // An edit makes them stale; a drag ends playing.
    e.play(true);
    e.beginGesture("Turn");
    e.poll();
    EXPECT_FALSE(e.state.time.playing);
    e.preview([](Look& look) { look.environment.yawDegrees = 1; });
    e.commitGesture();
    EXPECT_FALSE(e.frameKept(1));
}

TEST(EditorTime, ExportsTheFramesOfTheTimeLine) {
    KeyedSession s;
    Editor& e = *s.editor;
    e.setKey();
    e.goToFrame(3);
    e.edit("Off", [](Look& look) { setEnabled(look, "emitter-1", false); });
    ExportRequest request;
    request.views = ExportRequest::Views::timeline;
    request.range = "1-3:2";
    request.samples = 1;
    request.layers = "";
    request.file = s.folder / "f.##.exr";
    e.exportFrames(request);
    s.until([&] { return !e.job(); });
    EXPECT_TRUE(e.state.notices.empty());
    const Image first = readImage(s.folder / "f.01.exr"), last = readImage(s.folder / "f.03.exr");
    double before = 0, after = 0;
    for (const Rgb& c : first.pixels) before += luminance(c);
    for (const Rgb& c : last.pixels) after += luminance(c);
    EXPECT_LT(after, before);
}

}  // namespace
}  // namespace relamp::ui
