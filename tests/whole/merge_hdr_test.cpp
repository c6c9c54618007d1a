// relamp merge-hdr, run as a user runs it.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "image/image_io.h"
#include "support/run_program.h"
#include "support/temporary_folder.h"
#include "whole/relamp_program.h"

namespace relamp {
namespace {

using nlohmann::json;
using test::expectBadInput;
using test::relamp;

TEST(CommandLine, BracketsAreMergedFromTheirTimes) {
    const test::TemporaryFolder folder;
    const std::vector<double> times{0.25, 1, 4};
    for (size_t i = 0; i < times.size(); ++i) {
        Image image(120, 90);
        for (int y = 0; y < 90; ++y)
            for (int x = 0; x < 120; ++x)
                image.at(x, y) = Rgb(std::pow(10.0f, -2.2f + 2.2f * float(x) / 119)) * float(times[i]);
        writeImage(folder / fmt::format("{}.png", i), image);
    }
    const std::string a = folder / "0.png", b = folder / "1.png", c = folder / "2.png", out = folder / "out.exr";
    const test::ProgramResult merged = relamp({"merge-hdr", a, b, c, "-o", out, "--times", "0.25,1,4", "--response",
                                               folder / "curve.json", "--ghosts", folder / "ghosts.png"});
    ASSERT_EQ(merged.exitCode, 0) << merged.error;
    EXPECT_EQ(merged.out, "");
    const Image image = readImage(out);
    // sRGB's own curve is found: radiance grows by 10^(2.2 / 119) from pixel to pixel.
    EXPECT_NEAR(std::log10(image.at(100, 40).y / image.at(40, 40).y), 60 * 2.2 / 119, 0.06);
    EXPECT_EQ(json::parse(test::TemporaryFolder::read(folder / "curve.json"))["log_exposure"]["g"].size(), 256u);
    EXPECT_EQ(readImage(folder / "ghosts.png").at(60, 40), Rgb(1));
    expectBadInput(relamp({"merge-hdr", a, b, "-o", out}), {a, "exposure time"});
    // A curve that was written serves again, for two exposures of the three as well.
    const std::string curve = folder / "curve.json", again = folder / "again.exr";
    ASSERT_EQ(relamp({"merge-hdr", a, b, "-o", again, "--times", "0.25,1", "--use-response", curve}).exitCode, 0);
    EXPECT_NEAR(readImage(again).at(80, 40).y / image.at(80, 40).y, 1, 0.05);
    for (const char* bad :
         {"[1, 2]", "{\"log_exposure\": 5}", "{\"log_exposure\": {\"r\": [1]}}", "{\"log_exposure\": {\"r\": [[[[", ""})
        expectBadInput(relamp({"merge-hdr", a, b, "-o", again, "--times", "0.25,1", "--use-response",
                               folder.write("bad.json", bad)}),
                       {"bad.json"});
    for (const std::vector<std::string>& wrong :
         std::vector<std::vector<std::string>>{{"merge-hdr", a, "-o", out},
                                               {"merge-hdr", a, b, "-o", out, "--times", "1"},
                                               {"merge-hdr", a, b, "-o", out, "--times", "1,0"},
                                               {"merge-hdr", a, b, "-o", folder / "x.png", "--times", "1,2"}})
        EXPECT_EQ(relamp(wrong).exitCode, 2) << wrong.back();
}

}  // namespace
}  // namespace relamp
