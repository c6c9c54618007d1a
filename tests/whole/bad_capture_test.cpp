// The real program on captures that are broken.
#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "support/known_world.h"
#include "support/run_program.h"
#include "whole/relamp_program.h"

namespace relamp {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using test::expectBadInput;
using test::relamp;

/// Captures that are broken in one way each.
class BadCapture : public testing::Test {
protected:
    void SetUp() override {
        test::paintKnownWorld(folder / "capture", true, 5, 12);
        file = json::parse(test::TemporaryFolder::read(folder / "capture/transforms.json"));
    }
    test::ProgramResult solve() {
        folder.write("capture/transforms.json", file.dump());
        return relamp({"solve", folder / "capture", "-o", folder / "x.relamp", "--quality", "draft"});
    }
    void fillImages(const Rgb& value) {
        for (int i = 0; i < 5; ++i)
            writeImage(folder / fmt::format("capture/images/{:02}.exr", i), Image(96, 72, value));
    }
    /// One sentence and exit code 3, or a finished shot that says what was wrong: never a crash, never silence.
    void expectSentenceOrNote() {
        const test::ProgramResult r = solve();
        EXPECT_EQ(r.out, "");
        if (r.exitCode == 0) {
            EXPECT_TRUE(fs::exists(folder / "x.relamp/shot.json"));
            EXPECT_NE(r.error, "");
            // The shot can be read back.
            EXPECT_EQ(relamp({"info", folder / "x.relamp", "--json"}).exitCode, 0);
            EXPECT_EQ(
                relamp({"render", folder / "x.relamp", "-o", folder / "f.exr", "--samples", "1", "--size", "16x12"})
                    .exitCode,
                0);
        } else {
            expectBadInput(r, {});
            EXPECT_FALSE(fs::exists(folder / "x.relamp"));
        }
    }
    test::TemporaryFolder folder;
    json file;
};

TEST_F(BadCapture, WithAMissingImage) {
    fs::remove(folder / "capture/images/02.exr");
    expectBadInput(solve(), {"transforms.json", "frame 2", "02.exr"});
}

TEST_F(BadCapture, WithAnImageOfAnotherSize) {
    writeImage(folder / "capture/images/01.exr", Image(48, 36, Rgb(1)));
    expectBadInput(solve(), {"frame 1", "01.exr", "48 x 36"});
}

TEST_F(BadCapture, WithASingularMatrix) {
    file["frames"][3]["transform_matrix"][1] = {0, 0, 0, 0};
    expectBadInput(solve(), {"transforms.json", "frame 3", "transform_matrix"});
}

TEST_F(BadCapture, WithZeroFocalLength) {
    file["fl_x"] = 0;
    expectBadInput(solve(), {"transforms.json", "fl_x is 0"});
}

TEST_F(BadCapture, WithNoTriangles) {
    folder.write("capture/mesh.ply",
                 "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float "
                 "z\nelement face 0\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n");
    expectBadInput(solve(), {"mesh.ply"});
}

TEST_F(BadCapture, WithBrokenJson) {
    folder.write("capture/transforms.json", "{\"w\": ");
    expectBadInput(relamp({"solve", folder / "capture", "-o", folder / "x.relamp"}), {"transforms.json"});
}

TEST_F(BadCapture, WithNaNEverywhere) {
    fillImages(Rgb(std::numeric_limits<float>::quiet_NaN()));
    expectSentenceOrNote();
}

TEST_F(BadCapture, WithOneViewOfNaN) {
    writeImage(folder / "capture/images/01.exr", Image(96, 72, Rgb(std::numeric_limits<float>::infinity())));
    const test::ProgramResult r = solve();
    EXPECT_EQ(r.exitCode, 0) << r.error;
}

TEST_F(BadCapture, ThatIsBlack) {
    fillImages(Rgb(0));
    expectSentenceOrNote();
}

TEST_F(BadCapture, ThatIsClippedAllOver) {
    for (int i = 0; i < 5; ++i) {
        writeImage(folder / fmt::format("capture/images/{:02}.png", i), Image(96, 72, Rgb(1)));
        file["frames"][size_t(i)]["file_path"] = fmt::format("images/{:02}.png", i);
    }
    expectSentenceOrNote();
}

TEST_F(BadCapture, WithShuffledCamerasIsPoorUnlessThatIsAccepted) {
    const json frames = file["frames"];
    for (size_t i = 0; i < frames.size(); ++i)
        file["frames"][i]["file_path"] = frames[(i + 2) % frames.size()]["file_path"];
    EXPECT_EQ(solve().exitCode, 4);
    EXPECT_EQ(relamp({"solve", folder / "capture", "-o", folder / "x.relamp", "--quality", "draft", "--overwrite",
                      "--accept-poor"})
                  .exitCode,
              0);
}

TEST_F(BadCapture, WithOneViewOnly) {
    file["frames"] = {file["frames"][1]};
    expectSentenceOrNote();
}

TEST_F(BadCapture, WhoseCamerasSeeNothing) {
    // All stand far away and look away from the scene.
    for (auto& frame : file["frames"])
        frame["transform_matrix"] = {{1, 0, 0, 500}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}};
    expectSentenceOrNote();
}

TEST_F(BadCapture, WithCamerasInsideTheGround) {
    for (auto& frame : file["frames"])
        frame["transform_matrix"] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, -0.5}, {0, 0, 0, 1}};
    expectSentenceOrNote();
}

}  // namespace
}  // namespace relamp
