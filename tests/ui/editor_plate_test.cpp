// A plate in the editor without a window: imported, followed, kept with the shot, relit.
#include <gtest/gtest.h>

#include "actions.h"
#include "plate_player.h"
#include "relit_plate.h"
#include "support/exr_header.h"
#include "ui/editor_session.h"

namespace relamp::ui {
namespace {
namespace fs = std::filesystem;

/// Photographs 0, 1, 3 and 4 of the capture as frames of a plate, number 3 at half its size; the capture's cameras are
/// its track, which goes on to 5.
PlateLook writePlate(const fs::path& folder) {
    fs::create_directories(folder);
    for (const int i : {0, 1, 4})
        fs::copy_file(captureFolder() / fmt::format("images/{:02}.exr", i), folder / fmt::format("plate.{:02}.exr", i));
    const Image whole = readImage(captureFolder() / "images/03.exr");
    writeImage(folder / "plate.03.exr", Image(whole.width / 2, whole.height / 2));
    fs::copy_file(captureFolder() / "transforms.json", folder / "track.json");
    PlateLook look;
    look.files = folder / "plate.##.exr";
    look.cameras = folder / "track.json";
    look.match = "off";
    return look;
}

struct PlateSession : Session {
    PlateLook plate;
    PlateSession() {
        openEstimated();
        editor->setEye(eyeAt(40, 30), false);
        plate = writePlate(folder / "shots/plate");
    }
    void import() {
        editor->importPlate(plate);
        until([&] { return !editor->job(); });
    }
};

TEST(EditorPlate, ImportAndRemovalAreOneEditEachAndWhatIsLackingIsNamed) {
    PlateSession s;
    Editor& e = *s.editor;
    s.import();
    ASSERT_EQ(e.state.notices.size(), 1u);
    EXPECT_NE(e.state.notices[0].text.find("frames 2 are missing"), std::string::npos) << e.state.notices[0].text;
    EXPECT_NE(e.state.notices[0].text.find("plate.03.exr: is "), std::string::npos) << e.state.notices[0].text;
    ASSERT_TRUE(e.plate());
    ASSERT_EQ(e.plate()->plate.frames.size(), 3u) << "the rest can be used";
    EXPECT_EQ(e.state.time.first, 0);
    EXPECT_EQ(e.state.time.last, 4);
    EXPECT_EQ(e.history().index(), 1u);
    EXPECT_TRUE(e.unsavedChanges());
    e.undo();
    EXPECT_FALSE(e.look().plate || e.plate() || e.plateCamera());
    e.poll();
    EXPECT_EQ(e.state.time.first, 1) << "the strip has its own frames again";
    EXPECT_EQ(e.state.time.last, 48);
    EXPECT_EQ(e.state.time.frame, 1);
    e.redo();
    EXPECT_TRUE(e.plate()) << "at once, without being opened again";
    e.poll();
    EXPECT_EQ(e.state.time.last, 4);
    // Keys and other edits leave it alone, and it makes no key.
    e.setKey();
    EXPECT_TRUE(runAction(e, "file.removePlate"));
    EXPECT_FALSE(e.look().plate);
    EXPECT_EQ(e.look().keys.size(), 1u);
    e.undo();
    e.goToFrame(3);
    e.edit("Turn", [](Look& look) { look.environment.yawDegrees = 9; });
    EXPECT_EQ(e.look().keys.size(), 2u);
    EXPECT_TRUE(e.plate());
    e.storeSnapshot(0);
    e.edit("Reset the look", resetLook);
    EXPECT_TRUE(e.plate());
    e.recallSnapshot(0);
    EXPECT_TRUE(e.plate());
}

TEST(EditorPlate, CameraAndImageFollowTheFrameAndPlaying) {
    PlateSession s;
    Editor& e = *s.editor;
    s.import();
    const auto& views = e.state.document.capture->views;
    ASSERT_TRUE(e.plateCamera());
    for (const auto& [frame, shown] : {std::pair(4, 4), {1, 1}, {3, 1}}) {  // 3 cannot be used: the last one stays
        e.goToFrame(frame);
        s.until([&] { return e.plateImage() && e.plateImage()->frame == shown; });
        EXPECT_EQ(e.plateCamera()->worldFromCamera, views[size_t(shown)].camera.worldFromCamera);
        const PlateImage& image = *e.plateImage();
        const Image& photograph = views[size_t(shown)].image;
        ASSERT_EQ(image.pixels.size(), photograph.pixels.size());
        for (size_t p = 0; p < image.pixels.size(); p += 31)
            EXPECT_NEAR(image.at(p).x, photograph.pixels[p].x, 1e-5f + 5e-4f * photograph.pixels[p].x) << "a half";
    }
    s.settle();
    // One pass keeps every frame, though the eye is another in each.
    e.state.time.loop = false;
    e.state.time.framesPerSecond = 1000;
    e.goToFrame(0);
    e.play(true);
    s.until([&] { return !e.state.time.playing; });
    for (int frame = 0; frame <= 4; ++frame) EXPECT_TRUE(e.frameKept(frame)) << frame;
    EXPECT_EQ(e.plateImage()->frame, 4);
    // A photograph is looked through instead, and then neither.
    e.state.viewport.throughView = true;
    EXPECT_FALSE(e.plateCamera() || e.plateImage());
}

TEST(PlatePlayer, ALoopLongerThanItsMemoryReadsOnlyWhatFindsNoRoom) {
    PlateSession s;
    s.import();
    PlatePlayer player([] {});
    const auto shown = [&](int frame, bool playing, size_t mostBytes) {
        s.until([&] { return player.show(s.editor->plate(), frame, playing, mostBytes).empty() && player.ready(); });
        EXPECT_EQ(player.image()->frame, frame);
    };
    shown(0, true, 1);
    const size_t one = player.image()->bytes();
    for (int round = 0; round < 3; ++round) {
        const size_t before = player.read();
        for (const int frame : {0, 1, 4}) shown(frame, true, one);
        s.until([&] { return player.show(s.editor->plate(), 4, true, one).empty() && !player.working(); });
        // In the first round one is kept, and stays.
        if (round > 0) { EXPECT_LE(player.read() - before, 2u) << "of three"; }
    }
    // At rest what is far away makes room.
    shown(4, false, one);
    shown(1, false, one);
    const size_t before = player.read();
    shown(1, true, one);
    EXPECT_EQ(player.read(), before);
}

TEST(EditorPlate, IsSavedWithTheShotAndFoundWhereverBothOrOneOfThemWent) {
    PlateSession s;
    Editor& e = *s.editor;
    s.plate.offset = 0;
    s.plate.curve = "linear";
    s.import();
    e.state.notices.clear();
    e.saveAs(s.folder / "shots/mine.relamp");
    s.settle();
    ASSERT_FALSE(e.unsavedChanges());
    const auto opened = [&](const fs::path& shot) {
        s.open(shot);
        s.until([&] { return e.plate() != nullptr; });
        return e.plate()->plate.frames.empty() ? fs::path() : e.plate()->plate.frames.front().file;
    };
    EXPECT_EQ(opened(s.folder / "shots/mine.relamp"), s.folder / "shots/plate/plate.00.exr");
    EXPECT_EQ(e.look().plate->curve, "linear");
    EXPECT_FALSE(e.unsavedChanges());
    EXPECT_EQ(e.state.time.last, 4);
    EXPECT_FALSE(e.plateCamera()) << "opening leaves the view alone";
    fs::rename(s.folder / "shots/mine.relamp", s.folder / "alone.relamp");
    EXPECT_EQ(opened(s.folder / "alone.relamp"), s.folder / "shots/plate/plate.00.exr") << "by its absolute place";
    fs::rename(s.folder / "alone.relamp", s.folder / "shots/mine.relamp");
    fs::rename(s.folder / "shots", s.folder / "moved");
    EXPECT_EQ(opened(s.folder / "moved/mine.relamp"), s.folder / "moved/plate/plate.00.exr") << "both moved";
    EXPECT_TRUE(e.state.notices.empty());
    // Gone: said, and the shot is there.
    fs::rename(s.folder / "moved/plate", s.folder / "gone");
    EXPECT_EQ(opened(s.folder / "moved/mine.relamp"), fs::path());
    ASSERT_EQ(e.state.notices.size(), 1u);
    EXPECT_EQ(e.state.notices[0].title, "The plate cannot be shown");
    EXPECT_TRUE(e.estimate());
}

TEST(EditorPlate, RelitFramesAreWrittenAndThoseItLacksAreNamed) {
    PlateSession s;
    Editor& e = *s.editor;
    s.import();
    e.state.notices.clear();
    e.setKey();
    e.goToFrame(4);
    e.edit("Off", [](Look& look) { setEnabled(look, "emitter-1", false); });
    e.goToFrame(0);
    e.edit("As captured", [](Look& look) { setEnabled(look, "emitter-1", true); });
    e.moveKey(0, 1);
    ExportRequest request;
    request.views = ExportRequest::Views::plate;
    request.range = "1-4";
    request.plateSamples = 1;
    request.exr = {"piz", true};
    request.layers = "groups,cryptomatte";
    request.file = s.folder / "relit.####.exr";
    e.exportFrames(request);
    ASSERT_TRUE(e.job()) << e.state.notices[0].text;
    EXPECT_EQ(e.job()->title, "Rendering 2 frames");
    s.until([&] { return !e.job(); });
    ASSERT_EQ(e.state.notices.size(), 1u);
    EXPECT_EQ(e.state.notices[0].title, "2 frames could not be written");
    EXPECT_NE(e.state.notices[0].text.find("frame 2"), std::string::npos) << e.state.notices[0].text;
    const Image captured = readImage(captureFolder() / "images/04.exr"), relit = readImage(s.folder / "relit.0004.exr");
    ASSERT_EQ(relit.pixels.size(), captured.pixels.size());
    EXPECT_EQ(relamp::test::readExrHeader(s.folder / "relit.0004.exr").compression, "piz");
    EXPECT_EQ(relamp::test::readExrHeader(s.folder / "relit.0004.exr").channels.at("R"), "float");
    double before = 0, after = 0;
    for (size_t p = 0; p < relit.pixels.size(); ++p)
        before += double(luminance(captured.pixels[p])), after += double(luminance(relit.pixels[p]));
    EXPECT_LT(after, 0.9 * before);
    EXPECT_GT(after, 0.05 * before);
    EXPECT_FALSE(fs::exists(s.folder / "relit.0003.exr"));
    // What a matte holds out stays as it is. It is a change of the plate, which can be undone.
    e.state.notices.clear();
    writeImage(s.folder / "white.exr", Image(captured.width, captured.height, Rgb(1)));
    s.plate.matte = s.folder / "white.exr";
    s.import();
    e.state.notices.clear();
    ASSERT_EQ(e.plate()->plate.frames.size(), 3u);
    request.range = "4";
    request.file = s.folder / "held.exr";
    e.exportFrames(request);
    s.until([&] { return !e.job(); });
    ASSERT_TRUE(e.state.notices.empty()) << e.state.notices[0].text;
    const Image held = readImage(s.folder / "held.exr");
    for (size_t p = 0; p < held.pixels.size(); p += 7)
        EXPECT_NEAR(held.pixels[p].y, captured.pixels[p].y, 1e-3f * captured.pixels[p].y + 1e-6f);
    e.undo();
    EXPECT_TRUE(e.plate()->look.matte.empty());
    request.range = "1-4";
    // Its own frames are not written over.
    e.state.notices.clear();
    request.file = s.plate.files;
    const std::string bytes = TemporaryFolder::read(s.folder / "shots/plate/plate.01.exr");
    e.exportFrames(request);
    s.until([&] { return !e.job(); });
    EXPECT_FALSE(e.state.notices.empty());
    EXPECT_TRUE(TemporaryFolder::read(s.folder / "shots/plate/plate.01.exr") == bytes);
}

TEST(EditorExport, ATurntableAndWaysThroughViewsAndBookmarksFollowTheKeys) {
    Session s;
    s.openEstimated();
    Editor& e = *s.editor;
    e.setKey();
    e.goToFrame(3);
    e.edit("Off", [](Look& look) { setEnabled(look, "emitter-1", false); });
    ExportRequest request;
    request.views = ExportRequest::Views::path;
    request.range = "2,1,2";
    request.moveFrames = 3;
    request.samples = 1;
    request.layers = "correction";
    request.file = s.folder / "way.#.exr";
    e.exportFrames(request);
    s.until([&] { return !e.job(); });
    request.views = ExportRequest::Views::turntable;
    request.moveFrames = 2;
    request.width = 32, request.height = 24;
    request.file = s.folder / "turn.#.exr";
    e.exportFrames(request);
    s.until([&] { return !e.job(); });
    // Of two bookmarks one looks at the room, the other past it.
    request.views = ExportRequest::Views::bookmarks;
    request.range = "2,1";
    request.file = s.folder / "kept.#.exr";
    e.edit("Two bookmarks", [](Look& look) {
        CameraBookmark view;
        view.target = {0, 0, 0.5f};
        look.bookmarks = {view, view};
        look.bookmarks[0].target.z = 1e4f;
        look.bookmarks[0].name = "away";
        look.bookmarks[1].name = "there";
    });
    e.exportFrames(request);
    s.until([&] { return !e.job(); });
    ASSERT_TRUE(e.state.notices.empty()) << e.state.notices[0].text;
    const auto sumOf = [&](const char* name) {
        double sum = 0;
        for (const Rgb& pixel : readImage(s.folder / name).pixels) sum += double(luminance(pixel));
        return sum;
    };
    EXPECT_LT(sumOf("way.3.exr"), 0.95 * sumOf("way.1.exr")) << "the same camera, the light off";
    EXPECT_EQ(readImage(s.folder / "turn.2.exr").width, 32);
    EXPECT_EQ(readImage(s.folder / "kept.2.exr").width, 32);
    EXPECT_NE(sumOf("kept.1.exr"), sumOf("kept.2.exr")) << "from one bookmark to the other";
    EXPECT_FALSE(fs::exists(s.folder / "turn.3.exr"));
    // Where frames went is remembered, as long as the place is there, and how they were packed.
    e.state.exportFrames.file = request.file;
    e.state.exportFrames.exr = {"piz", true};
    e.state.time.keptMiB = 4096;
    s.editor.reset();
    s.start();
    EXPECT_EQ(s.editor->state.exportFrames.file, request.file);
    EXPECT_EQ(s.editor->state.exportFrames.exr, (ExrFormat{"piz", true}));
    EXPECT_EQ(s.editor->state.time.keptMiB, 4096);
    s.editor->state.exportFrames.file = s.folder / "gone/turn.#.exr";
    s.editor.reset();
    s.start();
    EXPECT_TRUE(s.editor->state.exportFrames.file.empty());
}

TEST(EditorPlate, BadFilesAreNamedAndTheDialogComesBackWithThem) {
    PlateSession s;
    Editor& e = *s.editor;
    const PlateLook good = s.plate;
    for (const auto& [change, words] : std::vector<std::pair<std::function<void(PlateLook&)>, std::string>>{
             {[](PlateLook& p) { p.files = p.files.parent_path() / "none.####.exr"; }, "holds no such frame"},
             {[](PlateLook& p) { p.cameras += ".chan"; }, "track.json.chan"},
             {[](PlateLook& p) { p.offset = 500; }, "an offset of the camera moves them"},
             {[](PlateLook& p) { p.matte = p.files.parent_path() / "matte.####.exr"; }, "matte.####.exr"}}) {
        s.plate = good;
        change(s.plate);
        s.import();
        ASSERT_EQ(e.state.notices.size(), 1u) << words;
        EXPECT_NE(e.state.notices[0].text.find(words), std::string::npos) << e.state.notices[0].text;
        EXPECT_EQ(e.state.notices[0].text.find("--"), std::string::npos) << e.state.notices[0].text;
        EXPECT_TRUE(e.state.plateImport == s.plate);
        EXPECT_FALSE(e.look().plate);
        EXPECT_EQ(e.history().index(), 0u);
        e.state.notices.clear();
        e.state.plateImport.reset();
    }
}

TEST(EditorPlate, ADroppedSequenceIsOfferedAndSoIsItsCamera) {
    PlateSession s;
    Editor& e = *s.editor;
    const fs::path folder = s.folder / "shots/plate";
    e.openDropped({folder / "plate.00.exr", folder / "plate.01.exr"});
    ASSERT_TRUE(e.state.plateImport);
    EXPECT_EQ(e.state.plateImport->files, folder / "plate.##.exr");
    e.openDropped({folder / "track.chan"});
    EXPECT_EQ(e.state.plateImport->files, folder / "plate.##.exr");
    EXPECT_EQ(e.state.plateImport->cameras, folder / "track.chan");
    e.state.plateImport.reset();
    e.openDropped({folder});
    ASSERT_TRUE(e.state.plateImport) << "a folder of frames";
    EXPECT_EQ(e.state.plateImport->files, folder / "plate.##.exr");
    e.state.plateImport.reset();
    // One image is another environment, and a capture is opened.
    e.openDropped({folder / "plate.00.exr"});
    EXPECT_FALSE(e.state.plateImport);
    s.until([&] { return !e.job(); });
    e.undo();
    e.openDropped({captureFolder()});
    EXPECT_FALSE(e.state.plateImport);
    s.until([&] { return !e.job(); });
}

TEST(EditorPlate, AtRestItIsShownAsItIsExported) {
    PlateSession s;
    Editor& e = *s.editor;
    s.import();
    e.state.exportFrames.plateSamples = 2;
    e.goToFrame(1);
    s.until([&] { return e.plateImage() && e.plateImage()->frame == 1; });
    const auto plain = e.plateImage();
    EXPECT_TRUE(runAction(e, "time.plateRelit"));
    s.until([&] { return e.relitPlateImage() && !e.relightingPlate(); });
    EXPECT_EQ(e.plateImage()->pixels, plain->pixels) << "nothing is edited";
    e.edit("Off", [](Look& look) { setEnabled(look, "emitter-1", false); });
    s.until([&] { return e.relitPlateImage()->pixels != plain->pixels && !e.relightingPlate(); });
    const auto off = e.plateImage();
    EXPECT_EQ(off, e.relitPlateImage());
    double before = 0, after = 0;
    for (size_t p = 0; p < plain->pixels.size(); ++p) before += double(plain->at(p).y), after += double(off->at(p).y);
    EXPECT_LT(after, 0.95 * before);
    // The second pass is what the export computes.
    Progress progress;
    Look look = e.history().present().look;
    look.bookmarks.clear();
    std::shared_ptr<const PlateGains> gains;
    const PlateImage exported =
        relitPlateImage({e.plate(), e.state.document.scene, e.estimate(), look, 1, 2, e.state.exportFrames.denoise},
                        PlateRequest{}.neighbours, gains, progress);
    s.until([&] { return e.relitPlateImage()->pixels == exported.pixels; });
    // A drag stops it and is never waited for; its last image stays until the next.
    e.beginGesture("Turn");
    e.preview([](Look& l) { l.environment.yawDegrees = 90; });
    s.until([&] { return !e.relightingPlate(); });
    EXPECT_EQ(e.plateImage()->pixels, exported.pixels);
    e.abandonGesture();
    e.state.viewport.plateRelit = false;
    EXPECT_EQ(e.plateImage()->pixels, plain->pixels);
    // The mode Relit shows it relit by its own light, after the model, and the model again while a light moves.
    e.state.viewport.mode = ViewMode::relit;
    e.edit("Dim", [&](Look& l) { l.environment.exposureStops = -1; });
    e.setEye(*e.plateCamera(), false);
    e.poll();
    s.until([&] { return e.relitAtRest() != nullptr; });
    EXPECT_TRUE(e.restFrame());
    EXPECT_FALSE(e.relitPlateImage()) << "nobody asked for the steadied one";
    look = e.history().present().look;
    look.bookmarks.clear();
    const PlateImage alone =
        relitPlateImage({e.plate(), e.state.document.scene, e.estimate(), look, 1, 2, e.state.exportFrames.denoise}, 0,
                        gains, progress);
    EXPECT_TRUE(e.relitAtRest()->pixels == alone.pixels);
    e.beginGesture("Turn");
    e.preview([](Look& l) { l.environment.yawDegrees = 90; });
    e.poll();
    EXPECT_FALSE(e.relitAtRest());
    e.abandonGesture();
    s.until([&] { return e.relitAtRest() != nullptr; });
    e.state.viewport.plateOpacity = 0.5f;
    EXPECT_FALSE(e.relitAtRest()) << "the model before a faded plate";
}

}  // namespace
}  // namespace relamp::ui
