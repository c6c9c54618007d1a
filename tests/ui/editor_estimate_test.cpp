// Estimates in the editor: stopped, killed and continued, their settings and the time they have left.
#include "editor.h"

#include <gtest/gtest.h>

#include "ui/editor_session.h"

namespace relamp::ui {
namespace {

TEST(Editor, aCancelledSolveKeepsTheBestSoFar) {
    Session s;
    s.open(captureFolder());
    s.editor->solve(s.editor->state.solve);
    s.until([&] { return s.editor->estimate() || !s.editor->job(); });
    ASSERT_TRUE(s.editor->job());
    s.editor->cancelJob();
    EXPECT_TRUE(s.editor->job()->stopping);
    s.until([&] { return !s.editor->job(); });
    ASSERT_TRUE(s.editor->history().present().estimate);
    EXPECT_TRUE(s.editor->estimate()->cancelled);
    EXPECT_EQ(s.editor->history().entries().back().label, "Estimate, stopped early");
    // And one that is stopped before there is anything leaves everything as it was.
    Session early;
    early.open(captureFolder());
    early.editor->solve(early.editor->state.solve);
    early.editor->cancelJob();
    early.until([&] { return !early.editor->job(); });
    EXPECT_FALSE(early.editor->estimate());
    EXPECT_EQ(early.editor->history().entries().size(), 1u);
    EXPECT_TRUE(early.editor->state.notices.empty());
}

bool hasFiles(const std::filesystem::path& folder) {
    std::error_code none;
    return std::filesystem::directory_iterator(folder, none) != std::filesystem::directory_iterator();
}

/// Estimates until something is shown and a checkpoint is there.
void solveUntilKept(Session& s) {
    s.editor->solve(s.editor->state.solve);
    s.until([&] {
        std::error_code none;
        for (const auto& entry : std::filesystem::directory_iterator(s.folder / "state/estimates", none))
            if (entry.path().extension() == ".checkpoint" && s.editor->estimate()) return true;
        return !s.editor->job();
    });
    ASSERT_TRUE(s.editor->job()) << "it ended before it could be stopped";
}

/// What an estimate is saved as by itself when it is killed: copied while it runs, once it has got anywhere.
void copyOfAKilledEstimate(Session& s, const std::filesystem::path& to) {
    const std::filesystem::path kept = s.folder / "state/estimates";
    solveUntilKept(s);
    std::filesystem::create_directories(to);
    for (const auto& entry : std::filesystem::directory_iterator(kept))
        if (!entry.path().filename().string().starts_with(".")) std::filesystem::copy(entry.path(), to);
}

void expectSameAnswer(const Estimate& a, const Estimate& b) {
    EXPECT_EQ(a.environment, b.environment);
    EXPECT_EQ(a.lighting.emitterRadiance, b.lighting.emitterRadiance);
    EXPECT_EQ(a.reflectance.weight, b.reflectance.weight);
}

TEST(Editor, aKilledEstimateIsOfferedAndEndsInTheSameAnswer) {
    Session whole;
    TemporaryFolder killed;
    whole.open(captureFolder());
    whole.editor->state.solve.seed = 7;
    copyOfAKilledEstimate(whole, killed / "estimates");
    whole.until([&] { return !whole.editor->job(); });
    ASSERT_TRUE(whole.editor->history().present().estimate);
    EXPECT_FALSE(whole.editor->state.interrupted) << "it came to its end";
    EXPECT_FALSE(hasFiles(whole.folder / "state/estimates"));

    // The program starts again: the offer opens the capture, and the settings are those of the estimate.
    Session next(killed / "estimates");
    ASSERT_TRUE(next.editor->state.interrupted);
    EXPECT_EQ(next.editor->state.interrupted->captureFolder, captureFolder());
    next.editor->answerInterrupted(true);
    next.until([&] { return next.editor->history().present().estimate || !next.editor->state.notices.empty(); });
    ASSERT_TRUE(next.editor->history().present().estimate);
    EXPECT_EQ(next.editor->state.solve.seed, 7u);
    EXPECT_EQ(next.editor->state.document.seed, 7u);
    expectSameAnswer(*next.editor->estimate(), *whole.editor->estimate());
    EXPECT_GT(next.editor->state.curves[0].entries.size(), 3u);
    EXPECT_FALSE(hasFiles(next.folder / "state/estimates"));

    // So does the capture when it is opened by hand.
    Session byHand(killed / "estimates");
    byHand.open(captureFolder());
    ASSERT_TRUE(byHand.editor->state.interrupted);
    EXPECT_GT(byHand.editor->state.interrupted->seconds, 0);
    byHand.editor->answerInterrupted(true);
    byHand.until([&] { return !byHand.editor->job(); });
    ASSERT_TRUE(byHand.editor->history().present().estimate);
    expectSameAnswer(*byHand.editor->estimate(), *whole.editor->estimate());
}

TEST(Editor, aStoppedEstimateCanGoOn) {
    Session s;
    s.open(captureFolder());
    solveUntilKept(s);
    s.editor->cancelJob();
    s.until([&] { return !s.editor->job(); });
    ASSERT_TRUE(s.editor->state.interrupted);
    EXPECT_TRUE(s.editor->estimate()->cancelled);
    s.editor->answerInterrupted(true);
    EXPECT_FALSE(s.editor->state.interrupted) << "nothing is offered while it runs";
    s.until([&] { return !s.editor->job(); });
    EXPECT_FALSE(s.editor->estimate()->cancelled);
    EXPECT_FALSE(s.editor->state.interrupted);
}

TEST(Editor, anInterruptedEstimateIsRefusedForOtherInputsAndCanBeThrownAway) {
    TemporaryFolder killed;
    {
        Session s;
        s.open(captureFolder());
        copyOfAKilledEstimate(s, killed / "estimates");
    }
    // Another capture behind the same name: the record is there, its checkpoint does not fit.
    Session changed(killed / "estimates");
    for (const auto& entry : std::filesystem::directory_iterator(changed.folder / "state/estimates")) {
        if (!entry.path().string().ends_with(".json")) continue;
        std::string text = TemporaryFolder::read(entry.path());
        const size_t at = text.find("\"seed\": 1");
        ASSERT_NE(at, std::string::npos);
        changed.folder.write("state/estimates/" + entry.path().filename().string(), text.replace(at, 9, "\"seed\": 2"));
    }
    changed.open(captureFolder());
    EXPECT_FALSE(changed.editor->state.interrupted);

    Session damaged(killed / "estimates");
    for (const auto& entry : std::filesystem::directory_iterator(damaged.folder / "state/estimates"))
        damaged.folder.write("state/estimates/" + entry.path().filename().string(), "{");
    damaged.open(captureFolder());
    EXPECT_FALSE(damaged.editor->state.interrupted);

    Session thrownAway(killed / "estimates");
    thrownAway.open(captureFolder());
    ASSERT_TRUE(thrownAway.editor->state.interrupted);
    thrownAway.editor->answerInterrupted(false);
    EXPECT_FALSE(thrownAway.editor->state.interrupted);
    EXPECT_FALSE(hasFiles(thrownAway.folder / "state/estimates"));
}

TEST(Editor, timeLeftComesFromThePlan) {
    Session s;
    s.open(captureFolder());
    s.editor->solve(s.editor->state.solve);
    bool told = false;
    s.until([&] {
        const auto& job = s.editor->job();
        if (job && !s.editor->state.plan.stages.empty() && job->secondsLeft) {
            told = true;
            EXPECT_LE(*job->secondsLeft, 4 * s.editor->state.plan.predictedSeconds() + 0.1);
        }
        return !job;
    });
    EXPECT_TRUE(told);
}

TEST(Editor, advancedSettingsOfTheEstimateTakePartAndAreRemembered) {
    Session s;
    s.editor->state.solve.basis = "lambert";
    s.editor->state.solve.bounce = SolveOptions::Bounce::off;
    s.editor->state.solve.meshTriangles = 500;
    s.editor->state.solve.texture = 0;
    s.open(captureFolder());
    s.solve();
    ASSERT_TRUE(s.editor->estimate());
    const Estimate& e = *s.editor->estimate();
    EXPECT_EQ(e.reflectance.basis.lobes.size(), 1u);
    EXPECT_EQ(e.reflectance.weight[0].size(), s.editor->state.document.scene->mesh.vertexCount());
    const auto leftOut = [&](Omission what) {
        return std::any_of(e.leftOut.begin(), e.leftOut.end(), [&](const LeftOut& l) { return l.what == what; });
    };
    EXPECT_TRUE(leftOut(Omission::triangles));
    EXPECT_FALSE(e.reflectance.texture);
    EXPECT_TRUE(leftOut(Omission::interreflection));
    EXPECT_FALSE(s.editor->stale());
    s.editor->state.solve.meshTriangles.reset();
    EXPECT_TRUE(s.editor->stale());
    s.editor->state.solve.texture = 2048;
    s.editor->state.solve.merl = "/nowhere";
    s.solve();
    ASSERT_EQ(s.editor->state.notices.size(), 1u);
    EXPECT_NE(s.editor->state.notices[0].text.find("/nowhere"), std::string::npos);
    s.editor.reset();
    s.start();
    EXPECT_EQ(s.editor->state.solve.basis, "lambert");
    EXPECT_EQ(s.editor->state.solve.bounce, SolveOptions::Bounce::off);
    EXPECT_EQ(s.editor->state.solve.merl, "/nowhere");
    EXPECT_FALSE(s.editor->state.solve.meshTriangles);
    EXPECT_EQ(s.editor->state.solve.texture, 2048);
}

TEST(Editor, aSearchForAnUnobservedEmitterCanBeStoppedAndAnEmitterTakenAwayAgain) {
    Session s;
    s.open(captureFolder());
    const size_t vertices = s.editor->state.document.scene->mesh.vertexCount();
    s.editor->findUnobservedLight();
    ASSERT_TRUE(s.editor->job());
    EXPECT_EQ(s.editor->job()->kind, JobStatus::Kind::search);
    s.editor->cancelJob();
    s.until([&] { return !s.editor->job(); });
    EXPECT_TRUE(s.editor->state.notices.empty());
    EXPECT_TRUE(s.editor->state.unobservedSearch.words.empty());
    EXPECT_EQ(s.editor->state.document.scene->mesh.vertexCount(), vertices);
    CaptureFix fix = s.editor->state.document.fix;
    fix.proxies.push_back({{0.4f, 0.2f, 1.1f}, 0.02f, Vec3(0), false});
    s.editor->fixCapture(fix);
    s.until([&] { return !s.editor->job(); });
    EXPECT_EQ(s.editor->state.document.scene->mesh.vertexCount(), vertices + proxyVertices);
    EXPECT_FALSE(s.editor->unsavedChanges()) << "nothing was estimated that could be lost";
    s.editor->removeProxy(1);
    EXPECT_FALSE(s.editor->job());
    s.editor->removeProxy(0);
    EXPECT_FALSE(s.editor->job()) << "the capture without it is still there";
    EXPECT_EQ(s.editor->state.document.scene->mesh.vertexCount(), vertices);
    EXPECT_TRUE(s.editor->state.document.fix.proxies.empty());
}

TEST(Editor, aCaptureThatIsReadOtherwiseIsOneEntryWithItsEstimate) {
    Session s(0);
    s.openEstimated();
    Editor& editor = *s.editor;
    const size_t vertices = editor.state.document.scene->mesh.vertexCount();
    editor.edit("turn", [](Look& look) { look.environment.yawDegrees = 30; });
    const auto before = editor.history().present();
    const std::filesystem::path shot = editor.state.document.shotFolder;
    ASSERT_FALSE(shot.empty());
    CaptureFix fix = editor.state.document.fix;
    fix.proxies.push_back({{0.4f, 0.2f, 1.1f}, 0.02f, Vec3(0), true});
    editor.fixCapture(fix, "Find off-camera light");
    s.until([&] { return !editor.job(); });
    EXPECT_EQ(editor.history().entries().back().label, "Find off-camera light");
    EXPECT_FALSE(editor.estimate());
    EXPECT_EQ(editor.state.viewport.mode, ViewMode::photograph);
    EXPECT_EQ(editor.state.document.shotFolder, shot) << "saving goes where it went";
    EXPECT_TRUE(editor.unsavedChanges());
    // While a job works on these inputs there is no way to others.
    editor.solve(editor.state.solve);
    editor.undo();
    ASSERT_EQ(editor.state.notices.size(), 1u);
    editor.state.notices.clear();
    EXPECT_EQ(editor.state.document.scene->mesh.vertexCount(), vertices + proxyVertices);
    s.until([&] { return !editor.job(); });
    const auto with = editor.estimate();
    ASSERT_TRUE(with);
    EXPECT_EQ(editor.history().entries().size(), 4u);
    editor.undo();
    editor.undo();
    EXPECT_EQ(editor.estimate(), before.estimate);
    EXPECT_EQ(editor.look(), before.look);
    EXPECT_EQ(editor.state.document.scene->mesh.vertexCount(), vertices);
    EXPECT_TRUE(editor.state.document.fix.proxies.empty());
    EXPECT_EQ(editor.state.viewport.mode, ViewMode::relit);
    editor.setEye(eyeAt(64, 48), false);
    s.until([&] { return editor.liveFrame() && editor.liveFrame()->mesh->vertexCount() == vertices; });
    editor.goTo(3);
    EXPECT_EQ(editor.estimate(), with);
    EXPECT_EQ(editor.state.document.fix.proxies.size(), 1u);
    s.until([&] { return editor.liveFrame() && editor.liveFrame()->mesh->vertexCount() == vertices + proxyVertices; });
    // What is saved then can be opened: the light is in the mesh.
    editor.saveAs(s.folder / "with.relamp");
    s.until([&] { return !editor.unsavedChanges(); });
    s.open(s.folder / "with.relamp");
    EXPECT_EQ(editor.state.document.scene->mesh.vertexCount(), vertices + proxyVertices);
    EXPECT_EQ(editor.state.document.fix.proxies.size(), 1u);
}

}  // namespace
}  // namespace relamp::ui
