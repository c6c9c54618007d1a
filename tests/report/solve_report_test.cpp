// The page of one solve, from figures put together by hand and from a whole solve.
#include "report/solve_report.h"

#include <gtest/gtest.h>

#include "support/known_world.h"
#include "support/run_program.h"

namespace relamp {
namespace {

SolveReport byHand() {
    SolveReport r;
    r.shot = "a & b.relamp";
    r.capture = "room";
    r.estimate.mode = "near-field";
    r.estimate.timeline = {
        {0.5, "light from ratios", 0, 9, 0.4}, {0.8, "light from ratios", 1, 5, 0.2}, {1.5, "reflectance", 2, 0, 0.1}};
    r.estimate.stability = {1e-9, 1e4, 3, 4, "", {1, 0.1f, 1e-3f, 1e-7f}};
    r.estimate.leftOut = {{Omission::glossyLobes, "no surface changes with the view"}};
    r.views = {{"one, two.exr", 31.25, 0}};
    return r;
}

TEST(SolveReport, IsOnePageWithoutAnythingFromElsewhere) {
    const std::string page = reportPage(byHand());
    EXPECT_NE(page.find("a &amp; b.relamp"), std::string::npos);
    for (const char* word : {"light from ratios", "glossy lobes", "3 of 4", "31.2 dB", "<svg"})
        EXPECT_NE(page.find(word), std::string::npos) << word;
    EXPECT_EQ(page.find("<script"), std::string::npos);
    EXPECT_EQ(page.find("src=\"http"), std::string::npos);
    EXPECT_EQ(reportPage(byHand()), page);
}

TEST(SolveReport, ShowsThePlanBesideWhatWasMeasured) {
    SolveReport r = byHand();
    EXPECT_EQ(reportPage(r).find("<h2>Plan"), std::string::npos) << "nothing where there is none";
    r.estimate.plan.stages.push_back({Stage::visibility, 2.5, 3.25, 40, 41});
    r.estimate.plan.leftOut.push_back({Omission::distantLight, "black & empty", 7, 30});
    const std::string page = reportPage(r);
    for (const char* word : {"visibility", "2.50 s", "3.25 s", "40 MiB", "black &amp; empty", "7.00 s"})
        EXPECT_NE(page.find(word), std::string::npos) << word;
}

TEST(SolveReport, ShowsTheTruthOverTime) {
    SolveReport r = byHand();
    EXPECT_EQ(truthPlot(r), "");
    EXPECT_EQ(truthCsv(r), "");
    r.truthOverTime = {{1.5, 20}, {3, 26.02}};
    EXPECT_EQ(truthCsv(r), "seconds,psnr_db\n1.5000,20.000\n3.0000,26.020\n");
    EXPECT_NE(truthPlot(r).find("26.0 dB"), std::string::npos);
    EXPECT_NE(reportPage(r).find("Truth against run time"), std::string::npos);
}

TEST(SolveReport, QuotesWhatACommaWouldSplit) {
    EXPECT_EQ(viewsCsv(byHand()), "view,psnr_db,distant_only_psnr_db\n\"one, two.exr\",31.250,\n");
    EXPECT_EQ(timelineCsv(byHand()).substr(0, 89),
              "mode,seconds,stage,iteration,objective,error\nnear-field,0.5000,light from ratios,0,9,0.4\n");
}

TEST(SolveReport, IsWrittenForAShotWithDistantOnlyBesideIt) {
    const test::TemporaryFolder folder;
    test::paintSmallWorld(folder / "capture");
    ASSERT_EQ(test::runProgram({RELAMP_BINARY, "solve", folder / "capture", "-o", folder / "x.relamp", "--quality",
                                "draft", "--quiet"})
                  .exitCode,
              0);
    const test::ProgramResult r =
        test::runProgram({RELAMP_BINARY, "report", folder / "x.relamp", "-o", folder / "r.html", "--against-distant",
                          "on", "--quiet"});  // by itself only after a quick solve
    ASSERT_EQ(r.exitCode, 0) << r.error;
    EXPECT_NE(r.out.find("r.html"), std::string::npos);
    for (const char* file : {"r.html", "r-timeline.csv", "r-views.csv", "r-error.svg", "r-spectrum.svg"})
        EXPECT_TRUE(std::filesystem::exists(folder / file)) << file;
    EXPECT_NE(test::TemporaryFolder::read(folder / "r-timeline.csv").find("distant-only,"), std::string::npos);
    // Without its photographs the report says so and has the rest.
    std::filesystem::remove_all(folder / "capture/images");
    EXPECT_EQ(
        test::runProgram({RELAMP_BINARY, "report", folder / "x.relamp", "-o", folder / "s.html", "--quiet"}).exitCode,
        0);
    EXPECT_NE(test::TemporaryFolder::read(folder / "s.html").find("Not measured"), std::string::npos);
    EXPECT_EQ(test::runProgram({RELAMP_BINARY, "report", folder / "x.relamp", "-o", folder / "page"}).exitCode, 2);
    EXPECT_EQ(test::runProgram(
                  {RELAMP_BINARY, "report", folder / "x.relamp", "-o", folder / "t.html", "--truth", folder / "absent"})
                  .exitCode,
              3);
}

}  // namespace
}  // namespace relamp
