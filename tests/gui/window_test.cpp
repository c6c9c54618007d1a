// The real editor in a real window: mouse, keys, screenshots, files. A session as an artist would have it.
#include <gtest/gtest.h>

#include "gui/desktop.h"
#include "relight/look.h"
#include "shot/shot_file.h"
#include "support/colmap_copy.h"
#include "support/known_world.h"
#include "support/run_program.h"

namespace relamp {
namespace {

using test::Box;
using test::Desktop;
using test::expectSameFrame;
using test::imageOf;
using test::state;
using Json = nlohmann::json;

/// With everything in it at three quarters of its size, as much fits as into 1280 x 800.
constexpr int width = 960, height = 600;

double differenceIn(const Image& a, const Image& b, const Box& box) {
    return test::differenceIn(a, b, box.x0, box.y0, box.x1, box.y1);
}

/// An image with more than one colour in it.
double contrastIn(const Image& image, const Box& box) {
    Image flat(image.width, image.height);
    Rgb mean(0);
    float count = 0;
    for (int y = box.y0; y < box.y1; ++y)
        for (int x = box.x0; x < box.x1; ++x) mean += image.at(x, y), ++count;
    std::fill(flat.pixels.begin(), flat.pixels.end(), mean / count);
    return differenceIn(image, flat, box);
}

/// White in the lower left quarter.
Image quarterMatte(const std::filesystem::path& photograph) {
    const auto [w, h] = readImageSize(photograph);
    Image matte(w, h);
    for (int y = h / 2; y < h; ++y)
        for (int x = 0; x < w / 2; ++x) matte.at(x, y) = Rgb(1);
    return matte;
}

/// Where the matte is white both show the same.
void expectHeldOut(const std::filesystem::path& one, const std::filesystem::path& other) {
    const Image a = readImage(one), b = readImage(other);
    ASSERT_EQ(a.pixels.size(), b.pixels.size());
    for (int y = a.height / 2; y < a.height; ++y)
        for (int x = 0; x < a.width / 2; ++x)
            ASSERT_NEAR(a.at(x, y).y, b.at(x, y).y, 1e-3f * b.at(x, y).y + 1e-6f) << "pixel " << x << ", " << y;
}

/// The photographs stand for a plate: imported with a matte, a light keyed over its frames, a key dragged and put back,
/// played, undone, relit as the command line does it.
void relightAPlate(const Desktop& desk, const std::filesystem::path& capture, const std::filesystem::path& shot) {
    const size_t entry = desk.map()["entry"];
    const std::string files = (capture / "images/##.exr").string(), track = (capture / "transforms.json").string();
    desk.key("ctrl+shift+p");
    desk.type("import plate");
    desk.key("Return");
    ASSERT_TRUE(desk.untilItem("plate Frames"));
    desk.click("plate Frames");
    desk.type(files, 8);
    desk.click("plate Camera");
    desk.type(track, 8);
    const std::filesystem::path mattes = capture.parent_path() / "matte.##.png";
    for (int i = 0; i < 8; ++i)
        writeImage(capture.parent_path() / fmt::format("matte.{:02}.png", i),
                   quarterMatte(capture / fmt::format("images/{:02}.exr", i)));
    desk.click("plate Matte");
    desk.type(mattes.string(), 8);
    desk.screenshot("08-import-plate");
    desk.click("import plate");
    ASSERT_TRUE(desk.until([&](const Json& m) { return m["entry"] == entry + 1 && m["plate_frame"] == 1; }, 30))
        << state(desk);
    EXPECT_EQ(desk.map()["notice"], "");
    const Box image = imageOf(desk);
    desk.moveTo((image.x0 + image.x1) / 2, (image.y0 + image.y1) / 2);
    desk.key("k");
    ASSERT_TRUE(desk.until([&](const Json& m) { return m["entry"] == entry + 2; }, 10)) << state(desk);
    const Image first = desk.screenshot("08-plate-first");
    const Json strip = desk.map()["items"].at("frames strip");
    desk.click(strip[2].get<int>() - 4, strip[3].get<int>() - 8);
    ASSERT_TRUE(desk.until([](const Json& m) { return m["time"] == 7 && m["plate_frame"] == 7; }, 10)) << state(desk);
    desk.moveTo((image.x0 + image.x1) / 2, (image.y0 + image.y1) / 2);
    desk.key("ctrl+a");
    desk.key("m");
    ASSERT_TRUE(desk.until([&](const Json& m) { return m["entry"] == entry + 3; }, 10)) << state(desk);
    EXPECT_GT(differenceIn(desk.screenshot("08-plate-last"), first, image), 0.01) << "another camera and another light";
    // The key of the last frame is dragged to the one before, and put back.
    const int end = strip[2].get<int>(), wide = end - strip[0].get<int>(), middle = strip[3].get<int>() - 12;
    desk.drag(end - 14, middle, end - 14 - wide / 7, middle);
    ASSERT_TRUE(
        desk.until([&](const Json& m) { return m["label"] == "Move key from frame 7 to 6" && m["time"] == 6; }, 10))
        << state(desk);
    desk.screenshot("08-plate-key-dragged");
    desk.key("ctrl+z");
    ASSERT_TRUE(desk.until([&](const Json& m) { return m["entry"] == entry + 3; }, 10)) << state(desk);
    desk.click(end - 4, strip[3].get<int>() - 8);
    ASSERT_TRUE(desk.until([](const Json& m) { return m["time"] == 7; }, 10)) << state(desk);
    // The exposure alone is keyed here, and changed at another frame.
    std::string exposure;
    const Json shown = desk.map()["items"];
    for (const auto& item : shown.items())
        if (item.key().starts_with("Exposure of")) exposure = item.key();
    const auto [x, y] = desk.middleOf(exposure);
    desk.click(x, y, 3);
    desk.click("value Set key");
    ASSERT_TRUE(desk.until([&](const Json& m) { return m["entry"] == entry + 4; }, 10)) << state(desk);
    desk.click(strip[0].get<int>() + 4, strip[3].get<int>() - 8);
    ASSERT_TRUE(desk.until([](const Json& m) { return m["time"] == 0; }, 10)) << state(desk);
    desk.drag(x, y, x + 60, y);
    ASSERT_TRUE(desk.until([&](const Json& m) { return m["entry"] == entry + 5; }, 10)) << state(desk);
    desk.screenshot("08-plate-value");
    desk.key("space");
    ASSERT_TRUE(desk.until([](const Json& m) { return m["time"] == 4 && m["plate_frame"] == 4; }, 30)) << state(desk);
    desk.key("space");
    desk.key("ctrl+z");
    ASSERT_TRUE(desk.until([&](const Json& m) { return m["entry"] == entry + 4; }, 10)) << state(desk);
    desk.key("ctrl+shift+z");
    ASSERT_TRUE(desk.until([&](const Json& m) { return m["entry"] == entry + 5; }, 10)) << state(desk);
    desk.key("ctrl+s");
    ASSERT_TRUE(desk.until([](const Json& m) { return m["unsaved"] == false; }, 30)) << state(desk);

    desk.key("F12");
    desk.click("export plate");
    desk.click("##plate frames");
    desk.key("ctrl+a");
    desk.type("3-4");
    desk.click("##file");
    desk.key("ctrl+a");
    const std::filesystem::path byWindow = desk.home() / "relit.04.exr", byLine = desk.home() / "line.04.exr";
    desk.type((desk.home() / "relit.##.exr").string(), 8);
    desk.key("Tab");
    desk.screenshot("08-export-plate");
    desk.click("Export");
    ASSERT_TRUE(desk.until([&](const Json& m) { return m["job"] == "" && std::filesystem::exists(byWindow); }, 60))
        << state(desk);
    EXPECT_EQ(desk.map()["notice"], "");
    const test::ProgramResult line =
        test::runProgram({RELAMP_BINARY, "render", shot.string(), "-o", (desk.home() / "line.##.exr").string(),
                          "--frames", "3-4", "--layers", "groups"});
    ASSERT_EQ(line.exitCode, 0) << line.error;
    expectSameFrame(byWindow, byLine);
    expectSameFrame(desk.home() / "relit.03.exr", desk.home() / "line.03.exr");
    expectHeldOut(byWindow, capture / "images/04.exr");
}

TEST(GuiWindow, anArtistOpensEstimatesMovesTheEmitterSwapsTheSkyAndExports) {
    Desktop desk(width, height);
    const test::TemporaryFolder folder;
    test::paintSmallWorld(folder / "table", 8, 24);
    desk.start({"--quality", "draft", "--scale", "0.75", "--width", std::to_string(width), "--height",
                std::to_string(height), (folder / "table").string()});
    ASSERT_TRUE(desk.until([](const Json& m) { return m["document"] == "table"; })) << state(desk);

    // Estimate with a key; stages and intermediate images while it runs.
    desk.moveTo(width / 2, height / 2);
    desk.key("ctrl+Return");
    ASSERT_TRUE(desk.until([](const Json& m) { return m["job"] != ""; }, 10)) << state(desk);
    EXPECT_TRUE(desk.until([](const Json& m) { return m["job"] != "" && m["live"] == true; }, 100))
        << "no intermediate image";
    // One bar for the whole job, which never goes back.
    double progress = 0;
    bool back = false;
    ASSERT_TRUE(desk.until(
        [&](const Json& m) {
            if (m["job"] == "") return m["estimate"] == true;
            const double now = m["progress"];
            back = back || now < progress;
            progress = now;
            return false;
        },
        200))
        << state(desk);
    EXPECT_FALSE(back);
    EXPECT_GT(progress, 0.5);
    ASSERT_TRUE(desk.settled());
    Json map = desk.map();
    EXPECT_EQ(map["mode"], 2);
    EXPECT_EQ(map["notice"], "");
    const Box image = imageOf(desk);
    const Image asCaptured = desk.screenshot("01-estimated");
    EXPECT_GT(contrastIn(asCaptured, image), 0.02);

    // Every view mode draws something of its own.
    Image last = asCaptured;
    for (const int mode : {1, 3, 4, 5, 6, 7, 8, 9, 2}) {
        desk.key(std::to_string(mode));
        ASSERT_TRUE(desk.until([&](const Json& m) { return m["mode"] == mode; }, 10)) << mode;
        ASSERT_TRUE(desk.settled()) << mode;
        const Image now = desk.screenshot("02-mode-" + std::to_string(mode));
        EXPECT_GT(differenceIn(now, last, image), 0.003) << mode;
        last = now;
    }

    // Select the emitter in the image, drag it by a handle of the gizmo, undo.
    desk.click("emitter:emitter-1");
    ASSERT_TRUE(desk.until([](const Json& m) { return m["selected"] == Json{"emitter-1"}; }, 10)) << state(desk);
    desk.click("##move");
    ASSERT_TRUE(desk.untilItem("gizmo:x"));
    // The pointer away from everything it would light up.
    const auto away = [&] {
        desk.moveTo(width / 2, height - 4);
        desk.pause();
        ASSERT_TRUE(desk.settled());
        ASSERT_TRUE(desk.until([](const Json& m) { return m["rest"] == true && m["busy"] == false; }, 60));
        for (Json frame; frame != desk.map()["frame"];) {  // edges are smoothed at rest
            frame = desk.map()["frame"];
            std::this_thread::sleep_for(std::chrono::seconds(1));
        }
    };
    away();
    const Image before = desk.screenshot("03-selected");
    const size_t entries = desk.map()["entries"];
    const auto [gx, gy] = desk.middleOf("gizmo:x");
    const auto [cx, cy] = desk.middleOf("gizmo:centre");
    desk.drag(gx, gy, gx + 2 * (gx - cx), gy + 2 * (gy - cy));
    ASSERT_TRUE(desk.until([&](const Json& m) { return m["entries"] == entries + 1; }, 10)) << "a drag is one entry";
    EXPECT_NE(desk.map()["label"].get<std::string>().find("Move"), std::string::npos);
    ASSERT_TRUE(desk.settled());
    const Image moved = desk.screenshot("04-moved");
    EXPECT_GT(differenceIn(moved, before, image), 0.01);
    desk.key("ctrl+z");
    ASSERT_TRUE(desk.until([&](const Json& m) { return m["entry"] == entries - 1; }, 10)) << state(desk);
    away();
    // A busy machine takes two samples a pixel in place of three: 0.0043 between such images.
    EXPECT_LT(differenceIn(desk.screenshot("05-undone"), before, image), 0.006);
    // A foreign file is no edit, and what was undone can still be done again.
    std::ofstream(desk.home() / "cameras.json") << "{}";
    desk.key("ctrl+o");
    ASSERT_TRUE(desk.untilItem("##path"));
    desk.click("##path");
    desk.key("ctrl+a");
    desk.type((desk.home() / "cameras.json").string());
    desk.key("Return");
    ASSERT_TRUE(desk.until([](const Json& m) { return m["notice"] != "" && m["items"].contains("OK"); }, 30))
        << state(desk);
    desk.click("OK");
    desk.key("ctrl+shift+z");
    ASSERT_TRUE(desk.until([&](const Json& m) { return m["entry"] == entries; }, 10)) << state(desk);

    // The same by keys: G, axis, number, Enter; Esc takes everything back.
    desk.moveTo((image.x0 + image.x1) / 2, (image.y0 + image.y1) / 2);
    desk.key("g");
    ASSERT_TRUE(desk.until([](const Json& m) { return m["gesture"] == true; }, 10)) << state(desk);
    desk.key("Escape");
    ASSERT_TRUE(desk.until([](const Json& m) { return m["gesture"] == false; }, 10)) << state(desk);
    EXPECT_EQ(desk.map()["entry"], entries);
    desk.key("g");
    ASSERT_TRUE(desk.until([](const Json& m) { return m["gesture"] == true; }, 10)) << state(desk);
    desk.type("z0.1");
    desk.key("Return");
    ASSERT_TRUE(desk.until([&](const Json& m) { return m["gesture"] == false && m["entry"] == entries + 1; }, 10))
        << state(desk);

    // Another environment by its panel and the file browser.
    Image sky(64, 32);
    for (int y = 0; y < 32; ++y)
        for (int x = 0; x < 64; ++x) sky.at(x, y) = y < 16 ? Rgb(0.1f, 0.4f, 2) : Rgb(0.05f);
    writeImage(desk.home() / "sky.exr", sky);
    ASSERT_TRUE(desk.settled());
    desk.click("Load HDRI...");
    ASSERT_TRUE(desk.untilItem("##path"));
    desk.click("##path");
    desk.key("ctrl+a");
    desk.type((desk.home() / "sky.exr").string());
    desk.key("Return");
    desk.screenshot("06-browser");
    if (!desk.until([&](const Json& m) { return m["entry"] == entries + 2; }, 3)) desk.key("Return");
    ASSERT_TRUE(desk.until([&](const Json& m) { return m["entry"] == entries + 2; }, 10)) << state(desk);
    ASSERT_TRUE(desk.settled());
    EXPECT_EQ(desk.map()["notice"], "");
    const Image blue = desk.screenshot("06-sky");
    EXPECT_GT(differenceIn(blue, moved, image), 0.01);

    // Only a part of the image is rendered at rest, until that is given up.
    const int middleX = (image.x0 + image.x1) / 2, middleY = (image.y0 + image.y1) / 2;
    desk.key("shift+b");
    desk.drag(middleX, middleY, middleX + 112, middleY + 75);
    ASSERT_TRUE(desk.until([](const Json& m) { return m["region"] == true && m["rest"] == true; }, 30)) << state(desk);
    const Image region = desk.screenshot("06-region");
    // Beside the region and inside it, away from its border, whose lines are as wide in any window.
    for (const Box& same : {Box{image.x0, image.y0, middleX - 6, image.y1},
                            {middleX + 118, image.y0, image.x1, image.y1},
                            {middleX + 6, middleY + 6, middleX + 106, middleY + 69}})
        EXPECT_LT(differenceIn(region, blue, same), 0.03) << same.x0 << ", " << same.y0;
    EXPECT_GT(differenceIn(region, blue, {middleX - 4, middleY - 4, middleX + 4, middleY + 79}), 0.01)
        << "its border is drawn";
    desk.key("shift+b");
    ASSERT_TRUE(desk.until([](const Json& m) { return m["region"] == false; }, 10)) << state(desk);
    ASSERT_TRUE(desk.settled());

    // Save the shot, then export a frame and compare it with the command line's for the same look.
    desk.key("ctrl+s");
    ASSERT_TRUE(desk.untilItem("##save name"));
    desk.click("##path");
    desk.key("ctrl+a");
    desk.type(desk.home().path().string());
    desk.key("Return");
    desk.pause();
    desk.click("##save name");
    desk.key("ctrl+a");
    desk.type("mine.relamp");
    desk.screenshot("07-save");
    desk.key("Return");
    ASSERT_TRUE(desk.until([](const Json& m) { return m["unsaved"] == false; }, 30)) << state(desk);
    const std::filesystem::path shot = desk.home() / "mine.relamp";
    ASSERT_TRUE(std::filesystem::exists(shot / "shot.json"));
    desk.key("F12");
    ASSERT_TRUE(desk.untilItem("##file"));
    desk.click("The selected view (1)");
    desk.click("##file");
    desk.key("ctrl+a");
    desk.type((desk.home() / "window.exr").string());
    desk.key("Tab");
    desk.screenshot("07-export");
    desk.click("Export");
    ASSERT_TRUE(desk.until(
        [&](const Json& m) { return m["job"] == "" && std::filesystem::exists(desk.home() / "window.exr"); }, 60))
        << state(desk);
    const test::ProgramResult line =
        test::runProgram({RELAMP_BINARY, "render", shot.string(), "-o", (desk.home() / "line.exr").string(), "--camera",
                          std::to_string(desk.map()["view"].get<int>()), "--layers", "groups"});
    ASSERT_EQ(line.exitCode, 0) << line.error;
    expectSameFrame(desk.home() / "window.exr", desk.home() / "line.exr");
    desk.key("Escape");
    relightAPlate(desk, folder / "table", shot);

    // Close it like an artist: nothing is unsaved, so nothing is asked.
    desk.key("Escape");
    desk.key("ctrl+q");
    EXPECT_EQ(desk.ended(), 0);
}

TEST(GuiWindow, aKilledEditorOffersTheWorkAgain) {
    Desktop desk(768, 480);
    const test::TemporaryFolder folder;
    test::paintSmallWorld(folder / "room");
    const std::vector<std::string> arguments{"--solve", "--quality", "draft",    "--scale", "0.75",
                                             "--width", "768",       "--height", "480",     (folder / "room").string()};
    desk.start(arguments);
    ASSERT_TRUE(desk.until([](const Json& m) { return m["estimate"] == true && m["job"] == ""; }, 60)) << state(desk);
    ASSERT_TRUE(desk.settled());
    desk.moveTo(384, 190);
    desk.key("ctrl+a");
    // Esc gives a box up and leaves the selection alone.
    const Json chosen = desk.map()["selected"];
    ASSERT_FALSE(chosen.empty()) << state(desk);
    const Json image = desk.map()["items"]["viewport"];
    const int left = image[0].get<int>() + 30, low = image[3].get<int>() - 30;
    desk.moveTo(left, low);
    desk.pause();
    desk.xdotool("mousedown 1");
    desk.pause();
    for (int i = 1; i <= 4; ++i) desk.moveTo(left + 10 * i, low - 10 * i), desk.pause();
    desk.key("Escape");
    desk.xdotool("mouseup 1");
    desk.pause();
    EXPECT_EQ(desk.map()["selected"], chosen);
    desk.key("m");
    ASSERT_TRUE(desk.until(
        [](const Json& m) { return m["label"].get<std::string>().find("Switch off") != std::string::npos; }, 10))
        << state(desk);
    const auto edited = std::chrono::steady_clock::now();
    // Within 30 seconds the edit is on disk.
    bool kept = false;
    while (!kept && std::chrono::steady_clock::now() - edited < std::chrono::seconds(30)) {
        for (const auto& entry : std::filesystem::recursive_directory_iterator(desk.home() / "state"))
            kept = kept || (entry.path().string().ends_with(".autosave.json") &&
                            test::TemporaryFolder::read(entry.path()).find("\"enabled\": false") != std::string::npos);
        desk.pause();
    }
    ASSERT_TRUE(kept);
    EXPECT_EQ(desk.end(SIGKILL), -1);

    desk.start({"--scale", "0.75", "--width", "768", "--height", "480"});
    ASSERT_TRUE(desk.until([](const Json& m) { return m["recovery"] == true; }, 30)) << state(desk);
    desk.screenshot("10-recovery");
    desk.click("Restore");
    ASSERT_TRUE(desk.until([](const Json& m) { return m["estimate"] == true && m["job"] == ""; }, 60)) << state(desk);
    EXPECT_EQ(desk.map()["label"], "Recovered work");
    EXPECT_EQ(desk.map()["unsaved"], true);
    // Leaving asks; giving it up leaves nothing behind.
    desk.key("ctrl+q");
    ASSERT_TRUE(desk.untilItem("Don't save"));
    desk.screenshot("11-unsaved");
    desk.click("Don't save");
    EXPECT_EQ(desk.ended(), 0);
    desk.start({"--scale", "0.75", "--width", "768", "--height", "480"});
    ASSERT_TRUE(desk.until([](const Json& m) { return m["frame"].get<int>() > 2; }, 30)) << state(desk);
    EXPECT_EQ(desk.map()["recovery"], false);
    // Idle draws nothing.
    std::this_thread::sleep_for(std::chrono::seconds(1));
    const int frame = desk.map()["frame"];
    std::this_thread::sleep_for(std::chrono::seconds(2));
    EXPECT_EQ(desk.map()["frame"], frame);

    // The dialog opens a COLMAP folder: into its parent, then the first line of the list.
    std::filesystem::create_directories(folder / "scans/hall");
    std::filesystem::copy(folder / "room", folder / "scans/hall/images", std::filesystem::copy_options::recursive);
    std::filesystem::rename(folder / "scans/hall/images/mesh.ply", folder / "scans/hall/mesh.ply");
    std::filesystem::rename(folder / "scans/hall/images/transforms.json", folder / "scans/hall/transforms.json");
    test::makeColmap(folder / "scans/hall", "sparse/0");
    desk.key("ctrl+o");
    ASSERT_TRUE(desk.untilItem("##path"));
    desk.click("##path");
    desk.key("ctrl+a");
    desk.type((folder / "scans").string());
    desk.key("Return");
    desk.pause();
    desk.key("Down");
    desk.screenshot("14-colmap");
    desk.key("Return");
    EXPECT_TRUE(desk.until([](const Json& m) { return m["document"] == "hall"; }, 30)) << state(desk);
    EXPECT_EQ(desk.map()["notice"], "");
}

TEST(GuiWindow, aLostContextAndBadFilesLeaveTheWindowStanding) {
    Desktop desk(1024, 640, {"RELAMP_TEST_LOSE_CONTEXT=6"});
    const test::TemporaryFolder folder;
    folder.write("broken/transforms.json", "{\"frames\": \"none\"}");
    desk.start({"--width", "1024", "--height", "640", (folder / "broken").string()});
    ASSERT_TRUE(desk.until([](const Json& m) { return m["notice"] != ""; }, 30)) << state(desk);
    EXPECT_NE(desk.map()["notice"].get<std::string>().find("frames"), std::string::npos);
    desk.screenshot("12-broken");
    // Both notices come up, one after the other, and the window goes on.
    for (int i = 0; i < 2; ++i) {
        ASSERT_TRUE(desk.until([](const Json& m) { return m["notice"] != "" && m["items"].contains("OK"); }, 30))
            << i << state(desk);
        desk.click("OK");
    }
    ASSERT_TRUE(desk.until([](const Json& m) { return m["notice"] == ""; }, 10)) << state(desk);
    desk.key("ctrl+q");
    EXPECT_EQ(desk.ended(), 0);
}

TEST(GuiWindow, anOldDriverGetsAReasonAndTheRestOfTheWindow) {
    Desktop desk(1024, 640, {"MESA_GL_VERSION_OVERRIDE=3.3", "MESA_GLSL_VERSION_OVERRIDE=330"});
    desk.start({"--width", "1024", "--height", "640"});
    ASSERT_TRUE(desk.until([](const Json& m) { return m["notice"] != ""; }, 30)) << state(desk);
    const std::string notice = desk.map()["notice"];
    EXPECT_NE(notice.find("4.3"), std::string::npos) << notice;
    EXPECT_NE(notice.find("3.3"), std::string::npos) << notice;
    desk.screenshot("13-old-driver");
    desk.click("OK");
    desk.key("ctrl+q");
    EXPECT_EQ(desk.ended(), 0);
}

}  // namespace
}  // namespace relamp
