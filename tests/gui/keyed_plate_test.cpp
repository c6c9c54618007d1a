// A plate of 24 frames in the real window: imported, its light keyed and moved over the frames, played, undone,
// exported; the saved look gives the same frames on the command line.
#include <set>

#include "gui/desktop.h"
#include "relight/frame.h"
#include "shot/shot_file.h"
#include "support/known_world.h"
#include "support/run_program.h"

namespace relamp {
namespace {

using test::Desktop;
using test::state;
using Json = nlohmann::json;

constexpr int lastFrame = 24;

/// A camera that goes past the table in 24 frames, what it sees of the solved scene, and its track.
struct FilmedTable {
    test::TemporaryFolder folder;
    std::filesystem::path shot = folder / "table.relamp", files = folder / "plate.####.exr",
                          track = folder / "track.json";
    std::filesystem::path frame(int number) const { return folder / fmt::format("plate.{:04}.exr", number); }
    FilmedTable() {
        test::paintSmallWorld(folder / "table", 8, 24);
        const test::ProgramResult solved = test::runProgram(
            {RELAMP_BINARY, "solve", (folder / "table").string(), "-o", shot.string(), "--quality", "draft"});
        if (solved.exitCode != 0) throw std::runtime_error(solved.error);
        Progress progress;
        const Shot opened = openShot(shot, true, progress);
        const Scene scene = buildScene(opened.capture.mesh, progress);
        const RelitScene relit = test::relitOf(scene, opened.estimate, {});
        FrameOptions options;
        options.samplesPerPixel = 4;
        std::string frames;
        for (int number = 1; number <= lastFrame; ++number) {
            const double t = double(number) / lastFrame;
            const Camera camera = test::cameraAt({2 - t, -1.5 - 0.4 * t, 1.5}, {0, 0, 0.2}, 48, 36, 50);
            const Frame seen = renderFrame(relit, camera, options, progress);
            Image image(seen.width, seen.height);
            image.pixels = seen.beauty;
            writeImage(frame(number), image);
            std::string rows;
            for (int r = 0; r < 4; ++r) {
                const DMat4& m = camera.worldFromCamera;
                rows += fmt::format("{}[{},{},{},{}]", r ? "," : "", m[0][r], m[1][r], m[2][r], m[3][r]);
            }
            frames += fmt::format("{}{{\"file_path\": \"{}\", \"transform_matrix\": [{}]}}", number > 1 ? "," : "",
                                  frame(number).filename().string(), rows);
        }
        folder.write("track.json", "{\"w\": 48, \"h\": 36, \"fl_x\": 50, \"frames\": [" + frames + "]}");
    }
};

double differenceOf(const std::filesystem::path& one, const std::filesystem::path& other) {
    const Image a = readImage(one), b = readImage(other);
    return test::differenceIn(a, b, 0, 0, a.width, a.height);
}

TEST(GuiPlate, ALightKeyedOver24FramesIsTheSameOnTheCommandLine) {
    const FilmedTable table;
    Desktop desk(768, 480);
    desk.start({"--scale", "0.75", "--width", "768", "--height", "480", table.shot.string()});
    ASSERT_TRUE(desk.until([](const Json& m) { return m["estimate"] == true && m["job"] == ""; })) << state(desk);

    desk.moveTo(384, 190);
    desk.key("ctrl+shift+p");
    desk.type("import plate");
    desk.key("Return");
    desk.click("plate Frames");
    desk.type(table.files.string(), 8);
    desk.click("plate Camera");
    desk.type(table.track.string(), 8);
    desk.click("import plate");
    ASSERT_TRUE(desk.until([](const Json& m) { return m["entry"] == 1 && m["plate_frame"] == 1; }, 60)) << state(desk);
    EXPECT_EQ(desk.map()["notice"], "");

    // A key at the first frame; at the last one the light is pushed aside and made brighter.
    const test::Box image = test::imageOf(desk);
    const int middleX = (image.x0 + image.x1) / 2, middleY = (image.y0 + image.y1) / 2;
    const auto label = [&](const std::string& words) {
        return desk.until([&](const Json& m) { return m["label"].get<std::string>().find(words) == 0; }, 20);
    };
    desk.moveTo(middleX, middleY);
    desk.key("ctrl+a");
    ASSERT_TRUE(desk.until([](const Json& m) { return m["selected"] == Json{"emitter-1"}; }, 10)) << state(desk);
    desk.key("k");
    ASSERT_TRUE(label("Set key at frame 1")) << state(desk);
    const Json strip = desk.map()["items"].at("frames strip");
    desk.click(strip[2].get<int>() - 4, strip[3].get<int>() - 8);
    ASSERT_TRUE(desk.until([](const Json& m) { return m["time"] == lastFrame && m["plate_frame"] == lastFrame; }, 20))
        << state(desk);
    desk.moveTo(middleX, middleY);
    desk.key("g");
    ASSERT_TRUE(desk.until([](const Json& m) { return m["gesture"] == true; }, 10)) << state(desk);
    desk.type("x-0.5");
    desk.key("Return");
    ASSERT_TRUE(label("Move")) << state(desk);
    std::string exposure;
    const Json shown = desk.map()["items"];
    for (const auto& item : shown.items())
        if (item.key().starts_with("Exposure of")) exposure = item.key();
    ASSERT_FALSE(exposure.empty());
    const auto [x, y] = desk.middleOf(exposure);
    desk.drag(x, y, x + 60, y);
    ASSERT_TRUE(label("Exposure of")) << state(desk);
    const size_t edited = desk.map()["entry"];
    desk.screenshot("20-keyed");

    // Every frame is shown when it plays, and again when it begins anew.
    desk.moveTo(middleX, middleY);
    desk.key("space");
    std::set<int> seen;
    bool again = false;
    EXPECT_TRUE(desk.until(
        [&](const Json& m) {
            const int now = m["time"];
            again = again || (now < lastFrame / 2 && seen.count(lastFrame));
            seen.insert(now);
            return again && seen.size() >= size_t(lastFrame) - 4;
        },
        120))
        << seen.size() << state(desk);
    desk.key("space");
    ASSERT_TRUE(desk.until([](const Json& m) { return m["busy"] == false; }, 60)) << state(desk);

    // Undo takes exposure, place and key away, one by one, and redo brings them back.
    for (size_t back = 1; back <= 3; ++back) {
        desk.key("ctrl+z");
        ASSERT_TRUE(desk.until([&](const Json& m) { return m["entry"] == edited - back; }, 10)) << state(desk);
    }
    EXPECT_TRUE(label("Import plate")) << state(desk);
    for (size_t forth = 1; forth <= 3; ++forth) {
        desk.key("ctrl+shift+z");
        ASSERT_TRUE(desk.until([&](const Json& m) { return m["entry"] == edited - 3 + forth; }, 10)) << state(desk);
    }
    desk.key("ctrl+s");
    ASSERT_TRUE(desk.until([](const Json& m) { return m["unsaved"] == false; }, 30)) << state(desk);

    desk.key("F12");
    desk.click("export plate");
    desk.click("##file");
    desk.key("ctrl+a");
    desk.type((desk.home() / "window.####.exr").string(), 8);
    desk.key("Tab");
    desk.screenshot("21-export");
    desk.click("Export");
    const auto by = [&](const char* name, int number) {
        return desk.home() / fmt::format("{}.{:04}.exr", name, number);
    };
    double progress = 0;
    bool back = false;
    ASSERT_TRUE(desk.until(
        [&](const Json& m) {
            const double now = m["progress"];
            if (m["job"] == "") return std::filesystem::exists(by("window", lastFrame));
            back = back || now < progress;
            progress = now;
            return false;
        },
        300))
        << state(desk);
    EXPECT_FALSE(back) << "one bar for all frames";
    EXPECT_EQ(desk.map()["notice"], "");
    desk.key("Escape");
    desk.key("ctrl+q");
    EXPECT_EQ(desk.ended(), 0);

    for (int number = 1; number <= lastFrame; ++number)
        ASSERT_TRUE(std::filesystem::exists(by("window", number))) << number;
    const test::ProgramResult line =
        test::runProgram({RELAMP_BINARY, "render", table.shot.string(), "-o", (desk.home() / "line.####.exr").string(),
                          "--layers", "groups", "--frames", fmt::format("1,{},{}", lastFrame / 2, lastFrame)});
    ASSERT_EQ(line.exitCode, 0) << line.error;
    for (const int number : {1, lastFrame / 2, lastFrame})
        test::expectSameFrame(by("window", number), by("line", number));
    const double first = differenceOf(by("window", 1), table.frame(1)),
                 middle = differenceOf(by("window", lastFrame / 2), table.frame(lastFrame / 2)),
                 last = differenceOf(by("window", lastFrame), table.frame(lastFrame));
    EXPECT_LT(first, 0.2 * middle) << "the first key is the light as it was";
    EXPECT_GT(last, 1.3 * middle);
}

}  // namespace
}  // namespace relamp
