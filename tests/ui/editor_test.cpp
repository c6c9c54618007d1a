// The editor without a window: what opens, shows, follows edits and is exported.
#include "editor.h"

#include <gtest/gtest.h>

#include "actions.h"
#include "image/image_io.h"
#include "ui/editor_session.h"
#include "viewport/display_transform.h"

namespace relamp::ui {
namespace {

TEST(Editor, opensEstimatesAndShowsTheScene) {
    Session s;
    s.open(captureFolder());
    ASSERT_TRUE(s.editor->state.document.capture);
    EXPECT_TRUE(s.editor->state.notices.empty()) << s.editor->state.notices[0].text;
    EXPECT_EQ(s.editor->state.document.name(), "room");
    EXPECT_FALSE(s.editor->estimate());
    s.editor->setEye(eyeAt(80, 60), false);
    bool shownEarly = false;
    s.editor->solve(s.editor->state.solve);
    s.until([&] {
        // Intermediate results before the end, without an entry in the history.
        shownEarly = shownEarly || (s.editor->job() && s.editor->estimate() && !s.editor->history().present().estimate);
        return !s.editor->job();
    });
    EXPECT_TRUE(shownEarly);
    ASSERT_TRUE(s.editor->estimate());
    EXPECT_EQ(s.editor->emitters().size(), 1u);
    EXPECT_EQ(s.editor->history().entries().size(), 2u);
    EXPECT_GT(s.editor->state.curves[0].entries.size(), 3u);
    EXPECT_FALSE(s.editor->state.curves[0].running);
    EXPECT_FALSE(s.editor->stale());
    s.editor->state.solve.quality = "fine";
    EXPECT_TRUE(s.editor->stale());
    s.settle();
    ASSERT_TRUE(s.editor->liveFrame());
    EXPECT_TRUE(s.editor->liveFrame()->refined);
    ASSERT_TRUE(s.editor->restFrame());
    EXPECT_EQ(s.editor->restFrame()->width, 80);
    s.editor->undo();
    EXPECT_FALSE(s.editor->estimate());
}

TEST(Editor, theViewportFollowsEditsAndSolo) {
    Session s;
    s.openEstimated();
    s.editor->setEye(eyeAt(40, 30), false);
    s.settle();
    const auto brightness = [&] {
        double sum = 0;
        for (const Rgb& c : s.editor->liveFrame()->radiance) sum += luminance(c);
        return sum;
    };
    const double before = brightness();
    s.editor->state.selection.emitters = {"emitter-1"};
    EXPECT_TRUE(runAction(*s.editor, "light.mute"));
    s.editor->poll();
    s.settle();
    const double off = brightness();
    EXPECT_LT(off, 0.9 * before);
    s.editor->undo();
    s.editor->poll();
    s.settle();
    EXPECT_NEAR(brightness(), before, 1e-3 * before);
    // Where a point's light comes from.
    PickedPoint point;
    point.triangle = 0;
    point.barycentric = Vec2(0.3f);
    s.editor->pick(point);
    s.until([&] { return s.editor->state.pointLight.has_value(); });
    EXPECT_EQ(s.editor->state.pointLight->fromEmitter.size(), 1u);
    EXPECT_GT(
        luminance(s.editor->state.pointLight->fromEmitter[0]) + luminance(s.editor->state.pointLight->fromEnvironment),
        0);
}

TEST(Editor, exportsWhatTheCommandLineWouldRender) {
    Session s;
    s.openEstimated();
    s.editor->edit("Move", [](Look& look) { moveEmitter(look, "emitter-1", test::translation({0.2f, 0, 0})); });
    ExportRequest request;
    request.views = ExportRequest::Views::capture;
    request.file = s.folder / "frame.exr";
    s.editor->exportFrames(request);
    s.until([&] { return !s.editor->job(); });
    ASSERT_TRUE(s.editor->state.notices.empty()) << s.editor->state.notices[0].text;
    Progress progress;
    const RelitScene relit =
        applyLook(*s.editor->state.document.scene, *s.editor->estimate(), s.editor->look(), progress);
    FrameOptions options;
    options.denoise = true;
    const Frame frame = renderFrame(relit, s.editor->state.document.capture->views[0].camera, options, progress);
    const Image written = readImage(s.folder / "frame.exr");
    ASSERT_EQ(written.pixels.size(), frame.beauty.size());
    for (size_t i = 0; i < frame.beauty.size(); i += 17)
        EXPECT_NEAR(written.pixels[i].x, frame.beauty[i].x, 2e-3f * frame.beauty[i].x + 1e-6f);
    // PNG as the viewport shows it, unless something else is asked for.
    s.editor->state.viewport.exposureStops = -1;
    s.editor->state.viewport.displayView = "ACES 1.0 SDR";
    const auto png = [&](std::optional<DisplayView> view) {
        request.view = view;
        request.file = s.folder / "frame.png";
        s.editor->exportFrames(request);
        s.until([&] { return !s.editor->job(); });
        return readCodes(request.file);
    };
    std::vector<Rgb> display = frame.beauty;
    displayTransform().apply("ACES 1.0 SDR", -1, display.data(), display.size());
    const CodeImage asShown = png(std::nullopt), standard = png(DisplayView::standard);
    for (size_t i = 0; i < display.size(); i += 17)
        for (int c = 0; c < 3; ++c) {
            const auto code = [&](float value) { return 65535 * std::clamp(value, 0.0f, 1.0f); };
            EXPECT_NEAR(float(asShown.codes[3 * i + size_t(c)]), code(display[i][c]), 400);
            EXPECT_NEAR(float(standard.codes[3 * i + size_t(c)]), code(srgbEncode(frame.beauty[i][c])), 400);
        }
    request.view.reset();
    // A photograph stays as it is.
    const std::filesystem::path photograph = captureFolder() / "images/00.exr";
    ASSERT_TRUE(std::filesystem::exists(photograph));
    const std::string before = TemporaryFolder::read(photograph);
    request.file = photograph;
    s.editor->exportFrames(request);
    s.until([&] { return !s.editor->job(); });
    EXPECT_FALSE(s.editor->state.notices.empty());
    EXPECT_TRUE(TemporaryFolder::read(photograph) == before);
    s.editor->state.notices.clear();
    request.file = s.folder / "frame.exr";
    // Bad names are told before anything runs.
    request.views = ExportRequest::Views::all;
    s.editor->exportFrames(request);
    EXPECT_FALSE(s.editor->job());
    EXPECT_FALSE(s.editor->state.notices.empty());
}

TEST(Editor, aGestureIsOneEntryAndActionsHaveDistinctKeys) {
    Session s;
    s.openEstimated();
    const size_t entries = s.editor->history().entries().size();
    s.editor->beginGesture("Turn the environment");
    for (int i = 0; i < 20; ++i) s.editor->preview([&](Look& look) { look.environment.yawDegrees += float(i); });
    EXPECT_EQ(s.editor->look().environment.yawDegrees, 19);
    s.editor->commitGesture();
    EXPECT_EQ(s.editor->history().entries().size(), entries + 1);
    std::vector<KeyChord> chords;
    for (const Action& a : actions()) {
        EXPECT_FALSE(a.label.empty() || a.explanation.empty()) << a.id;
        EXPECT_EQ(findAction(a.id), &a) << a.id;
        for (const KeyChord& chord : a.keys) {
            EXPECT_EQ(std::find(chords.begin(), chords.end(), chord), chords.end()) << a.id << ' ' << chord.text();
            chords.push_back(chord);
        }
    }
}

}  // namespace
}  // namespace relamp::ui
