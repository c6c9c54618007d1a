// What an artist has must survive: files that cannot be read, shots that were moved, leaving in the middle.
#include <fstream>
#include <nlohmann/json.hpp>

#include "actions.h"
#include "base/json_fields.h"
#include "image/image_io.h"
#include "panels/dialogs.h"
#include "panels/emitter_controls.h"
#include "panels/light_clipboard.h"
#include "support/measured.h"
#include "temperature_tint.h"
#include "ui/panels/panel_harness.h"

namespace relamp::ui::test {
namespace {
namespace fs = std::filesystem;

void settle(Panels& p) {
    p.editor->poll();  // what was asked for just now is under way
    p.until([&] { return !p.editor->job() && !p.editor->busy(); });
}

void writeSky(const fs::path& file) {
    Image sky(32, 16);
    std::fill(sky.pixels.begin(), sky.pixels.end(), Rgb(0.2f, 0.4f, 1));
    writeImage(file, sky);
}

/// A copy of the solved shot with its own copy of the capture beside it.
struct MovedShot {
    TemporaryFolder folder;
    fs::path shot, capture;
    MovedShot() : shot(folder / "a/room.relamp"), capture(folder / "a/room") {
        fs::create_directories(folder / "a");
        fs::copy(PaintedRoom::get().shot, shot, fs::copy_options::recursive);
        fs::copy(PaintedRoom::get().capture, capture, fs::copy_options::recursive);
        change([&](Json& document) {
            document["capture"] = "../room";
            document.erase("capture_absolute");
        });
    }
    void change(const std::function<void(Json&)>& edit) const {
        Json document = Json::parse(std::ifstream(shot / "shot.json"));
        edit(document);
        std::ofstream(shot / "shot.json") << document.dump();
    }
};

TEST(NothingLost, aForeignFileIsNoEditAndLeavesTheRedoHistory) {
    Panels p;
    p.openSolved();
    Editor& editor = *p.editor;
    editor.edit("Neutral", [](Look& look) { look.neutralMaterials = true; });
    editor.undo();
    const Look before = editor.look();
    const size_t entries = editor.history().entries().size();
    p.folder.write("cameras.json", "{}");
    p.folder.write("broken.exr", "no image");
    for (const char* name : {"cameras.json", "broken.exr", "nowhere.exr"}) {
        editor.open(p.folder / name);
        settle(p);
        EXPECT_FALSE(editor.state.notices.empty()) << name;
        editor.state.notices.clear();
        EXPECT_EQ(editor.look(), before) << name;
        EXPECT_EQ(editor.history().entries().size(), entries) << name;
        EXPECT_TRUE(editor.history().canRedo()) << name;
        EXPECT_TRUE(editor.state.recentEnvironments.empty()) << name;
    }
    writeSky(p.folder / "sky.exr");
    editor.open(p.folder / "sky.exr");
    settle(p);
    EXPECT_TRUE(editor.state.notices.empty());
    EXPECT_EQ(editor.look().environment.file, p.folder / "sky.exr");
    EXPECT_EQ(editor.state.recentEnvironments.size(), 1u);
}

TEST(NothingLost, anEditThatCannotBeShownIsUndoneFromItsMessage) {
    Panels p;
    p.openSolved();
    Editor& editor = *p.editor;
    const Look before = editor.look();
    editor.edit("Gone", [&](Look& look) {
        look.environment.source = EnvironmentLook::Source::file;
        look.environment.file = p.folder / "gone.exr";
    });
    p.until([&] { return !editor.state.notices.empty(); });
    EXPECT_TRUE(editor.state.notices.front().ofAnEdit);
    p.frame({});
    p.frames(3);
    input().control = true;
    p.key('Z');
    input().control = false;
    p.frames(2);
    EXPECT_EQ(editor.look(), before);
    EXPECT_TRUE(editor.state.notices.empty());
}

TEST(NothingLost, leavingDuringAnEstimateAsksAndItCanGoOnNextTime) {
    const TemporaryFolder folder;
    EditorOptions options;
    options.configFolder = folder / "config";
    options.stateFolder = folder / "state";
    options.checkpointSeconds = 0;
    const fs::path capture = PaintedRoom::get().capture;
    {
        Editor editor(options);
        const auto until = [&](const std::function<bool()>& done) {
            while (!done()) {
                editor.poll();
                std::this_thread::sleep_for(std::chrono::milliseconds(1));
            }
        };
        editor.openNow(capture);
        until([&] { return !editor.job(); });
        editor.state.solve.quality = "draft";
        editor.solve(editor.state.solve);
        until([&] { return editor.estimate() || !editor.job(); });
        ASSERT_TRUE(editor.job());
        EXPECT_EQ(editor.state.viewport.mode, ViewMode::relit) << "the first answer is brought up";
        editor.requestQuit();
        EXPECT_FALSE(editor.quitting());
        ASSERT_TRUE(editor.state.unsaved);
        EXPECT_TRUE(editor.state.unsaved->estimating);
        EXPECT_FALSE(editor.state.unsaved->edits);
        editor.answerUnsaved(false, false);
        EXPECT_FALSE(editor.quitting());
        ASSERT_TRUE(editor.job()) << "it goes on";
        editor.requestQuit();
        editor.answerUnsaved(false, true);
        EXPECT_TRUE(editor.quitting());
    }
    const Editor next(options);
    ASSERT_TRUE(next.state.interrupted);
    EXPECT_EQ(next.state.interrupted->captureFolder, capture);
}

TEST(NothingLost, theFirstAnswerIsBroughtUpOnce) {
    Panels p;
    p.openCapture();
    Editor& editor = *p.editor;
    ASSERT_EQ(editor.state.viewport.mode, ViewMode::photograph);
    editor.solve(editor.state.solve);
    p.until([&] { return editor.estimate() || !editor.job(); });
    EXPECT_EQ(editor.state.viewport.mode, ViewMode::relit);
    editor.state.viewport.mode = ViewMode::photograph;
    p.until([&] { return !editor.job(); });
    EXPECT_EQ(editor.state.viewport.mode, ViewMode::photograph) << "who looks at the photographs keeps them";
}

TEST(NothingLost, oneBarForTheWholeJobNeverGoesBack) {
    Panels p;
    p.openCapture();
    Editor& editor = *p.editor;
    editor.solve(editor.state.solve);
    double last = 0;
    bool told = false;
    p.until([&] {
        if (!editor.job()) return true;
        if (const auto whole = editor.job()->whole) {
            EXPECT_GE(*whole, last);
            EXPECT_LT(*whole, 1);
            last = *whole;
            told = true;
        }
        return false;
    });
    EXPECT_TRUE(told);
    last = 0;
    ExportRequest request;
    request.views = ExportRequest::Views::all;
    request.samples = 2;
    request.file = p.folder / "frame.####.png";
    request.layers.clear();
    editor.exportFrames(request);
    bool timed = false;
    p.until([&] {
        if (!editor.job()) return true;
        if (const auto whole = editor.job()->whole) {
            EXPECT_GE(*whole, last);
            last = *whole;
            timed = timed || editor.job()->secondsLeft;
        }
        return false;
    });
    EXPECT_TRUE(timed);
    EXPECT_GT(last, 0.5);
    EXPECT_TRUE(editor.state.notices.empty());
}

TEST(NothingLost, timeLeftIsToldInWholeSecondsAndNeverAsNothing) {
    JobStatus job;
    job.seconds = 7;
    EXPECT_EQ(timeLeftWords(job), "7 s");
    job.secondsLeft = 0.02;
    EXPECT_EQ(timeLeftWords(job), "finishing");
    job.secondsLeft = 12.4;
    EXPECT_EQ(timeLeftWords(job), "about 13 s left");
    job.secondsLeft = 61;
    EXPECT_EQ(timeLeftWords(job), "about 1 min 5 s left");
    job.paused = true;
    EXPECT_EQ(timeLeftWords(job), "paused");
}

TEST(MovedShot, itsCaptureIsLocatedOrLeftOut) {
    Panels p;
    p.openSolved();
    const MovedShot moved;
    Editor& editor = *p.editor;
    // Both moved together: the relative path holds.
    fs::rename(moved.folder / "a", moved.folder / "b");
    const fs::path shot = moved.folder / "b/room.relamp", capture = moved.folder / "b/room";
    editor.openNow(shot);
    settle(p);
    EXPECT_FALSE(editor.state.missing);
    EXPECT_EQ(editor.state.document.captureFolder, capture);
    // The capture alone: asked, and nothing is opened by Cancel.
    const fs::path elsewhere = moved.folder / "elsewhere";
    fs::rename(capture, elsewhere);
    editor.openNow(shot);
    settle(p);
    ASSERT_TRUE(editor.state.missing);
    EXPECT_EQ(editor.state.missing->what, MissingQuestion::What::capture);
    EXPECT_EQ(editor.state.missing->path, capture);
    p.frame({});
    p.frames(3);
    EXPECT_TRUE(dialogOpen(editor));
    p.key(keyEscape);
    p.frames(3);
    EXPECT_FALSE(editor.state.missing);
    EXPECT_TRUE(editor.state.notices.empty());
    // Located.
    editor.openNow(shot);
    settle(p);
    ASSERT_TRUE(editor.state.missing);
    editor.answerMissing(MissingAnswer::located, elsewhere);
    settle(p);
    EXPECT_TRUE(editor.state.notices.empty());
    EXPECT_EQ(editor.state.document.captureFolder, elsewhere);
    EXPECT_TRUE(editor.state.document.samples);
    // Saving keeps the new place, and leaving without it asks.
    EXPECT_TRUE(editor.unsavedChanges());
    editor.save();
    p.until([&] { return !editor.unsavedChanges(); });
    editor.openNow(shot);
    settle(p);
    EXPECT_FALSE(editor.state.missing);
    EXPECT_FALSE(editor.unsavedChanges());
    fs::rename(elsewhere, moved.folder / "third");
    const size_t vertices = editor.state.document.scene->mesh.vertexCount();
    // Without it: the same mesh and light, no photographs.
    editor.openNow(shot);
    settle(p);
    editor.answerMissing(MissingAnswer::without);
    settle(p);
    ASSERT_TRUE(editor.state.document.capture);
    EXPECT_TRUE(editor.state.notices.empty());
    EXPECT_TRUE(editor.state.document.capture->views.empty());
    EXPECT_FALSE(editor.state.document.samples);
    EXPECT_EQ(editor.state.document.scene->mesh.vertexCount(), vertices);
    EXPECT_FALSE(editor.emitters().empty());
    EXPECT_TRUE(editor.liveFrame());
}

TEST(MovedShot, theAbsolutePathIsTakenWhereTheRelativeOneFails) {
    Panels p;
    p.openSolved();
    const MovedShot moved;
    moved.change([&](Json& document) {
        document["capture"] = "../not-here";
        document["capture_absolute"] = moved.capture.string();
    });
    p.editor->openNow(moved.shot);
    settle(p);
    EXPECT_FALSE(p.editor->state.missing);
    EXPECT_EQ(p.editor->state.document.captureFolder, moved.capture);
}

TEST(MovedShot, itsEnvironmentIsLocatedByAnEdit) {
    Panels p;
    p.openSolved();
    const MovedShot moved;
    moved.change([](Json& document) {
        document["look"]["environment"] = {{"source", "file"}, {"file", "sky.exr"}, {"yaw_degrees", 30}};
    });
    Editor& editor = *p.editor;
    editor.openNow(moved.shot);
    settle(p);
    ASSERT_TRUE(editor.state.missing);
    EXPECT_EQ(editor.state.missing->what, MissingQuestion::What::environment);
    writeSky(moved.folder / "sky.exr");
    editor.answerMissing(MissingAnswer::located, moved.folder / "sky.exr");
    settle(p);
    EXPECT_TRUE(editor.state.notices.empty());
    EXPECT_EQ(editor.look().environment.file, moved.folder / "sky.exr");
    EXPECT_FLOAT_EQ(editor.look().environment.yawDegrees, 30);
    EXPECT_TRUE(editor.unsavedChanges());
    EXPECT_TRUE(editor.history().canUndo());
}

TEST(MovedShot, theFolderOfItsMeasuredMaterialsIsLocated) {
    Panels p;
    p.openSolved();
    const MovedShot moved;
    moved.folder.write("a/merl/paint.binary",
                       relamp::test::merlBytes([](const Vec3&, const Vec3&) { return Rgb(0.1f); }));
    Progress progress;
    Shot shot = openShot(moved.shot, false, progress);
    Reflectance& r = shot.estimate.reflectance;
    const size_t lobe = r.basis.lobes.size();
    r.basis.lobes.push_back(readMeasuredLobes(moved.folder / "a/merl").at(0));
    r.weight.push_back(r.weight[0]);
    saveShot(shot, shot.capture.mesh, moved.shot, true);
    fs::rename(moved.folder / "a/merl", moved.folder / "elsewhere");
    Editor& editor = *p.editor;
    editor.openNow(moved.shot);
    settle(p);
    ASSERT_TRUE(editor.state.missing);
    EXPECT_EQ(editor.state.missing->what, MissingQuestion::What::measured);
    EXPECT_EQ(editor.state.missing->path, moved.folder / "a/merl/paint.binary");
    // A folder that does not have it asks again.
    editor.answerMissing(MissingAnswer::located, moved.folder.path());
    settle(p);
    ASSERT_TRUE(editor.state.missing);
    editor.answerMissing(MissingAnswer::located, moved.folder / "elsewhere");
    settle(p);
    EXPECT_FALSE(editor.state.missing);
    ASSERT_TRUE(editor.state.notices.empty()) << editor.state.notices[0].text;
    EXPECT_EQ(editor.state.document.shotFolder, moved.shot);
    const Lobe& found = editor.estimate()->reflectance.basis.lobes.at(lobe);
    ASSERT_EQ(found.kind, Lobe::Kind::measured);
    EXPECT_EQ(found.measured->file, moved.folder / "elsewhere/paint.binary");
}

TEST(SavingAShot, proposesOneSuffixAndNumbersVersions) {
    Panels p;
    p.openSolved();
    Editor& editor = *p.editor;
    EXPECT_EQ(nameToSave(editor.state.document), "room.relamp");
    editor.state.document.shotFolder = "/x/room.relamp.relamp";
    EXPECT_EQ(nameToSave(editor.state.document), "room.relamp");
    editor.saveAs(p.folder / "mine.relamp");
    p.until([&] { return editor.state.document.shotFolder == p.folder / "mine.relamp"; });
    for (const char* next : {"mine-002.relamp", "mine-003.relamp"}) {
        editor.saveVersion();
        p.until([&] { return editor.state.document.shotFolder.filename() == next; });
    }
    EXPECT_TRUE(fs::exists(p.folder / "mine.relamp/shot.json"));
}

TEST(Snapshots, areKeptWithTheShotAndRecalledByOneEdit) {
    Panels p;
    p.openSolved();
    Editor& editor = *p.editor;
    const std::string id = editor.emitters()[0].id;
    editor.storeSnapshot(0);
    EXPECT_TRUE(editor.unsavedChanges()) << "a snapshot is not lost by leaving";
    editor.edit("Off", [&](Look& look) { setEnabled(look, id, false); });
    editor.storeSnapshot(1);
    const size_t entries = editor.history().entries().size();
    editor.recallSnapshot(0);
    EXPECT_TRUE(editor.emitter(id)->enabled);
    EXPECT_EQ(editor.history().entries().size(), entries + 1);
    editor.undo();
    EXPECT_FALSE(editor.emitter(id)->enabled);
    editor.recallSnapshot(2);
    EXPECT_EQ(editor.history().index() + 1, editor.history().entries().size() - 1) << "there is none";
    // The one that is compared with is drawn by a worker of its own.
    editor.setEye(relamp::test::cameraAt({2, -1.5, 1.5}, {0, 0, 0.2}, 80, 60, 80), false);
    editor.state.viewport.mode = ViewMode::compare;
    settle(p);
    ASSERT_TRUE(editor.beforeFrame());
    ASSERT_TRUE(editor.liveFrame());
    EXPECT_NE(editor.beforeFrame()->radiance, editor.liveFrame()->radiance);
    editor.state.viewport.compareWith = 1;
    settle(p);
    EXPECT_EQ(editor.beforeFrame()->radiance, editor.liveFrame()->radiance);
    editor.saveAs(p.folder / "mine.relamp");
    p.until([&] { return !editor.unsavedChanges(); });
    editor.openNow(p.folder / "mine.relamp");
    settle(p);
    ASSERT_TRUE(editor.state.snapshots[0] && editor.state.snapshots[1]);
    EXPECT_FALSE(editor.state.snapshots[2]);
    EXPECT_EQ(editor.state.snapshots[1]->look, editor.look());
    EXPECT_FALSE(editor.unsavedChanges());
}

TEST(Snapshots, stayUnsavedWhenSavingFails) {
    Panels p;
    p.openSolved();
    Editor& editor = *p.editor;
    editor.storeSnapshot(0);
    p.folder.write("a file", "x");
    editor.saveAs(p.folder / "a file/mine.relamp");
    p.until([&] { return !editor.state.notices.empty(); });
    EXPECT_TRUE(editor.unsavedChanges());
}

TEST(Escape, leavesTheBrushOfLightBeforeTheSelection) {
    Panels p;
    p.openSolved();
    Editor& editor = *p.editor;
    const std::vector<std::string> selected{editor.emitters()[0].id};
    editor.state.selection.emitters = selected;
    editor.state.viewport.tool = Tool::paint;
    EXPECT_TRUE(runAction(editor, "edit.selectNone"));
    EXPECT_EQ(editor.state.viewport.tool, Tool::select);
    EXPECT_EQ(editor.state.selection.emitters, selected);
    EXPECT_TRUE(runAction(editor, "edit.selectNone"));
    EXPECT_TRUE(editor.state.selection.emitters.empty());
}

TEST(LightClipboard, pastesLightsAndTheirValues) {
    Panels p;
    p.openSolved();
    Editor& editor = *p.editor;
    const EmitterState first = editor.emitters()[0];
    EXPECT_EQ(first.name, "Light 1");
    editor.state.selection.emitters = {first.id};
    copyLights(editor);
    pasteLights(editor);
    ASSERT_EQ(editor.look().added.size(), 1u);
    const EmitterState* pasted = editor.emitter(editor.state.selection.active());
    ASSERT_TRUE(pasted);
    EXPECT_NEAR(glm::distance(pasted->pivot, first.pivot), 0, 1e-4);
    EXPECT_EQ(pasted->radiance, first.radiance);
    EXPECT_NEAR(powerOf(editor, *pasted), powerOf(editor, first), 1e-3 * double(powerOf(editor, first)));
    editor.edit("Dim", [&](Look& look) {
        setRadiance(look, *editor.estimate(), first.id, first.radiance * Rgb(0.5f, 0.2f, 0.1f));
    });
    pasteLightValues(editor);
    editor.state.selection.emitters = {first.id};
    pasteLightValues(editor);
    EXPECT_NEAR(editor.emitter(first.id)->radiance.z, first.radiance.z, 1e-4);
    editor.undo();
    EXPECT_NEAR(editor.emitter(first.id)->radiance.z, 0.1f * first.radiance.z, 1e-4);
}

TEST(LiveImage, isOwedUntilItShowsTheStepOfTheHand) {
    Panels p;
    p.openSolved();
    Editor& editor = *p.editor;
    p.until([&] { return editor.liveFrame() && !editor.imageOwed() && !editor.busy(); });
    const std::string id = editor.emitters()[0].id;
    const auto before = editor.liveFrame();
    editor.beginGesture("Move");
    Mat4 by(1);
    by[3] = Vec4(0.1f, 0, 0, 1);
    editor.preview([&](Look& look) { moveEmitter(look, id, by); });
    editor.requestImage();
    // On a busy machine the image may be there before this thread goes on.
    p.until([&] { return !editor.imageOwed(); });
    // The first image that comes has the light at its new place.
    EXPECT_NE(editor.liveFrame()->mesh, before->mesh);
    editor.abandonGesture();
}

TEST(Scope, goesWithItsDocument) {
    Panels p;
    p.openCapture();
    p.editor->state.scope = std::make_shared<const relamp::Scope>();
    p.editor->state.probe = Rgb(1);
    p.openCapture();
    EXPECT_FALSE(p.editor->state.scope);
    EXPECT_FALSE(p.editor->state.probe);
}

TEST(TemperatureTint, theOneLeavesTheOther) {
    for (const float kelvin : {2400.0f, 3200.0f, 6504.0f, 12000.0f})
        for (const float tint : {-0.6f, 0.0f, 0.4f}) {
            const TemperatureTint back = splitColour(3.0f * joinColour({kelvin, tint}));
            EXPECT_NEAR(back.kelvin, kelvin, 0.002f * kelvin);
            EXPECT_NEAR(back.tint, tint, 2e-3);
            EXPECT_NEAR(luminance(joinColour({kelvin, tint})), 1, 1e-4);
        }
    EXPECT_EQ(splitColour(Rgb(0)).tint, 0);
}

}  // namespace
}  // namespace relamp::ui::test
